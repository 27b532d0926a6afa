"""The distribution of quantities over all rows at every time, without the motions: counts in narrow bins.

Bins are those of the leading bits of doubles: the sign, the exponent and `BITS` bits of the fraction. So the
ends of a bin that is not at 0 differ by at most one part in 2^`BITS`, bins are the same on every machine, and
counts of several chunks add up without rounding, in any order. Each bin also has its least and its greatest
value. (Such sketches of quantiles with a relative error are those of Masson, Rim and Lee, "DDSketch",
Proceedings of the VLDB Endowment 12, 2019, with logarithms that are linear between powers of two.)
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import OptionError, quoted
from kanegen.model.arrays import Floats

BITS = 7
"""Bits of the fraction that distinguish bins."""

RESOLUTION = 2.0**-BITS
"""Largest width of a bin, relative to the magnitude of its values."""

_SHIFT = 52 - BITS

Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Bins:
    """Occupied bins of E quantities at T times, in the order of time, quantity and value.

    Attributes:
        time: (K,) place of the time.
        quantity: (K,) place of the quantity.
        key: (K,) number of the bin, which grows with the values in it.
        count: (K,) number of values in it.
        least: (K,) the least of them.
        greatest: (K,) the greatest of them.
    """

    time: Integers
    quantity: Integers
    key: Integers
    count: Integers
    least: Floats
    greatest: Floats

    def column(self, time: int, quantity: int) -> tuple[Integers, Floats, Floats]:
        """Return counts, least and greatest values of the bins of a quantity at a time."""
        first, last = np.searchsorted(self.time, [time, time + 1])
        inner = np.searchsorted(self.quantity[first:last], [quantity, quantity + 1]) + first
        part = slice(*inner)
        return self.count[part], self.least[part], self.greatest[part]


FIELDS = ("time", "quantity", "key", "count", "least", "greatest")
"""Fields of `Bins` in their order."""


def bins_of(values: Floats, first_time: int = 0) -> Bins:
    """Return the bins of values.

    Args:
        values: (B, K, E) values of E quantities in B rows at K times; those that are not finite are left out.
        first_time: Place of the first time.
    """
    _, K, E = values.shape
    times, quantities = np.broadcast_arrays(np.arange(K)[:, None] + first_time, np.arange(E)[None])
    inside = np.isfinite(values)
    found = values[inside] + 0.0  # no zero has a sign
    place = [np.broadcast_to(one, values.shape)[inside].astype(np.int64) for one in (times, quantities)]
    ones = np.ones(len(found), np.int64)
    return _collected(Bins(place[0], place[1], _keys(found), ones, found, found))


def merged(parts: Iterable[Bins]) -> Bins:
    """Return the bins of several parts together, in whatever order they come."""
    several = list(parts)
    return _collected(Bins(*(np.concatenate([getattr(one, name) for one in several]) for name in FIELDS)))


def quantile(counts: Integers, least: Floats, greatest: Floats, share: float) -> float:
    """Return the value below which a share of the values lies, off by no more than the width of a bin.

    As in `numpy.quantile`, a share between two values is interpolated linearly. Values in a bin count as
    equally distant from its least to its greatest value.

    Args:
        counts: (K,) numbers of values in bins, in the order of the values.
        least: (K,) least values of bins.
        greatest: (K,) greatest values of bins.
        share: Share of the values, 0 to 1.

    Returns:
        The value; NaN if there is none.

    Raises:
        OptionError: If the share is not between 0 and 1.
    """
    if not 0 <= share <= 1:
        raise OptionError(f"quantile: {quoted(share)} is not between 0 and 1.")
    if not len(counts):
        return float("nan")
    until = np.cumsum(counts)
    rank = share * int(until[-1] - 1)
    low = int(rank)

    def value(number: int) -> float:
        """Return the value with a number, from 0 for the least one."""
        place = int(np.searchsorted(until, number, side="right"))
        part = (number - (until[place] - counts[place])) / max(counts[place] - 1, 1)
        return float(least[place] + part * (greatest[place] - least[place]))

    part = rank - low
    if part == 0:
        return value(low)
    before, after = value(low), value(low + 1)
    return min(max((1 - part) * before + part * after, before), after)


def _keys(values: Floats) -> Integers:
    """Return the numbers of the bins of finite values."""
    bits = np.abs(values).view(np.int64) >> _SHIFT
    return np.where(np.signbit(values), -1 - bits, bits)


def _collected(bins: Bins) -> Bins:
    """Return bins in their order, equal ones together."""
    order = np.lexsort((bins.key, bins.quantity, bins.time))
    time, quantity, key = (getattr(bins, name)[order] for name in FIELDS[:3])
    if not len(order):
        return bins
    changes = (np.diff(time) != 0) | (np.diff(quantity) != 0) | (np.diff(key) != 0)
    first = np.flatnonzero(np.concatenate([[True], changes]))
    return Bins(
        time[first],
        quantity[first],
        key[first],
        np.add.reduceat(bins.count[order], first),
        np.minimum.reduceat(bins.least[order], first),
        np.maximum.reduceat(bins.greatest[order], first),
    )
