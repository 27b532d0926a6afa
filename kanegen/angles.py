"""Sines and cosines of constant angles, exact at right angles."""

from __future__ import annotations

import math

RIGHT_ANGLE_ULPS = 4
"""An angle this many units in the last place from a multiple of pi/2 means the right angle, which double
precision cannot say."""

MOST_QUARTER_TURNS = 8
"""Beyond two full turns a unit in the last place is too coarse for that reading."""


def sine_cosine(angle: float) -> tuple[float, float]:
    """(sin, cos) of `angle` (rad), exactly 0 and +-1 where the angle means a multiple of pi/2."""
    quarter_turns = round(angle / (math.pi / 2))
    exact = quarter_turns * (math.pi / 2)
    if 0 < abs(quarter_turns) <= MOST_QUARTER_TURNS and abs(angle - exact) <= RIGHT_ANGLE_ULPS * math.ulp(
        angle
    ):
        return ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[quarter_turns % 4]
    return math.sin(angle), math.cos(angle)
