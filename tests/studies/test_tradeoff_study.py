"""A whole trade-off study: its measurements, refusals and files, from Python and on the command line."""

from __future__ import annotations

import csv
import io
import json
import sys
import xml.etree.ElementTree
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import kanegen as kg
from kanegen.cli.app import app
from kanegen.measure.timing import OBJECTIVES, Rounds
from kanegen.options import Variant
from kanegen.studies.tradeoff import compilation, evaluator, variants
from kanegen.studies.tradeoff.compilation import compile_variants
from kanegen.studies.tradeoff.domain import default_domain
from kanegen.studies.tradeoff.evaluator import accelerations_of_driver, time_variants
from kanegen.studies.tradeoff.exact_results import compute_accelerations
from kanegen.studies.tradeoff.outcome import Study, StudyOptions
from kanegen.studies.tradeoff.plot import tradeoff_svg
from kanegen.studies.tradeoff.report import comma_separated, json_record, markdown, statements
from kanegen.studies.tradeoff.study import study
from kanegen.studies.tradeoff.variants import Candidate
from tests.support import systems
from tests.support.tradeoff_times import ignore_stage, times_from_operations

HINGES = systems.chain(2, ["theta3"])
HUGE = kg.System.from_arrays([0], [1e60], [1e60 * np.eye(3)], [[0, 0, 0]], [[0, 0, 0]], name="huge")
QUICK = StudyOptions(states=4, hard=2, search=8, rounds=2, seconds=0.0)
FEW: list[dict[str, Any]] = [
    {"solver": "articulated bodies", "refinement": 0, "optimisation": 0},
    {"solver": "factorisation", "refinement": 0, "optimisation": 0},
    {"solver": "articulated bodies", "refinement": 0, "precision": "float", "optimisation": 0},
    {"solver": "articulated bodies", "refinement": 0, "speeds": "angular_velocity", "optimisation": 0},
    {"precision": "quad"},
]
QUIET = ["tradeoff", "--states", "3", "--rounds", "1", "--seconds", "0", "--search", "2"]


def few() -> list[Candidate]:
    return variants.candidates(FEW)[0]


@pytest.fixture
def still(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evaluator, "time_variants", times_from_operations)


@pytest.fixture(scope="module")
def outcome() -> Study:
    return study(HINGES, QUICK, ignore_stage, variants=few())


@pytest.fixture
def small_table(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(variants, "combinations", lambda: FEW)
    yield


def test_the_timed_driver_computes_the_measured_results() -> None:
    (one, _, single, _), _ = compile_variants(HINGES, few(), ignore_stage)
    sample = default_domain(HINGES).sample(40, 0)
    for built in (one, single):
        found = accelerations_of_driver(built, sample)
        for objective in OBJECTIVES:
            assert np.array_equal(found[objective], compute_accelerations(built.library, sample, objective))
    times = time_variants({one: sample, single: sample}, Rounds(3, 0.0), ignore_stage)
    assert [len(times[built][objective].rounds) for built in times for objective in OBJECTIVES] == [3] * 4
    assert times[one]["batch"].least <= times[one]["batch"].median
    assert times[one]["latency"].least > 0


def test_a_study_measures_every_variant_and_equal_programs_once(outcome: Study) -> None:
    by_label = {entry.label: entry for entry in outcome.results}
    assert len(by_label) == 4
    spinning = by_label["articulated, -O0, angular velocity"]
    plain = by_label["articulated, -O0"]
    assert spinning.same_as == plain.label  # hinges have no angular velocity to choose
    assert (spinning.times, spinning.errors) == (plain.times, plain.errors)
    assert plain.errors["latency"].max < 1e-14
    assert 1e-9 < by_label["float, articulated, -O0"].errors["batch"].max < 1e-4
    assert not any(entry.wrong for entry in outcome.results)
    assert plain.times is not None
    assert outcome.points("batch")[0].time == plain.times["batch"].median
    for objective, front in outcome.pareto_fronts.items():
        assert any(confirmed.stays for confirmed in front)
        for confirmed in front:
            assert confirmed.found >= confirmed.errors.max
            assert confirmed.proven >= confirmed.errors.median
            assert not np.array_equal(confirmed.errors.normwise, confirmed.result.errors[objective].normwise)


def test_variants_that_cannot_be_built_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    built, refused = compile_variants(HUGE, [Candidate(Variant(precision="float"))], ignore_stage)
    assert not built
    assert "leaves the range of single precision" in refused[0].reason
    monkeypatch.setenv("KANEGEN_CC", sys.executable)
    built, refused = compile_variants(HINGES, few()[:1], ignore_stage)
    assert not built
    assert refused[0].label == "articulated, -O0"
    assert refused[0].reason


def test_a_wrong_variant_is_not_timed(monkeypatch: pytest.MonkeyPatch, still: None) -> None:
    heavier = replace(HINGES, bodies=tuple(replace(b, mass=1.001 * b.mass) for b in HINGES.bodies))  # type: ignore[operator]
    right = compilation.generate_variant

    def generate_variant(system: kg.System, candidate: Candidate) -> Any:
        return right(heavier if candidate.variant.solver == "factorisation" else system, candidate)

    monkeypatch.setattr(compilation, "generate_variant", generate_variant)
    found = study(HINGES, QUICK, ignore_stage, variants=few())
    wrong = [entry for entry in found.results if entry.wrong]
    assert [entry.label for entry in wrong] == ["factorisation, -O0"]
    assert wrong[0].wrong == 8
    assert wrong[0].times is None
    assert "Wrong, and not timed" in statements(found)[-1]
    assert not any(c.result is wrong[0] for front in found.pareto_fronts.values() for c in front)
    assert "| factorisation, -O0 | wrong |" in markdown(found)


@pytest.mark.slow
def test_documents_are_the_same_but_for_times(still: None) -> None:
    one, two = (study(HINGES, QUICK, ignore_stage, variants=few()) for _ in range(2))
    assert markdown(one) == markdown(two)
    assert comma_separated(one) == comma_separated(two)
    assert json_record(one) == json_record(two)
    assert tradeoff_svg(one) == tradeoff_svg(two)


def test_documents_hold_every_variant(outcome: Study) -> None:
    text, facts = markdown(outcome), json.loads(json_record(outcome))
    rows = list(csv.DictReader(io.StringIO(comma_separated(outcome))))
    assert [row["variant"] for row in rows] == 2 * [entry.label for entry in outcome.results]
    assert [entry["variant"] for entry in facts["variants"]] == [entry.label for entry in outcome.results]
    for entry in outcome.results:
        assert text.count(f"| {entry.label} |") >= 2
    assert float(rows[0]["max"]) == outcome.results[0].errors["latency"].max
    worst = facts["fronts"]["batch"][0]["worst_state"]
    assert len([float.fromhex(number) for number in worst["tau"]]) == 2
    assert "the same program as articulated, -O0" in text
    xml.etree.ElementTree.fromstring(tradeoff_svg(outcome))


def test_impossible_options_and_domains() -> None:
    with pytest.raises(kg.OptionError, match=r"unknown quantile 'mx'. Did you mean 'max'\?"):
        study(HINGES, replace(QUICK, quantile="mx"))
    other = default_domain(systems.chain(3, ["theta3"]))
    with pytest.raises(kg.OptionError, match="the domain belongs to another system than 'chain'"):
        study(HINGES, QUICK, ignore_stage, other, variants=few())


def test_a_model_without_any_variant() -> None:
    with pytest.raises(kg.OptionError, match=r"no variant can be built\. The first one, float.*the range"):
        study(HUGE, QUICK, ignore_stage, variants=[Candidate(Variant(precision="float"))])
    massless = kg.System.from_arrays([0], [0.0], [np.zeros((3, 3))], [[0, 0, 0]], [[0, 0, 0]])
    with pytest.raises(kg.SingularError):
        study(massless, QUICK, ignore_stage)


def test_loads_and_parameters_are_named() -> None:
    system = kg.load("models/double_pendulum.toml")
    found = study(system, QUICK, ignore_stage, variants=few()[:1])
    assert "run-time parameters are constants" in found.notes[0]
    assert "Note: run-time parameters" in markdown(found)


def test_the_command(tmp_path: Path, small_table: None, still: None) -> None:
    HINGES.save(tmp_path / "hinges.toml")
    out = tmp_path / "made" / "here"
    arguments = [*QUIET, str(tmp_path / "hinges.toml"), "-o", str(out), "--json", str(tmp_path / "x")]
    done = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert done.exit_code == 0
    assert {path.name for path in out.iterdir()} == {
        f"tradeoff.{end}" for end in ("md", "csv", "json", "svg")
    }
    assert (out / "tradeoff.json").read_text() == (tmp_path / "x").read_text()
    assert "Refused: quad: unknown precision 'quad'" in done.stdout
    assert done.stdout.count("All variants") == 2
    assert "Spearman" in done.stdout


def refusal(*arguments: str) -> str:
    done = CliRunner().invoke(app, [*QUIET, "models/double_pendulum.toml", *arguments])
    assert isinstance(done.exception, kg.KanegenError)
    return str(done.exception)


def test_impossible_options_are_refused_before_the_study(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kanegen.studies.tradeoff.study.study", None)
    file = tmp_path / "file"
    file.touch()
    assert "cannot be made: Not a directory" in refusal("-o", str(file / "folder"))
    assert f"{tmp_path}: cannot be written: Is a directory" in refusal("--json", str(tmp_path))
    assert "cannot be written: No such file" in refusal("--plot", str(tmp_path / "no" / "a.svg"))
    assert "does not end in .svg" in refusal("--plot", "a.png")
    assert "Did you mean 'latency'?" in refusal("--objective", "latncy")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kanegen.extras.importlib.util.find_spec", _without_flint)
    assert refusal() == "the Python package flint is not installed (pip install 'kanegen[study]')"


def _without_flint(name: str) -> Any:
    return None if name == "flint" else sys.modules[name.partition(".")[0]].__spec__
