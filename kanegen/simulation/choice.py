"""The choice of method, step and precision by the measured error of the motion itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kanegen.extras import is_installed
from kanegen.model.arrays import Floats as Doubles
from kanegen.simulation.extrapolation import EVALUATIONS
from kanegen.simulation.growth import Growth, growth_of, prefix_end
from kanegen.simulation.methods import Method
from kanegen.simulation.promise import FOR_DIGITS, Promise

PILOT_TOLERANCE = 1e-10
"""Tolerance of the motion by which the growth of differences is measured."""

SAFETY = 0.5
"""Share of the error that is asked for which an estimate may use up."""

FIRST_STEPS = 64
"""Number of steps of the first motion that is tried."""

MOST_IN_C = 10_000_000
"""Largest number of evaluations of a motion in C."""

MOST_WITH_INPUTS = 400_000
"""Largest number of evaluations of a motion in C whose inputs are sampled in Python."""

DEAR = 0.1
"""Share of these numbers of evaluations from which on a method of higher order is tried, too."""

PILOT_STEPS = 2**15
"""Number of steps in C of the motion by which the growth of differences is measured."""

MOST_IN_PYTHON = 400_000
"""Largest number of evaluations of a motion with a call of the library for each."""

MOST_TO_CHECK = MOST_IN_PYTHON // 8
"""Largest number of evaluations of a motion by which another one is checked."""

PRICE = 50.0
"""Time of an evaluation that is called from Python over that of one in C, of a small model: about."""

TOLERANCES = tuple(10.0**-k for k in range(3, 14))
"""Tolerances of adaptive methods that are tried."""

STIFF = 0.9
"""Share of the evaluations at a tenth of the tolerance from which on steps are limited by stability."""

NEIGHBOURS = 3
"""Number of motions with a changed first state by which the growth of differences is measured."""

CHANGE = 1e-7
"""Change of the first state of a neighbour, in units of the motion, where steps are chosen by a tolerance."""

POWER = 0.7
"""Power of the rounding error that is the change where steps are fixed: far from 1, and far from rounding."""


@dataclass(frozen=True)
class Solution:
    """A motion by one method.

    Attributes:
        method: The method.
        precision: Precision of the states.
        states: (T, ..., m + n) coordinates and speeds; NaN behind a time at which it broke off.
        evaluations: Evaluations of {ydot}.
    """

    method: Method
    precision: str
    states: Doubles
    evaluations: int


Solve = Callable[[Method, str, Doubles, Doubles], tuple[Doubles, int]]
"""Function that returns (T, ..., m + n) states and the evaluations of a method in a precision, from a first
state of (..., m + n); where the motion breaks off there are fewer states."""


@dataclass(frozen=True)
class Problem:
    """A motion whose error is asked for.

    Attributes:
        solve: Computes it by a method.
        start: (..., m + n) first coordinates and speeds.
        times: (T,) times, s.
        units: Unit of each of the m + n numbers: "rad", "1", "m", "rad/s" or "m/s".
        precisions: Precisions of states that can be had, the first one first.
        in_c: Whether fixed steps run in C.
        finest: Largest first step that sees all that acts, s.
        acts: Whether something acts from outside.
    """

    solve: Solve
    start: Doubles
    times: Doubles
    units: Sequence[str]
    precisions: Sequence[str]
    in_c: bool
    finest: float = np.inf
    acts: bool = False

    @property
    def most(self) -> int:
        """Largest number of evaluations of a motion by fixed steps."""
        if not self.in_c:
            return MOST_IN_PYTHON
        return MOST_WITH_INPUTS if self.acts else MOST_IN_C

    def solution(self, method: Method, precision: str) -> Solution:
        """Return the motion by a method; NaN where it breaks off."""
        states = np.full((len(self.times), *self.start.shape), np.nan)
        found, evaluations = self.solve(method, precision, self.start, self.times)
        states[: len(found)] = found
        return Solution(method, precision, states, evaluations)

    def sizes(self, states: Doubles) -> Doubles:
        """Return the size of each number that counts as one: 1 for angles, else the largest of its unit."""
        largest = np.nanmax(np.abs(states.reshape(-1, len(self.units))), axis=0, initial=0.0)
        units = np.array(self.units)
        of_units = np.array([largest[units == unit].max() for unit in units])
        angles = np.isin(units, ("rad", "1"))
        return np.where(angles, 1.0, np.where(of_units > 0, of_units, 1.0))

    def differences(self, states: Doubles, exact: Doubles) -> Doubles:
        """Return the (T,) largest differences of two motions, infinite where one has no state."""
        relative = np.abs(states - exact) / self.sizes(exact)
        largest = relative.reshape(len(self.times), -1).max(axis=1)
        return np.where(np.isnan(largest), np.inf, largest)


@dataclass(frozen=True)
class Found:
    """A method, its coarsest motion that keeps the error longest, and a finer one.

    Attributes:
        chosen: The coarsest motion that keeps the error longest.
        finer: A motion with smaller errors, by which they are measured.
        order: Order of the method: the error falls with this power of the step.
    """

    chosen: Solution
    finer: Solution
    order: float


def choose(problem: Problem, asked: float) -> tuple[Method, str, Promise]:
    """Return the method and the precision that keep an error, and what is known about it.

    First the growth of differences is measured, which says until when rounding allows the error, and so in
    which precision. Up to then fixed steps are halved, or tolerances lowered, until the difference of two
    motions in a row is small enough, or until that no longer helps.

    Args:
        problem: The motion.
        asked: The error that is asked for, see `Promise`.
    """
    growth = _growth(problem, _pilot(problem))
    precision = _precision(problem, growth, asked)
    until = growth.kept_until(FOR_DIGITS[precision], asked)
    count = max(int(np.searchsorted(problem.times, until, "right")), min(len(problem.times), 2))
    part = replace(problem, times=problem.times[:count])
    found, others = _found(part, precision, growth, asked)
    reference = _reference(part, found, others, growth, asked)
    return found.chosen.method, precision, _promise(part, found, reference, growth, asked)


def _precision(problem: Problem, growth: Growth, asked: float) -> str:
    """Return the first precision in which rounding allows the error up to the end, or else double."""
    for precision in problem.precisions:
        if growth.kept_until(FOR_DIGITS[precision], asked * SAFETY) >= problem.times[-1]:
            return precision
    return "double" if "double" in problem.precisions else problem.precisions[-1]


def _pilot(problem: Problem) -> Solution:
    """Return a motion that is accurate enough to measure how differences grow."""
    precision = "double" if "double" in problem.precisions else problem.precisions[0]
    if not problem.in_c and problem.start.ndim == 1 and precision == "double" and is_installed("scipy"):
        return problem.solution(Method("DOP853", tolerance=PILOT_TOLERANCE), precision)
    span, steps = (
        float(problem.times[-1] - problem.times[0]),
        PILOT_STEPS if problem.in_c else FIRST_STEPS * 16,
    )
    found = problem.solution(Method("RK4", span / steps), precision)
    while not np.isfinite(found.states).all() and 4 * steps < problem.most:
        steps *= 8
        found = problem.solution(Method("RK4", span / steps), precision)
    return found


def _found(problem: Problem, precision: str, growth: Growth, asked: float) -> tuple[Found, Sequence[Found]]:
    """Return the cheapest method in a precision among those that keep the error longest, and the others."""
    found: list[Found] = []
    adaptive = precision == "double" and problem.start.ndim == 1 and is_installed("scipy")
    if problem.in_c or not adaptive:
        found.append(_coarsest(problem, _halved(problem, precision, problem.most), asked, 4.0))
    is_cheap = bool(found) and found[0].chosen.evaluations < DEAR * problem.most
    is_enough = is_cheap and _keeps(problem, found[0], asked)
    if adaptive and not (is_enough or (found and growth.is_chaotic)):
        found.append(_coarsest(problem, _tightened(problem, "DOP853", asked), asked, 8.0))
        if _is_stiff(found[-1]):
            found.append(_coarsest(problem, _tightened(problem, "Radau", asked), asked, 5.0))

    def rank(one: Found) -> tuple[float, float]:
        """Return how long a method keeps the error, and its price, so that the best is first."""
        errors = problem.differences(one.chosen.states, one.finer.states)
        in_c = problem.in_c and one.chosen.method.step is not None
        price = one.chosen.evaluations * (1 if in_c else PRICE)
        return -prefix_end(problem.times, errors, asked * SAFETY), price

    best = min(found, key=rank)
    return best, [one for one in found if one is not best]


def _is_stiff(found: Found) -> bool:
    """Return whether the stability of an explicit method limits its steps, whatever the tolerance."""
    return found.chosen.evaluations > STIFF * found.finer.evaluations and found.finer.evaluations > 1000


def _keeps(problem: Problem, found: Found, asked: float) -> bool:
    """Return whether a method keeps the error up to the end."""
    return bool((problem.differences(found.chosen.states, found.finer.states) <= asked * SAFETY).all())


def _coarsest(problem: Problem, solutions: Iterator[Solution], asked: float, order: float) -> Found:
    """Return the coarsest of ever finer motions that keeps the error, or the one that keeps it longest."""
    coarse = next(solutions)
    best: tuple[float, Found] | None = None
    idle = 0
    for fine in solutions:
        errors = problem.differences(coarse.states, fine.states)
        until = prefix_end(problem.times, errors, asked * SAFETY)
        if best is None or until > best[0]:
            best, idle = (until, Found(coarse, fine, order)), 0
        else:
            idle += 1
        if (errors <= asked * SAFETY).all() or (idle > 2 and best[0] > problem.times[0]):
            break
        coarse = fine
    assert best is not None
    return best[1]


def _halved(problem: Problem, precision: str, most: int) -> Iterator[Solution]:
    """Yield motions by the Runge-Kutta method, each with half the step of the one before."""
    span = float(problem.times[-1] - problem.times[0])
    step = min(span / max(FIRST_STEPS, len(problem.times) - 1), problem.finest)
    for k in range(60):
        if k > 1 and 4 * span / step > most:
            return
        yield problem.solution(Method("RK4", step, compensated=True), precision)
        step /= 2


def _tightened(problem: Problem, method: str, asked: float) -> Iterator[Solution]:
    """Yield motions by an adaptive method, each with a tenth of the tolerance of the one before."""
    tolerances = [one for one in TOLERANCES if one <= asked] or [*TOLERANCES[-2:]]
    tolerances = tolerances if len(tolerances) > 1 else [*TOLERANCES[-2:]]
    for k, tolerance in enumerate(tolerances):
        found = problem.solution(Method(method, tolerance=tolerance), "double")
        yield found
        if k > 0 and found.evaluations > MOST_IN_PYTHON:
            return


def _growth(problem: Problem, pilot: Solution) -> Growth:
    """Return the growth of differences: motions from changed first states, by the same method."""
    sizes = problem.sizes(pilot.states)
    change = CHANGE if pilot.method.step is None else FOR_DIGITS[pilot.precision] ** POWER
    rng = np.random.default_rng(0)
    largest = np.zeros(len(problem.times))
    for _ in range(NEIGHBOURS):
        direction = rng.choice([-1.0, 1.0], problem.start.shape)
        moved = replace(problem, start=problem.start + change * sizes * direction)
        neighbour = moved.solution(pilot.method, pilot.precision)
        found = problem.differences(neighbour.states, pilot.states)
        largest = np.maximum(largest, np.where(np.isinf(found), 0.0, found))
    return growth_of(problem.times, largest, change)


def _promise(problem: Problem, found: Found, reference: Solution, growth: Growth, asked: float) -> Promise:
    """Return what is known about the error of a chosen method.

    Args:
        problem: The motion, up to the time until which rounding allows the error.
        found: The method.
        reference: The motion with which it is compared.
        growth: The growth of differences up to the last time of the whole motion.
        asked: The error that is asked for.
    """
    chosen = found.chosen
    errors = problem.differences(chosen.states, reference.states)
    until = prefix_end(problem.times, errors, asked)
    rounding = FOR_DIGITS[chosen.precision] * float(growth.factors[-1])
    shown = str(reference.method)
    shown = shown if reference.precision == "double" else f"{shown}, {reference.precision}"
    return Promise(
        asked=asked,
        error=float(errors[problem.times <= until].max()),
        kept_until=until,
        end=float(growth.times[-1]),
        measured_by=shown if reference.method.name != chosen.method.name else f"the same method, {shown}",
        precision=chosen.precision,
        evaluations=chosen.evaluations,
        rounding=rounding,
        growth=growth,
        next_digit=10 ** (1 / found.order) if 10 * rounding < asked else np.inf,
    )


def _reference(
    problem: Problem, found: Found, others: Sequence[Found], growth: Growth, asked: float
) -> Solution:
    """Return the motion by which the error is measured: by another method where one is accurate enough.

    Fixed steps are compared with DOP853, adaptive ones with LSODA, a multistep method of ODEPACK, and what
    SciPy does not compute, such as long double, with extrapolated steps. Where none of these is accurate
    enough in a bounded number of evaluations, it is a finer motion by the same method.
    """
    chosen = found.chosen
    tolerance = 0.01 * asked / float(growth.factors[len(problem.times) - 1])
    can = chosen.precision == "double" and problem.start.ndim == 1 and is_installed("scipy")
    if chosen.method.step is not None and can and tolerance >= TOLERANCES[-1]:
        other = problem.solution(Method("DOP853", tolerance=min(tolerance, 1e-6)), "double")
        agrees = problem.differences(other.states, found.finer.states) <= asked
        if agrees.all() or other.evaluations < MOST_IN_PYTHON:
            return other
    tried = (one.finer for one in others if _keeps(problem, one, asked))
    checks = _multistep(problem, tolerance) if chosen.method.step is None else _extrapolated(problem, chosen)
    return next(tried, None) or _settled(problem, checks, found.finer, asked) or found.finer


def _settled(
    problem: Problem, solutions: Iterator[Solution], known: Solution, asked: float
) -> Solution | None:
    """Return the first of ever finer motions that agrees with a known one, or with the one before.

    To agree is to differ by at most a tenth of the error that is asked for. None is returned where none does.
    """
    before = known
    for fine in solutions:
        for other in (known, before):
            if (problem.differences(fine.states, other.states) <= 0.1 * asked).all():
                return fine
        before = fine
    return None


def _multistep(problem: Problem, tolerance: float) -> Iterator[Solution]:
    """Yield motions by LSODA, each with a hundredth of the tolerance of the one before."""
    tolerances = {max(factor * tolerance, TOLERANCES[-1]) for factor in (1.0, 1e-2, 1e-4)}
    for one in sorted(tolerances, reverse=True):
        yield problem.solution(Method("LSODA", tolerance=min(one, 1e-6)), "double")


def _extrapolated(problem: Problem, chosen: Solution) -> Iterator[Solution]:
    """Yield motions by extrapolated steps, each with half the step of the one before.

    No step is longer than the largest interval between two times, so that halving changes it.
    """
    span = float(problem.times[-1] - problem.times[0])
    step = min(span * EVALUATIONS / chosen.evaluations, float(np.diff(problem.times).max()), problem.finest)
    while EVALUATIONS * span / step < MOST_TO_CHECK:
        yield problem.solution(Method("extrapolation", step, compensated=True), chosen.precision)
        step /= 2
