"""How the position and orientation of every body follow from {x}: plain data that the script of a page reads.

The script (`viewer/src/kinematics.js`) walks the tree from the ground outward. For each of the six freedoms
of a
body it finds here from where the value comes: a number, a place in {x}, a place among the prescribed values,
or a sum over other freedoms.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.coordinates import FREEDOMS, Coordinate, Freedom, QuaternionRotation
from kanegen.model.system import System

Source = dict[str, Any] | float
"""Where the value of a freedom comes from: `{"x": i}`, `{"prescribed": i}`, `{"terms": ..., "offset": b}`, or
a constant (rad, m)."""


@dataclass(frozen=True)
class JointData:
    """The joint of a body as the script of a page reads it.

    Attributes:
        lower: Number of the lower body, 0 for the ground.
        position: (3,) joint point Q_K from O_J, components of the lower body (m).
        orientation: (9,) rotation from components of the joint frame to those of the lower body, by rows.
        axes: (3,) basis vectors, from 0, about which the angles turn; None for a quaternion.
        quaternion: (4,) places of the Euler parameters in {x}; None for angles.
        freedoms: (6,) sources of the freedoms; the three angles of a quaternion are zeros that nothing reads.
    """

    lower: int
    position: list[float]
    orientation: list[float]
    axes: list[int] | None
    quaternion: list[int] | None
    freedoms: list[Source]


def joints_of(system: System, arrays: SystemArrays) -> list[JointData]:
    """Return the joints of all bodies, lower bodies first; parameters stand at their defaults.

    Args:
        system: The tree.
        arrays: Its numbers.

    Example:
        joints_of(system, system.values())[0].freedoms
    """
    sources = _sources(system, arrays)
    found = []
    for k, body in enumerate(system.bodies, start=1):
        rotation = body.joint.rotation
        is_quaternion = isinstance(rotation, QuaternionRotation)
        places = [
            system.coordinate_places[Coordinate(k, kind)] for kind in rotation.coordinates if is_quaternion
        ]
        found.append(
            JointData(
                lower=body.lower,
                position=arrays.joint_position[k - 1].tolist(),
                orientation=arrays.joint_orientation[k - 1].T.ravel().tolist(),
                axes=None if is_quaternion else list(body.joint.axes),
                quaternion=places if is_quaternion else None,
                freedoms=[sources[Freedom(k, index)] for index in range(len(FREEDOMS))],
            )
        )
    return found


def hinge_axis(system: System, arrays: SystemArrays, k: int) -> Floats | None:
    """Return the (3,) axis of body K where exactly one of its angles moves, in components of K; else None.

    Locked angles after the moving one turn the axis in the body.

    Args:
        system: The tree.
        arrays: Its numbers.
        k: Number of the body, from 1.
    """
    joint = system.bodies[k - 1].joint
    moving = [index for index in range(3) if joint.moving[index]]
    if len(moving) != 1:
        return None
    axis = np.eye(3)[joint.axes[moving[0]]]
    for index in range(moving[0] + 1, 3):
        axis = _turn(joint.axes[index], arrays.locked[k - 1, index]).T @ axis
    found: Floats = axis
    return found


def _turn(axis: int, angle: float) -> Floats:
    """Return the (3, 3) matrix that turns a vector about a basis vector by an angle (rad)."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[j, j] = matrix[k, k] = np.cos(angle)
    matrix[k, j] = np.sin(angle)
    matrix[j, k] = -np.sin(angle)
    return matrix


def _sources(system: System, arrays: SystemArrays) -> dict[Freedom, Source]:
    """Return the source of the value of each of the 6N freedoms."""
    found: dict[Freedom, Source] = {
        Freedom(k, index): float(arrays.locked[k - 1, index])
        for k in range(1, system.number_of_bodies + 1)
        for index in range(len(FREEDOMS))
    }
    for place, coordinate in enumerate(system.coordinates):
        if coordinate.index < len(FREEDOMS):
            found[Freedom(coordinate.body, coordinate.index)] = {"x": place}
    found |= {freedom: {"prescribed": place} for place, freedom in enumerate(system.prescribed)}
    for one in arrays.coupled:
        terms = [[other.body, other.index, factor] for other, factor in one.terms]
        found[one.freedom] = {"terms": terms, "offset": one.offset}
    return found
