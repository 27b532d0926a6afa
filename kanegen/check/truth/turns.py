"""Turns about basis vectors, one after the other."""

from __future__ import annotations

from kanegen.check.truth.balls import arb, arb_mat, diagonal, square
from kanegen.sequences import Axes


def turned(angles: arb_mat, axes: Axes) -> tuple[arb_mat, ...]:
    """Rotations from a frame to itself and to those after one, two and three turns about `axes`."""
    frames = [diagonal(3)]
    for axis, angle in zip(axes, angles.entries(), strict=True):
        frames.append(_turn(axis, angle) * frames[-1])
    return tuple(frames)


def _turn(axis: int, angle: arb) -> arb_mat:
    """From a frame to the one turned by `angle` about basis vector 0, 1 or 2."""
    sine, cosine = angle.sin_cos()
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rows: list[list[float | arb]] = [[0.0] * 3 for _ in range(3)]
    rows[axis][axis] = 1.0
    rows[j][j] = rows[k][k] = cosine
    rows[j][k], rows[k][j] = sine, -sine
    return square(rows)
