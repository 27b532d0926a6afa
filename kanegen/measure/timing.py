"""Times of programs that take turns, and the statistics that tell which program is faster.

Every program has one time in every round, and all programs share the rounds, so a disturbance of the
machine hits one round of all of them. Two programs are compared by the ratios of their rounds. The confidence
interval of the median ratio comes from order statistics: the median lies between the j-th smallest and the
j-th largest of n ratios with the probability 1 - 2 P(B < j), where B is binomial with n and 1/2, whatever the
distribution of the ratios is. Such an interval needs at least six rounds.
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
