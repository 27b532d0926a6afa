"""Points of bodies and of the ground in inertial components, with the partial velocities of the notes.

In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import SystemArrays
from kanegen.model.numbers import Number, value_of
from kanegen.reference.kinematics import BodyKinematics
from kanegen.reference.matrices import Numbers, apply, length, skew, transposed


@dataclass(frozen=True)
class Place:
    """A point and what carries it.

    Attributes:
        position: (..., 3) from the inertial origin (m).
        velocity: (..., 3) of it (m/s).
        velocity_y: (..., 3, 6N) its partial velocities.
        omega_y: (..., 3, 6N) the partial angular velocities of its body.
        reach: (...) the way to it along the tree (m), by which its position is rounded.
    """

    position: Numbers
    velocity: Numbers
    velocity_y: Numbers
    omega_y: Numbers
    reach: Numbers


def on_body(
    system: SystemArrays, bodies: Sequence[BodyKinematics], speeds: Numbers, k: int, arm: Numbers
) -> Place:
    """A point of a body.

    Args:
        system: The numbers of the tree.
        bodies: Their kinematics.
        speeds: (..., 6N) in the order of Eq. (1).
        k: Number of the body, from 1.
        arm: (3,) from its origin, in its components (m).
    """
    body = bodies[k - 1]
    out = transposed(body.rotation)
    velocity_y = out @ (body.relative_rotation @ body.origin_y - skew(arm) @ body.omega_y)
    reach = np.zeros(speeds.shape[:-1])
    while k:
        reach = reach + norm(bodies[k - 1].offset)
        k = int(system.connection[k - 1])
    return Place(
        position=apply(out, body.position + arm),
        velocity=apply(velocity_y, speeds),
        velocity_y=velocity_y,
        omega_y=out @ body.omega_y,
        reach=reach + norm(arm),
    )


def on_ground(position: Sequence[Number], speeds: Numbers) -> Place:
    """A place of the ground, where nothing moves; its parameters stand at their defaults."""
    at = np.array([value_of(value) for value in position])
    still = np.zeros((*speeds.shape[:-1], 3), speeds.dtype)
    columns = np.zeros((*still.shape, speeds.shape[-1]), speeds.dtype)
    return Place(still + at, still, columns, columns, still[..., 0].real + norm(at))


def norm(vectors: Numbers, axis: int = -1) -> Numbers:
    """Lengths, of complex vectors too, which carry derivatives."""
    return length(np.abs(vectors), axis)
