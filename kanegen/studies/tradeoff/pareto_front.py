"""Which variants are worth having: those that no other beats in time and error at once."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from scipy import stats

T = TypeVar("T")

TIE = 0.02
"""Times that differ by no more count as equal; the more accurate one then stands for both."""

FLAT = 2.0
"""A ratio of errors below which nobody would give up speed."""


@dataclass(frozen=True)
class Point(Generic[T]):
    """Something with a time and an error."""

    what: T
    time: float
    error: float


def front(points: Iterable[Point[T]]) -> list[Point[T]]:
    """The Pareto front, the fastest first; the errors fall along it.

    Of points with the same time and error the first stays. A point without a finite time and error is on no
    front.
    """
    usable = [point for point in points if math.isfinite(point.time) and math.isfinite(point.error)]
    kept: list[Point[T]] = []
    for point in sorted(usable, key=lambda point: (point.time, point.error)):
        if not kept or point.error < kept[-1].error:
            kept.append(point)
    return _without_ties(kept)


def _without_ties(points: Sequence[Point[T]]) -> list[Point[T]]:
    """From the most accurate on, whoever is not faster than the last one kept by more than a tie goes."""
    kept: list[Point[T]] = []
    for point in reversed(points):
        if not kept or point.time * (1 + TIE) < kept[-1].time:
            kept.append(point)
    return kept[::-1]


def verdict(points: Sequence[Point[T]], label: Callable[[T], str], every: Sequence[Point[T]]) -> str:
    """A front in words: what a trade costs and brings, or that there is none.

    Args:
        points: The front.
        label: Names what stands in a point.
        every: All points, for what they span.
    """
    if not points:
        return "No variant gives finite results in every state, so there is nothing to choose from."
    fast, accurate = points[0], points[-1]
    if len(points) == 1:
        others = [point for point in every if point is not fast and math.isfinite(point.time)]
        slowest = max((point.time for point in others), default=fast.time)
        return (
            f"No trade exists: {label(fast.what)} is both the fastest ({fast.time:.3g} ns) and the most "
            f"accurate ({fast.error:.1e}); the others take up to {slowest / fast.time:.2f} times as long."
        )
    speed, loss = accurate.time / fast.time, _ratio(fast.error, accurate.error)
    if loss < FLAT:
        return (
            f"No trade exists: from {label(accurate.what)} to {label(fast.what)} the error grows only "
            f"{loss:.2f} times, from {accurate.error:.1e} to {fast.error:.1e}, and the time falls "
            f"{speed:.2f} times, from {accurate.time:.3g} to {fast.time:.3g} ns: the fastest will do for all."
        )
    steps = "; ".join(f"{label(point.what)} {point.time:.3g} ns, {point.error:.1e}" for point in points)
    return (
        f"A trade exists: {label(fast.what)} is {speed:.3g} times as fast as {label(accurate.what)}, with "
        f"{loss:.2g} times the error. The front: {steps}."
    )


def _ratio(larger: float, smaller: float) -> float:
    return larger / smaller if smaller > 0 else math.inf


def rank_correlation(costs: Sequence[float], times: Sequence[float]) -> float:
    """Spearman's rho; NaN where all costs or all times are equal, or there are fewer than three."""
    if len(costs) < 3 or len(set(costs)) == 1 or len(set(times)) == 1:
        return math.nan
    return float(stats.spearmanr(costs, times).statistic)
