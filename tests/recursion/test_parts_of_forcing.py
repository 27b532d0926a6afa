"""The parts of {f} that gravity and motion cause: by the reference, and by what they cost alone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.reference import coriolis as reference
from kanegen.reference import equations
from kanegen.reference.states import random_states
from tests.support import random_trees, systems
from tests.support.cases import slow_except
from tests.support.programs import values
from tests.support.robots import robot_file

PARTS = ("gravity_forces", "velocity_forces")


def given(system: kg.System, seed: int) -> dict[str, Any]:
    """Return a random state, without loads."""
    states = random_states(system, 1, seed)
    found = {"x": states.x[0], "y": states.y[0]}
    return found | {name: each[0] for name, each in states.inputs.items() if name == "prescribed"}


@pytest.mark.parametrize("seed", slow_except(range(30), *range(4)))
def test_both_parts_agree_with_the_reference(seed: int) -> None:
    system = random_trees.everything(seed)
    state = given(system, seed)
    found = values(system, PARTS, state)
    expected = {
        "gravity_forces": reference.gravity_forces(system, state["x"]),
        "velocity_forces": reference.velocity_forces(system, state["x"], state["y"]),
    }
    for name in PARTS:
        assert np.abs(found[name] - expected[name]).max() <= 1e-13 * np.abs(expected[name]).max(), name


@pytest.mark.parametrize("seed", range(20))
def test_gravity_on_hinges_at_right_angles(seed: int) -> None:
    """Parallel, opposite and vertical axes, with side branches: torques pass on, first moments do not."""
    rng = np.random.default_rng(seed)
    bare = systems.random_system(rng, 7, loads=False, locked=False)
    bodies = []
    for body in bare.bodies:
        free = np.zeros(6, dtype=bool)
        free[int(rng.choice([0, 1, 2, 2, 2, 4]))] = True
        turned = np.eye(3)[rng.permutation(3)] * rng.choice([-1.0, 1.0], 3)
        turned *= np.linalg.det(turned)
        joint = replace(body.joint, free=tuple(map(bool, free)), orientation=turned.tolist())
        bodies.append(replace(body, joint=joint))
    system = kg.System("hinges", tuple(bodies), (0.0, 0.0, -9.81))
    x = rng.uniform(-2, 2, len(system.freedoms))
    found = values(system, ("gravity_forces",), {"x": x})["gravity_forces"].astype(float)
    expected = reference.gravity_forces(system, x)
    assert np.abs(found - expected).max() <= 1e-13 * np.abs(expected).max()


def test_without_loads_and_force_elements_they_are_all_of_f() -> None:
    system = systems.random_system(np.random.default_rng(4), 5, loads=False)
    state = given(system, 4)
    found = values(system, ("forcing", *PARTS), state)
    both = found["gravity_forces"] + found["velocity_forces"]
    assert both == pytest.approx(found["f"], rel=1e-13, abs=1e-13 * np.abs(found["f"]).max())
    f = equations.forcing(system, state["x"], state["y"])
    assert both == pytest.approx(f, rel=1e-12, abs=1e-13 * np.abs(f).max())


COUNTS = {
    "ur5_robot": (False, 28, 260),
    "panda": (False, 88, 655),
    "talos_reduced": (True, 534, 3634),
}
"""Additions, multiplications and divisions of gravity alone, and of velocity forces alone."""


@pytest.mark.parametrize("name", COUNTS)
@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
def test_each_costs_only_itself(name: str) -> None:
    floating, *most = COUNTS[name]
    system = kg.load(robot_file(name), floating_base=floating)
    for part, expected in zip(PARTS, most, strict=True):
        counts = compile_module(system, (part,)).operations
        assert counts["add"] + counts["multiply"] + counts["divide"] <= expected
        assert counts["sqrt"] == counts["prepare"] == 0


def test_gravity_reads_only_positions() -> None:
    (function,) = compile_module(systems.eight_body(), ("gravity_forces",)).module.functions.values()
    assert [array.name for array in function.inputs] == ["x"]
