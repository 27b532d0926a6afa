"""Couplings: every output compared with G^T [A] G and the like of the tree without couplings; textbooks."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.program.evaluate import evaluate
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from tests.support import prescribed_trees as trees
from tests.support.couplings import random_couplings, rate_matrices, released, released_state
from tests.support.orientation_trees import close
from tests.support.prescribed_trees import KINDS, POINTS, SAME, Arrays, state, values

FRAMES = ("frame_jacobians", "frame_velocities", "frame_accelerations")
EQUATIONS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")


@cache
def tree(kind: str, seed: int, driven: bool) -> kg.System:
    """A random tree with points, motors and random couplings, with some prescribed freedoms or without."""
    system, rng = trees.tree(kind, seed), np.random.default_rng([seed, 77])
    system = system if driven else trees.freed(system)
    bodies = []
    for body in system.bodies:
        armature = tuple(float(rng.uniform(0, 0.5)) if moves else 0.0 for moves in body.joint.moving)
        rated = body.joint.speeds_are_rates
        bodies.append(replace(body, joint=replace(body.joint, armature=armature)) if rated else body)
    return random_couplings(replace(system, bodies=tuple(bodies)), rng, 0.6, parameters=0.0)


def expected(system: kg.System, given: Arrays) -> Arrays:
    """Return [A], {f} and what follows from them, from the reference of the tree without couplings."""
    other, whole = released(system), released_state(system, given)
    free, driven, _ = rate_matrices(system)
    loads = {"force": given["force"], "torque": given["torque"]}
    a = reference.mass_matrix(other, whole["x"])
    f = reference.forcing(other, whole["x"], whole["y"], **loads)
    own = free.T @ a @ free
    forcing = free.T @ (f - a @ driven @ given["prescribed"][2])
    found = {
        "mass_matrix": own,
        "forcing": forcing,
        "inverse_dynamics": own @ given["ydot"] - forcing,
        "forward_dynamics": np.linalg.solve(own, forcing + given["tau"]),
    }
    if system.prescribed:
        found["prescribed_efforts"] = driven.T @ (a @ whole["ydot"] - f)
    found |= values(other, whole, *SAME, *POINTS, *FRAMES)
    for name in ("point_jacobians", "frame_jacobians"):
        found[name] = found[name] @ free
    return found


def require_equal(kind: str, seed: int, driven: bool) -> None:
    system = tree(kind, seed, driven)
    given = state(system, seed)
    right = expected(system, given)
    outputs = tuple(right)
    together = values(system, given, *outputs)
    for name in outputs:
        close(together[name], right[name], 1e-9 if name == "forward_dynamics" else 1e-12)
    alone = EQUATIONS[seed % len(EQUATIONS)]
    close(values(system, given, alone)[alone], right[alone], 1e-9)


@pytest.mark.parametrize("driven", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_outputs_equal_those_of_the_tree_without_couplings(kind: str, driven: bool) -> None:
    assert tree(kind, 0, driven).couplings
    require_equal(kind, 0, driven)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_many_trees(kind: str) -> None:
    cases = [(seed, driven) for seed in range(1, 20) for driven in (False, True)]
    coupled = [(seed, driven) for seed, driven in cases if tree(kind, seed, driven).couplings]
    assert len(coupled) > 20
    for seed, driven in coupled:
        require_equal(kind, seed, driven)


@pytest.mark.parametrize("driven", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_the_reference_and_the_literal_equations(kind: str, driven: bool) -> None:
    system = tree(kind, 2, driven)
    given = state(system, 2)
    right = expected(system, given)
    x, y, ydot, prescribed = (given[name] for name in ("x", "y", "ydot", "prescribed"))
    loads = {"force": given["force"], "torque": given["torque"]}
    close(reference.mass_matrix(system, x, prescribed), right["mass_matrix"])
    close(reference.forcing(system, x, y, **loads, prescribed=prescribed), right["forcing"])
    if driven and system.prescribed:
        efforts = reference.prescribed_efforts(system, x, y, ydot, prescribed, **loads)
        close(efforts, right["prescribed_efforts"])
    literal = derive(system, intermediates=True).lambdify()
    close(literal.mass_matrix(x, prescribed=prescribed), right["mass_matrix"])
    close(literal.forcing(x, y, given["force"], given["torque"], prescribed=prescribed), right["forcing"])


@pytest.mark.parametrize("solver", ["articulated bodies", "factorisation"])
@pytest.mark.parametrize("kind", KINDS)
def test_both_solvers(kind: str, solver: str) -> None:
    system = tree(kind, 1, driven=True)
    given = state(system, 1)
    variant = kg.Variant(solver=solver, refinement=1)
    module = compile_module(system, ("forward_dynamics", "regularity"), variant=variant).module
    inputs = {name: np.ravel(value) for name, value in given.items()}
    found = evaluate(module.functions["evaluate"], inputs, np)
    close(np.array(found["acceleration"]), expected(system, given)["forward_dynamics"], 1e-11)
    assert all(0 < value <= 1 + 1e-12 for value in found["regularity"])
