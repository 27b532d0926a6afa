"""Arrays of intervals with outward rounding: every operation encloses all results for numbers inside.

The ends are doubles. Each operation of NumPy rounds to nearest, so the next double outward is a bound. Sums,
and products with powers of two, can be kept where they are exact: bounds often are powers of two, above
which rounding errors double.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.model.arrays import Floats

_HUGE = 1e300
"""Products below this have not overflowed."""

_GROWTH = 1 + 2.0**-51
"""More than the relative rounding errors of a sum or product of two doubles and of this factor."""

_TINY = 5e-324
"""The smallest double."""

_FRACTION = np.int64(2**52 - 1)
"""The bits of the fraction of a double, all 0 in powers of two."""


@dataclass(frozen=True, slots=True)
class Intervals:
    """An array of intervals; an end that is infinite means that there is no bound.

    Attributes:
        low: Lower ends.
        high: Upper ends, of the same shape.
    """

    low: Floats
    high: Floats

    def __add__(self, other: Intervals) -> Intervals:
        return Intervals(_down(self.low + other.low), _up(self.high + other.high))

    def __sub__(self, other: Intervals) -> Intervals:
        return self + -other

    def __neg__(self) -> Intervals:
        return Intervals(-self.high, -self.low)

    def __mul__(self, other: Intervals) -> Intervals:
        low, high = self._products(other)
        return Intervals(_down(low), _up(high))

    def plus(self, other: Intervals) -> Intervals:
        """Return the sums, with ends that are exact where the sums of ends are."""
        return Intervals(_sum(self.low, other.low, -np.inf), _sum(self.high, other.high, np.inf))

    def times(self, other: Intervals) -> Intervals:
        """Return the products, with exact ends where one factor is between powers of two."""
        low, high = self._products(other)
        small = (np.abs(low) < _HUGE) & (np.abs(high) < _HUGE)
        exact = (self._is_scale | other._is_scale) & small
        return Intervals(np.where(exact, low, _down(low)), np.where(exact, high, _up(high)))

    def _products(self, other: Intervals) -> tuple[Floats, Floats]:
        """Return the least and the largest product of ends; 0 times infinity is 0."""
        a, b = self.low * other.low, self.low * other.high
        c, d = self.high * other.low, self.high * other.high
        low = np.fmin(np.fmin(a, b), np.fmin(c, d))
        high = np.fmax(np.fmax(a, b), np.fmax(c, d))
        return _zero_for_nan(low), _zero_for_nan(high)

    def __truediv__(self, other: Intervals) -> Intervals:
        return self * other.reciprocal()

    @property
    def is_zero(self) -> bool:
        """Whether every interval holds 0 alone."""
        return not (self.low.any() or self.high.any())

    @property
    def magnitude(self) -> Floats:
        """The largest absolute value of each interval."""
        largest: Floats = np.maximum(np.abs(self.low), np.abs(self.high))
        return largest

    @property
    def is_bounded(self) -> bool:
        """Whether all ends are finite."""
        return bool(np.isfinite(self.low).all() and np.isfinite(self.high).all())

    @property
    def _is_scale(self) -> NDArray[np.bool_]:
        """Whether both ends are 0 or powers of two not below 1, products with which are exact."""
        found: NDArray[np.bool_] = _scales(self.low) & _scales(self.high)
        return found

    def square(self) -> Intervals:
        """Return the squares, which are nowhere negative."""
        crosses = (self.low <= 0) & (self.high >= 0)
        smallest = np.where(crosses, 0.0, np.minimum(np.abs(self.low), np.abs(self.high)))
        size = Intervals(smallest, self.magnitude)
        products = size.times(size)
        return Intervals(np.maximum(products.low, 0.0), products.high)

    def reciprocal(self) -> Intervals:
        """Return the reciprocals; without bound where an interval holds 0."""
        holds_zero = (self.low <= 0) & (self.high >= 0)
        low, high = _down(1.0 / self.high), _up(1.0 / self.low)
        return Intervals(np.where(holds_zero, -np.inf, low), np.where(holds_zero, np.inf, high))

    def root(self) -> Intervals:
        """Return the square roots of what is not negative."""
        low, high = (np.sqrt(np.maximum(end, 0.0)) for end in (self.low, self.high))
        return Intervals(np.maximum(_down(low), 0.0), _up(high))

    def widened(self, by: Floats) -> Intervals:
        """Return intervals that reach `by` farther to both sides."""
        return self.plus(Intervals(-by, by))

    def within(self, other: Intervals) -> Intervals:
        """Return the intersection of two enclosures of the same numbers."""
        return Intervals(np.maximum(self.low, other.low), np.minimum(self.high, other.high))

    def scattered(self, rows: NDArray[np.intp], count: int) -> Intervals:
        """Return `count` rows of intervals, these ones in their places and 0 elsewhere."""
        ends = (np.zeros((count, *end.shape[1:])) for end in (self.low, self.high))
        low, high = ends
        low[rows], high[rows] = self.low, self.high
        return Intervals(low, high)

    def hull(self, other: Intervals) -> Intervals:
        """Return the smallest intervals that hold both."""
        return Intervals(np.minimum(self.low, other.low), np.maximum(self.high, other.high))

    def symmetric(self) -> Intervals:
        """Return the smallest intervals about 0 that hold these."""
        return Intervals(-self.magnitude, self.magnitude)


def point(value: float | Floats) -> Intervals:
    """Return the intervals that hold one number each."""
    ends = np.asarray(value, dtype=np.float64)
    return Intervals(ends, ends)


def enclosed(number: Any) -> Intervals:
    """Return an interval that holds a number of any precision."""
    nearest = np.asarray(float(number))
    return point(nearest) if number == float(nearest) else Intervals(_down(nearest), _up(nearest))


def up_sum(terms: Iterable[Floats]) -> Floats:
    """Return an upper bound of a sum of numbers that are not negative, the sum where it is a double."""
    total: Floats | None = None
    for term in terms:
        total = term if total is None else _sum(total, term, np.inf)
    return np.zeros(()) if total is None else total


def up_total(a: Floats, b: Floats) -> Floats:
    """Return an upper bound of a sum of two errors, which costs less than `up_sum`; 0 if both are."""
    return (a + b) * _GROWTH


def up_product(a: Floats, b: Floats) -> Floats:
    """Return an upper bound of a product of numbers that are not negative; 0 times infinity is 0."""
    return np.where(np.minimum(a, b) > 0.0, a * b * _GROWTH + _TINY, 0.0)


def _sum(a: Floats, b: Floats, outward: float) -> Floats:
    """Return a + b, or the next double towards `outward` where the sum is not exact (Knuth's TwoSum)."""
    total = a + b
    part = total - a
    lost = (a - (total - part)) + (b - part)
    found: Floats = np.where(lost == 0.0, total, np.nextafter(total, outward))
    return found


def _scales(ends: Floats) -> NDArray[np.bool_]:
    """Return whether numbers are 0 or powers of two not below 1, up to the sign; infinity is one."""
    bits = np.asarray(ends, dtype=np.float64).view(np.int64)
    found: NDArray[np.bool_] = ((bits & _FRACTION) == 0) & ((ends == 0.0) | (np.abs(ends) >= 1.0))
    return found


def _down(ends: Floats) -> Floats:
    lower: Floats = np.nextafter(ends, -np.inf)
    return lower


def _up(ends: Floats) -> Floats:
    higher: Floats = np.nextafter(ends, np.inf)
    return higher


def _zero_for_nan(ends: Floats) -> Floats:
    """Return `ends` with 0 for 0 times infinity: an infinite end is not a number of its interval."""
    if not np.isnan(np.min(ends, initial=0.0)):
        return ends
    fixed: Floats = np.where(np.isnan(ends), 0.0, ends)
    return fixed
