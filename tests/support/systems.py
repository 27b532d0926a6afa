"""Random systems for every test: plain functions on a seeded generator, and hypothesis strategies.

All of them are regular and generic: every body has mass and a positive definite inertia that a real body
could have, so nothing vanishes by accident. Numbers are of order one unless `size` and `density` say
otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from kanegen.model.arrays import SystemArrays
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.system import System
from kanegen.reference.states import States, random_states

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

EIGHT_BODY_CONNECTION = (0, 1, 2, 2, 1, 1, 1, 7)
"""The notes' example."""


def random_rotation(rng: np.random.Generator) -> Floats:
    """(3, 3) rotation, uniform over all of them, orthogonal to rounding."""
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    rotation: Floats = q * np.linalg.det(q).round()
    return rotation


def random_inertia(rng: np.random.Generator, mass: float = 1.0, size: float = 1.0) -> Floats:
    """(3, 3) central inertia of a body of `mass` whose points lie about `size` from its mass centre."""
    points = rng.uniform(-size, size, (6, 3))
    points -= points.mean(axis=0)
    second = points.T @ points * (mass / 6)
    inertia: Floats = np.trace(second) * np.eye(3) - second
    return inertia


def random_connection(rng: np.random.Generator, bodies: int) -> tuple[int, ...]:
    """Return a random tree; a later body is on the ground now and then."""
    return (0, *(int(rng.integers(0, k)) for k in range(2, bodies + 1)))


def random_free(rng: np.random.Generator, bodies: int, share: float = 0.5) -> Flags:
    """(N, 6) freedoms, each free with probability `share`, never all locked."""
    free = rng.random((bodies, 6)) < share
    if not free.any():
        free[rng.integers(bodies), rng.integers(6)] = True
    return free


def flags(bodies: int, names: Iterable[str]) -> Flags:
    """(N, 6) freedoms, the same ones free at every body: `flags(3, ["theta3"])` is three hinges."""
    row = np.array([freedom in set(names) for freedom in FREEDOMS])
    return np.tile(row, (bodies, 1))


def random_system(
    rng: np.random.Generator,
    bodies: int,
    *,
    connection: Sequence[int] | None = None,
    free: Flags | None = None,
    loads: Sequence[bool] | bool | None = None,
    orientations: bool = True,
    locked: bool = True,
    gravity: Sequence[float] | None = None,
    size: float = 1.0,
    density: float = 1.0,
    name: str = "tree",
    armature: Floats | None = None,
) -> System:
    """A generic regular system.

    Args:
        rng: Source of everything random.
        bodies: N.
        connection: Connection array; default a random tree.
        free: (N, 6) freedoms; default each free with probability one half.
        loads: Which bodies take loads; default each with probability one half.
        orientations: Random constant joint orientations, else identities.
        locked: Random values in (-1, 1) of locked freedoms (translations times `size`), else zeros.
        gravity: Inertial components (m/s^2); default random, of size 9.81.
        size: Typical length (m).
        density: Masses are about `density * size**3` (kg).
        name: Name of the system.
        armature: (N, 6) reflected inertias of motors, in units of the mass and size of a body; default none.
    """
    mass = rng.uniform(0.3, 3.0, bodies) * density * size**3
    lengths = np.array([1.0, 1.0, 1.0, size, size, size])
    down = rng.standard_normal(3)
    return System.from_arrays(
        connection=random_connection(rng, bodies) if connection is None else connection,
        mass=mass,
        inertia=[random_inertia(rng, m, 0.5 * size) for m in mass],
        mass_center=rng.uniform(-0.5, 0.5, (bodies, 3)) * size,
        joint_position=rng.uniform(-1.0, 1.0, (bodies, 3)) * size,
        joint_orientation=[random_rotation(rng) if orientations else np.eye(3) for _ in range(bodies)],
        free=random_free(rng, bodies) if free is None else free,
        locked=rng.uniform(-1.0, 1.0, (bodies, 6)) * lengths * locked,
        gravity=down * (9.81 / np.linalg.norm(down)) if gravity is None else gravity,
        armature=None if armature is None else armature * (density * size**3) * lengths**-2 * size**2,
        loads=rng.random(bodies) < 0.5 if loads is None else loads,
        name=name,
    )


def eight_body(seed: int = 8, *, loads: bool = True) -> System:
    """The notes' eight-body tree: 48 freedoms, identity joint orientations, q'_1 = 0."""
    system = random_system(
        np.random.default_rng(seed),
        8,
        connection=EIGHT_BODY_CONNECTION,
        free=flags(8, FREEDOMS),
        loads=loads,
        orientations=False,
        gravity=(0.0, 0.0, -9.81),
        name="eight_body",
    )
    arrays = system.values()
    arrays.joint_position[0] = 0.0
    return replace(from_values(arrays), name=system.name)


def chain(bodies: int, free: Iterable[str] = ("theta3",), seed: int = 1, *, loads: bool = False) -> System:
    """A serial chain with generic links and the same free freedoms at every joint."""
    return random_system(
        np.random.default_rng(seed),
        bodies,
        connection=range(bodies),
        free=flags(bodies, free),
        loads=loads,
        name="chain",
    )


def random_state(system: System, seed: int = 0) -> States:
    """One random state; its arrays have no batch axis."""
    batch = random_states(system, 1, seed)
    force = None if batch.force is None else batch.force[0]
    torque = None if batch.torque is None else batch.torque[0]
    return States(batch.x[0], batch.y[0], force, torque)


def from_values(arrays: SystemArrays) -> System:
    """The system that has these numbers."""
    return System.from_arrays(**arrays.rows())


def rescaled(arrays: SystemArrays, mass: float, length: float, time: float) -> SystemArrays:
    """The same system in units that are smaller by these factors."""
    return replace(
        arrays,
        mass=arrays.mass * mass,
        inertia=arrays.inertia * (mass * length**2),
        mass_center=arrays.mass_center * length,
        joint_position=arrays.joint_position * length,
        locked=arrays.locked * [1, 1, 1, length, length, length],
        armature=arrays.armature * mass * np.array([length, length, length, 1, 1, 1]) ** 2,
        gravity=arrays.gravity * (length / time**2),
    )


@st.composite
def systems(draw: st.DrawFn, max_bodies: int = 12, *, min_bodies: int = 1) -> System:
    """Regular systems; the tree, the freedoms, loads and motors shrink, the numbers come from a seed."""
    bodies = draw(st.integers(min_bodies, max_bodies))
    connection = [0, *(draw(st.integers(0, k)) for k in range(1, bodies))]
    mask = st.lists(st.booleans(), min_size=6, max_size=6)
    free = np.array(draw(st.lists(mask, min_size=bodies, max_size=bodies).filter(lambda m: any(map(any, m)))))
    loads = draw(st.lists(st.booleans(), min_size=bodies, max_size=bodies))
    return random_system(
        np.random.default_rng(draw(st.integers(0, 2**32 - 1))),
        bodies,
        connection=connection,
        free=free,
        loads=loads,
        orientations=draw(st.booleans()),
        locked=draw(st.booleans()),
        gravity=draw(st.sampled_from([None, (0.0, 0.0, -9.81), (0.0, 0.0, 0.0)])),
        armature=draw(st.booleans()) * np.random.default_rng(bodies).uniform(0.0, 1.0, (bodies, 6)),
    )
