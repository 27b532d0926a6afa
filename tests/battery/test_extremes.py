"""The quick size of the battery of extremes: every row holds."""

from __future__ import annotations

import math

import pytest
from hypothesis import strategies as st

from kanegen.model.saving import toml_text
from kanegen.program.precision import DOUBLE
from tests.battery import counterexamples, plot, robustness, scenes
from tests.battery.battery import experiments
from tests.battery.experiments import Point, Row, Size, count
from tests.battery.measurement import worst
from tests.battery.report import report

EXPERIMENTS = {experiment.number: experiment for experiment in experiments()}

SLOW = {
    f"X{i}"
    for i in (
        *(1, 2, 3, 4, 7, 8, 10, 13, 14, 19, 20, 24),
        *(25, 26, 28, 29, 31, 32, 33, 34, 35, 36, 38, 40),
    )
}
"""Many compilations or many states; tests of their own, such as those of refinement, try a little of each."""

NUMBERS = [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in EXPERIMENTS]


@pytest.mark.parametrize("number", NUMBERS)
def test_extremes(number: str) -> None:
    rows = list(EXPERIMENTS[number].rows(Size()))
    assert rows
    for row in rows:
        assert row.holds, row


def test_nothing_is_left_out() -> None:
    """Every number of the battery is tried, or has a reason why not."""
    assert {f"X{i}" for i in range(1, 41)} == EXPERIMENTS.keys()


def test_the_worst_point_counts() -> None:
    curve = [Point(1, 1e-3, 1.0), Point(2, 5.0, 1.0), Point(3, 9.0, math.inf), Point(4, 0.0, 0.0)]
    row = worst("case", curve, "rule", "over")
    assert (row.figure, row.limit, row.holds) == (5.0, 1.0, False)
    assert row.over == "over; 1 of 4 states without a bound"
    assert not worst("nothing", [], "rule", "over").holds
    assert not worst("NaN", [Point(1, 0.1, 1.0), Point(2, math.nan, 1.0)], "rule", "over").holds
    assert not worst("infinite", [Point(1, 0.1, 1.0), Point(2, math.inf, 1.0)], "rule", "over").holds
    assert count("two", [True, False, True], "over", "rule").figure == 2


def test_sizes() -> None:
    assert [size.pick(1, 2, 3) for size in (Size(), Size(full=True), Size(nightly=True))] == [1, 2, 3]
    assert Size(nightly=True).pick(1, 2) == 2


def test_fuzzing_tells_what_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing keeps a bound of 0."""
    monkeypatch.setattr(robustness, "promise", lambda *_: 0.0)
    words = robustness.Tally().run(st.just(toml_text(scenes.mixed(2).as_table())), 1)
    assert words is not None
    assert "where 0.0e+00 is promised, 3 freedoms" in words


def test_a_search_begins_with_the_worst_known() -> None:
    system = scenes.straight(1)
    ordinary = counterexamples.climbed(system, DOUBLE, 0, None)
    known = counterexamples.climbed(system, DOUBLE, 5, ordinary.text())
    assert known.share >= ordinary.share > 0
    assert counterexamples.climbed(system, DOUBLE, 0, known.text()).text() == known.text()


def test_the_report() -> None:
    rows = [
        Row("double", 1e-15, 2e-15, "16 N u chi", "1 chain"),
        Row("float", 2, 0, "0 states", "x", "bad luck"),
        Row("wrong", math.inf, 1e-3, "T(u)", "x", "no result"),
    ]
    text = report({"X1": rows})
    assert "1 of 3 rows hold, in 1 experiments." in text
    assert "- X1, wrong: inf where 1.0e-03 is allowed. No result." in text
    assert "- X1, float: 2 where 0 is allowed. Bad luck." in text
    assert "| double | 1.0e-15 | 2.0e-15 | holds | 16 N u chi | 1 chain |" in text
    assert set(plot.PANELS) <= EXPERIMENTS.keys()
