"""Poses, Jacobians, velocities and accelerations of frames, by the partial velocities of the notes.

A frame at {r} from O_K moves as G_K does in Eqs. (23), (31), (32) and (34), with {r} in the place of {r'_K}.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.arrays import FrameArrays, SystemArrays
from kanegen.model.system import System
from kanegen.reference.arguments import arrays_of, coordinates, prescribed_motion, speeds
from kanegen.reference.freedoms import free_columns, full_order, gathered
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.reference.matrices import Numbers, apply, skew, transposed


@dataclass(frozen=True)
class FrameMotions:
    """The motion of k frames; of six components the first three are angular, all are inertial.

    Attributes:
        poses: (..., k, 4, 3) rows of [R], which takes inertial components to those of the frame, then the
            origin (1, m).
        jacobians: (..., k, 6, n) partial velocities by {y} (1, m).
        velocities: (..., k, 6) angular velocity, and velocity of the origin (rad/s, m/s).
        accelerations: (..., k, 6) angular acceleration, and acceleration of the origin (rad/s^2, m/s^2).
        bias: (..., k, 6) the accelerations for {ydot} = 0.
    """

    poses: Numbers
    jacobians: Numbers
    velocities: Numbers
    accelerations: Numbers
    bias: Numbers


def frame_motions(
    system: System | SystemArrays,
    names: Sequence[str],
    x: ArrayLike,
    y: ArrayLike,
    ydot: ArrayLike,
    prescribed: ArrayLike | None = None,
) -> FrameMotions:
    """Return the motion of some frames of a system.

    Args:
        system: The tree; parameters stand at their defaults.
        names: Names of the frames.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        y: (n,) or (B, n) generalized speeds.
        ydot: (n,) or (B, n) generalized accelerations.
        prescribed: (3, p) or (B, 3, p) values, rates and second derivatives of the prescribed freedoms.

    Raises:
        ArrayError: If an array has another shape.

    Example:
        >>> system = kg.load("models/double_pendulum.toml")
        >>> frame_motions(system, system.frame_names, [0.3, 0.4], [1.0, 2.0], [0.0, 0.0]).velocities
    """
    system = arrays_of(system)
    x, y, ydot = coordinates(system, x), speeds(system, y, "y"), speeds(system, ydot, "ydot")
    motion = prescribed_motion(system, prescribed, x)
    bodies = kinematics(system, x, y, motion)
    rates = full_order(system, y, motion[..., 1, :])
    unaccelerated = full_order(system, 0 * ydot, motion[..., 2, :])
    accelerated = full_order(system, ydot, motion[..., 2, :])
    found = [_motion(system.frames[name], bodies, rates, (unaccelerated, accelerated)) for name in names]
    pose, jacobian, velocity, bias, acceleration = ([one[i] for one in found] for i in range(len(found[0])))
    return FrameMotions(
        poses=np.stack(pose, axis=-3),
        jacobians=gathered(system, np.stack(jacobian, axis=-3), free_columns(system)),
        velocities=np.stack(velocity, axis=-2),
        accelerations=np.stack(acceleration, axis=-2),
        bias=np.stack(bias, axis=-2),
    )


def _motion(
    frame: FrameArrays,
    bodies: Sequence[BodyKinematics],
    rates: Numbers,
    accelerations: tuple[Numbers, Numbers],
) -> tuple[Numbers, ...]:
    """Return pose, Jacobian, velocity and, for each of two (..., 6N) accelerations, the acceleration.

    The Jacobian has a column for each of the 6N speeds.
    """
    if not frame.body:
        still = np.zeros((*rates.shape[:-1], 6), rates.dtype)
        jacobian = np.zeros((*still.shape, rates.shape[-1]), rates.dtype)
        pose = np.concatenate([frame.rotation, frame.position[None]])
        return np.broadcast_to(pose, (*rates.shape[:-1], 4, 3)), jacobian, still, still, still
    body, arm = bodies[frame.body - 1], skew(frame.position)
    up, turn = transposed(body.rotation), body.relative_rotation
    turn_dot = transposed(skew(body.relative_omega)) @ turn  # (7)
    v_y = turn @ body.origin_y - arm @ body.omega_y  # (32)
    v_y_dot = turn @ body.origin_y_dot + turn_dot @ body.origin_y - arm @ body.omega_y_dot  # (34)
    velocity = apply(v_y, rates)  # (31)
    origin = apply(up, body.position + frame.position)  # (23)
    pose = np.concatenate([frame.rotation @ body.rotation, origin[..., None, :]], axis=-2)
    jacobian = np.concatenate([up @ body.omega_y, up @ v_y], axis=-2)
    found = [pose, jacobian, np.concatenate([apply(up, body.omega), apply(up, velocity)], axis=-1)]
    for accelerated in accelerations:
        angular = apply(body.omega_y, accelerated) + apply(body.omega_y_dot, rates)
        linear = apply(v_y, accelerated) + apply(v_y_dot, rates) + np.cross(body.omega, velocity)
        found.append(np.concatenate([apply(up, angular), apply(up, linear)], axis=-1))
    return tuple(found)
