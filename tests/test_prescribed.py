"""Prescribed freedoms: every output against the same tree with these freedoms free, and against textbooks."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kanegen as kg
from kanegen.check import reference
from kanegen.compiler import compile_module
from kanegen.program.evaluate import evaluate
from kanegen.sequences import SEQUENCES
from kanegen.signature import chosen
from kanegen.system import Freedom
from tests import systems
from tests.test_quaternions import with_some
from tests.test_speeds import SPINS, close, mixed

Arrays = dict[str, np.ndarray]

SAME = ("kinetic_energy", "potential_energy", "momentum", "mass_center", "body_poses")
POINTS = ("point_positions", "point_velocities", "point_accelerations", "point_jacobians")
EQUATIONS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics", "prescribed_efforts")
KINDS = ("slides and hinges", "sequences", "welded", "rates", "spins", "quaternions")


@cache
def tree(kind: str, seed: int) -> kg.System:
    """A random tree with points; in most joints some freedoms are free, some prescribed, some locked."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    bodies = 4
    if kind in ("rates", "spins", "quaternions"):
        system = with_some(seed) if kind == "quaternions" else mixed(seed)
        system = system.with_speeds(SPINS) if kind == "spins" else system
    else:
        free = systems.random_free(rng, bodies, 0.7)
        free[1] &= kind != "welded"
        free[0, 0] = True
        system = systems.random_system(rng, bodies, free=free, loads=True, orientations=bool(seed % 2))
    if kind == "sequences":
        kinds = rng.choice(list(SEQUENCES), bodies)
        pairs = zip(system.bodies, kinds, strict=True)
        turned = (replace(b, joint=replace(b.joint, sequence=str(sequence))) for b, sequence in pairs)
        system = replace(system, bodies=tuple(turned))
    able = [f for f in system.freedoms if not (f.is_angle and system.bodies[f.body - 1].joint.spins)]
    chosen = [system.freedom_names[system.places[f]] for f in able if rng.random() < 0.45]
    system = system.with_prescribed(chosen[: len(system.freedoms) - 1])
    points = {f"p{k}": (k, rng.normal(size=3)) for k in (1, system.number_of_bodies)}
    return system.with_points(points)


def freed(system: kg.System) -> kg.System:
    """The same tree with its prescribed freedoms free."""
    joints = (replace(b.joint, free=b.joint.moving, prescribed=(False,) * 6) for b in system.bodies)
    bodies = (replace(b, joint=joint) for b, joint in zip(system.bodies, joints, strict=True))
    return replace(system, bodies=tuple(bodies))


def state(system: kg.System, seed: int) -> Arrays:
    """Everything that a function may read."""
    rng = np.random.default_rng(seed)
    n, bodies = len(system.freedoms), system.number_of_bodies
    found = {name: rng.normal(size=n) for name in ("y", "ydot", "tau")}
    found |= {name: rng.normal(size=(bodies, 3)) for name in ("force", "torque")}
    found["x"] = rng.uniform(-1, 1, len(system.coordinates))
    return found | {"prescribed": rng.uniform(-1, 1, (3, len(system.prescribed)))}


def merged(system: kg.System, other: kg.System, given: Arrays) -> Arrays:
    """The same state of the tree where all that moves is free."""
    x, y, ydot = np.zeros(len(other.coordinates)), *np.zeros((2, len(other.freedoms)))
    for coordinate, place in other.coordinate_places.items():
        known = system.coordinate_places.get(coordinate)
        told = Freedom(coordinate.body, coordinate.index)
        x[place] = (
            given["prescribed"][0, system.prescribed.index(told)] if known is None else given["x"][known]
        )
    free, moved = parts(system, other)
    y[free], y[moved] = given["y"], given["prescribed"][1]
    ydot[free], ydot[moved] = given["ydot"], given["prescribed"][2]
    return given | {"x": x, "y": y, "ydot": ydot}


def parts(system: kg.System, other: kg.System) -> tuple[list[int], list[int]]:
    """Where the free freedoms and the prescribed ones stand in {y} where all are free."""
    return [other.places[f] for f in system.freedoms], [other.places[f] for f in system.prescribed]


def values(system: kg.System, given: Arrays, *outputs: str) -> Arrays:
    """Results of the program that becomes C, by output."""
    module = compile_module(system, outputs).module
    function = module.functions["evaluate" if len(outputs) > 1 else outputs[0]]
    found = evaluate(function, {name: np.ravel(value) for name, value in given.items()}, np)
    pairs = zip(chosen(outputs), function.outputs, strict=True)
    return {name: np.array(found[o.array.name], float).reshape(o.array.shape) for name, o in pairs}


def partitioned(system: kg.System, other: kg.System, given: Arrays) -> Arrays:
    """[A], {f} and what follows from them, from the reference of the tree where all that moves is free."""
    free, moved = parts(system, other)
    whole = merged(system, other, given)
    loads = {"force": given["force"], "torque": given["torque"]}
    a = reference.mass_matrix(other, whole["x"])
    f = reference.forcing(other, whole["x"], whole["y"], **loads)
    coupled, own = a[np.ix_(free, moved)], a[np.ix_(free, free)]
    told = given["prescribed"][2]
    forcing = f[free] - coupled @ told
    return {
        "mass_matrix": own,
        "forcing": forcing,
        "inverse_dynamics": own @ given["ydot"] - forcing,
        "forward_dynamics": np.linalg.solve(own, forcing + given["tau"]),
        "prescribed_efforts": coupled.T @ given["ydot"] + a[np.ix_(moved, moved)] @ told - f[moved],
    }


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [0, 2])
def test_the_same_tree_with_these_freedoms_free(kind: str, seed: int) -> None:
    """[A] and {f} partitioned; energies, momentum, poses and points as they are."""
    system = tree(kind, seed)
    assert system.prescribed
    other, given = freed(system), state(system, seed)
    free, _ = parts(system, other)
    right = partitioned(system, other, given)
    right |= values(other, merged(system, other, given), *SAME, *POINTS)
    right["point_jacobians"] = right["point_jacobians"][..., free]
    outputs = (*EQUATIONS, *SAME, *POINTS)
    together = values(system, given, *outputs)
    for name in outputs:
        close(together[name], right[name], 1e-11 if name == "forward_dynamics" else 1e-12)
    alone = EQUATIONS[seed // 2]
    close(values(system, given, alone)[alone], right[alone])


@pytest.mark.parametrize("kind", KINDS)
def test_the_reference(kind: str) -> None:
    """It takes the prescribed columns as they come; the partition is of [A] and {f} without any."""
    system = tree(kind, 3)
    given = state(system, 3)
    right = partitioned(system, freed(system), given)
    x, y, ydot, told = (given[name] for name in ("x", "y", "ydot", "prescribed"))
    loads = {"force": given["force"], "torque": given["torque"]}
    close(reference.mass_matrix(system, x, told), right["mass_matrix"])
    close(reference.forcing(system, x, y, **loads, prescribed=told), right["forcing"])
    close(reference.prescribed_efforts(system, x, y, ydot, told, **loads), right["prescribed_efforts"])


@pytest.mark.parametrize("solver", ["articulated bodies", "factorisation"])
def test_both_solvers(solver: str) -> None:
    system = tree("slides and hinges", 1)
    given = state(system, 1)
    variant = kg.Variant(solver=solver, refinement=1)
    module = compile_module(system, ("forward_dynamics", "regularity"), variant=variant).module
    inputs = {name: np.ravel(value) for name, value in given.items()}
    found = evaluate(module.functions["evaluate"], inputs, np)
    close(
        np.array(found["acceleration"]), partitioned(system, freed(system), given)["forward_dynamics"], 1e-11
    )
    assert all(0 < value <= 1 + 1e-12 for value in found["regularity"])


def test_what_stands_still_is_locked() -> None:
    """With rates and accelerations of zero nothing tells a prescribed freedom from one locked there."""
    system = tree("sequences", 4)
    given = state(system, 4)
    given["prescribed"][1:] = 0
    held = list(system.bodies)
    for freedom, value in zip(system.prescribed, given["prescribed"][0], strict=True):
        body = held[freedom.body - 1]
        locked, told = list(body.joint.locked), list(body.joint.prescribed)
        locked[freedom.index], told[freedom.index] = float(value), False
        joint = replace(body.joint, locked=tuple(locked), prescribed=tuple(told))
        held[freedom.body - 1] = replace(body, joint=joint)
    locked = replace(system, bodies=tuple(held))
    outputs = (*EQUATIONS[:-1], *SAME, *POINTS)
    right = values(locked, given, *outputs)
    for name, found in values(system, given, *outputs).items():
        close(found, right[name], 1e-11)
