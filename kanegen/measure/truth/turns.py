"""Turns about basis vectors, one after the other, and the turn by a quaternion."""

from __future__ import annotations

from kanegen.measure.truth.balls import arb, arb_mat, beside, column, diagonal, skew, square, unit
from kanegen.model.sequences import Axes


def turned(angles: arb_mat, axes: Axes) -> tuple[arb_mat, ...]:
    """Rotations from a frame to itself and to those after one, two and three turns about `axes`."""
    frames = [diagonal(3)]
    for axis, angle in zip(axes, angles.entries(), strict=True):
        frames.append(_turn(axis, angle) * frames[-1])
    return tuple(frames)


def turned_at_once(quaternion: arb_mat) -> tuple[arb_mat, ...]:
    """The same for a quaternion (4, 1) of any length but 0, which has no turns on the way.

    The rotation is the product of two (3, 4) matrices of its elements over their squared length (Nikravesh
    1988, section 6.3).
    """
    scalar, *elements = quaternion.entries()
    vector = column(elements)
    lower, upper = (
        beside([-vector, *_columns(diagonal(3) * scalar + skew(vector) * sign)]) for sign in (arb(1), arb(-1))
    )
    squared = (quaternion.transpose() * quaternion)[0, 0]
    before = diagonal(3)
    return before, before, before, upper * lower.transpose() * (1 / squared)


def _columns(matrix: arb_mat) -> list[arb_mat]:
    return [matrix * unit(axis) for axis in range(3)]


def _turn(axis: int, angle: arb) -> arb_mat:
    """From a frame to the one turned by `angle` about basis vector 0, 1 or 2."""
    sine, cosine = angle.sin_cos()
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rows: list[list[float | arb]] = [[0.0] * 3 for _ in range(3)]
    rows[axis][axis] = 1.0
    rows[j][j] = rows[k][k] = cosine
    rows[j][k], rows[k][j] = sine, -sine
    return square(rows)
