"""Rows of the battery, and the register in which every subject enters its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

_T = TypeVar("_T")


@dataclass(frozen=True)
class Size:
    """How much is tried: the quick size is part of the tests, the full one makes the report.

    The nightly size is the full one with many more random examples.
    """

    full: bool = False
    nightly: bool = False

    def pick(self, quick: _T, full: _T, nightly: _T | None = None) -> _T:
        """One of two or three amounts of work."""
        if self.nightly and nightly is not None:
            return nightly
        return full if self.full or self.nightly else quick


@dataclass(frozen=True)
class Point:
    """One measurement of a curve: where, the figure, and the limit there."""

    at: float
    figure: float
    limit: float


@dataclass(frozen=True)
class Row:
    """One line of the report.

    Attributes:
        case: What was varied, the precision included.
        figure: What was reached.
        limit: What it must not exceed.
        rule: The limit in words or as a formula.
        over: What it was measured over.
        cause: Why it is missed, where that is known; a row with a cause is allowed to miss.
        curve: The measurements one by one, for the picture.
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
        """Whether the figure meets the limit; what is not a number does not."""
        return self.figure <= self.limit


@dataclass(frozen=True)
class Subject:
    """A number of the battery, its title and the function that makes its rows."""

    number: str
    title: str
    rows: Callable[[Size], Iterable[Row]]


SUBJECTS: dict[str, Subject] = {}
"""By number, in the order in which the modules were read."""


def subject(
    number: str, title: str
) -> Callable[[Callable[[Size], Iterator[Row]]], Callable[[Size], Iterator[Row]]]:
    """Enter the function below as the subject `number`."""

    def enter(rows: Callable[[Size], Iterator[Row]]) -> Callable[[Size], Iterator[Row]]:
        SUBJECTS[number] = Subject(number, title, rows)
        return rows

    return enter


def count(case: str, failures: Iterable[object], over: str, rule: str, cause: str = "") -> Row:
    """A row whose figure is how many of `failures` are true; none may be."""
    return Row(case, float(sum(map(bool, failures))), 0.0, rule, over, cause)
