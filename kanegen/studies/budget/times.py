"""Times of candidates that took turns: what may be said about which is faster.

Every candidate has one time a round, and the rounds of all are the same ones, so a disturbance of the machine
hits a round of everybody. Two candidates are compared by the ratios of their rounds. The interval of the
median ratio comes from order statistics: between the j-th smallest and the j-th largest of n ratios lies the
median with the probability 1 - 2 P(B < j), B binomial with n and 1/2, whatever the distribution. It takes
six rounds at least.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

TIE = 1.02
"""Ratio of times up to which two candidates count as equally fast."""

CONFIDENCE = 0.95
"""Of the interval of a ratio."""


@dataclass(frozen=True)
class Times:
    """Nanoseconds an evaluation, one number a round."""

    rounds: tuple[float, ...]

    @property
    def least(self) -> float:
        """The fastest round."""
        return min(self.rounds)

    @property
    def median(self) -> float:
        """Of the rounds."""
        return float(np.median(self.rounds))


@dataclass(frozen=True)
class Speedup:
    """How many times as fast one candidate is as another.

    Attributes:
        median: Median ratio of the rounds.
        low: Lower end of its confidence interval.
        high: Upper end.
        least: Ratio of the fastest rounds.
    """

    median: float
    low: float
    high: float
    least: float

    @property
    def is_real(self) -> bool:
        """Whether both the interval and the fastest rounds lie beyond a tie."""
        return min(self.low, self.least) > TIE


def speedup(slow: Times, fast: Times) -> Speedup:
    """How many times as fast `fast` is as `slow`, from the same rounds."""
    ratios = sorted(a / b for a, b in zip(slow.rounds, fast.rounds, strict=True))
    low, high = _interval(ratios)
    return Speedup(float(np.median(ratios)), low, high, slow.least / fast.least)


def tied(times: Sequence[Times]) -> list[int]:
    """Places of those that are at most a tie slower than the fastest, by their medians."""
    limit = TIE * min(time.median for time in times)
    return [place for place, time in enumerate(times) if time.median <= limit]


def _interval(ordered: Sequence[float]) -> tuple[float, float]:
    """That of the median; from 0 to infinity where there are too few to have one."""
    count, cut, outside = len(ordered), -1, 0.0
    while 2 * (outside := outside + math.comb(count, cut + 1) / 2**count) <= 1 - CONFIDENCE:
        cut += 1
    return (ordered[cut], ordered[-1 - cut]) if cut >= 0 else (0.0, math.inf)
