"""Random trees in which some freedoms are prescribed, their states, and the values of their outputs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.coordinates import SEQUENCES
from kanegen.program.evaluate import evaluate
from kanegen.recursion.outputs import chosen
from tests.support import systems
from tests.support.orientation_trees import ANGULAR_VELOCITY, mixed, with_quaternions

Arrays = dict[str, np.ndarray]

SAME = ("kinetic_energy", "potential_energy", "momentum", "mass_center", "body_poses")
POINTS = ("point_positions", "point_velocities", "point_accelerations", "point_jacobians")
EQUATIONS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics", "prescribed_efforts")
KINDS = ("slides and hinges", "sequences", "welded", "rates", "angular velocities", "quaternions")


@cache
def tree(kind: str, seed: int) -> kg.System:
    """A random tree with points; in most joints some freedoms are free, some prescribed, some locked."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    bodies = 3
    if kind in ("rates", "angular velocities", "quaternions"):
        system = with_quaternions(seed) if kind == "quaternions" else mixed(seed)
        system = system.with_speeds(ANGULAR_VELOCITY) if kind == "angular velocities" else system
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
    able = [f for f in system.freedoms if system.speed_of(f).kind.is_rate]
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
    """Return random values of all arrays that a function may read."""
    rng = np.random.default_rng(seed)
    n, bodies = len(system.freedoms), system.number_of_bodies
    found = {name: rng.normal(size=n) for name in ("y", "ydot", "tau")}
    found |= {name: rng.normal(size=(bodies, 3)) for name in ("force", "torque")}
    found["x"] = rng.uniform(-1, 1, len(system.coordinates))
    return found | {"prescribed": rng.uniform(-1, 1, (3, len(system.prescribed)))}


def values(system: kg.System, given: Arrays, *outputs: str) -> Arrays:
    """Return the results of the program that becomes C, by output."""
    module = compile_module(system, outputs).module
    function = module.functions["evaluate" if len(outputs) > 1 else outputs[0]]
    found = evaluate(function, {name: np.ravel(value) for name, value in given.items()}, np)
    pairs = zip(chosen(outputs), function.outputs, strict=True)
    return {name: np.array(found[o.array.name], float).reshape(o.array.shape) for name, o in pairs}
