"""The regressor: against the reference, and with random inertial parameters against inverse dynamics."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.program.count import count
from kanegen.reference import equations
from kanegen.reference.regressor import regressor
from kanegen.reference.states import random_states
from tests.support import prescribed_trees, random_trees, systems
from tests.support.cases import slow_except
from tests.support.orientation_trees import close
from tests.support.programs import values


def state(system: kg.System, seed: int) -> dict[str, Any]:
    """Return the arrays of a random state by name."""
    states = random_states(system, 1, seed)
    found = {"x": states.x[0], "y": states.y[0]} | {name: each[0] for name, each in states.inputs.items()}
    return found | {"ydot": np.random.default_rng(seed).normal(size=found["y"].shape)}


def bare(system: kg.System) -> kg.System:
    """Return the system without force elements, loads and motors, whose effort is [Y]{pi}."""
    bodies = tuple(replace(b, joint=replace(b.joint, armature=(0.0,) * 6)) for b in system.bodies)
    return replace(system, bodies=bodies, rotors=(), force_elements=())


def with_random_inertias(system: kg.System, seed: int) -> kg.System:
    """Return the same tree with other masses, mass centres and inertias."""
    rng = np.random.default_rng(seed)
    bodies = []
    for body in system.bodies:
        mass = float(rng.uniform(0.1, 3.0))
        inertia = systems.random_inertia(rng, mass).tolist()
        bodies.append(replace(body, mass=mass, inertia=inertia, mass_center=tuple(rng.normal(size=3))))
    return replace(system, bodies=tuple(bodies))


def effort(system: kg.System, given: dict[str, Any]) -> np.ndarray:
    """Return [A]{ydot} - {f} by the reference."""
    motion = given.get("prescribed")
    a = equations.mass_matrix(system, given["x"], motion)
    f = equations.forcing(system, given["x"], given["y"], prescribed=motion)
    found: np.ndarray = a @ given["ydot"] - f
    return found


def agrees(system: kg.System, given: dict[str, Any], seed: int) -> None:
    """Make sure that [Y] is the reference's, and [Y]{pi} the effort for random {pi}."""
    expected = regressor(system, given["x"], given["y"], given["ydot"], given.get("prescribed"))
    found = values(system, ("regressor",), given)["regressor"].astype(float)
    close(found, expected)
    other = bare(with_random_inertias(system, seed))
    close(expected @ kg.inertial_parameters(other), effort(other, given))


@pytest.mark.parametrize("seed", slow_except(range(40), *range(5)))
def test_trees_with_everything(seed: int) -> None:
    """All kinds of joints, frames of bodies for their users, and couplings."""
    system = random_trees.everything(seed, 3)
    agrees(system, state(system, seed), seed)


@pytest.mark.parametrize("kind", prescribed_trees.KINDS)
def test_prescribed_motion(kind: str) -> None:
    for seed in range(2):
        system = prescribed_trees.tree(kind, seed)
        agrees(system, prescribed_trees.state(system, seed), seed)


def test_no_inertial_parameter_is_in_the_code() -> None:
    """The same tree with other masses, inertias and motors has the same program."""
    system = random_trees.everything(2, 3)
    one, other = (
        compile_module(each, ("regressor",)).module.functions["regressor"]
        for each in (bare(system), with_random_inertias(system, 1))
    )
    unnamed = ([each.named("") for each in f.instructions] for f in (one, other))
    assert next(unnamed) == next(unnamed)
    assert one.outputs == other.outputs


def test_freedoms_that_carry_no_body_have_zeros_of_the_program() -> None:
    """In a tree with two branches half of the entries are zero and cost nothing."""
    system = systems.random_system(
        np.random.default_rng(3), 5, connection=(0, 1, 2, 1, 4), free=systems.flags(5, ["theta2"])
    )
    given = state(system, 1)
    found = values(system, ("regressor",), given)["regressor"].reshape(5, 5, 10)
    carried = np.array([[1, 1, 1, 1, 1], [0, 1, 1, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 1, 1], [0, 0, 0, 0, 1]])
    assert not found[carried == 0].any()
    assert found[carried == 1].any(axis=-1).all()


@pytest.mark.parametrize(("precision", "margin"), [("double", 1e-12), ("float", 1e-5)])
def test_one_state_and_many_in_c(precision: str, margin: float) -> None:
    system = systems.random_system(np.random.default_rng(5), 3)
    library = kg.build(system, "regressor", precision=precision)
    dtype = np.float32 if precision == "float" else np.float64
    x, y, ydot = np.random.default_rng(6).normal(size=(3, 33, library.n)).astype(dtype)
    expected = regressor(system, *(one.astype(float) for one in (x, y, ydot)))
    for row in (slice(None), 5):
        close(library.regressor(x[row], y[row], ydot[row]), expected[row], margin)


def test_parameters_of_the_call() -> None:
    system = random_trees.everything(4, 3)
    library = kg.build(system, "regressor").with_parameters(
        changed := random_trees.other_parameters(system, 1)
    )
    other = system.with_parameters(changed)
    given = state(other, 3)
    x, y, ydot = (given[name] for name in ("x", "y", "ydot"))
    close(library.regressor(x, y, ydot), regressor(other, x, y, ydot))


def test_inverse_dynamics_shares_motions() -> None:
    system = systems.chain(5)
    alone = compile_module(system, ("regressor",)).module.functions["regressor"]
    both = compile_module(system, ("regressor", "inverse_dynamics"))
    inverse = compile_module(system, ("inverse_dynamics",)).module.functions["inverse_dynamics"]
    together = sum(both.operations.values())
    assert together < sum(count(alone).values()) + sum(count(inverse).values()) - 100
