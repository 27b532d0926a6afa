"""A system as a list of joints, each with one body beyond it: the form in which the peers take a tree.

A free freedom becomes a joint, translations before angles; the body stands beyond the last of them. Locked
freedoms, and joints without any freedom, become part of the next placement.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.sequences import NOTES, SEQUENCES
from kanegen.model.system import System

KINDS = ("RX", "RY", "RZ", "PX", "PY", "PZ")
"""Joints with one freedom: turns and slides about and along the three basis vectors."""

ORDER = (3, 4, 5, 0, 1, 2)
"""In which a body's freedoms follow one another from the ground outwards."""


@dataclass(frozen=True)
class Placement:
    """Where a frame stands in another: R turns its components into those of the other (m)."""

    rotation: Floats  # (3, 3)
    position: Floats  # (3,)

    def __mul__(self, inner: Placement) -> Placement:
        return Placement(self.rotation @ inner.rotation, self.position + self.rotation @ inner.position)

    @property
    def inverse(self) -> Placement:
        """Where the other frame stands in this one."""
        return Placement(self.rotation.T, -self.rotation.T @ self.position)


@dataclass(frozen=True)
class Mass:
    """A rigid body in a frame: kg, kg m, and kg m^2 about the frame's origin."""

    mass: float
    moment: Floats  # (3,)
    inertia: Floats  # (3, 3)

    def __add__(self, other: Mass) -> Mass:
        return Mass(self.mass + other.mass, self.moment + other.moment, self.inertia + other.inertia)

    @property
    def centre(self) -> Floats:
        """(3,) the mass centre, m; the origin where there is no mass."""
        return self.moment / self.mass if self.mass else np.zeros(3)

    @property
    def central_inertia(self) -> Floats:
        """(3, 3) about the mass centre."""
        return self.inertia - _shift(self.mass, self.centre)


@dataclass
class Joint:
    """`parent` counts joints from 1, 0 is the ground; `columns` are the places of its freedoms in {x}."""

    parent: int
    kind: str
    columns: tuple[int, ...]
    placement: Placement
    body: Mass


HERE = Placement(np.eye(3), np.zeros(3))
NOTHING = Mass(0.0, np.zeros(3), np.zeros((3, 3)))


Groups = Callable[[Sequence[bool]], list[tuple[int, ...]]]
"""From the free ones among a body's six freedoms to those that make up a joint together."""


def single_joints(system: System) -> list[Joint]:
    """One joint for every freedom."""
    return _joints(system, _single)


def joints(system: System) -> list[Joint]:
    """The same coordinates, three translations together being one joint."""
    return _joints(system, lambda free: _together((3, 4, 5), free))


def floating_joints(system: System) -> list[Joint]:
    """Other coordinates: six freedoms, angles 1-2-3, are a free-flyer, the rest as in `single_joints`."""
    return _joints(system, lambda free: _together(ORDER, free))


def _single(free: Sequence[bool]) -> list[tuple[int, ...]]:
    return [(index,) for index in ORDER if free[index]]


def _together(several: tuple[int, ...], free: Sequence[bool]) -> list[tuple[int, ...]]:
    if not all(free[index] for index in several):
        return _single(free)
    return [several, *((index,) for index in ORDER if free[index] and index not in several)]


def _joints(system: System, groups: Groups) -> list[Joint]:
    arrays = system.values()
    columns = {(f.body - 1, f.index): i for i, f in enumerate(system.freedoms)}
    found: list[Joint] = []
    carrier = {0: (0, HERE)}  # joint and placement of every body
    for k in _depth_first(list(arrays.connection)):
        parent, placement = carrier[int(arrays.connection[k])]
        placement = placement * Placement(arrays.joint_orientation[k].T, arrays.joint_position[k])
        free = [bool(flag) for flag in arrays.free[k]]
        axes = (*SEQUENCES[arrays.sequence[k]], 3, 4, 5)
        flies = arrays.sequence[k] == NOTES or not all(free)
        waiting = {group[0]: group for group in (groups(free) if flies else _single(free))}
        for index in ORDER:
            if index in waiting:
                group = waiting[index]
                places = tuple(columns[k, i] for i in group)
                found.append(Joint(parent, _kind([axes[i] for i in group]), places, placement, NOTHING))
                parent, placement = len(found), HERE
            elif not free[index]:
                placement = placement * _locked(axes[index], arrays.locked[k, index])
        carrier[k + 1] = parent, placement
        if parent:
            found[parent - 1].body += _mass(arrays, k, placement)
    return found


def _depth_first(connection: list[int]) -> list[int]:
    """Bodies counted from 0, every subtree contiguous."""
    order: list[int] = []
    waiting = [k for k, lower in enumerate(connection) if lower == 0]
    while waiting:
        order.append(waiting.pop())
        waiting += [k for k, lower in enumerate(connection) if lower == order[-1] + 1]
    return order


def _kind(group: Sequence[int]) -> str:
    if len(group) == 1:
        return KINDS[group[0]]
    return "translation" if len(group) == 3 else "free-flyer"


def _locked(index: int, value: float) -> Placement:
    """Placement of a joint of one of `KINDS` locked at `value`."""
    axis = np.eye(3)[index % 3]
    if index >= 3:
        return Placement(np.eye(3), value * axis)
    cross = np.cross(np.eye(3), axis)  # axis x v = cross @ v
    turn = np.eye(3) + np.sin(value) * cross + (1 - np.cos(value)) * cross @ cross
    return Placement(turn, np.zeros(3))


def _mass(arrays: SystemArrays, k: int, placement: Placement) -> Mass:
    mass, turn = float(arrays.mass[k]), placement.rotation
    centre = placement.position + turn @ arrays.mass_center[k]
    return Mass(mass, mass * centre, turn @ arrays.inertia[k] @ turn.T + _shift(mass, centre))


def _shift(mass: float, centre: Floats) -> Floats:
    """(3, 3) what a point mass at `centre` adds to an inertia."""
    return mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
