"""Rounded right angles of a model, such as 1.5708 for pi/2, 3.1416 for pi and 6e-17 for 0.

An angle that is no farther than a tolerance from a multiple of a right angle can be replaced by it. Its sine
and cosine are then 0 and +-1, and the operations that they cost disappear. The model changes, but by no more
than the tolerance.
"""

from __future__ import annotations

import math
from typing import Any

from kanegen.errors import ModelError, OptionError, quoted
from kanegen.model.numbers import Matrix, Number, Vector, finite, map_numbers, value_of
from kanegen.model.rotations import Square, Triple, cross, normalized
from kanegen.program.constants import MOST_QUARTER_TURNS

AS_WRITTEN = 0.0
"""Default tolerance (rad): numbers stay as the file has them, so that results agree to the last digits with
other programs that read the same file. Making even 1.57079632679 exact changes results by 5e-12."""

FOUR_DECIMALS = 5e-5
"""Tolerance (rad) for right angles that were typed with four decimals, as 1.5708, 3.1416 and 4.7124: half a
unit of the last decimal. No real joint is built or measured as accurately."""

MAX_TOLERANCE = 0.01
"""Largest tolerance (rad): an angle more than half a degree from a right angle is intended."""


def checked_tolerance(tolerance: Any) -> float:
    """Return `tolerance` (rad) as a float.

    Raises:
        OptionError: If it is not a number from 0 to `MAX_TOLERANCE`.
    """
    try:
        value = finite(tolerance, "right_angles")
    except ModelError:
        value = math.nan
    if not 0 <= value <= MAX_TOLERANCE:
        raise OptionError(
            f"right_angles is {quoted(tolerance)}; it must be a number from 0, the model as written, to "
            f"{MAX_TOLERANCE} rad. {FOUR_DECIMALS:g} takes what was typed with four decimals or more."
        )
    return value


def angle(value: float, tolerance: float) -> float:
    """Return the multiple of a right angle within `tolerance` of `value` (rad), else `value`."""
    turns = round(value / (math.pi / 2))
    exact = turns * (math.pi / 2)
    return exact if abs(turns) <= MOST_QUARTER_TURNS and abs(value - exact) <= tolerance else value


def if_plain(value: Number, tolerance: float) -> Number:
    """Return a constant angle with right angles made exact; parameters and expressions stay as they are."""
    return angle(value, tolerance) if isinstance(value, float) else value


def orientation(value: Matrix | Vector, tolerance: float) -> Matrix | Vector:
    """Return a constant orientation, a matrix or three angles, with right angles made exact.

    Matrices with parameters, and angles that are no plain floats, stay as they are.
    """
    if isinstance(value[0], tuple):
        plain = map_numbers(value, value_of)
        return rotation(plain, tolerance) if plain == value else value
    exact: Vector = map_numbers(value, lambda one: if_plain(one, tolerance))
    return exact


def direction(v: Triple, tolerance: float) -> Triple:
    """Return a unit vector whose components within `tolerance` of zero are exactly zero."""
    if not _misses(v, tolerance):
        return v
    x, y, z = (0.0 if abs(x) <= tolerance else x for x in v)
    return normalized((x, y, z))


def rotation(m: Square, tolerance: float) -> Square:
    """Return a rotation with exact zeros and ones where axes of its two frames coincide within `tolerance`.

    If one axis coincides, the rotation becomes one about this axis; if two do, all three coincide.
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
    """Return whether a component is within `tolerance` of zero but not zero."""
    return any(0 < abs(x) <= tolerance for x in v)
