"""Random trees with every kind of orientation, coordinate, speed, force element and parameter at once."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.measure.comparison import compare
from kanegen.measure.truth import truth
from kanegen.model.force_elements.elements import JointSpring, Spring
from kanegen.model.numbers import value_of
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states
from kanegen.symbolic import derive
from tests.support import moving_bodies, random_trees
from tests.support.cases import slow_except
from tests.support.programs import values

DYNAMICS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
SEEDS = slow_except(range(60), 0, 1, 4)
"""The 32 bodies of eight successive seeds have every pair of a rotation and a constant orientation; those of
five have most of them."""


def changed(seed: int) -> tuple[kg.System, kg.System]:
    """Return a tree, and the same tree with the parameters of the call as defaults."""
    system = random_trees.everything(seed)
    return system, system.with_parameters(random_trees.other_parameters(system, seed))


def state(states: States, system: kg.System, index: int = 0) -> dict[str, Any]:
    """Return the arrays of one state by name, parameters at the defaults of `system`."""
    found: dict[str, Any] = {"x": states.x[index], "y": states.y[index]}
    found |= {name: each[index] for name, each in states.inputs.items()}
    if states.force is not None and states.torque is not None:
        found |= {"force": states.force[index], "torque": states.torque[index]}
    return found | {"parameters": [parameter.value for parameter in system.parameters]}


@pytest.mark.parametrize("seed", SEEDS)
def test_every_output_agrees_with_the_reference(seed: int) -> None:
    system, other = changed(seed)
    given = state(random_states(other, 1, seed), other)
    loads = {name: given[name] for name in given if name not in ("x", "y", "parameters")}
    a, f = reference.mass_matrix(other, given["x"]), reference.forcing(other, given["x"], given["y"], **loads)
    terms = reference.forcing_terms(other, given["x"], given["y"], **loads)
    size = max(np.abs(part).max() for part in vars(terms).values())
    ydot, tau = np.random.default_rng(seed).normal(size=(2, len(f)))
    found = values(system, DYNAMICS, given | {"ydot": ydot, "tau": tau})
    assert np.abs(found["A"].reshape(a.shape) - a).max() <= 1e-13 * np.abs(a).max()
    assert np.abs(found["f"] - f).max() <= 1e-12 * size
    effort = a @ ydot - f
    assert np.abs(found["generalized_force"] - effort).max() <= 1e-12 * (size + np.abs(effort).max())
    expected = np.linalg.solve(a, f + tau)
    room = 1e-12 * np.linalg.cond(a) * (np.abs(expected).max() + size / np.abs(a).max())
    assert np.abs(found["acceleration"] - expected).max() <= room


@pytest.mark.parametrize("seed", slow_except(range(30), 3))
def test_certified_truth_without_force_elements(seed: int) -> None:
    """Both algorithms of truth are independent of the reference, too; parameters have other values."""
    system = random_trees.without_actions(random_trees.everything(seed, 3))
    other = random_trees.other_parameters(system, seed)
    sample = random_states(system.with_parameters(other), 1, seed)
    given = state(sample, system.with_parameters(other))
    tau, ydot = np.random.default_rng(seed).normal(size=(2, len(given["y"])))
    loads = {name: given[name] for name in ("force", "torque") if name in given}
    exact = truth(system, given["x"], given["y"], tau, **loads, ydot=ydot, parameters=other, outputs=DYNAMICS)
    found = values(system, DYNAMICS, given | {"ydot": ydot, "tau": tau})
    condition = np.linalg.cond(exact["mass_matrix"].value)
    for name, array in zip(DYNAMICS, ("A", "f", "generalized_force", "acceleration"), strict=True):
        expected = np.ravel(exact[name].value)
        room = 1e-13 * (condition if name == "forward_dynamics" else 10)
        assert np.abs(found[array] - expected).max() <= room * np.abs(expected).max(), name


@pytest.mark.parametrize("seed", slow_except(range(6), 1))
def test_c_agrees_with_the_reference(seed: int) -> None:
    report = compare(random_trees.everything(seed), kg.build(random_trees.everything(seed)), states=50)
    assert report.passed, str(report)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_literal_equations_agree_with_the_reference(seed: int) -> None:
    """The notes' equations in SymPy, with parameters as symbols."""
    system = random_trees.everything(seed, 2)
    given = state(random_states(system, 1, seed), system)
    loads = {name: given[name] for name in given if name not in ("x", "y", "parameters")}
    expected = reference.forcing(system, given["x"], given["y"], **loads)
    found = derive(system).lambdify().forcing(given["x"], given["y"], **loads)
    assert np.abs(found - expected).max() <= 1e-11 * np.abs(expected).max()


def test_every_pairing_is_drawn() -> None:
    """Successive bodies have every pair of a rotation and a constant orientation."""
    pairs = set()
    for turn in range(4 * 8):
        pairs.add((turn % len(random_trees.ROTATIONS), turn % len(random_trees.ORIENTATIONS)))
    assert len(pairs) == len(random_trees.ROTATIONS) * len(random_trees.ORIENTATIONS)


@pytest.mark.parametrize("seed", slow_except(range(12), 1, 6))
def test_the_energy_of_springs_and_gravity(seed: int) -> None:
    """The potential energy is that of the weights and of springs of known stiffness, rest and length."""
    system = random_trees.everything(seed)
    springs = tuple(e for e in system.force_elements if isinstance(e, Spring | JointSpring))
    system = replace(system, force_elements=springs)
    given = state(random_states(system, 1, seed), system)
    theirs = moving_bodies.expected(system.values(), given["x"], given["y"])
    energy = float(theirs["potential_energy"])
    for spring in springs:
        if isinstance(spring, Spring):
            one, two = (_place(system, theirs["body_poses"], end) for end in spring.between)
            stretch = np.linalg.norm(two - one) - value_of(spring.rest_length)
        else:
            stretch = given["x"][system.coordinate_names.index(spring.freedom)] - value_of(spring.rest)
        energy += value_of(spring.stiffness) * stretch**2 / 2
    found = values(system, ("potential_energy",), given)["potential_energy"]
    assert found == pytest.approx(energy, rel=1e-12, abs=1e-11)


def _place(system: kg.System, poses: Any, end: Any) -> Any:
    """Return the inertial position of an end of a spring (m)."""
    if not isinstance(end, str):
        return _numbers(end)
    k, position = system.values().place(end)
    return poses[k - 1, 3] + poses[k - 1, :3].T @ position if k else position


def _numbers(vector: Any) -> Any:
    return np.array([value_of(value) for value in vector])
