"""Symbols in place of the numbers of a tree: which numbers get one, and that the equations stay the same."""

from __future__ import annotations

import numpy as np
import pytest

import kanegen as kg
from kanegen.model.numbers import value_of
from kanegen.model.symbolic import Place, places
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from tests.support.paths import MODELS
from tests.support.random_trees import everything
from tests.support.systems import eight_body


def test_eight_bodies_have_the_symbols_of_the_notes() -> None:
    system = eight_body().symbolic()
    names = {parameter.name for parameter in system.parameters}
    expected = {"g"} | {f"m_{k}" for k in range(1, 9)}
    expected |= {f"r_{k}_{i}" for k in range(1, 9) for i in (1, 2, 3)}
    expected |= {f"q_{k}_{i}" for k in range(2, 9) for i in (1, 2, 3)}  # the notes define {q'_1} as zero
    expected |= {f"I_{k}_{ij}" for k in range(1, 9) for ij in (11, 12, 13, 22, 23, 33)}
    assert names == expected
    assert {one.name: place for one, place in places(system)}["I_8_13"] == Place("I", 8, (1, 3))


def test_zeros_stay_unless_every_body_is_to_be_general() -> None:
    system = kg.load(MODELS / "six_revolute_arm.toml")
    kept, general = system.symbolic(), system.symbolic(keep_zeros=False)
    for before, after in zip(system.bodies, kept.bodies, strict=True):
        zeros = [value == 0 for value in (*before.mass_center, *before.joint.position)]
        assert zeros == [value == 0.0 for value in (*after.mass_center, *after.joint.position)]
    assert {"q_2_1", "q_2_2", "q_2_3"} <= {parameter.name for parameter in general.parameters}
    assert kept.symbolic() == kept
    at_origin = kg.load(MODELS / "double_pendulum.toml").symbolic(keep_zeros=False)
    assert at_origin.bodies[0].joint.position == (0.0, 0.0, 0.0)


def test_parameters_and_expressions_stay_and_taken_names_are_avoided() -> None:
    taken = kg.Parameter("m_1", 0.25)
    inertia = ((0.1, 0, 0), (0, 0.2, 0), (0, 0, taken * 0.4))
    body = kg.Body("bob", 0, 2.0, inertia, (0, 0, -taken))
    system = kg.System("pendulum", (body,), gravity=(0.0, 3.0, -4.0)).symbolic()
    (bob,) = system.bodies
    assert bob.mass == kg.Parameter("m_1_", 2.0)
    assert bob.mass_center == body.mass_center
    assert bob.inertia[2][2] == body.inertia[2][2]
    assert system.gravity == (0.0, kg.Parameter("g_2", 3.0), kg.Parameter("g_3", -4.0))
    assert dict(places(system))[kg.Parameter("m_1_", 2.0)] == Place("m", 1)
    upward = kg.System("pendulum", (body,), gravity=(9.0, 0, 0)).symbolic()
    assert upward.gravity == (kg.Parameter("g", 9.0), 0.0, 0.0)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("keep_zeros", [True, False])
def test_a_symbolic_tree_has_the_values_of_its_tree(seed: int, keep_zeros: bool) -> None:
    system = everything(seed)
    symbolic = system.symbolic(keep_zeros)
    for name, expected in system.values().rows().items():
        assert np.array_equal(getattr(symbolic.values(), name), expected)


def test_other_values_of_the_symbols_give_the_equations_of_another_tree() -> None:
    system = kg.load(MODELS / "satellite.toml")
    symbolic = system.symbolic()
    factors = {"m": 1.5, "r": 1.25, "q": 0.75, "I": 1.125}
    changed = {one.name: one.value * factors[place.quantity] for one, place in places(symbolic)}
    heavier = symbolic.with_parameters(changed).map_numbers(value_of)
    assert heavier.bodies[0].mass == 1.5 * system.bodies[0].mass
    assert not heavier.parameters
    x = np.random.default_rng(1).uniform(-1, 1, len(system.coordinates))
    found = derive(symbolic.with_parameters(changed)).lambdify().mass_matrix(x)
    expected = reference.mass_matrix(heavier, x)
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()  # the rounding of a few products
