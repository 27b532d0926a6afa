"""The quick size of the battery of extremes: rows hold, and known misses get no worse."""

from __future__ import annotations

import math

import pytest

from benchmarks.extremes import plot
from benchmarks.extremes.battery import subjects
from benchmarks.extremes.document import document
from benchmarks.extremes.measuring import worst
from benchmarks.extremes.missing import MISSING
from benchmarks.extremes.rows import Point, Row, Size, count

SUBJECTS = {subject.number: subject for subject in subjects()}

KNOWN = {
    ("X4", "wrong by a hundredth and silent, double"): 2,
    ("X4", "wrong by a hundredth and silent, float"): 7,
    ("X13", "mass, double"): 1,
    ("X13", "length, double"): 1,
    ("X13", "mass, float"): 1,
    ("X19", "the process after loading, flags -O3 -ffast-math"): 1,
    ("X32", "state by state, ziglang -O0 too, double"): 2,
    ("X32", "state by state, ziglang -O0 too, float"): 2,
}
"""Figures of the rows that miss their limits. Lower one when it gets better."""


@pytest.mark.parametrize("number", SUBJECTS)
def test_extremes(number: str) -> None:
    rows = list(SUBJECTS[number].rows(Size()))
    assert rows
    for row in rows:
        known = KNOWN.get((number, row.case))
        if known is None:
            assert row.holds, row
        else:
            assert row.figure <= known, row
            assert row.holds or row.cause, row


def test_nothing_is_left_out() -> None:
    """Every number of the battery is tried, or has a reason why not."""
    missing = {what.split()[0] for what in MISSING}
    assert {f"X{i}" for i in range(1, 39)} == SUBJECTS.keys() | (missing - {"part"})


def test_the_worst_point_counts() -> None:
    curve = [Point(1, 1e-3, 1.0), Point(2, 5.0, 1.0), Point(3, 9.0, math.inf), Point(4, 0.0, 0.0)]
    row = worst("case", curve, "rule", "over")
    assert (row.figure, row.limit, row.holds) == (5.0, 1.0, False)
    assert row.over == "over; 1 of 4 states beyond the promise"
    assert not worst("nothing", [], "rule", "over").holds
    assert not worst("NaN", [Point(1, 0.1, 1.0), Point(2, math.nan, 1.0)], "rule", "over").holds
    assert not worst("infinite", [Point(1, 0.1, 1.0), Point(2, math.inf, 1.0)], "rule", "over").holds
    assert count("two", [True, False, True], "over", "rule").figure == 2


def test_the_report() -> None:
    rows = [
        Row("double", 1e-15, 2e-15, "16 N u chi", "1 chain"),
        Row("float", 2, 0, "0 states", "x", "bad luck"),
    ]
    text = document({"X1": rows})
    assert "1 of 2 rows hold, in 1 subjects." in text
    assert "- X1, float: 2 where 0 is allowed. Bad luck." in text
    assert "| double | 1.0e-15 | 2.0e-15 | holds | 16 N u chi | 1 chain |" in text
    assert "- X37 tiers of more than double precision: needs those tiers." in text
    assert set(plot.PANELS) <= SUBJECTS.keys()
