"""Times of programs that take turns, and the statistics that tell which program is faster.

Every program has one time in every round, and all programs share the rounds, so a disturbance of the
machine hits one round of all of them. Two programs are compared by the ratios of their rounds. The confidence
interval of the median ratio comes from order statistics: the median lies between the j-th smallest and the
j-th largest of n ratios with the probability 1 - 2 P(B < j), where B is binomial with n and 1/2, whatever the
distribution of the ratios is (H. A. David, H. N. Nagaraja, Order Statistics, 3rd edition, 2003, section 7.1).
Such an interval needs at least six rounds.

Rounds of two runs are not taken in turns. Then the change is the ratio of the two medians. Its confidence
interval comes from the ratios of every round of one run to every round of the other and the statistic of Mann
and Whitney (M. Hollander, D. A. Wolfe, E. Chicken, Nonparametric Statistical Methods, 3rd edition, 2014,
sections 4.2 and 4.3), which needs at least five rounds in each run. If the times have two modes, the ratio of
the medians can lie outside; then the interval is extended to it, since such rounds decide less, not more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LATENCY = "latency"
"""Time of one state a call, where each call waits for the result of the call before it."""

BATCH = "batch"
"""Time of one state when a call computes many states."""

OBJECTIVES = (LATENCY, BATCH)
"""The times for which a program may be chosen."""

TIE = 1.02
"""Ratio of times up to which two programs count as equally fast."""

CONFIDENCE = 0.95
"""Probability with which a confidence interval holds the median ratio."""

LEAST_FOR_INTERVAL = 6
"""Number of rounds below which the median ratio has no such interval."""

CONFIDENCE_OF_CHANGES = 0.99
"""Probability with which a confidence interval holds the ratio of two runs, of which many are looked at."""

SEEN = 1.1
"""Ratio of two runs that an interval must rule out, if it is to show that a task did not become slower."""


@dataclass(frozen=True)
class Rounds:
    """The length of a timing.

    Attributes:
        number: Number of rounds; every program has one turn in each round.
        seconds: Duration of every task of a program in every round (s).
    """

    number: int
    seconds: float


@dataclass(frozen=True)
class Times:
    """Nanoseconds of one evaluation, one number for each round."""

    rounds: tuple[float, ...]

    @property
    def least(self) -> float:
        """Time of the fastest round (ns)."""
        return min(self.rounds)

    @property
    def largest(self) -> float:
        """Time of the slowest round (ns)."""
        return max(self.rounds)

    @property
    def median(self) -> float:
        """Median of the rounds (ns)."""
        return float(np.median(self.rounds))


@dataclass(frozen=True)
class Speedup:
    """How many times as fast one program is as another.

    Attributes:
        median: Median ratio of the rounds.
        low: Lower end of the confidence interval of the median ratio.
        high: Upper end of this interval.
        least: Ratio of the fastest rounds.
    """

    median: float
    low: float
    high: float
    least: float

    @property
    def is_real(self) -> bool:
        """Whether both the confidence interval and the ratio of the fastest rounds exceed a tie."""
        return min(self.low, self.least) > TIE


def speedup(slow: Times, fast: Times) -> Speedup:
    """Return how many times as fast `fast` is as `slow`, from times of the same rounds."""
    ratios = sorted(a / b for a, b in zip(slow.rounds, fast.rounds, strict=True))
    low, high = _median_interval(ratios)
    return Speedup(float(np.median(ratios)), low, high, slow.least / fast.least)


@dataclass(frozen=True)
class Change:
    """The ratio of the times of a later run to those of an earlier one.

    Attributes:
        ratio: Ratio of the medians.
        low: Lower end of the confidence interval of the ratio; 0 with too few rounds.
        high: Upper end of this interval; infinity with too few rounds.
    """

    ratio: float
    low: float
    high: float

    @property
    def is_slower(self) -> bool:
        """Whether the confidence interval is above a tie."""
        return self.low > TIE

    @property
    def is_faster(self) -> bool:
        """Whether the confidence interval is below a tie."""
        return self.high < 1 / TIE

    @property
    def is_undecided(self) -> bool:
        """Whether the interval neither shows nor rules out that the later run is slower by a tenth."""
        return not self.is_slower and self.high > SEEN


def change(later: Sequence[float], earlier: Sequence[float]) -> Change:
    """Return the ratio of the rounds of a later run to those of an earlier one, which may be fewer or more.

    Example:
        >>> change([2.0] * 9, [1.0] * 9).ratio
        2.0
    """
    ratios = sorted(a / b for a in later for b in earlier)
    cut, outside = -1, 0.0
    shares = _mann_whitney(len(later), len(earlier))
    while 2 * (outside := outside + shares[cut + 1]) <= 1 - CONFIDENCE_OF_CHANGES:
        cut += 1
    low, high = (ratios[cut], ratios[-1 - cut]) if cut >= 0 else (0.0, math.inf)
    ratio = float(np.median(later) / np.median(earlier))
    return Change(ratio, min(low, ratio), max(high, ratio))


def _mann_whitney(m: int, n: int) -> list[float]:
    """Return the probabilities of 0, 1, ... m n pairs in order, for m and n numbers of one distribution.

    The number of pairs is that of the inversions of a random merger; the coefficients of the Gaussian
    binomial count the mergers.
    """
    counts = np.zeros(m * n + 1, dtype=object)
    counts[0] = 1
    for k in range(1, m + 1):
        for j in range(m * n, n + k - 1, -1):
            counts[j] -= counts[j - n - k]
        for j in range(k, m * n + 1):
            counts[j] += counts[j - k]
    return [float(count / math.comb(m + n, m)) for count in counts]


def tied(times: Sequence[Times]) -> list[int]:
    """Return the indices of the programs whose median is at most a tie slower than the fastest median."""
    limit = TIE * min(time.median for time in times)
    return [index for index, time in enumerate(times) if time.median <= limit]


def _median_interval(ordered: Sequence[float]) -> tuple[float, float]:
    """Return the confidence interval of the median; from 0 to infinity where there are too few numbers."""
    count, cut, outside = len(ordered), -1, 0.0
    while 2 * (outside := outside + math.comb(count, cut + 1) / 2**count) <= 1 - CONFIDENCE:
        cut += 1
    return (ordered[cut], ordered[-1 - cut]) if cut >= 0 else (0.0, math.inf)
