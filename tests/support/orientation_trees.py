"""Trees with angular velocities as speeds or quaternions as coordinates, their states and their results."""

from __future__ import annotations

from functools import cache

import numpy as np

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.coordinates import Freedom
from kanegen.program.evaluate import evaluate
from tests.support import systems

ANGULAR_VELOCITY = "angular_velocity"
"""Name of the speeds that are components of relative angular velocities."""

ARRAYS = {"mass_matrix": "A", "forcing": "f", "inverse_dynamics": "generalized_force"}
ARRAYS |= {"forward_dynamics": "acceleration"}
"""Names of output arrays by output."""


@cache
def mixed(seed: int) -> kg.System:
    """Return a random tree in which about half of the bodies have three free angles, with angle rates."""
    rng = np.random.default_rng(seed)
    bodies = int(rng.integers(1, 5))
    free = systems.random_free(rng, bodies, 0.4)
    free[rng.random(bodies) < 0.5, :3] = True
    free[rng.integers(bodies), :3] = True
    return systems.random_system(rng, bodies, free=free, loads=True, orientations=bool(seed % 3))


def angle_state(system: kg.System, seed: int = 0) -> dict[str, np.ndarray]:
    """Return random values of all arrays that a function may read, with theta2 away from gimbal lock."""
    rng = np.random.default_rng(seed)
    n, bodies = len(system.freedoms), system.number_of_bodies
    values = {name: rng.normal(size=n) for name in ("x", "y", "ydot", "tau")}
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.has_free_orientation:  # the rates of the angles exist
            values["x"][system.places[Freedom(k, 1)]] = rng.uniform(-1.2, 1.2)
    return values | {name: rng.normal(size=(bodies, 3)) for name in ("force", "torque")}


def values(system: kg.System, given: dict[str, np.ndarray], *outputs: str) -> dict[str, np.ndarray]:
    """Return the results of the program that becomes C, by array."""
    program = compile_module(system, outputs).module.functions
    function = program["evaluate" if len(outputs) > 1 else outputs[0]]
    found = evaluate(function, {name: value.ravel() for name, value in given.items()}, np)
    return {name: np.array(value, dtype=float) for name, value in found.items()}


def maps(system: kg.System, given: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return [T] of {y} = [T]{xdot}, Eq. (8), its time derivative, and {xdot}."""
    n = len(system.freedoms)
    whole, rate, xdot = np.eye(n), np.zeros((n, n)), given["y"].copy()
    for k, body in enumerate(system.bodies, start=1):
        if not body.joint.speeds_are_rates:
            place = [system.places[Freedom(k, i)] for i in range(3)]
            (s2, s3), (c2, c3) = np.sin(given["x"][place[1:]]), np.cos(given["x"][place[1:]])
            block = np.array([[c2 * c3, s3, 0.0], [-c2 * s3, c3, 0.0], [s2, 0.0, 1.0]])
            _, d2, d3 = xdot[place] = np.linalg.solve(block, given["y"][place])
            whole[np.ix_(place, place)] = block
            rate[np.ix_(place, place)] = [
                [-s2 * c3 * d2 - c2 * s3 * d3, c3 * d3, 0.0],
                [s2 * s3 * d2 - c2 * c3 * d3, -s3 * d3, 0.0],
                [c2 * d2, 0.0, 0.0],
            ]
    return whole, rate, xdot


def close(found: np.ndarray, expected: np.ndarray, factor: float = 1e-12) -> None:
    """Require equal arrays, up to `factor` times the largest entry."""
    found, expected = np.ravel(found), np.ravel(expected)
    assert np.abs(found - expected).max() <= factor * max(np.abs(expected).max(), 1e-3)


@cache
def with_quaternions(seed: int) -> kg.System:
    """Return `mixed(seed)` with quaternions for about half of the bodies with three free angles."""
    rng = np.random.default_rng(seed)
    tree = mixed(seed)
    coordinates = [
        "quaternion" if b.joint.has_free_orientation and rng.random() < 0.7 else "angles" for b in tree.bodies
    ]
    first = next(k for k, body in enumerate(tree.bodies) if body.joint.has_free_orientation)
    coordinates[first] = "quaternion"
    return remade(tree, "coordinates", coordinates)


KINDS = ("rates", "angular velocities", "quaternions", "slides and hinges")
"""Kinds of random trees, by their speeds and coordinates."""


def tree_of_kind(kind: str, seed: int) -> kg.System:
    """Return a random tree of one of `KINDS`."""
    return {
        "rates": mixed(seed),
        "angular velocities": mixed(seed).with_speeds(ANGULAR_VELOCITY),
        "quaternions": with_quaternions(seed),
        "slides and hinges": systems.random_system(np.random.default_rng(seed), 5),
    }[kind]


def remade(system: kg.System, what: str, value: list[str]) -> kg.System:
    """Return the system with one of its arrays changed."""
    arrays = system.values()
    kept = arrays.rows()
    return kg.System.from_arrays(**(kept | {what: value}))


def quaternion_state(system: kg.System, seed: int = 0) -> dict[str, np.ndarray]:
    """Return random values of all arrays that a function may read, with quaternions of any length."""
    rng = np.random.default_rng(seed)
    n, bodies = len(system.freedoms), system.number_of_bodies
    found = {name: rng.normal(size=n) for name in ("y", "ydot", "tau")}
    found["x"] = rng.uniform(-1.2, 1.2, len(system.coordinates))
    return found | {name: rng.normal(size=(bodies, 3)) for name in ("force", "torque")}
