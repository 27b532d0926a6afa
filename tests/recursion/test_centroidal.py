"""The centroidal momentum matrix and its bias: against the reference, the momentum, and what gravity does."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.coordinates import FREEDOMS
from kanegen.reference.momentum import centroidal_momentum
from kanegen.reference.states import random_states
from tests.support import prescribed_trees, random_trees, systems
from tests.support.cases import slow_except
from tests.support.orientation_trees import close
from tests.support.programs import values

OUTPUTS = ("centroidal_momentum_matrix", "centroidal_momentum_bias")


def state(system: kg.System, seed: int) -> dict[str, Any]:
    """Return the arrays of a random state by name."""
    states = random_states(system, 1, seed)
    return {"x": states.x[0], "y": states.y[0]} | {name: each[0] for name, each in states.inputs.items()}


def agrees(system: kg.System, given: dict[str, Any]) -> None:
    """Make sure that both outputs are those of the reference, and that {h} = [A_G]{y}."""
    expected = centroidal_momentum(system, given["x"], given["y"], given.get("prescribed"))
    found = values(system, (*OUTPUTS, "momentum"), given)
    close(found["centroidal_momentum_matrix"].astype(float), expected.matrix)
    close(found["centroidal_momentum_bias"].astype(float), expected.bias)
    close(found["momentum"].astype(float), expected.momentum)
    if not system.prescribed:
        close(
            found["centroidal_momentum_matrix"].astype(float).reshape(6, -1) @ given["y"], expected.momentum
        )


@pytest.mark.parametrize("seed", slow_except(range(40), *range(3)))
def test_trees_with_everything(seed: int) -> None:
    """All kinds of joints, couplings and rotors."""
    system = random_trees.everything(seed)
    agrees(system, state(system, seed))


@pytest.mark.parametrize("kind", slow_except(prescribed_trees.KINDS, "rates", "sequences"))
def test_prescribed_motion_is_part_of_the_bias(kind: str) -> None:
    for seed in range(3):
        system = prescribed_trees.tree(kind, seed)
        agrees(system, prescribed_trees.state(system, seed))


def test_rotors_that_prescribed_motion_drives() -> None:
    """Their spin accelerates, on the ground and in a body that turns."""
    system = systems.chain(2).with_prescribed(["body2.theta3"])
    rotors = [
        kg.Rotor(name, "body2.theta3", (0.3, -0.2, 0.9), 0.01, 20.0, body)
        for name, body in (("low", "ground"), ("high", "body1"))
    ]
    rng = np.random.default_rng(1)
    given = {"x": rng.normal(size=1), "y": rng.normal(size=1), "prescribed": rng.normal(size=(3, 1))}
    for mounted in (rotors, rotors[:1], rotors[1:]):
        agrees(system.with_rotors(*mounted), given)


def test_parameters_of_the_call() -> None:
    system = random_trees.everything(4)
    library = kg.build(system, OUTPUTS).with_parameters(changed := random_trees.other_parameters(system, 1))
    other = system.with_parameters(changed)
    given = state(other, 3)
    inputs = {name: value for name, value in given.items() if name == "prescribed"}
    expected = centroidal_momentum(other, given["x"], given["y"])
    close(library.centroidal_momentum_matrix(given["x"], **inputs), expected.matrix)
    close(library.centroidal_momentum_bias(given["x"], given["y"], **inputs), expected.bias)


@pytest.mark.parametrize(("precision", "margin"), [("double", 1e-12), ("float", 1e-5)])
def test_one_state_and_many_in_c(precision: str, margin: float) -> None:
    system = systems.random_system(np.random.default_rng(5), 4)
    library = kg.build(system, OUTPUTS, precision=precision)
    dtype = np.float32 if precision == "float" else np.float64
    x, y = np.random.default_rng(6).normal(size=(2, 33, library.n)).astype(dtype)
    expected = centroidal_momentum(system, x.astype(float), y.astype(float))
    for row in (slice(None), 5):
        close(library.centroidal_momentum_matrix(x[row]), expected.matrix[row], margin)
        close(library.centroidal_momentum_bias(x[row], y[row]), expected.bias[row], margin)


def test_a_translation_of_all_mass_has_exactly_no_angular_momentum() -> None:
    """No difference is computed: the entries are zeros of the program, also where the tree is far away."""
    system = systems.chain(4, FREEDOMS[5:3:-1])
    first = replace(system.bodies[0], joint=replace(system.bodies[0].joint, free=(True,) * 6))
    floating = replace(system, bodies=(first, *system.bodies[1:]))
    given = state(floating, 2)
    matrix = values(floating, OUTPUTS[:1], given)["centroidal_momentum_matrix"].reshape(6, -1)
    places = [floating.places[f] for f in floating.freedoms if f.body == 1 and not f.is_angle]
    assert not matrix[3:, places].any()
    arrays = floating.values()
    close(matrix[:3, places].astype(float), arrays.joint_orientation[0].T * arrays.mass.sum(), 1e-14)
    far = given | {"x": np.where(np.isin(np.arange(len(given["x"])), places), 1e9, given["x"])}
    again = values(floating, OUTPUTS[:1], far)["centroidal_momentum_matrix"]
    assert np.array_equal(again, matrix.ravel())


def test_bodies_without_mass_have_angular_momentum_alone() -> None:
    disc = kg.System.from_arrays(
        (0,), [0.0], [np.diag([3.0, 4.0, 5.0])], np.zeros((1, 3)), np.zeros((1, 3)),
        free=systems.flags(1, ["theta3"]),
    )  # fmt: skip
    found = values(disc, OUTPUTS, {"x": [0.3], "y": [2.0]})
    assert found["centroidal_momentum_matrix"].tolist() == [0, 0, 0, 0, 0, 5]
    assert not found["centroidal_momentum_bias"].any()


@pytest.mark.slow
def test_together_they_share_intermediates() -> None:
    """With [A] and with the momentum the matrix costs less than alone."""
    system = systems.eight_body(loads=False)

    def cost(*outputs: str) -> int:
        return sum(compile_module(system, outputs).operations.values())

    for other, spared in (("mass_matrix", 600), ("momentum", 200), ("mass_center", 200)):
        assert cost(OUTPUTS[0], other) <= cost(OUTPUTS[0]) + cost(other) - spared, other
