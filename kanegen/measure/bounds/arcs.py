"""Ranges of sine and cosine of one angle together, which as two independent numbers would be a square.

For numbers x and y from intervals and an angle from an arc, the range of x cos + y sin is exact but for
rounding: the extreme pairs (x, y) are corners, and for each of them the extremes are at the ends of the arc,
or +-hypot(x, y) where the arc holds the direction of (x, y) or the opposite one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import mpmath
import numpy as np
from numpy.typing import NDArray

from kanegen.measure.bounds.intervals import Intervals
from kanegen.model.arrays import Floats

_CONTEXT = mpmath.mp.clone()
_CONTEXT.prec = 160

LARGEST_ANGLE = 1e9
"""Angle (rad) beyond which an arc counts as the whole circle."""

TOLERANCE = 1e-6
"""Angle (rad) by which arcs are taken longer than they are when extremes inside are looked for: far more than
the rounding errors of directions, and far too little to matter, since an extreme is flat."""

_LONGEST = 6.28
"""Length of an arc (rad), a little less than the circle, from which it counts as the circle."""

_SLACK = 2.0**-50
"""Relative error of a few rounded operations and of NumPy's hypot, more than enough."""


@dataclass(frozen=True)
class Arcs:
    """Angles between two ends (rad), one arc for every box.

    Attributes:
        low: (B,) first angles.
        high: (B,) last angles.
    """

    low: Floats
    high: Floats

    @cached_property
    def is_circle(self) -> NDArray[np.bool_]:
        """For every arc whether it counts as the whole circle."""
        is_near = np.maximum(-self.low, self.high) < LARGEST_ANGLE
        whole: NDArray[np.bool_] = ~(is_near & (self.high - self.low < _LONGEST))
        return whole

    @cached_property
    def ends(self) -> tuple[tuple[Intervals, Intervals], tuple[Intervals, Intervals]]:
        """Cosine and sine at the first and at the last angle."""
        return _cosine_sine(self.low), _cosine_sine(self.high)

    @cached_property
    def doubled(self) -> Arcs:
        """The arcs of the double angles."""
        return Arcs(2 * self.low, 2 * self.high)

    @property
    def cosine(self) -> Intervals:
        """The ranges of the cosine."""
        return self.combination(_ONE, _ZERO).within(_UNIT)

    @property
    def sine(self) -> Intervals:
        """The ranges of the sine."""
        return self.combination(_ZERO, _ONE).within(_UNIT)

    def combination(self, x: Intervals, y: Intervals) -> Intervals:
        """Return the ranges of x cos + y sin for arrays of intervals (..., B)."""
        if self.is_circle.all():
            radius = _hypot(x.magnitude, y.magnitude)
            return Intervals(-radius, radius)
        low, high = np.asarray(np.inf), np.asarray(-np.inf)
        for a, b in product((x.low, x.high), (y.low, y.high)):
            least, most = self.extremes(a, b)
            low, high = np.minimum(low, least), np.maximum(high, most)
        return Intervals(low, high)

    def extremes(self, a: Floats, b: Floats) -> tuple[Floats, Floats]:
        """Return the least and the largest a cos + b sin of numbers a and b."""
        x, y = Intervals(a, a), Intervals(b, b)
        first, last = (x * cosine + y * sine for cosine, sine in self.ends)
        radius = _hypot(np.abs(a), np.abs(b))
        direction = np.arctan2(b, a)
        most = np.where(self._holds(direction), radius, np.maximum(first.high, last.high))
        least = np.where(self._holds(direction + np.pi), -radius, np.minimum(first.low, last.low))
        return least, most

    def _holds(self, direction: Floats) -> NDArray[np.bool_]:
        """Return whether the arcs, and a little more, hold directions (rad)."""
        with np.errstate(invalid="ignore"):
            beyond = np.mod(direction - self.low + TOLERANCE, 2 * np.pi)
            held: NDArray[np.bool_] = self.is_circle | ~(beyond > self.high - self.low + 2 * TOLERANCE)
        return held


def _hypot(a: Floats, b: Floats) -> Floats:
    with np.errstate(invalid="ignore"):
        found: Floats = np.hypot(a, b) * (1 + _SLACK) + 1e-320
    return found


def _cosine_sine(angles: Floats) -> tuple[Intervals, Intervals]:
    """Return enclosures of cosine and sine of each angle, few of which differ."""
    inside = np.where(np.abs(angles) < 2 * LARGEST_ANGLE, angles, 0.0)
    different, places = np.unique(inside, return_inverse=True)
    found = [(_CONTEXT.cos(angle), _CONTEXT.sin(angle)) for angle in map(float, different)]
    cosine, sine = (np.array([float(v) for v in column])[places] for column in zip(*found, strict=True))
    return Intervals(cosine, cosine).widened(_HALF_ULP), Intervals(sine, sine).widened(_HALF_ULP)


_HALF_ULP = np.asarray(2.0**-53)
_ONE = Intervals(np.ones(()), np.ones(()))
_ZERO = Intervals(np.zeros(()), np.zeros(()))
_UNIT = Intervals(-np.ones(()), np.ones(()))
