"""Ranges of sine and cosine of one angle together, which as two independent numbers would be a square.

For numbers x and y from intervals and an angle from an arc, the range of x cos + y sin is exact but for
rounding: the extreme pairs (x, y) are corners, and for each of them the extremes are at the ends of the arc,
or +-hypot(x, y) where the arc holds the direction of (x, y) or the opposite one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
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

_ENDS_SLACK = 2.0**-50
"""More than the error of x cos + y sin relative to the length of (x, y): less than 2^-53 from each of cosine
and sine, the two products and the sum."""

_SHORTEST = 1e-160
"""More than what squares lose of a length by underflow."""

_LONGEST_SQUARED = 1e150
"""Length whose square does not overflow."""


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
    def ends(self) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Cosine and sine at the first and at the last angle, rounded to nearest."""
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
        most = self._largest_at_ends((x.low, x.high), (y.low, y.high))
        least = -self._largest_at_ends((-x.low, -x.high), (-y.low, -y.high))
        slack = _hypot(x.magnitude, y.magnitude) * _ENDS_SLACK
        least, most = least - slack, most + slack
        for a, b in product((x.low, x.high), (y.low, y.high)):
            least, most = self._with_directions(a, b, least, most)
        return Intervals(least, most)

    def extremes(self, a: Floats, b: Floats) -> tuple[Floats, Floats]:
        """Return the least and the largest a cos + b sin of numbers a and b."""
        slack = _hypot(a, b) * _ENDS_SLACK
        most = self._largest_at_ends((a,), (b,)) + slack
        least = -self._largest_at_ends((-a,), (-b,)) - slack
        return self._with_directions(a, b, least, most)

    def _largest_at_ends(self, x: Sequence[Floats], y: Sequence[Floats]) -> Floats:
        """Return the largest x cos + y sin at the ends, rounded, of some numbers x and y."""
        first, last = (
            reduce(np.maximum, [a * cosine for a in x]) + reduce(np.maximum, [b * sine for b in y])
            for cosine, sine in self.ends
        )
        return np.maximum(first, last)

    def _with_directions(self, a: Floats, b: Floats, least: Floats, most: Floats) -> tuple[Floats, Floats]:
        """Return the extremes, -+hypot(a, b) where the arcs, or a little more, hold such a direction.

        A direction differs from the middle of an arc by as much as its cosine to the middle says.
        """
        cosine, sine, limit = self._middle
        radius = _hypot(a, b)
        along, beyond = a * cosine + b * sine, radius * limit
        return (
            np.where(-along >= beyond, np.minimum(least, -radius), least),
            np.where(along >= beyond, np.maximum(most, radius), most),
        )

    @cached_property
    def _middle(self) -> tuple[Floats, Floats, Floats]:
        """Cosine and sine of the middle of each arc, and the cosine of half its length and a little more."""
        middle = np.where(self.is_circle, 0.0, self.low / 2 + self.high / 2)
        half = np.minimum((self.high - self.low) / 2 + TOLERANCE, np.pi)
        return np.cos(middle), np.sin(middle), np.where(self.is_circle, -2.0, np.cos(half))


def _hypot(a: Floats, b: Floats) -> Floats:
    """Return upper bounds of the lengths of (a, b), in squares where these neither overflow nor vanish."""
    found: Floats = np.sqrt(a * a + b * b) * (1 + _SLACK) + _SHORTEST
    if not np.max(found, initial=0.0) < _LONGEST_SQUARED:
        with np.errstate(invalid="ignore"):
            found = np.hypot(a, b) * (1 + _SLACK) + _SHORTEST
    return found


def _cosine_sine(angles: Floats) -> tuple[Floats, Floats]:
    """Return cosine and sine of each angle, few of which differ, rounded to nearest."""
    inside = np.where(np.abs(angles) < 2 * LARGEST_ANGLE, angles, 0.0)
    different, places = np.unique(inside, return_inverse=True)
    found = [(_CONTEXT.cos(angle), _CONTEXT.sin(angle)) for angle in map(float, different)]
    cosine, sine = (np.array([float(v) for v in column])[places] for column in zip(*found, strict=True))
    return cosine, sine


_ONE = Intervals(np.ones(()), np.ones(()))
_ZERO = Intervals(np.zeros(()), np.zeros(()))
_UNIT = Intervals(-np.ones(()), np.ones(()))
