"""The joints of a tree as chains of hinges and slides, which move by one freedom each.

A translation along a basis vector of the joint frame is a slide, a turn about an axis a hinge. Constant
placements stand between them: of the joint on its lower body, and of freedoms that are locked. A rotation by
a quaternion, or with an angular velocity as speeds, reaches the same orientations and angular velocities as
three hinges.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Flags, Floats, SystemArrays
from kanegen.model.coordinates import SEQUENCES, Freedom
from kanegen.model.rotations import turn
from kanegen.model.system import System


@dataclass(frozen=True)
class Placement:
    """A constant placement of an upper frame in a lower one.

    Attributes:
        rotation: (3, 3) from lower to upper components.
        position: (3,) upper origin from the lower one, lower components (m).
    """

    rotation: Floats
    position: Floats

    def scaled(self, length: float) -> Placement:
        """Return the same placement with lengths in another unit, `length` in m."""
        return Placement(self.rotation, self.position / length)


@dataclass(frozen=True)
class SingleJoint:
    """A hinge, which turns the upper frame about a basis vector, or a slide, which moves it along one.

    Attributes:
        is_hinge: Whether it is a hinge.
        axis: The basis vector, from 0.
        freedom: The freedom that moves it.
    """

    is_hinge: bool
    axis: int
    freedom: Freedom

    @property
    def motion(self) -> Floats:
        """(6,) angular velocity, then velocity of the upper origin, for unit speed, upper components."""
        found: Floats = np.zeros(6)
        found[self.axis if self.is_hinge else 3 + self.axis] = 1.0
        return found


Element = Placement | SingleJoint


@dataclass(frozen=True)
class Geometry:
    """The geometry of a tree: what is left of it without masses, inertias and forces.

    Attributes:
        arrays: The numbers of the system.
        length: Unit of lengths: a power of two near the longest one in a joint (m).
        chains: (N,) placements and single joints from the lower body to each body, in units of `length`.
        frames: (N,) placement of the frame of each body that users see, in units of `length`.
    """

    arrays: SystemArrays
    length: float
    chains: tuple[tuple[Element, ...], ...]
    frames: tuple[Placement, ...]

    @property
    def connection(self) -> tuple[int, ...]:
        """(N,) number of the lower body of each body."""
        return tuple(int(lower) for lower in self.arrays.connection)

    @property
    def weight(self) -> Floats:
        """(6,) a motion of the ground along gravity, zero without it."""
        found, gravity = np.zeros(6), self.arrays.gravity
        found[3:] = gravity / (np.linalg.norm(gravity) or 1.0)
        return found

    @property
    def is_independent(self) -> bool:
        """Whether every freedom that moves is an entry of {y}: none is coupled or prescribed."""
        return not self.arrays.coupled and not self.arrays.prescribed.any()


def geometry_of(system: System) -> Geometry:
    """Return the geometry of a system, run-time parameters at their defaults."""
    arrays = system.values()
    chains = [tuple(_elements(arrays, k)) for k in range(1, system.number_of_bodies + 1)]
    positions = [one.position for chain in chains for one in chain if isinstance(one, Placement)]
    longest = max(float(np.abs(position).max()) for position in positions)
    length = math.ldexp(1.0, math.frexp(longest)[1]) if longest else 1.0
    own = [arrays.frames[body.name] for body in system.bodies]
    return Geometry(
        arrays,
        length,
        tuple(
            tuple(one.scaled(length) if isinstance(one, Placement) else one for one in chain)
            for chain in chains
        ),
        tuple(Placement(frame.rotation, frame.position).scaled(length) for frame in own),
    )


def _elements(arrays: SystemArrays, k: int) -> Iterator[Element]:
    """Yield the placements and single joints from the lower body of body `k` (from 1) to its own frame."""
    row, moving = k - 1, _moving(arrays, k)
    locked = np.where(moving, 0.0, arrays.locked[row])
    yield Placement(arrays.joint_orientation[row], arrays.joint_position[row])
    if locked[3:].any():
        yield Placement(np.eye(3), locked[3:])
    for axis in range(3):
        if moving[3 + axis]:
            yield SingleJoint(False, axis, Freedom(k, 3 + axis))
    for index, axis in enumerate(SEQUENCES[arrays.sequence[row]]):
        if moving[index]:
            yield SingleJoint(True, axis, Freedom(k, index))
        elif locked[index]:
            yield Placement(np.array(turn(axis, locked[index])), np.zeros(3))


def _moving(arrays: SystemArrays, k: int) -> Flags:
    """Return (6,) which freedoms of body `k` are free, prescribed or coupled."""
    moving: Flags = arrays.free[k - 1] | arrays.prescribed[k - 1]
    moving[[one.freedom.index for one in arrays.coupled if one.freedom.body == k]] = True
    return moving
