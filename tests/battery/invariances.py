"""The same motion told otherwise: X28."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

import kanegen as kg
from kanegen.measure import truth
from kanegen.model.arrays import SystemArrays
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.measuring import PRECISIONS, Floats, built, efforts, promise, rounded, worst
from tests.battery.rows import Point, Row, Size, subject


@dataclass(frozen=True)
class Retold:
    """Another description: its numbers, and its freedoms as places and signs of the first one's."""

    arrays: SystemArrays
    places: np.ndarray
    signs: np.ndarray


TURN = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Relabels axes: what was 2 is now 1."""

QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
MIRROR = np.diag([1.0, -1.0, 1.0])


def _plain(system: kg.System) -> Retold:
    n = len(system.freedoms)
    return Retold(system.values(), np.arange(n), np.ones(n))


def turned_world(system: kg.System) -> Retold:
    """Ground and gravity turned by a right angle."""
    same = _plain(system)
    arrays = same.arrays
    arrays.gravity[:] = QUARTER @ arrays.gravity
    arrays.joint_position[0] = QUARTER @ arrays.joint_position[0]
    arrays.joint_orientation[0] = arrays.joint_orientation[0] @ QUARTER.T
    return same


def moved_base(system: kg.System) -> Retold:
    """The joint on the ground elsewhere."""
    same = _plain(system)
    same.arrays.joint_position[0] += [10.0, -20.0, 30.0]
    return same


def mirrored(system: kg.System) -> Retold:
    """Seen in the plane of axes 1 and 3: angles about those axes change sign, and translations along 2."""
    same = _plain(system)
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
    return Retold(arrays, same.places, signs)


def relabelled(system: kg.System) -> Retold:
    """Axes 1, 2, 3 of every frame become 3, 1, 2; joints of one freedom keep their meaning."""
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
    return Retold(arrays, np.arange(n), np.ones(n))


def renumbered(system: kg.System) -> Retold:
    """The bodies in another order that still counts outward."""
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
    return Retold(arrays, np.array([old.index(key) for key in bodies]), np.ones(len(old)))


WAYS: dict[str, Callable[[kg.System], Retold]] = {
    "world turned": turned_world,
    "base moved": moved_base,
    "mirrored": mirrored,
    "axes relabelled": relabelled,
    "bodies renumbered": renumbered,
}


def _system(arrays: SystemArrays) -> kg.System:
    return kg.System.from_arrays(**arrays.rows())


@subject("X28", "Invariance")
def invariances(size: Size) -> Iterator[Row]:
    """Both descriptions have the same exact accelerations, so their results agree to what each may err."""
    free = np.eye(6, dtype=bool)[[2, 0, 4, 1, 5]]
    system = scenes.tree(np.random.default_rng(28), [0, 1, 1, 2, 3], free)
    for precision in PRECISIONS:
        states = random_states(system, size.pick(4, 64), 28).rounded(precision)
        tau = rounded(efforts(system, states, np.random.default_rng(28)), precision)
        right = built(system, precision).forward_dynamics(states.x, states.y, tau).astype(np.float64)
        limits = [
            promise(truth.truth(system, *state, unit_roundoff=precision.roundoff), precision)
            for state in zip(states.x, states.y, tau, strict=True)
        ]
        for name, way in WAYS.items():
            other = way(system)
            inputs = [array[:, other.places] * other.signs for array in (states.x, states.y, tau)]
            found = built(_system(other.arrays), precision).forward_dynamics(*inputs) * other.signs
            error = _relative(found.astype(np.float64), right[:, other.places])
            curve = [Point(0.0, e, 2 * limit) for e, limit in zip(error.tolist(), limits, strict=True)]
            yield worst(f"{name}, {precision.name}", curve, "2 T(u)", f"{len(curve)} states; 5 bodies")


def _relative(found: Floats, right: Floats) -> Floats:
    error: Floats = np.linalg.norm(found - right, axis=1) / np.linalg.norm(right, axis=1)
    return error
