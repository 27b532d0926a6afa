"""Motions in many digits: Taylor series of the equations of motion, in ball arithmetic.

The right sides are the literal equations in SymPy, which share nothing with generated C. Coefficients of the
series come from them, one order after another (Moore, Interval Analysis, 1966, chapter 11). Every step starts
from midpoints, so that a result is no enclosure: its digits are those in which two runs with other steps and
orders agree.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import sympy
from flint import arb, arb_series, ctx

from kanegen.symbolic.equations import Equations

Rates = Callable[..., Sequence[arb_series]]
"""Function from the series of a state, and from the parameters, to the series of its rates."""


@dataclass(frozen=True)
class Run:
    """How a motion is computed.

    Attributes:
        steps: Number of equal steps.
        order: Order of the Taylor series.
        bits: Working precision.
    """

    steps: int
    order: int
    bits: int = 256


RUNS = (Run(steps=320, order=40), Run(steps=500, order=32))
"""Two runs whose truncation errors have nothing in common."""


def rates(equations: Equations, parameters: Sequence[str]) -> Rates:
    """Return a function for the rates of a state, whose arguments are {x}, {y} and the named parameters."""
    state = [*equations.x, *equations.y]
    right = [*equations.xdot, *equations.A.LUsolve(equations.f)]
    symbols = {str(symbol): symbol for one in right for symbol in one.free_symbols}
    arguments = [*state, *(symbols[name] for name in parameters)]
    functions = {"sin": lambda u: u.sin(), "cos": lambda u: u.cos()}
    made: Rates = sympy.lambdify(arguments, right, modules=[functions, "math"], cse=True)
    return made


def motion(
    field: Rates, start: Callable[[], Sequence[arb]], parameters: Mapping[str, str], time: str, run: Run
) -> list[arb]:
    """Return the state at a time.

    Args:
        field: Rates of the state.
        start: Function that returns the first state in the working precision.
        parameters: Exact values of the parameters as decimals, in the order in which `field` takes them.
        time: Time since the first state as a decimal, s.
        run: Steps, order and precision.
    """
    cap = ctx.cap
    try:
        with ctx.workprec(run.bits):
            state, values = list(start()), [arb(value) for value in parameters.values()]
            step = arb(time) / run.steps
            for _ in range(run.steps):
                state = [_sum(series, step).mid() for series in _series(field, state, values, run.order)]
            return state
    finally:
        ctx.cap = cap


def agreed(first: arb, second: arb, most: int = 25) -> str:
    """Return the digits of a number in which two runs agree, at most `most` of them.

    The number is that of the first run; it agrees if the second differs by less than half a unit of the last
    digit.
    """
    with ctx.workprec(256):
        for digits in range(most, 0, -1):
            text = str(first.str(digits, radius=False))
            if abs(first - second) < _half_a_unit(text):
                return text
    return "none"


def _series(field: Rates, state: list[arb], values: list[arb], order: int) -> list[list[arb]]:
    """Return the Taylor coefficients of a state about the present time, one list for each of its numbers."""
    coefficients = [[number] for number in state]
    for length in range(1, order + 1):
        ctx.cap = length
        slopes = field(*(arb_series(known, length) for known in coefficients), *values)
        for known, slope in zip(coefficients, slopes, strict=True):
            known.append(arb_series(slope)[length - 1] / length)
    return coefficients


def _sum(coefficients: Sequence[arb], step: arb) -> arb:
    """Return the value of a series after a step, by Horner's rule."""
    total = arb(0)
    for coefficient in reversed(coefficients):
        total = total * step + coefficient
    return total


def _half_a_unit(text: str) -> arb:
    """Return half a unit of the last digit of a decimal without exponent."""
    return arb(10) ** -len(text.partition(".")[2]) / 2
