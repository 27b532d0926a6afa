"""Code without functions for many states: what it leaves out, and that nothing else of it changes."""

from __future__ import annotations

from pathlib import Path

import pytest

import kanegen as kg
from kanegen.errors import OptionError
from kanegen.library import load
from tests.support.c_compilers import WARNINGS, C, run
from tests.support.cases import slow_except
from tests.support.command import kanegen
from tests.support.paths import MODELS, PENDULUM

OUTPUTS = ("mass_matrix", "forward_dynamics", "rollout_rk4", "step_rk4_derivatives")


def example(folder: Path, name: str, batch: bool) -> str:
    """Return what the example prints."""
    files = ["main.c", f"{name}.c", *([f"{name}_batch.c"] if batch else [])]
    run(*C["gcc"], "-std=c99", "-O1", "-ffp-contract=off", *WARNINGS, *files, "-lm", folder=folder)
    return run("./a.out", folder=folder)


@pytest.mark.parametrize(("model", "precision"), [("double_pendulum", "double"), ("panda_arm", "float")])
def test_the_functions_for_one_state_have_the_same_bits(model: str, precision: str, tmp_path: Path) -> None:
    """The arm has so many angles that with batches their sines are computed in SIMD lanes."""
    system = kg.load(MODELS / f"{model}.toml")
    full = kg.generate(system, ("mass_matrix", "forcing"), precision=precision)
    alone = kg.generate(system, ("mass_matrix", "forcing"), precision=precision, batches=False)
    assert full.has_batches and not alone.has_batches
    assert example(alone.write(tmp_path / "alone"), model, False) == example(
        full.write(tmp_path / "full"), model, True
    )


@pytest.mark.parametrize(
    "precision", slow_except(("float", "double", "double-double", "long double"), "double")
)
def test_nothing_mentions_batches(precision: str) -> None:
    source = kg.generate(kg.load(PENDULUM), OUTPUTS, precision=precision, batches=False)
    for name, text in source.files.items():
        assert "batch" not in text + name, name
        if not name.startswith("kanegen_elementary"):  # which is the same for one state and for many
            assert "simd" not in text + name, name
    assert source.operations == kg.generate(kg.load(PENDULUM), OUTPUTS, precision=precision).operations


def test_cmake_builds_it(tmp_path: Path) -> None:
    kanegen("generate", PENDULUM, "-o", str(tmp_path), "--no-batches", "--output", "rollout_rk4")
    run("cmake", "-S", ".", "-B", "build", folder=tmp_path)
    run("cmake", "--build", "build", "--target", "kanegen_double_pendulum_example", folder=tmp_path)
    assert "acceleration[1]" in run("build/kanegen_double_pendulum_example", folder=tmp_path)


def test_a_library_needs_batches() -> None:
    with pytest.raises(OptionError, match="double_pendulum: this code has no functions for many states"):
        load(kg.generate(kg.load(PENDULUM), batches=False))


def test_parameters_by_state_need_batches() -> None:
    with pytest.raises(OptionError, match="parameters_by_state: there are no batches"):
        kg.generate(kg.load(PENDULUM), batches=False, parameters_by_state=True)
