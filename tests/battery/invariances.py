"""Models that describe the same motion in different ways: X28 and X29."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

import kanegen as kg
from kanegen.measure.truth import truth
from kanegen.model.arrays import SystemArrays
from kanegen.reference.states import random_states
from kanegen.studies.explain.general_form import with_numbers_as_parameters
from tests.battery import scenes
from tests.battery.experiments import Point, Row, Size, experiment
from tests.battery.measurement import PRECISIONS, Floats, built, efforts, promise, rounded, worst


@dataclass(frozen=True)
class Description:
    """Another description of a system.

    Attributes:
        arrays: The numbers of the other description.
        places: Index, in the original description, of each freedom of the other one.
        signs: Sign by which each of its coordinates differs.
    """

    arrays: SystemArrays
    places: np.ndarray
    signs: np.ndarray


TURN = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Rotation that relabels axes 1, 2, 3 as 3, 1, 2."""

QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
MIRROR = np.diag([1.0, -1.0, 1.0])


def _unchanged(system: kg.System) -> Description:
    n = len(system.freedoms)
    return Description(system.values(), np.arange(n), np.ones(n))


def turned_world(system: kg.System) -> Description:
    """Turn the ground and gravity by a right angle."""
    same = _unchanged(system)
    arrays = same.arrays
    arrays.gravity[:] = QUARTER @ arrays.gravity
    arrays.joint_position[0] = QUARTER @ arrays.joint_position[0]
    arrays.joint_orientation[0] = arrays.joint_orientation[0] @ QUARTER.T
    return same


def moved_base(system: kg.System) -> Description:
    """Move the joint on the ground."""
    same = _unchanged(system)
    same.arrays.joint_position[0] += [10.0, -20.0, 30.0]
    return same


def mirrored(system: kg.System) -> Description:
    """Reflect in the plane of axes 1 and 3: angles about these axes and translations along 2 change sign."""
    same = _unchanged(system)
    a = same.arrays
    arrays = replace(
        a,
        inertia=MIRROR @ a.inertia @ MIRROR,
        mass_center=a.mass_center @ MIRROR,
        joint_position=a.joint_position @ MIRROR,
        joint_orientation=MIRROR @ a.joint_orientation @ MIRROR,
        gravity=MIRROR @ a.gravity,
    )
    signs = np.array([{0: -1.0, 2: -1.0, 4: -1.0}.get(freedom.index, 1.0) for freedom in system.freedoms])
    return Description(arrays, same.places, signs)


def relabelled(system: kg.System) -> Description:
    """Relabel axes 1, 2, 3 of every frame as 3, 1, 2; joints with one freedom keep their meaning."""
    a = system.values()
    arrays = replace(
        a,
        inertia=TURN @ a.inertia @ TURN.T,
        mass_center=a.mass_center @ TURN.T,
        joint_position=a.joint_position @ TURN.T,
        joint_orientation=TURN @ a.joint_orientation @ TURN.T,
        gravity=TURN @ a.gravity,
        free=a.free[:, [1, 2, 0, 4, 5, 3]],
    )
    n = len(system.freedoms)
    return Description(arrays, np.arange(n), np.ones(n))


def renumbered(system: kg.System) -> Description:
    """Number the bodies in another order that still runs outward."""
    a = system.values()
    order = np.array([0, 2, 1, 4, 3])
    number = np.append(0, np.argsort(order) + 1)
    alike = ("sequence", "speeds", "coordinates")  # the same for every body
    kept = ("connection", "gravity", *alike)
    moved = {name: rows[order] for name, rows in a.rows().items() if name not in kept}
    arrays = replace(a, connection=number[a.connection[order]], **moved)
    other = _system(arrays)
    bodies = [(order[f.body - 1] + 1, f.index) for f in other.freedoms]
    old = [(f.body, f.index) for f in system.freedoms]
    return Description(arrays, np.array([old.index(key) for key in bodies]), np.ones(len(old)))


DESCRIPTIONS: dict[str, Callable[[kg.System], Description]] = {
    "world turned": turned_world,
    "base moved": moved_base,
    "mirrored": mirrored,
    "axes relabelled": relabelled,
    "bodies renumbered": renumbered,
}


def _system(arrays: SystemArrays) -> kg.System:
    return kg.System.from_arrays(**arrays.rows())


@experiment("X28", "Other descriptions of the same system")
def invariances(size: Size) -> Iterator[Row]:
    """Two descriptions of one system have the same exact accelerations, so results differ by two errors at
    most."""
    free = np.eye(6, dtype=bool)[[2, 0, 4, 1, 5]]
    system = scenes.tree(np.random.default_rng(28), [0, 1, 1, 2, 3], free)
    for precision in PRECISIONS:
        states = random_states(system, size.pick(4, 64), 28).rounded(precision)
        tau = rounded(efforts(system, states, np.random.default_rng(28)), precision)
        right = built(system, precision).forward_dynamics(states.x, states.y, tau).astype(np.float64)
        limits = [
            promise(truth(system, *state, unit_roundoff=precision.roundoff), precision)
            for state in zip(states.x, states.y, tau, strict=True)
        ]
        for name, describe in DESCRIPTIONS.items():
            other = describe(system)
            inputs = [array[:, other.places] * other.signs for array in (states.x, states.y, tau)]
            found = built(_system(other.arrays), precision).forward_dynamics(*inputs) * other.signs
            error = _relative(found.astype(np.float64), right[:, other.places])
            curve = [Point(0.0, e, 2 * limit) for e, limit in zip(error.tolist(), limits, strict=True)]
            yield worst(f"{name}, {precision.name}", curve, "2 T(u)", f"{len(curve)} states; 5 bodies")


def _relative(found: Floats, right: Floats) -> Floats:
    error: Floats = np.linalg.norm(found - right, axis=1) / np.linalg.norm(right, axis=1)
    return error


@experiment("X29", "Known zeros, and zeros that are parameters")
def specialisation(size: Size) -> Iterator[Row]:
    """Code without the operations on known zeros must agree with code that reads the zeros as parameters."""
    straight, crooked = scenes.planar([1.0, 2.0, 0.5]), scenes.mixed(3)
    for precision in PRECISIONS:
        for name, system in (("many zeros", straight), ("no zeros", crooked)):
            states = random_states(system, size.pick(4, 64), 29).rounded(precision)
            special = built(system, precision).forward_dynamics(states.x, states.y)
            general = built(with_numbers_as_parameters(system), precision).forward_dynamics(
                states.x, states.y
            )
            found: list[Point] = []
            for x, y, one, other in zip(states.x, states.y, special, general, strict=True):
                exact = truth(system, x, y, unit_roundoff=precision.roundoff)
                scale = exact.units.of("forward_dynamics")
                difference = np.linalg.norm((rounded(one, precision) - other) * scale)
                whole = np.linalg.norm(exact["forward_dynamics"].value * scale)
                found.append(Point(0.0, float(difference / whole), 2 * promise(exact, precision)))
            yield worst(f"{name}, {precision.name}", found, "2 T(u)", f"{len(found)} states; 3 bodies")
