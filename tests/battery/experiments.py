"""The terms of the battery: sizes, points, rows, and the registry of experiments."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

_T = TypeVar("_T")


@dataclass(frozen=True)
class Size:
    """The amount of work: the tests run the quick size, the report comes from the full one.

    The nightly size is the full one with many more random examples.
    """

    full: bool = False
    nightly: bool = False

    def pick(self, quick: _T, full: _T, nightly: _T | None = None) -> _T:
        """Return the value for this size; the nightly size takes the full one if it has no value of its
        own."""
        if self.nightly and nightly is not None:
            return nightly
        return full if self.full or self.nightly else quick


@dataclass(frozen=True)
class Point:
    """One measurement of a curve: its place on the horizontal axis, the figure, and the limit there."""

    at: float
    figure: float
    limit: float


@dataclass(frozen=True)
class Row:
    """One line of the report.

    Attributes:
        case: What is varied, with the precision.
        figure: The figure that was measured.
        limit: The largest figure allowed.
        rule: The limit as a formula or in words.
        over: The systems and states that were measured.
        cause: The reason for a miss, if it is known; a row with a cause may miss its limit.
        curve: The single measurements, for the plot.
    """

    case: str
    figure: float
    limit: float
    rule: str
    over: str
    cause: str = ""
    curve: tuple[Point, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether the figure meets the limit; NaN does not."""
        return self.figure <= self.limit


@dataclass(frozen=True)
class Experiment:
    """An experiment of the battery: its number, its title, and the function that yields its rows."""

    number: str
    title: str
    rows: Callable[[Size], Iterable[Row]]


EXPERIMENTS: dict[str, Experiment] = {}
"""All registered experiments by number."""


def experiment(
    number: str, title: str
) -> Callable[[Callable[[Size], Iterator[Row]]], Callable[[Size], Iterator[Row]]]:
    """Register the decorated function as the experiment `number`; the report prints its docstring."""

    def register(rows: Callable[[Size], Iterator[Row]]) -> Callable[[Size], Iterator[Row]]:
        EXPERIMENTS[number] = Experiment(number, title, rows)
        return rows

    return register


def count(case: str, failures: Iterable[object], over: str, rule: str, cause: str = "") -> Row:
    """Return a row whose figure is the number of true values among `failures`; its limit is 0."""
    return Row(case, float(sum(map(bool, failures))), 0.0, rule, over, cause)
