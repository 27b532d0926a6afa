"""Blocks as a Python module: every matrix of every body has the value of the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.reference.freedoms import free_columns, gathered
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.reference.states import random_states
from kanegen.symbolic.printing import render
from tests.support import prescribed_trees
from tests.support.paths import MODELS
from tests.support.random_trees import everything, without_actions
from tests.support.systems import eight_body

KINEMATICS: dict[str, Callable[[BodyKinematics], Any]] = {
    "relative_rotation": lambda body: body.relative_rotation,
    "rotation": lambda body: body.rotation,
    "relative_angular_velocity": lambda body: body.relative_omega[:, None],
    "angular_velocity": lambda body: body.omega[:, None],
    "partial_angular_velocity": lambda body: body.omega_y,
    "partial_angular_velocity_rate": lambda body: body.omega_y_dot,
    "offset": lambda body: body.offset[:, None],
    "position_of_origin": lambda body: body.position[:, None],
    "position_of_center": lambda body: body.center_position[:, None],
    "velocity_of_center": lambda body: body.center_velocity[:, None],
    "partial_velocity_of_origin": lambda body: body.origin_y,
    "partial_velocity_of_origin_rate": lambda body: body.origin_y_dot,
    "partial_velocity_of_center": lambda body: body.center_y,
    "partial_velocity_of_center_rate": lambda body: body.center_y_dot,
}
"""What the reference has of a body, by the name in the module."""

SYSTEMS = {
    "eight bodies in symbols": lambda: eight_body().symbolic(),
    "quaternion": lambda: kg.load(MODELS / "satellite.toml"),
    "prescribed": lambda: prescribed_trees.tree(sorted(prescribed_trees.KINDS)[0], 1),
    "couplings": lambda: everything(3),
}


def module(system: kg.System, body: int | None = None) -> dict[str, Any]:
    """Return the variables of the module with the blocks of a system."""
    space: dict[str, Any] = {}
    exec(render(kg.derive(system), "python", only="blocks", body=body), space)
    return space


@pytest.mark.parametrize("name", SYSTEMS)
def test_every_matrix_has_the_value_of_the_reference(name: str) -> None:
    system = SYSTEMS[name]()
    states = random_states(system, 1, 3)
    x, y, values = states.x[0], states.y[0], system.values()
    given: dict[str, Any] = {key: array[0] for key, array in states.inputs.items()}
    if states.force is not None and states.torque is not None:
        given |= {"force": states.force[0], "torque": states.torque[0]}
    space = module(system)
    arguments = space["blocks"].__code__.co_varnames[: space["blocks"].__code__.co_argcount]
    found = space["blocks"](x, y, **{key: value for key, value in given.items() if key in arguments})
    free = free_columns(values)
    for number, body in enumerate(kinematics(values, x, y, states.prescribed[0]), start=1):
        for key, of in KINEMATICS.items():
            expected = of(body)
            if expected.shape[-1] == 6 * system.number_of_bodies:
                expected = gathered(values, expected, free)
            scale = max(1.0, np.abs(expected).max(initial=0.0))
            assert np.abs(found[number][key] - expected).max() <= 1e-12 * scale, (number, key)


def test_bodies_add_up_to_the_equations() -> None:
    system = without_actions(kg.load(MODELS / "satellite.toml"))
    states = random_states(system, 1, 5)
    assert states.force is not None and states.torque is not None
    found = module(system)["blocks"](states.x[0], states.y[0], states.force[0], states.torque[0])
    A = sum(one["mass_matrix"] for one in found.values())
    f = sum(one["forcing"] for one in found.values())
    expected = reference.mass_matrix(system, states.x[0])
    assert np.abs(A - expected).max() <= 1e-12 * np.abs(expected).max()
    right = reference.forcing(system, states.x[0], states.y[0], states.force[0], states.torque[0])
    assert np.abs(f[:, 0] - right).max() <= 1e-12 * np.abs(right).max()


def test_rates_are_those_of_the_matrices() -> None:
    """Central differences in time, whose error is of second order: 1e-10 for steps of 1e-5."""
    system = kg.load(MODELS / "gantry_crane.toml")
    blocks = module(system)["blocks"]
    x, y = (values[0] for values in (random_states(system, 1, 7).x, random_states(system, 1, 7).y))
    step = 1e-5
    before, now, after = (blocks(x + shift * y, y) for shift in (-step, 0.0, step))
    for number, body in now.items():
        for name in ("relative_rotation", "rotation", "angle_rate_matrix", "partial_velocity_of_center"):
            slope = (after[number][name] - before[number][name]) / (2 * step)
            assert np.abs(body[f"{name}_rate"] - slope).max() < 1e-8


def test_one_body_alone() -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    both, one = module(system), module(system, body=2)
    x, y = [0.3, -0.4], [1.0, 2.0]
    (number,) = one["blocks"](x, y)
    assert number == 2
    for name, expected in both["blocks"](x, y)[2].items():
        assert np.array_equal(one["blocks"](x, y)[2][name], expected)
    heavier = both["blocks"](x, y, parameters=both["PARAMETERS"] | {"m2": 5.0})
    assert heavier[2]["mass"] == 5.0
