"""The Pareto front: the variants that no other variant beats in both time and error."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from scipy import stats

T = TypeVar("T")

TIE = 0.02
"""Relative difference up to which two times count as equal; the more accurate point then stands for both."""

FLAT = 2.0
"""Ratio of errors below which a front has no trade-off: so small a gain is worth no loss of speed."""


@dataclass(frozen=True)
class Point(Generic[T]):
    """An object with a time and an error.

    Attributes:
        item: The object that the point stands for.
        time: Time of the object (ns).
        error: Error of the object.
    """

    item: T
    time: float
    error: float


def pareto_front(points: Iterable[Point[T]]) -> list[Point[T]]:
    """Return the points on the Pareto front, the fastest first; the errors fall along it.

    Of points with the same time and error the first is kept. A point without a finite time and error is on no
    front.
    """
    usable = [point for point in points if math.isfinite(point.time) and math.isfinite(point.error)]
    kept: list[Point[T]] = []
    for point in sorted(usable, key=lambda point: (point.time, point.error)):
        if not kept or point.error < kept[-1].error:
            kept.append(point)
    return _without_ties(kept)


def _without_ties(points: Sequence[Point[T]]) -> list[Point[T]]:
    """Drop each point that is at most a tie faster than the next more accurate point that is kept."""
    kept: list[Point[T]] = []
    for point in reversed(points):
        if not kept or point.time * (1 + TIE) < kept[-1].time:
            kept.append(point)
    return kept[::-1]


def verdict(front: Sequence[Point[T]], label: Callable[[T], str], every: Sequence[Point[T]]) -> str:
    """Return in words the speed and the error of the ends of a trade-off, or that there is none.

    Args:
        front: The points on the Pareto front, the fastest first.
        label: Function that returns the name of the object of a point.
        every: All points, whose slowest one is named if there is no trade-off.
    """
    if not front:
        return "No variant gives finite results in every state, so there is nothing to choose from."
    fast, accurate = front[0], front[-1]
    if len(front) == 1:
        others = [point for point in every if point is not fast and math.isfinite(point.time)]
        slowest = max((point.time for point in others), default=fast.time)
        return (
            f"There is no trade-off: {label(fast.item)} is both the fastest ({fast.time:.3g} ns) and the "
            f"most accurate ({fast.error:.1e}); the others take up to {slowest / fast.time:.2f} times as "
            "long."
        )
    speed = accurate.time / fast.time
    loss = fast.error / accurate.error if accurate.error > 0 else math.inf
    if loss < FLAT:
        return (
            f"There is no trade-off: from {label(accurate.item)} to {label(fast.item)} the error grows "
            f"only {loss:.2f} times, from {accurate.error:.1e} to {fast.error:.1e}, and the time falls "
            f"{speed:.2f} times, from {accurate.time:.3g} to {fast.time:.3g} ns: the fastest will do for all."
        )
    steps = "; ".join(f"{label(point.item)} {point.time:.3g} ns, {point.error:.1e}" for point in front)
    return (
        f"There is a trade-off: {label(fast.item)} is {speed:.3g} times as fast as {label(accurate.item)}, "
        f"with {loss:.2g} times the error. The Pareto front: {steps}."
    )


def rank_correlation(costs: Sequence[float], times: Sequence[float]) -> float:
    """Return Spearman's rho of costs and times.

    It is NaN if there are fewer than three of them, or if all costs or all times are equal.
    """
    if len(costs) < 3 or len(set(costs)) == 1 or len(set(times)) == 1:
        return math.nan
    return float(stats.spearmanr(costs, times).statistic)
