"""Sines and cosines of constant angles, exact at right angles."""

from __future__ import annotations

import math
from typing import Any

RIGHT_ANGLE_ULPS = 4
"""An angle this many units in the last place from a multiple of pi/2 means the right angle, which double
precision cannot say."""

MOST_QUARTER_TURNS = 8
"""Beyond two full turns a unit in the last place is too coarse for that reading."""


def quarter_turns(angle: float) -> int:
    """How many right angles `angle` (rad) means; 0 where it means none, or is anything else."""
    turns = round(angle / (math.pi / 2))
    near = abs(angle - turns * (math.pi / 2)) <= RIGHT_ANGLE_ULPS * math.ulp(angle)
    return turns if abs(turns) <= MOST_QUARTER_TURNS and near else 0


def sine_cosine(angle: float, functions: Any = math) -> tuple[Any, Any]:
    """(sin, cos) of `angle` (rad), exactly 0 and +-1 where the angle means a multiple of pi/2.

    Args:
        angle: The angle.
        functions: What computes them elsewhere, such as `math` or a context of mpmath.
    """
    turns = quarter_turns(angle)
    if turns:
        return ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[turns % 4]
    return functions.sin(angle), functions.cos(angle)
