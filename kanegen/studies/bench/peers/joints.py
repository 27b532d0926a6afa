"""A system as a list of joints, each with one body beyond it: the form in which the peers take a tree.

Every free freedom becomes a joint, translations before angles, and the body is attached to the last of them.
Locked freedoms, and joints without freedoms, become part of the placement of the next joint.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.coordinates import NOTES, SEQUENCES
from kanegen.model.system import System

KINDS = ("RX", "RY", "RZ", "PX", "PY", "PZ")
"""Kinds of joints with one freedom: turns about the three basis vectors, then slides along them."""

ORDER = (3, 4, 5, 0, 1, 2)
"""The order of the freedoms of a body from the ground outwards."""


@dataclass(frozen=True)
class Placement:
    """The placement of a frame in another frame.

    Attributes:
        rotation: (3, 3) matrix from components in the frame to components in the other frame.
        position: (3,) origin of the frame in the other frame (m).
    """

    rotation: Floats
    position: Floats

    def __mul__(self, inner: Placement) -> Placement:
        return Placement(self.rotation @ inner.rotation, self.position + self.rotation @ inner.position)

    @property
    def inverse(self) -> Placement:
        """The placement of the other frame in this one."""
        return Placement(self.rotation.T, -self.rotation.T @ self.position)


@dataclass(frozen=True)
class Mass:
    """A rigid body in a frame.

    Attributes:
        mass: Mass (kg).
        moment: (3,) first moment of mass (kg m).
        inertia: (3, 3) inertia about the origin of the frame (kg m^2).
    """

    mass: float
    moment: Floats
    inertia: Floats

    def __add__(self, other: Mass) -> Mass:
        return Mass(self.mass + other.mass, self.moment + other.moment, self.inertia + other.inertia)

    @property
    def center(self) -> Floats:
        """The (3,) mass centre (m); the origin if there is no mass."""
        return self.moment / self.mass if self.mass else np.zeros(3)

    @property
    def central_inertia(self) -> Floats:
        """The (3, 3) inertia about the mass centre (kg m^2)."""
        return self.inertia - _shift(self.mass, self.center)


@dataclass
class Joint:
    """A joint and the body beyond it.

    Attributes:
        parent: Number of the joint that carries it, from 1; 0 is the ground.
        kind: One of `KINDS`, "translation" or "free-flyer".
        columns: Indices of its coordinates in {x}.
        armature: Reflected inertias of its motors (kg m^2, kg), one for each coordinate.
        placement: Placement of its frame, at zero coordinates, in the frame beyond `parent`.
        body: The rigid body beyond it.
        bodies: Numbers of the bodies of the system that it consists of.
    """

    parent: int
    kind: str
    columns: tuple[int, ...]
    armature: tuple[float, ...]
    placement: Placement
    body: Mass
    bodies: tuple[int, ...] = ()


HERE = Placement(np.eye(3), np.zeros(3))
"""The placement of a frame in itself."""

NOTHING = Mass(0.0, np.zeros(3), np.zeros((3, 3)))
"""The body without mass."""

Groups = Callable[[Sequence[bool]], list[tuple[int, ...]]]
"""Function from the flags of the free freedoms of a body to groups of freedoms, one group for each joint."""


def single_joints(system: System) -> list[Joint]:
    """Return the joints of a system, one for every freedom."""
    return _joints(system, _single)


def joints(system: System) -> list[Joint]:
    """Return the joints of a system, where three translations together are one joint."""
    return _joints(system, lambda free: _together((3, 4, 5), free))


def floating_joints(system: System) -> list[Joint]:
    """Return the joints of a system; six freedoms with angles 1-2-3 and no motors are one free-flyer."""
    return _joints(system, lambda free: _together(ORDER, free))


def _single(free: Sequence[bool]) -> list[tuple[int, ...]]:
    """Return one group for each free freedom."""
    return [(index,) for index in ORDER if free[index]]


def _together(several: tuple[int, ...], free: Sequence[bool]) -> list[tuple[int, ...]]:
    """Return one group for the freedoms `several` if all are free, and one for each other free freedom."""
    if not all(free[index] for index in several):
        return _single(free)
    return [several, *((index,) for index in ORDER if free[index] and index not in several)]


def _joints(system: System, groups: Groups) -> list[Joint]:
    """Return the joints of a system, with the freedoms of each body in groups."""
    arrays = system.values()
    columns = {(f.body - 1, f.index): i for i, f in enumerate(system.freedoms)}
    found: list[Joint] = []
    carrier = {0: (0, HERE)}  # joint and placement of every body
    for k in _depth_first(list(arrays.connection)):
        parent, placement = carrier[int(arrays.connection[k])]
        placement = placement * Placement(arrays.joint_orientation[k].T, arrays.joint_position[k])
        free = [bool(flag) for flag in arrays.free[k]]
        axes = (*SEQUENCES[arrays.sequence[k]], 3, 4, 5)
        flies = not all(free) or (arrays.sequence[k] == NOTES and not arrays.armature[k].any())
        waiting = {group[0]: group for group in (groups(free) if flies else _single(free))}
        for index in ORDER:
            if index in waiting:
                group = waiting[index]
                places = tuple(columns[k, i] for i in group)
                kind, motors = (
                    _kind([axes[i] for i in group]),
                    tuple(map(float, arrays.armature[k, list(group)])),
                )
                found.append(Joint(parent, kind, places, motors, placement, NOTHING))
                parent, placement = len(found), HERE
            elif not free[index]:
                placement = placement * _locked(axes[index], arrays.locked[k, index])
        carrier[k + 1] = parent, placement
        if parent:
            found[parent - 1].body += _mass(arrays, k, placement)
            found[parent - 1].bodies += (k + 1,)
    return found


def _depth_first(connection: list[int]) -> list[int]:
    """Return the bodies, numbered from 0, in an order in which every subtree is contiguous."""
    order: list[int] = []
    waiting = [k for k, lower in enumerate(connection) if lower == 0]
    while waiting:
        order.append(waiting.pop())
        waiting += [k for k, lower in enumerate(connection) if lower == order[-1] + 1]
    return order


def _kind(group: Sequence[int]) -> str:
    """Return the kind of a joint with a group of freedoms."""
    if len(group) == 1:
        return KINDS[group[0]]
    return "translation" if len(group) == 3 else "free-flyer"


def _locked(index: int, value: float) -> Placement:
    """Return the placement of a joint of the kind `KINDS[index]` that is locked at `value`."""
    axis = np.eye(3)[index % 3]
    if index >= 3:
        return Placement(np.eye(3), value * axis)
    cross = np.cross(np.eye(3), axis)  # axis x v = cross @ v
    turn = np.eye(3) + np.sin(value) * cross + (1 - np.cos(value)) * cross @ cross
    return Placement(turn, np.zeros(3))


def _mass(arrays: SystemArrays, k: int, placement: Placement) -> Mass:
    """Return body `k`, from 0, in the frame of its joint."""
    mass, turn = float(arrays.mass[k]), placement.rotation
    center = placement.position + turn @ arrays.mass_center[k]
    return Mass(mass, mass * center, turn @ arrays.inertia[k] @ turn.T + _shift(mass, center))


def _shift(mass: float, center: Floats) -> Floats:
    """Return the (3, 3) inertia of a point mass at `center` about the origin (kg m^2)."""
    return mass * (center @ center * np.eye(3) - np.outer(center, center))
