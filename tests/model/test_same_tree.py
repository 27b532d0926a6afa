"""One system for several that differ in numbers: which numbers become parameters, and with which values."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.model.numbers import value_of
from kanegen.model.system_numbers import numbers_of
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states
from tests.support.paths import MODELS
from tests.support.programs import values
from tests.support.random_trees import everything, other_parameters


def pair(seed: int) -> tuple[kg.System, kg.System]:
    """Return two random trees without parameters that differ in about a fifth of their numbers."""
    system = everything(seed)
    other = system.with_parameters(other_parameters(system, seed))
    return system.map_numbers(value_of), other.map_numbers(value_of)


def numbers(system: kg.System) -> Any:
    return np.array([value_of(one) for one in numbers_of(system)])


@pytest.mark.parametrize("seed", range(5))
def test_parameters_stand_where_numbers_differ_and_give_the_other_system(seed: int) -> None:
    system, other = pair(seed)
    shared = system.with_parameters_for(other)
    differs = numbers(system) != numbers(other)
    assert differs.any()
    assert [not isinstance(one, float) for one in numbers_of(shared)] == differs.tolist()
    assert shared.map_numbers(value_of) == system
    found = shared.parameters_for(other)
    assert list(found) == [one.name for one in shared.parameters]
    assert shared.with_parameters(found).map_numbers(value_of) == other
    assert shared.parameters_for(system) == {one.name: one.value for one in shared.parameters}


@pytest.mark.parametrize("seed", [0, 3])
def test_one_program_has_the_equations_of_both_systems(seed: int) -> None:
    """Expected are those of the NumPy reference for each system, which knows nothing of parameters."""
    system, other = pair(seed)
    shared = system.with_parameters_for(other)
    for one in (system, other):
        states = random_states(one, 1, seed)
        given: dict[str, Any] = {name: each[0] for name, each in states.inputs.items()}
        if states.force is not None and states.torque is not None:
            given |= {"force": states.force[0], "torque": states.torque[0]}
        x, y = states.x[0], states.y[0]
        parameters = list(shared.parameters_for(one).values())
        found = values(shared, ("mass_matrix", "forcing"), given | {"x": x, "y": y, "parameters": parameters})
        mass, forcing = reference.mass_matrix(one, x), reference.forcing(one, x, y, **given)
        terms = reference.forcing_terms(one, x, y, **given)
        size = max(np.abs(part).max() for part in vars(terms).values())
        assert np.abs(found["A"].reshape(mass.shape) - mass).max() <= 1e-13 * np.abs(mass).max()
        assert np.abs(found["f"] - forcing).max() <= 1e-12 * size


def test_symbols_get_their_values_from_a_system_without_symbols() -> None:
    """Gravity along an axis is -g: a parameter with the other sign."""
    arm = kg.load(MODELS / "six_revolute_arm.toml")
    bodies = tuple(replace(body, mass=2 * value_of(body.mass)) for body in arm.bodies)
    on_mars = replace(arm, bodies=bodies, gravity=(0.0, 0.0, -3.7), name="on_mars")
    symbolic = arm.symbolic()
    given = symbolic.parameters_for(on_mars)
    assert given["g"] == 3.7
    assert given["m_2"] == 2 * value_of(arm.bodies[1].mass)
    found = symbolic.with_parameters(given).with_name("on_mars").map_numbers(value_of)
    assert found == on_mars.map_numbers(value_of)
    assert symbolic.with_parameters_for(on_mars) == symbolic


def test_a_product_of_inertia_is_one_parameter() -> None:
    pendulum = kg.load(MODELS / "planar_pendulum.toml").map_numbers(value_of)
    bob, *outward = pendulum.bodies
    turned = replace(bob, inertia=((2.0, 0.5, 0.0), (0.5, 2.5, 0.0), (0.0, 0.0, 3.0)))
    shared = pendulum.with_parameters_for(replace(pendulum, bodies=(turned, *outward)))
    inertia = shared.bodies[0].inertia
    assert inertia[0][1] is inertia[1][0] == kg.Parameter("I_1_12", bob.inertia[0][1])
    assert inertia[1][2] == 0.0


def test_names_and_limits_do_not_make_another_tree_and_taken_names_are_avoided() -> None:
    pendulum = kg.load(MODELS / "planar_pendulum.toml").map_numbers(value_of)
    bob, *outward = pendulum.bodies
    taken = kg.Parameter("m_1", 0.25)
    system = replace(pendulum, bodies=(replace(bob, mass_center=(0.0, 0.0, -taken)), *outward))
    limited = system.with_limits({system.freedom_names[0]: {"position": (-1.0, 1.0)}}).with_name("heavier")
    other = replace(limited, bodies=(replace(limited.bodies[0], mass=7.0), *outward))
    shared = system.with_parameters_for([other, other])
    assert shared.bodies[0].mass == kg.Parameter("m_1_", value_of(bob.mass))
    assert shared.parameters_for(other) == {"m_1_": 7.0, "m_1": 0.25}
    assert system.with_parameters_for([]) == system


def test_what_is_no_other_set_of_numbers_is_refused_with_its_place() -> None:
    arm = kg.load(MODELS / "double_pendulum.toml").map_numbers(value_of)
    first, second = arm.bodies
    heavier = replace(arm, bodies=(first, replace(second, mass=9.0)))
    with pytest.raises(kg.ModelError, match=r"m_2 is 9\.0, but .* has the number .* with_parameters_for"):
        arm.parameters_for(heavier)
    with pytest.raises(kg.ModelError, match="body 2 differs in more than the values of numbers"):
        arm.with_parameters_for(replace(arm, bodies=(first, replace(second, lower=0))))
    with pytest.raises(kg.ModelError, match="it has 1 instead of 2 bodies"):
        arm.with_parameters_for([heavier, replace(arm, bodies=(first,))])
    with pytest.raises(kg.ModelError, match="is no system"):
        arm.with_parameters_for([3])  # type: ignore[list-item]
    with pytest.raises(kg.ModelError, match="its poses differ"):
        arm.parameters_for(arm.with_poses([first.name]))
    one = kg.Parameter("both", 1.0)
    tied = replace(arm, bodies=(replace(first, mass=one), replace(second, mass=one)))
    with pytest.raises(kg.ModelError, match=r"m_2 is 9\.0, but .* has 'both' there, which is"):
        tied.parameters_for(heavier)
