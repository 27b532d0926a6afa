"""Right angles that a model misses: 1.5708 for pi/2, 3.1416 for pi, 6e-17 for 0.

What no more than a tolerance parts from a multiple of a right angle can be taken for it. Its sine and cosine
are then 0 and +-1, and the operations that they cost disappear; but it is another model, if only by so much.
"""

from __future__ import annotations

import math
from typing import Any

from kanegen.errors import ModelError, OptionError
from kanegen.model.numbers import finite
from kanegen.model.rotations import Square, Triple, cross, normalized
from kanegen.program.constants import MOST_QUARTER_TURNS

AS_WRITTEN = 0.0
"""The default (rad): a file means the numbers that it holds, and agrees to the last digits with every other
program that reads it. Even 1.57079632679, the commonest of all, would change results by 5e-12."""

TYPED = 5e-5
"""Half a unit of the fourth decimal (rad): what a right angle misses at most that was rounded there, as
1.5708, 3.1416 and 4.7124 were. It is less than joints are built or measured to."""

LARGEST = 0.01
"""The largest tolerance (rad): more than half a degree is something that a designer means."""


def checked(tolerance: Any) -> float:
    """A tolerance that makes sense.

    Raises:
        OptionError: If it is not a number from 0 to `LARGEST`.
    """
    try:
        value = finite(tolerance, "right_angles")
    except ModelError:
        value = math.nan
    if not 0 <= value <= LARGEST:
        raise OptionError(
            f"right_angles is {tolerance!r}; it must be a number from 0, the model as written, to "
            f"{LARGEST} rad. {TYPED:g} takes what was typed with four decimals or more."
        )
    return value


def angle(value: float, tolerance: float) -> float:
    """`value` (rad), or the multiple of a right angle that is no farther away than `tolerance`."""
    turns = round(value / (math.pi / 2))
    exact = turns * (math.pi / 2)
    return exact if abs(turns) <= MOST_QUARTER_TURNS and abs(value - exact) <= tolerance else value


def direction(v: Triple, tolerance: float) -> Triple:
    """A unit vector, at right angles to the basis vectors to which it nearly is."""
    if not _misses(v, tolerance):
        return v
    x, y, z = (0.0 if abs(x) <= tolerance else x for x in v)
    return normalized((x, y, z))


def rotation(m: Square, tolerance: float) -> Square:
    """A rotation, the axes of its frames along each other where they nearly are.

    Where one axis is, a turn about it is left; where two are, so is the third.
    """
    if not any(_misses(row, tolerance) for row in m):
        return m
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        along = direction(m[i], tolerance)
        if sum(map(bool, along)) == 1:
            x, y, z = (0.0 if there else x for x, there in zip(m[j], along, strict=True))
            beside = direction(normalized((x, y, z)), tolerance)
            rows = {i: along, j: beside, k: cross(along, beside)}
            return rows[0], rows[1], rows[2]
    return m


def _misses(v: Triple, tolerance: float) -> bool:
    return any(0 < abs(x) <= tolerance for x in v)
