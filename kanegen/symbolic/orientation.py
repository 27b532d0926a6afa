"""The 1-2-3 angles of one joint as matrices of sines and cosines, Eqs. (4), (8), (9) and (17)."""

from __future__ import annotations

from collections.abc import Sequence

import sympy
from sympy import Expr, ImmutableMatrix

from kanegen.angles import sine_cosine
from kanegen.numbers import Number, Parameter
from kanegen.symbolic.symbols import expression, parameter


def rotation_123(sines: Sequence[Expr], cosines: Sequence[Expr]) -> ImmutableMatrix:
    """[R_123] of Eq. (4): components before to components after the three turns."""
    (s1, s2, s3), (c1, c2, c3) = sines, cosines
    return ImmutableMatrix(
        [
            [c2 * c3, c1 * s3 + s1 * s2 * c3, s1 * s3 - c1 * s2 * c3],
            [-c2 * s3, c1 * c3 - s1 * s2 * s3, s1 * c3 + c1 * s2 * s3],
            [s2, -s1 * c2, c1 * c2],
        ]
    )


def angle_rate_matrix(sines: Sequence[Expr], cosines: Sequence[Expr]) -> ImmutableMatrix:
    """[P^AV_K] of Eq. (17): angle rates to relative angular velocity in body K."""
    (_, s2, s3), (_, c2, c3) = sines, cosines
    return ImmutableMatrix([[c2 * c3, s3, 0], [-c2 * s3, c3, 0], [s2, 0, 1]])


def angle_rate_matrix_rate(
    sines: Sequence[Expr], cosines: Sequence[Expr], rates: Sequence[Expr]
) -> ImmutableMatrix:
    """Time derivative of [P^AV_K], below Eq. (20)."""
    (_, s2, s3), (_, c2, c3), (_, u2, u3) = sines, cosines, rates
    return ImmutableMatrix(
        [
            [-s2 * c3 * u2 - c2 * s3 * u3, c3 * u3, 0],
            [s2 * s3 * u2 - c2 * c3 * u3, -s3 * u3, 0],
            [c2 * u2, 0, 0],
        ]
    )


def angle_rate_inverse(sines: Sequence[Expr], cosines: Sequence[Expr]) -> ImmutableMatrix:
    """Inverse of [P^AV_K], Eq. (9); it does not exist where the middle cosine is zero."""
    (_, s2, s3), (_, c2, c3) = sines, cosines
    return ImmutableMatrix([[c3 / c2, -s3 / c2, 0], [s3, c3, 0], [-s2 * c3 / c2, s2 * s3 / c2, 1]])


def skew(vector: ImmutableMatrix) -> ImmutableMatrix:
    """The matrix whose product with a column is the cross product with `vector`."""
    x, y, z = vector
    return ImmutableMatrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def constant_sine_cosine(angle: Number) -> tuple[Expr, Expr]:
    """(sin, cos) of a constant angle (rad), exact at right angles; functions of a parameter's symbol."""
    if isinstance(angle, Parameter):
        symbol = parameter(angle)
        return sympy.sin(symbol), sympy.cos(symbol)
    sine, cosine = sine_cosine(angle)
    return expression(sine), expression(cosine)
