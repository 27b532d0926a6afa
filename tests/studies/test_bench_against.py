"""Saved comparisons: they return from their files, damaged files have one error, and changes are seen."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import kanegen as kg
from kanegen.cli.app import app
from kanegen.measure.machine import Machine
from kanegen.measure.timing import Times, change
from kanegen.studies import bench
from kanegen.studies.bench import table
from kanegen.studies.bench.against import compare_records, require_comparable
from kanegen.studies.bench.comparison import Absence, BenchOptions, Comparison, Entry
from kanegen.studies.bench.record import Record, read_record
from kanegen.studies.bench.results import DYNAMICS, EQUATIONS, Task
from kanegen.studies.bench.settings import Setting
from tests.support import systems

MACHINE = Machine("processor, 2 cores", "Linux x86_64", "glibc 2.36", "gcc 12", "Python 3.11, casadi 3.8")
CONTRACTED = Setting("contracted", ("-O3", "-march=native"), "AVX-512")
SAVED = Path("before.json")


def entry(participant: str, rounds: Sequence[float], quantity: str = EQUATIONS) -> Entry:
    return Entry(participant, CONTRACTED, Task(quantity, quantity), 1e-15, Times(tuple(rounds)))


def record(*entries: Entry, machine: Machine = MACHINE) -> Record:
    comparison = Comparison("arm", 3, entries, (Absence("drake", "it rains"),), ("a note",))
    return Record("0.1.0", machine, BenchOptions(256, 9, 0.05), (comparison,))


def rounds(median: float, seed: int = 0, count: int = 9) -> list[float]:
    """Return rounds with the noise of a quiet machine."""
    return list(median * np.random.default_rng(seed).lognormal(0, 0.003, count))


def test_a_record_returns_from_its_file(tmp_path: Path) -> None:
    failed = replace(entry("other", []), error=np.inf)
    several = replace(entry("kanegen", rounds(5), DYNAMICS), cores=2)
    saved = record(entry("kanegen", rounds(10)), several, failed)
    path = tmp_path / "saved.json"
    path.write_text(saved.text(), encoding="utf-8")
    assert read_record(path) == saved
    assert read_record(path).text() == saved.text()
    lines = [line for line in saved.text().splitlines() if "participant" in line]
    assert len(lines) == 3, "one line for each entry"


def content() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(record(entry("kanegen", rounds(10))).text())
    return found


def first(found: dict[str, Any]) -> dict[str, Any]:
    result: dict[str, Any] = found["comparisons"][0]["entries"][0]
    return result


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda c: c.pop("kind"), "it holds no times of kanegen bench."),
        (lambda c: c.update(format=7), "it has format 7, and this version of kanegen reads 1."),
        (lambda c: c.update(machine=[]), "machine is no object."),
        (lambda c: c["machine"].pop("compiler"), "machine.compiler is no text."),
        (lambda c: c.update(comparisons="all"), "comparisons is no list."),
        (lambda c: c.update(comparisons=[3]), "comparisons[0] is no object."),
        (lambda c: c["comparisons"][0].update(entries=[]), "comparisons[0].entries is empty."),
        (lambda c: first(c).update(batch=1), "comparisons[0].entries[0].batch is no truth value."),
        (lambda c: first(c).update(cores=True), "comparisons[0].entries[0].cores is no number."),
        (lambda c: first(c).update(flags=[1]), "comparisons[0].entries[0].flags is no list of texts."),
        (
            lambda c: first(c).update(nanoseconds=[1.0, -2.0]),
            "comparisons[0].entries[0].nanoseconds is no list of positive numbers.",
        ),
        (
            lambda c: first(c).update(nanoseconds=[1.0]),
            "comparisons[0] has entries with times of other than 9 rounds.",
        ),
        (
            lambda c: c["options"].update(seconds=10**400),
            "options.seconds is beyond the numbers of a computer.",
        ),
        (
            lambda c: first(c).update(nanoseconds=[10**400]),
            "comparisons[0].entries[0].nanoseconds is no list of positive numbers.",
        ),
        (
            lambda c: first(c).update(nanoseconds=[float("nan")]),
            "comparisons[0].entries[0].nanoseconds is no list of positive numbers.",
        ),
    ],
)
def test_a_damaged_file(damage: Callable[[dict[str, Any]], Any], message: str, tmp_path: Path) -> None:
    found = content()
    damage(found)
    path = tmp_path / "saved.json"
    path.write_text(json.dumps(found), encoding="utf-8")
    with pytest.raises(kg.OptionError) as caught:
        read_record(path)
    assert str(caught.value) == f"{path}: {message} Save it anew with kanegen bench --save."


@pytest.mark.parametrize("text", ["", "[1, 2", "null", "[]", '{"kind": 3}'])
def test_a_file_that_is_no_record(text: str, tmp_path: Path) -> None:
    path = tmp_path / "saved.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(kg.OptionError, match=r"saved\.json: .* Save it anew"):
        read_record(path)
    with pytest.raises(kg.ReadError, match="absent"):
        read_record(tmp_path / "absent.json")


def test_a_slower_task_is_seen_beside_a_peer_whatever_the_load() -> None:
    """All times of the later run are 30 % longer, those of kanegen 35 %."""
    saved = record(entry("Pinocchio", rounds(100, 1)), entry("kanegen", rounds(10, 2)))
    new = record(entry("Pinocchio", rounds(130, 3)), entry("kanegen", rounds(13.5, 4)))
    (row,) = compare_records(new, saved, SAVED).rows
    assert row.peer == "Pinocchio"
    assert row.change.is_slower
    assert row.change.low < 1.35 / 1.3 < row.change.high
    assert table.row_of_change(row)[-1] == "slower"
    loaded = record(entry("Pinocchio", rounds(130, 3)), entry("kanegen", rounds(13, 4)))
    verdict = compare_records(loaded, saved, SAVED)
    assert not verdict.slower
    assert not verdict.rows[0].change.is_faster


def test_times_are_compared_without_a_peer() -> None:
    saved, new = record(entry("kanegen", rounds(10, 2))), record(entry("kanegen", rounds(9, 5)))
    (row,) = compare_records(new, saved, SAVED).rows
    assert (row.peer, row.change.is_faster) == ("", True)
    assert table.row_of_change(row)[4] == "ns"


def test_the_change_is_the_ratio_of_the_medians_that_stand_beside_it() -> None:
    """Rounds of two modes: the median of all ratios, 1.0, would contradict the medians."""
    saved = record(entry("kanegen", [*[10.0] * 4, *[16.0] * 5]))
    new = record(entry("kanegen", [*[10.0] * 5, *[16.0] * 4]))
    (row,) = compare_records(new, saved, SAVED).rows
    assert (row.before, row.now) == (16.0, 10.0)
    assert row.change.ratio == row.now / row.before
    assert row.change.low <= row.change.ratio <= row.change.high
    assert table.row_of_change(row)[5:7] == ["16", "10"]


def test_noise_is_undecided_and_not_a_pass() -> None:
    noisy = list(10 * np.random.default_rng(3).lognormal(0, 0.5, 9))
    verdict = compare_records(record(entry("kanegen", noisy)), record(entry("kanegen", noisy)), SAVED)
    assert len(verdict.undecided) == 1
    assert table.row_of_change(verdict.rows[0])[-1] == "undecided"
    lines = table.words_of_changes(verdict)
    assert lines[1] == "Of 1 task 0 became slower, 0 became faster; undecided: 1."
    assert "do not rule out that the task became 10 % slower" in lines[2]
    quiet = record(entry("kanegen", rounds(10)))
    assert not compare_records(quiet, quiet, SAVED).undecided


def test_rows_of_one_quantity_stand_together() -> None:
    other = Setting("portable", ("-O2",), "SSE2")
    first, second = entry("kanegen", rounds(10)), entry("kanegen", rounds(5), DYNAMICS)
    both = record(first, second, replace(first, setting=other), replace(second, setting=other))
    quantities = [row.entry.task.quantity for row in compare_records(both, both, SAVED).rows]
    assert quantities == [EQUATIONS, EQUATIONS, DYNAMICS, DYNAMICS]


def test_times_of_another_machine_are_not_compared() -> None:
    other = replace(MACHINE, processor="another processor")
    alone = record(entry("kanegen", rounds(10)), machine=other)
    with pytest.raises(kg.OptionError, match="another machine or with another compiler") as caught:
        compare_records(record(entry("kanegen", rounds(99))), alone, SAVED)
    assert "another processor; gcc 12" in str(caught.value)
    both = record(entry("CasADi", rounds(50)), entry("kanegen", rounds(10, 1)), machine=other)
    verdict = compare_records(
        record(entry("CasADi", rounds(500)), entry("kanegen", rounds(100, 3))), both, SAVED
    )
    assert not verdict.slower
    assert "only ratios to a peer are compared" in verdict.notes[0]


def test_a_task_of_one_run_is_named() -> None:
    saved = record(entry("kanegen", rounds(10)), entry("kanegen", rounds(5), DYNAMICS))
    verdict = compare_records(record(entry("kanegen", rounds(10))), saved, SAVED)
    assert verdict.notes == ("arm: only the saved run timed dynamics (contracted)",)
    assert len(verdict.rows) == 1


def test_what_cannot_be_compared_is_refused_before_times_are_taken() -> None:
    saved = record(entry("kanegen", rounds(10)))
    require_comparable(saved, SAVED, "arm", 9)
    with pytest.raises(kg.OptionError, match=r"before\.json: it has no times of 'leg', only of arm"):
        require_comparable(saved, SAVED, "leg", 9)
    with pytest.raises(kg.OptionError, match="--rounds: 4 rounds are too few to compare runs"):
        require_comparable(saved, SAVED, "arm", 4)


def test_the_interval_of_a_change_holds_the_ratio_as_often_as_it_says() -> None:
    rng = np.random.default_rng(1)
    runs = rng.lognormal(0, 0.1, (1000, 2, 9)) * np.array([1.5, 1.0])[:, None]
    inside = [found.low <= 1.5 <= found.high for found in (change(*pair) for pair in runs)]
    assert 0.98 <= np.mean(inside) <= 1.0
    assert change([1.0] * 4, [1.0] * 4).high == np.inf, "too few rounds for an interval"


@pytest.mark.parametrize(("factor", "status"), [(1.2, 1), (1.0, 0), (0.8, 0)])
def test_the_command(factor: float, status: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`--against` compares a run with the file that `--save` wrote; the status says what it found."""
    monkeypatch.setattr(Machine, "here", lambda: MACHINE)
    model, saved = tmp_path / "arm.toml", tmp_path / "saved.json"
    replace(systems.chain(3), name="arm").save(model)

    def invoke(median: float, *options: str) -> Result:
        times = record(entry("CasADi", rounds(50)), entry("kanegen", rounds(median, 1)))
        monkeypatch.setattr(bench, "compare", lambda *arguments: times.comparisons[0])
        return CliRunner().invoke(app, ["bench", str(model), *options])

    with pytest.warns(kg.KanegenWarning, match="--save: 3 rounds will not do for --against, which needs 5"):
        few = invoke(10.0, "--save", str(tmp_path / "few.json"), "--rounds", "3")
    assert "There are no confidence intervals: they need at least 6 rounds." in few.stdout
    alone = invoke(10.0, "--save", str(saved))
    assert (alone.exit_code, alone.stderr) == (0, "")
    assert "over CasADi: median ratio of the rounds to its fastest row" in alone.stdout
    assert "compiler contracted, AVX-512 (-O3 -march=native): code for this processor" in alone.stdout
    done = invoke(10.0 * factor, "--against", str(saved))
    assert done.exit_code == status, done.output
    assert f"Of 1 task {status} became slower" in done.output
    assert "over CasADi" in done.output
