"""Reverse mode on programs: every operation against forward mode and differences, branches, roots at zero."""

from __future__ import annotations

from itertools import product
from math import prod
from typing import Any

import mpmath
import numpy as np
import pytest

from kanegen.lowering.embedded import Embedded, gradient
from kanegen.program.builder import Builder
from kanegen.program.constants import DOUBLE_CONSTANTS
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import ARITY, Op, Output, Program
from kanegen.program.plane_rotations import plane_rotations
from tests.support.handmade import Listing, array

SIZE = 3

OPERATIONS = [op for op in Op if ARITY[op]]


def tangent(program: Program, values: int) -> Program:
    """Return the program of the derivatives of an output along the input "d"."""
    builder = Builder((*program.inputs, array("d", SIZE)))
    embedded = Embedded(builder, program, DOUBLE_CONSTANTS, {})
    direction = [builder.input("d", i) for i in range(SIZE)]
    zero = builder.constant(0.0)
    found = embedded.tangents({"x": direction}, ["f"])["f"]
    return builder.program([Output(array("f", values), tuple(zero if v is None else v for v in found))])


def reverse(program: Program) -> Program:
    return gradient(program, ["f"], ["x"], DOUBLE_CONSTANTS)


def by_reverse(program: Program, x: list[float], weights: list[float]) -> Any:
    with np.errstate(all="ignore"):
        arrays = {"x": list(np.array(x)), "f_weights": list(np.array(weights))}
        return np.array(evaluate(reverse(program), arrays, np)["x_gradient"], dtype=float)


def random_program(seed: int) -> Program:
    """Return a random program of all operations, kept where they are defined and of ordinary size."""
    rng, code = np.random.default_rng(seed), Listing()
    values = [code.read("x", i) for i in range(SIZE)]
    one = code.number(1.0)
    for _ in range(40):
        op = OPERATIONS[int(rng.integers(len(OPERATIONS)))]
        operands = [int(rng.choice(values[-12:])) for _ in range(ARITY[op])]
        if op in (Op.DIVIDE, Op.SQRT, Op.LOG, Op.ATAN2):
            last = operands[-1]
            operands[-1] = code(Op.ADD, code(Op.MULTIPLY, last, last), one)
        values.append(code(Op.SIN, code(op, *operands)))
    return code.program([array("x", SIZE)], {array("f", 9): [int(rng.choice(values)) for _ in range(9)]})


@pytest.mark.parametrize("seed", range(20))
def test_reverse_mode_is_the_transpose_of_forward_mode(seed: int) -> None:
    """Weights times the derivative along a direction are the gradient times the direction."""
    program, rng = random_program(seed), np.random.default_rng([seed, 1])
    weights, direction, x = rng.uniform(-1, 1, 9), rng.uniform(-1, 1, SIZE), rng.uniform(-2, 2, SIZE)
    forward = evaluate(tangent(program, 9), {"x": list(x), "d": list(direction)}, np)["f"]
    terms, others = weights * np.array(forward), by_reverse(program, list(x), list(weights)) * direction
    assert np.isfinite(terms).all()
    assert np.abs(terms).max() > 0
    assert terms.sum() == pytest.approx(others.sum(), abs=1e-12 * np.abs(terms).sum())


def program_of(op: Op) -> Program:
    """Return the program of an operation on shifted inputs, where it is smooth."""
    code = Listing()
    x = [code.read("x", i) for i in range(SIZE)]
    large = [code(Op.ADD, code(Op.MULTIPLY, one, one), code.number(k + 1.0)) for k, one in enumerate(x)]
    return code.program([array("x", SIZE)], {array("f", 1): [code(op, *large[: ARITY[op]])]})


@pytest.mark.parametrize("op", OPERATIONS)
def test_every_operation_against_a_difference(op: Op) -> None:
    program, x = program_of(op), [0.3, -0.7, 1.1]
    digits = mpmath.MPContext()
    digits.dps = 40
    step = digits.mpf(10) ** -15
    found = by_reverse(program, x, [1.0])
    for place in range(SIZE):
        ends = []
        for sign in (1, -1):
            moved = [digits.mpf(v) for v in x]
            moved[place] += sign * step
            ends.append(evaluate(program, {"x": moved}, digits, digits.mpf)["f"][0])
        slope = (ends[0] - ends[1]) / (2 * step)
        assert float(slope) == pytest.approx(found[place], rel=1e-12, abs=1e-14)


@pytest.mark.parametrize("signs", list(product((1, -1), repeat=4)))
def test_turned_vectors_have_each_other_as_slopes(signs: tuple[int, ...]) -> None:
    """The angle x[0] + x[0] turns (x[1], x[2]) in either sense; both components may be negative."""
    code = Listing()
    angle, first, second = (code.read("x", i) for i in range(SIZE))
    angle = code(Op.ADD, angle, angle)
    cosine, sine = code(Op.COS, angle), code(Op.SIN, angle)
    products = [
        code(Op.MULTIPLY, *pair)
        for pair in ((cosine, first), (second, sine), (sine, first), (second, cosine))
    ]
    signed = [one if sign > 0 else code(Op.NEGATE, one) for one, sign in zip(products, signs, strict=True)]
    values = [code(Op.ADD, *signed[:2]), code(Op.SUBTRACT, *signed[3:1:-1])]
    program = code.program([array("x", SIZE)], {array("f", 2): values})
    x, weights = [0.4, 1.3, -0.7], [0.3, 0.9]
    c, s = np.cos(2 * x[0]), np.sin(2 * x[0])
    a, b = x[1:]
    slopes = np.array([[-2 * s * a, c, 0], [2 * c * b, 0, s], [2 * c * a, s, 0], [-2 * s * b, 0, c]])
    slopes *= np.array(signs)[:, None]
    by_value = np.array([slopes[0] + slopes[1], slopes[3] - slopes[2]])
    assert by_reverse(program, x, weights) == pytest.approx(weights @ by_value, rel=1e-15)
    along = evaluate(tangent(program, 2), {"x": x, "d": [0.5, -2.0, 0.25]}, np)["f"]
    assert along == pytest.approx(by_value @ [0.5, -2.0, 0.25], rel=1e-15)
    assert set(plane_rotations(program)) == (set(values) if prod(signs) > 0 else set())


def test_a_branch_that_is_not_taken_leaves_no_trace() -> None:
    """1/x in the branch of x > 0, also inside of another branch: at x = 0 the others decide."""
    code = Listing()
    x, y = code.read("x", 0), code.read("x", 1)
    inverse = code(Op.DIVIDE, code.number(1.0), x)
    root = code(Op.SQRT, code(Op.SUBTRACT, x, code.number(1.0)))
    inner = code(Op.SELECT, y, code(Op.MULTIPLY, root, inverse), inverse)
    chosen = code(Op.SELECT, x, code(Op.MULTIPLY, inner, inverse), code(Op.MULTIPLY, y, y))
    program = code.program([array("x", SIZE)], {array("f", 1): [chosen]})
    assert by_reverse(program, [0.0, 3.0, 0.0], [2.0]).tolist() == [0.0, 12.0, 0.0]
    assert np.isfinite(by_reverse(program, [2.0, 3.0, 0.0], [2.0])).all()


def test_a_root_of_a_sum_of_squares_has_slope_zero_at_zero() -> None:
    """As forward mode has it; elsewhere it is the unit vector, and that of sqrt(x) at 0 is no number."""
    code = Listing()
    x = [code.read("x", i) for i in range(SIZE)]
    squares = [code(Op.MULTIPLY, one, one) for one in x]
    length = code(Op.SQRT, code(Op.ADD, code(Op.ADD, *squares[:2]), squares[2]))
    program = code.program([array("x", SIZE)], {array("f", 1): [length]})
    assert by_reverse(program, [0.0, 0.0, 0.0], [2.0]).tolist() == [0.0, 0.0, 0.0]
    assert by_reverse(program, [3.0, 0.0, 4.0], [5.0]) == pytest.approx([3.0, 0.0, 4.0])
    code = Listing()
    program = code.program([array("x", SIZE)], {array("f", 1): [code(Op.SQRT, code.read("x", 0))]})
    assert not np.isfinite(by_reverse(program, [0.0, 0.0, 0.0], [1.0])[0])
