"""The memory of functions that a README states, beside what compilers report."""

from __future__ import annotations

import platform
import re
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.c import Source, interface
from kanegen.errors import KanegenError
from tests.support.c_compilers import C
from tests.support.paths import MODEL_FILES, PENDULUM
from tests.support.stack_usage import calls, deepest, frames
from tests.support.systems import random_system

OUTPUTS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics", "step_rk4", "rollout_rk4")
FURTHER = (
    "step_rk4_derivatives",
    "step_implicit_midpoint",
    "step_linearly_implicit",
    "kinetic_energy",
    "momentum",
)
LEVELS = ("-O0", "-O1", "-O2", "-O3", "-Os")


def stacks(source: Source, folder: Path, command: tuple[str, ...], level: str) -> dict[str, int]:
    """Return the bytes of stack that a compiler takes for each function and all that it calls."""
    name = f"{source.model.name}.c"
    return deepest(calls(folder, name), frames(folder, name, (*command, level)))


def require_bounded(source: Source, folder: Path, command: tuple[str, ...], levels=LEVELS) -> None:
    source.write(folder)
    assert len(source.footprints) == len(source.functions) + len(source.rollouts)
    for level in levels:
        found = stacks(source, folder, command, level)
        for one in source.footprints:
            assert found[one.name] <= one.stack, (one, level)
        assert max(found.values()) > 0


def generated(system: kg.System, outputs: tuple[str, ...], **options) -> Source:
    """Return code for these outputs, without those that solve with [A] where it is singular."""
    try:
        return kg.generate(system, outputs, **options)
    except KanegenError:
        return kg.generate(system, outputs[:3], **options)


@pytest.mark.parametrize("precision", ["float", "double"])
def test_no_compiler_takes_more_stack_than_the_bound(precision: str, tmp_path: Path) -> None:
    source = kg.generate(kg.load(PENDULUM), OUTPUTS, precision=precision)
    for name, command in C.items():
        if len(command) == 1:
            require_bounded(source, tmp_path / name, command, ("-O0", "-O2"))


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["float", "double", "double-double", "long double"])
@pytest.mark.parametrize("model", MODEL_FILES, ids=lambda path: path.stem)
def test_no_compiler_takes_more_stack_in_any_model(model: Path, precision: str, tmp_path: Path) -> None:
    if model.stem == "eight_body" and precision != "float":
        pytest.skip("one precision of the largest model takes long enough")
    source = generated(kg.load(model), OUTPUTS, precision=precision)
    for name, command in C.items():
        require_bounded(source, tmp_path / name, command, ("-O0", "-O2", "-O3"))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_no_compiler_takes_more_stack_in_random_trees(seed: int, tmp_path: Path) -> None:
    system = random_system(np.random.default_rng(seed), 3, loads=bool(seed % 2))
    source = generated(
        system, (*OUTPUTS, *FURTHER), precision=("float", "double")[seed % 2], batches=seed < 3
    )
    for name, command in C.items():
        require_bounded(source, tmp_path / name, command)


def test_functions_that_call_others_take_more() -> None:
    found = {one.name: one for one in kg.generate(kg.load(PENDULUM), OUTPUTS).footprints}
    forward, step, rollout = (
        found[f"double_pendulum_{name}"] for name in ("forward_dynamics", "step_rk4", "rollout_rk4")
    )
    assert forward.stack < step.stack < rollout.stack
    assert forward.optimised_stack < step.optimised_stack < rollout.optimised_stack
    assert all(one.optimised_stack < one.stack for one in found.values())


def require_stack_of_batches(source: Source, folder: Path) -> None:
    """Check the largest stack of the batch functions, with the widest vectors, against that of the header."""
    source.write(folder)
    file = f"{source.model.name}_batch.c"
    stated = re.search(r"arrays of up to (\d+) KiB", (folder / f"{source.model.name}.h").read_text())
    assert stated is not None
    for command in C.values():
        if len(command) == 1 and platform.machine() == "x86_64":
            sizes = frames(folder, file, (*command, "-O2", "-mavx512f"))
            found = max(
                size for name, size in deepest(calls(folder, file), sizes).items() if name.endswith("_batch")
            )
            assert found <= 1024 * (1.5 * int(stated[1]) + 16), command


@pytest.mark.parametrize("tier", ["strict", kg.Variant(storage="float")], ids=["double", "mixed"])
def test_the_stack_of_a_batch(tier: kg.Variant | str, tmp_path: Path) -> None:
    system = random_system(np.random.default_rng(3), 6, connection=(0, 1, 1, 0, 4, 4), name="forked")
    require_stack_of_batches(kg.generate(system, ("mass_matrix", "forcing"), tier=tier), tmp_path / "out")


@pytest.mark.slow
@pytest.mark.parametrize("outputs", [OUTPUTS, ("forward_dynamics_derivatives",)], ids=["equations", "dFD"])
@pytest.mark.parametrize("model", sorted(MODEL_FILES), ids=lambda path: path.stem)
def test_the_stack_of_batches_of_every_model(model: Path, outputs: tuple[str, ...], tmp_path: Path) -> None:
    require_stack_of_batches(generated(kg.load(model), outputs), tmp_path / "out")


def test_copies_of_rows_decide_whether_a_batch_takes_states_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """In mixed precision the rows of a batch are copied, whatever values a matrix holds several times."""
    system = random_system(np.random.default_rng(3), 6, connection=(0, 1, 1, 0, 4, 4), name="forked")
    generated = {
        storage: kg.generate(system, ("mass_matrix",), tier=kg.Variant(storage=storage))
        for storage in ("", "float")
    }
    needed = {
        storage: source.render_input.batch_programs["mass_matrix"].numbers
        for storage, source in generated.items()
    }
    assert needed["float"] > needed[""] + len(system.freedoms) ** 2
    monkeypatch.setattr(interface, "LARGEST_BATCH_ROW", needed["float"] - 1)
    for storage, takes_together in (("", True), ("float", False)):
        made = kg.generate(system, ("mass_matrix",), tier=kg.Variant(storage=storage))
        assert ("simd_gather(" in made.files["forked_batch.c"]) == takes_together
