"""The study of growth: its cases, its measurements and its document; the plot needs matplotlib."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from benchmarks.growth import compiling
from benchmarks.growth.cases import CURVES, Case, Curve, cases, free_tree
from benchmarks.growth.document import GrowthOptions, document
from benchmarks.growth.generating import generated
from benchmarks.growth.results import Point, Study, exponent, series
from kanegen.library.native.commands import CommandError, TimeLimitError
from tests.support.cases import slow_except


def test_cases_double_and_end_at_their_largest() -> None:
    bodies = [case.bodies for case in cases(256) if case.curve == Curve("tree", "forcing")]
    assert bodies == [1, 2, 4, 8, 16, 32, 64, 128, 256]
    assert max(case.bodies for case in cases(256) if case.curve.output == "mass_matrix") == 64
    assert {case.bodies for case in cases(5)} == {1, 2, 4}


def test_free_trees_are_binary() -> None:
    system = free_tree(7)
    assert [body.lower for body in system.bodies] == [0, 1, 1, 2, 2, 3, 3]
    assert len(system.freedoms) == 42


def test_exponents() -> None:
    assert exponent([(n, 3.0 * n**1.5) for n in (32, 64, 256)]) == pytest.approx(1.5)
    steep_at_first = [(1, 0.0), (16, 1e-9), (32, 2.0), (64, 4.0)]
    assert exponent(steep_at_first) == pytest.approx(1.0)
    assert exponent([(16, 1.0), (32, 2.0)]) is None


@pytest.mark.parametrize(
    "output", slow_except(("forcing", "forward_dynamics", "mass_matrix"), "forward_dynamics")
)
def test_a_case_is_generated_compiled_and_run(output: str, tmp_path: Path) -> None:
    case = Case(Curve("chain", output), 2)
    measured = generated(case, tmp_path)
    source = kg.generate(case.system(), (output,))
    assert measured["operations"] == sum(source.operations.values())
    assert measured["code"] == len(source.files["chain2.c"])
    assert measured["freedoms"] == 2
    assert 0 < measured["derive"] < measured["generate"]
    assert measured["memory"] > 0
    assert compiling.compiled(tmp_path, "", 60.0)["compile"] > 0
    assert compiling.run_time(compiling.link(case, tmp_path, 2), 1e-4) > 0


def test_a_slow_compiler_is_stopped(tmp_path: Path) -> None:
    (tmp_path / "slow.c").write_text("int main(void) { return 0; }\n")
    with pytest.raises(TimeLimitError, match="more than"):
        compiling.compiled(tmp_path, "", 1e-4)


def test_a_compiler_that_fails_says_why(tmp_path: Path) -> None:
    (tmp_path / "wrong.c").write_text("int x = y;\n")
    with pytest.raises(CommandError, match="undeclared"):
        compiling.compiled(tmp_path, "", 60.0)


def test_document_holds_exponents_numbers_and_what_is_missing() -> None:
    study = Study([Point(Case(CURVES[0], n), {"operations": [7.0 * n]}) for n in (16, 32, 64)])
    study.points[0].add({"operations": 100.0})
    study.points[0].add({"operations": 112.0})
    study.missing.append("forcing, chain of 128: too slow")
    text = document(study, GrowthOptions())
    assert "| forcing, chain | 1.00 | - |" in text
    assert "| 16 | - | 112 |" in text
    assert "- forcing, chain of 128: too slow" in text
    assert series(study.points, "operations") == [(16, 112.0), (32, 224.0), (64, 448.0)]
    assert np.isclose(exponent(series(study.points, "operations")) or 0.0, 1.0)
