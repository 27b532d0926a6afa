"""What a row keeps of a quantity over time: its last value, extremes, means, or all of it.

A statistic takes the times of a rollout in blocks, one after the other, so that no trajectory has to be kept.
Every block has the same number of times, whatever the number of states is, and sums go in the order of time:
so no bit of a result depends on how many states are computed at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from kanegen.model.arrays import Floats


class Statistic(Protocol):
    """A statistic of E quantities of B states over time."""

    def add(self, times: Floats, values: Floats) -> None:
        """Take (K,) further times, s, and the (B, K, E) values of the quantities at them."""

    def result(self) -> Floats:
        """Return (B, E) numbers, or (B, T, E) with one for each time."""


class End:
    """The value at the last time."""

    def add(self, times: Floats, values: Floats) -> None:
        """Keep the last value of each quantity."""
        self._last = values[:, -1].copy()

    def result(self) -> Floats:
        """Return (B, E) last values."""
        return self._last


class Extreme:
    """The largest value, or with another sign the smallest, and the first time of it.

    A value that is NaN counts as the largest.
    """

    sign = 1.0

    def __init__(self) -> None:
        self._found: Floats | None = None
        self._when = np.empty(0)

    def add(self, times: Floats, values: Floats) -> None:
        """Compare the values with the largest one so far."""
        signed = self.sign * values
        place = signed.argmax(axis=1)
        best = np.take_along_axis(signed, place[:, None], axis=1)[:, 0]
        if self._found is None:
            self._found, self._when = best, times[place]
            return
        is_better = (best > self._found) | (np.isnan(best) & ~np.isnan(self._found))
        self._found = np.where(is_better, best, self._found)
        self._when = np.where(is_better, times[place], self._when)

    def result(self) -> Floats:
        """Return (B, E) extreme values."""
        assert self._found is not None
        found: Floats = self.sign * self._found
        return found


class Maximum(Extreme):
    """The largest value, or NaN if one is NaN."""


class Minimum(Extreme):
    """The smallest value, or NaN if one is NaN."""

    sign = -1.0


class TimeOfMaximum(Maximum):
    """The first time of the largest value."""

    def result(self) -> Floats:
        """Return (B, E) times, s."""
        return self._when.copy()


class TimeOfMinimum(Minimum):
    """The first time of the smallest value."""

    def result(self) -> Floats:
        """Return (B, E) times, s."""
        return self._when.copy()


class Mean:
    """The mean of the values at all times."""

    def __init__(self) -> None:
        self._sum: Floats | float = 0.0
        self._count = 0

    def add(self, times: Floats, values: Floats) -> None:
        """Add the values to those so far."""
        for values_at_once in np.moveaxis(values, 1, 0):
            self._sum = self._sum + values_at_once
        self._count += len(times)

    def result(self) -> Floats:
        """Return (B, E) means over all times."""
        return np.asarray(self._sum / self._count)


class RootMeanSquare(Mean):
    """The root of the mean of the squares at all times."""

    def add(self, times: Floats, values: Floats) -> None:
        """Add the squares of the values to those so far."""
        super().add(times, values * values)

    def result(self) -> Floats:
        """Return (B, E) roots of means."""
        return np.sqrt(super().result())


class Drift:
    """The largest distance from the value at the first time."""

    def __init__(self) -> None:
        self._first: Floats | None = None

    def add(self, times: Floats, values: Floats) -> None:
        """Compare the values with the first one."""
        if self._first is None:
            self._first, self._largest = values[:, :1].copy(), np.zeros_like(values[:, 0])
        self._largest = np.maximum(self._largest, np.abs(values - self._first).max(axis=1))

    def result(self) -> Floats:
        """Return (B, E) distances, none of them negative."""
        return self._largest


class TimeOfZero:
    """The first time at which the value is 0 or changes its sign; NaN where it does not.

    Values before the first that is not 0, such as speeds at the start of a motion from rest, do not count.
    Between two times the value is taken to change linearly.
    """

    def __init__(self) -> None:
        self._before: tuple[Floats, Floats] | None = None

    def add(self, times: Floats, values: Floats) -> None:
        """Look for changes of sign from the last value of the block before."""
        if self._before is None:
            self._found = np.full(values[:, 0].shape, np.nan)
        else:
            times = np.concatenate([self._before[0], times])
            values = np.concatenate([self._before[1], values], axis=1)
        first, second = values[:, :-1], values[:, 1:]
        crosses = (first != 0) & (np.sign(first) * np.sign(second) <= 0)
        if crosses.any():
            place = crosses.argmax(axis=1)[:, None]
            a, b = (np.take_along_axis(one, place, axis=1)[:, 0] for one in (first, second))
            begin, end = times[place[:, 0]], times[place[:, 0] + 1]
            is_new = np.isnan(self._found) & crosses.any(axis=1)
            self._found = np.where(is_new, begin + (end - begin) * (a / (a - b)), self._found)
        self._before = times[-1:], values[:, -1:].copy()

    def result(self) -> Floats:
        """Return (B, E) times, s, with NaN for none."""
        return self._found


class Path:
    """All values, one for each time."""

    def __init__(self) -> None:
        self._blocks: list[Floats] = []

    def add(self, times: Floats, values: Floats) -> None:
        """Keep the values of all quantities."""
        self._blocks.append(values.copy())

    def result(self) -> Floats:
        """Return (B, T, E) values."""
        return np.concatenate(self._blocks, axis=1)


PATH = "path"
"""The statistic with one value for each time."""

ZERO = "time_of_zero"
"""The statistic that is NaN where there is nothing to find."""

STATISTICS: Mapping[str, type[Statistic]] = {
    "end": End,
    "max": Maximum,
    "min": Minimum,
    "time_of_max": TimeOfMaximum,
    "time_of_min": TimeOfMinimum,
    ZERO: TimeOfZero,
    "mean": Mean,
    "rms": RootMeanSquare,
    "drift": Drift,
    PATH: Path,
}
"""All statistics by the first part of the name of a result, such as "max.y.elbow"."""

IN_SECONDS = ("time_of_max", "time_of_min", ZERO)
"""Statistics that are times; the others have the unit of the quantity."""
