"""The driver of single outputs, and its command line; Pinocchio itself runs in the benchmarks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import kanegen as kg
from kanegen.cli.app import app
from kanegen.recursion.outputs import OUTPUTS
from kanegen.reference.states import states_away_from_gimbal_lock
from kanegen.studies.bench import BenchOptions, outputs
from kanegen.studies.bench.outputs import FUNCTIONS, OutputBench, compare_outputs
from kanegen.studies.bench.peers.problem import Problem
from kanegen.studies.bench.states import write_states
from tests.support import systems
from tests.support.cases import slow_except

STATES = 40
"""More states than a batch of the driver holds, and no whole number of batches."""


@pytest.fixture(scope="module")
def arm() -> kg.System:
    chain = systems.chain(7, ["theta2"])
    return chain.with_poses(["body7"]).with_points({"tip": ("body7", (0.1, 0, 0))}).with_contacts(["tip"])


QUICK = ("gravity_forces", "frame_jacobians")
"""Outputs of one array and of two; the others run with `make slow`."""


@pytest.mark.parametrize("output", slow_except(FUNCTIONS, *QUICK))
def test_the_driver_computes_the_output_of_each_state(output: str, arm: kg.System, tmp_path: Path) -> None:
    states = states_away_from_gimbal_lock(arm, STATES)
    problem = Problem(arm, states, write_states(states, tmp_path / "states"), tmp_path)
    bench = OutputBench(arm, 7, (output,))
    found = outputs._participant(bench, problem, output).results(7)
    library = kg.build(arm, (output,))
    third = {"tau": states.tau, "ydot": states.tau}
    given = {"x": states.x, "y": states.y} | third
    arrays = {name: given[name] for name in OUTPUTS[output].arguments if name in given}
    expected = getattr(library, output)(**arrays)
    for values in found.values():
        assert np.allclose(
            values.ravel(), np.ravel(expected), rtol=1e-12, atol=1e-12 * np.abs(expected).max()
        )


def test_the_deepest_body_counts_joints_that_move() -> None:
    branched = systems.random_system(
        np.random.default_rng(0), 5, connection=(0, 1, 2, 1, 4), free=systems.flags(5, ["theta2"])
    )
    assert outputs._deepest(branched) == 3


def test_what_cannot_be_compared_is_named() -> None:
    with pytest.raises(kg.OptionError, match=r"unknown output 'gravity'. Did you mean 'gravity_forces'\?"):
        compare_outputs(systems.chain(2), ["gravity"], BenchOptions())
    done = CliRunner().invoke(
        app, ["bench", "models/double_pendulum.toml", "--output", "regressor", "--plot", "a.svg"]
    )
    assert "--plot shows [A] and {f}" in str(done.exception)


def test_the_help_names_all_outputs() -> None:
    text = " ".join(CliRunner().invoke(app, ["bench", "--help"], env={"COLUMNS": "300"}).stdout.split())
    assert all(name in text for name in FUNCTIONS)
