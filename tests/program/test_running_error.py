"""Running errors cover the rounding of random programs, which exact arithmetic shows."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kanegen.program.builder import Builder
from kanegen.program.evaluate import evaluate as run
from kanegen.program.ir import TRANSCENDENTAL, Op, Output, Program
from kanegen.program.linear_bound import linear_bound
from kanegen.program.precision import DOUBLE, FLOAT, Precision
from kanegen.program.running_error import SLACK, Arithmetic, RunningErrors
from tests.support.handmade import Listing, array, evaluate
from tests.support.random_programs import EXACT, programs

STATES = st.lists(st.floats(-1e6, 1e6) | st.floats(-1e-300, 1e-300), min_size=3, max_size=3)
NUMBERS = st.floats(-1e6, 1e6) | st.sampled_from([0.1, 1.0, -2.0, 1e-308, 5e-324])
CORRECTLY_ROUNDED = 0.53
"""Error of Python's sines and cosines, in units of u: at most 0.52 units in the last place."""


ROUNDING = mpmath.mpf("1e-380")
"""More than 400 digits leave of the sine of a multiple of pi, whose sign they do not tell."""


def _known(number: mpmath.mpf) -> mpmath.mpf:
    """Return a sine or cosine, NaN where it is nothing but rounding."""
    return mpmath.nan if 0 < abs(number) < ROUNDING else number


class Functions:
    """The functions of mpmath, but for numbers whose sine or exponential would need endless digits."""

    fabs, sqrt = staticmethod(mpmath.fabs), staticmethod(mpmath.sqrt)
    tanh, atan2 = staticmethod(mpmath.tanh), staticmethod(mpmath.atan2)

    @staticmethod
    def exp(number: mpmath.mpf) -> mpmath.mpf:
        return mpmath.exp(number) if abs(number) < 1e9 else mpmath.nan

    @staticmethod
    def log(number: mpmath.mpf) -> mpmath.mpf:
        return mpmath.log(number) if number > 0 else mpmath.nan

    @staticmethod
    def sin(angle: mpmath.mpf) -> mpmath.mpf:
        return _known(mpmath.sin(angle)) if abs(angle) < 1e100 else mpmath.nan

    @staticmethod
    def cos(angle: mpmath.mpf) -> mpmath.mpf:
        return _known(mpmath.cos(angle)) if abs(angle) < 1e100 else mpmath.nan


def exact_values(program: Program, x: list[float]) -> list[mpmath.mpf]:
    """Return the outputs of a program in 400 digits."""
    with mpmath.workdps(400):
        numbers = {"x": [mpmath.mpf(value) for value in x]}
        return run(program, numbers, Functions, mpmath.mpf)["f"]


def bounded(program: Program, arithmetic: Arithmetic) -> tuple[Program, list[int]]:
    """Return the program whose outputs are the values and u E of the outputs, and the places with an E."""
    builder = Builder(program.inputs)
    errors = RunningErrors(builder, program, arithmetic)
    (output,) = program.outputs
    found = [errors.error(i) for i in output.values]
    zero = builder.constant(0.0)
    values = [errors.value(i) for i in output.values] + [zero if e is None else e for e in found]
    return builder.program([Output(array("f", len(values)), tuple(values))]), [
        place for place, error in enumerate(found) if error is not None
    ]


@pytest.mark.parametrize("precision", [DOUBLE, FLOAT])
@settings(max_examples=80, deadline=None)
@given(data=st.data())
def test_no_error_exceeds_its_bound(precision: Precision, data: st.DataObject) -> None:
    sines = [] if precision is FLOAT else [Op.SIN, Op.COS]
    program = data.draw(programs([*EXACT, Op.SQRT, *sines, *TRANSCENDENTAL], NUMBERS))
    x = [float(precision.dtype.type(value)) for value in data.draw(STATES)]
    try:
        exact = exact_values(program, x)
    except (
        ZeroDivisionError,
        TypeError,
        AttributeError,
    ):  # complex numbers are not compared, and have no angle
        return
    both, inexact = bounded(program, Arithmetic(precision, CORRECTLY_ROUNDED))
    found = evaluate(both, precision.dtype.type, x=x)["f"].astype(np.float64)
    values, errors = np.split(found, 2)
    for place, truth in enumerate(exact):
        if not math.isfinite(values[place]) or not math.isfinite(errors[place]) or mpmath.isnan(truth):
            continue
        with mpmath.workdps(400):  # a root is imaginary where a negative number has become 0 in `values`
            error = abs(mpmath.mpf(values[place]) - truth)
            assert error <= (1 + SLACK) * precision.roundoff * mpmath.mpf(errors[place]), place
        if place not in inexact:
            assert error == 0


def test_bounds_are_close_where_nothing_cancels() -> None:
    """A sum of ten products of positive numbers loses at most 11 u; the bound is below 22 u."""
    code = Listing()
    letters = [code.read("x", i, f"x_{i}") for i in range(3)]
    total = code(Op.MULTIPLY, letters[0], letters[1])
    for k in range(9):
        total = code(Op.ADD, total, code(Op.MULTIPLY, letters[k % 3], letters[(k + 1) % 3]))
    program = code.program([array("x", 3)], {array("f", 1): [total]})
    both, _ = bounded(program, Arithmetic(DOUBLE, CORRECTLY_ROUNDED))
    value, error = evaluate(both, x=[0.3, 0.7, 1.1])["f"]
    assert 0 < error <= 11 * value


def test_what_is_exact_has_no_error() -> None:
    code = Listing()
    x = code.read("x", 0, "x_0")
    twice = code(Op.MULTIPLY, code.number(-2.0), x)
    program = code.program([array("x", 3)], {array("f", 3): [x, code(Op.NEGATE, twice), code.number(0.1)]})
    errors = RunningErrors(Builder(program.inputs), program, Arithmetic(FLOAT, CORRECTLY_ROUNDED))
    exact = [errors.error(i) for i in program.outputs[0].values]
    assert exact[:2] == [None, None]
    assert exact[2] is not None  # 0.1 is a double, but no float


def test_the_error_of_a_constant_is_that_of_its_rounding() -> None:
    with mpmath.workdps(90):
        third = mpmath.mpf(1) / 3
    code = Listing()
    program = code.program([array("x", 3)], {array("f", 1): [code.number(third)]})
    both, _ = bounded(program, Arithmetic(DOUBLE, CORRECTLY_ROUNDED))
    value, error = evaluate(both, x=[0.0] * 3)["f"]
    off = abs(Fraction(1, 3) - Fraction(float(value))) * 2**53
    assert off <= Fraction(float(error)) <= off * Fraction(1001, 1000)


def test_changes_of_linear_values() -> None:
    """y = (3 x_0 - x_1 / x_2): a change of x_0 by 1 and of x_1 by 2 changes y by at most 3 + 2 / |x_2|."""
    code = Listing()
    a, b, c = (code.read("x", i, f"x_{i}") for i in range(3))
    y = code(Op.SUBTRACT, code(Op.MULTIPLY, code.number(3.0), a), code(Op.DIVIDE, b, c))
    program = code.program([array("x", 3)], {array("f", 2): [y, c]})
    builder = Builder(program.inputs)
    errors = RunningErrors(builder, program, Arithmetic(DOUBLE, CORRECTLY_ROUNDED))
    changed = {a: builder.constant(1.0), b: builder.constant(2.0)}
    bounds = linear_bound(errors, builder, program, changed, [y, c])
    both = builder.program([Output(array("f", 2), tuple(bounds))])
    assert evaluate(both, x=[5.0, 7.0, -4.0])["f"] == pytest.approx([3.5, 0.0])
    with pytest.raises(ArithmeticError, match="not linear"):
        linear_bound(errors, builder, program, {c: changed[a]}, [y])
