"""Constants of a model as exact SymPy numbers; irrational ones have 320 bits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain
from typing import Any

import sympy
from sympy import Expr, Rational

from kanegen.model.evaluation import multiprecise
from kanegen.model.expression import Expression
from kanegen.model.joint import Joint
from kanegen.model.numbers import Number, Parameter, value_of
from kanegen.program.constants import MULTIPRECISION, Constants, as_fraction, quarter_turns, sine_cosine
from kanegen.symbolic.operations import of_parameters

Matrix = Sequence[Sequence[Expr]]
"""A matrix, row by row."""

_NEWTON_STEPS = 4
"""Newton steps to a rotation: each doubles the correct bits, of which a matrix of doubles has 50 or more."""


def exact(value: Number) -> Expr:
    """Return the symbol of a parameter, an expression of such symbols, or a float as an exact fraction.

    So folding rounds only once.
    """
    if isinstance(value, Expression):
        return of_parameters(value, exact)
    return sympy.Symbol(value.name, real=True) if isinstance(value, Parameter) else sympy.Rational(value)


def constant_sine_cosine(angle: Number, constants: Constants) -> tuple[Expr, Expr]:
    """Return sine and cosine of a constant angle without parameters (rad), exact at right angles.

    For C in double and single precision they are doubles; fractions of 320 bits grow too long in products.
    """
    if isinstance(angle, Expression) and not quarter_turns(angle.value):
        exactly = multiprecise(angle.exact)
        sine, cosine = MULTIPRECISION.sin(exactly), MULTIPRECISION.cos(exactly)
        if constants.are_rotations_exact:
            return rational(sine), rational(cosine)
        return rational(float(sine)), rational(float(cosine))
    value, functions = value_of(angle), constants.functions if constants.are_rotations_exact else math
    sine, cosine = sine_cosine(value, functions)
    return rational(sine), rational(cosine)


def constant_rotation(matrix: Matrix, constants: Constants) -> Matrix:
    """Return the rotation that a matrix of doubles stands for: itself, or the nearest rotation."""
    if not constants.are_rotations_exact or any(entry.free_symbols for row in matrix for entry in row):
        return matrix
    return nearest_rotation(matrix)


def nearest_rotation(matrix: Matrix) -> Matrix:
    """Return the rotation nearest to a matrix of doubles, itself where it is exact.

    [C] <- [C] (3 [1] - [C]^T [C]) / 2, the Newton iteration for the polar factor (Higham, Functions of
    Matrices, section 8.3), keeps exact zeros and planar turns.
    """
    turned = sympy.Matrix(matrix)
    for _ in range(_NEWTON_STEPS):
        turned = (turned * (3 * sympy.eye(3) - turned.T * turned) / 2).applyfunc(_rounded)
    rows: Matrix = turned.tolist()
    return rows


def distance_from_rotation(joint: Joint) -> float:
    """Return the largest difference of the constant orientation of a joint to the nearest rotation."""
    orientation = joint.orientation
    rows = [[exact(entry) for entry in row] for row in orientation if isinstance(row, tuple)]
    if any(entry.free_symbols for row in rows for entry in row) or not rows:
        return 0.0
    pairs = zip(chain(*rows), chain(*nearest_rotation(rows)), strict=True)
    return max(float(abs(one - other)) for one, other in pairs)


def rational(number: Any) -> Rational:
    """Return a float or an mpmath number as an exact fraction."""
    return Rational(number if isinstance(number, float) else as_fraction(number))


def _rounded(entry: Rational) -> Rational:
    """Round a fraction to the digits of wide constants; a fraction with fewer digits stays exact."""
    return rational(MULTIPRECISION.mpf(entry.p) / entry.q)
