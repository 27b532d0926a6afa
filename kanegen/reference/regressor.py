"""The regressor of the inertial parameters, from the partial velocities of the notes.

A body with the mass m, the first moment {h} and the inertia [I] about an origin P of its frame requires the
force m {a_P} + {alpha} x {h} + {omega} x ({omega} x {h}) at P and the moment [I]{alpha} + {omega} x
[I]{omega} + {h} x {a_P}, gravity being part of {a_P}. Kane's method takes their products with the partial
velocities of P and of {omega}. In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.arrays import FrameArrays, SystemArrays
from kanegen.model.identification.inertial_parameters import UPPER
from kanegen.model.system import System
from kanegen.reference.arguments import arrays_of, coordinates, prescribed_motion, speeds
from kanegen.reference.freedoms import free_columns, full_order, gathered
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.reference.matrices import Numbers, apply, skew, transposed


def regressor(
    system: System | SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    ydot: ArrayLike,
    prescribed: ArrayLike | None = None,
) -> Numbers:
    """Return the regressor [Y] of [A]{ydot} - {f} without loads, force elements and motors.

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        y: (n,) or (B, n) generalized speeds.
        ydot: (n,) or (B, n) generalized accelerations.
        prescribed: (3, p) or (B, 3, p) values, rates and second derivatives of the prescribed freedoms.

    Returns:
        (n, 10 N) or (B, n, 10 N), columns in the order of `model.identification.inertial_parameters`.

    Raises:
        ArrayError: If an array has another shape.

    Example:
        >>> system = kg.load("models/double_pendulum.toml")
        >>> regressor(system, [0.3, 0.4], [1.0, 2.0], [0.0, 0.0]) @ kg.inertial_parameters(system)
    """
    arrays = arrays_of(system)
    x, y, ydot = coordinates(arrays, x), speeds(arrays, y, "y"), speeds(arrays, ydot, "ydot")
    motion = prescribed_motion(arrays, prescribed, x)
    rates = full_order(arrays, y, motion[..., 1, :])
    accelerations = full_order(arrays, ydot, motion[..., 2, :])
    bodies = kinematics(arrays, x, y, motion)
    # Those of the bodies come first among the frames.
    columns = [
        _columns(arrays, frame, body, rates, accelerations)
        for frame, body in zip(arrays.frames.values(), bodies, strict=False)
    ]
    rows = gathered(arrays, np.concatenate(columns, axis=-2), free_columns(arrays))
    return transposed(rows)


def _columns(
    system: SystemArrays, frame: FrameArrays, body: BodyKinematics, rates: Numbers, accelerations: Numbers
) -> Numbers:
    """Return the (..., 10, 6N) generalized forces for unit parameters of a body about its frame.

    Args:
        system: The numbers of the tree.
        frame: The frame that users of the body see.
        body: Kinematics of the body.
        rates: (..., 6N) speeds in the order of Eq. (1).
        accelerations: (..., 6N) accelerations beside those at constant speeds.
    """
    arm, turn = skew(frame.position), body.relative_rotation
    turn_dot = transposed(skew(body.relative_omega)) @ turn  # (7)
    v_y = frame.rotation @ (turn @ body.origin_y - arm @ body.omega_y)  # (32)
    v_y_dot = turn @ body.origin_y_dot + turn_dot @ body.origin_y - arm @ body.omega_y_dot  # (34)
    omega_y, omega = frame.rotation @ body.omega_y, apply(frame.rotation, body.omega)
    alpha = apply(frame.rotation, apply(body.omega_y, accelerations) + apply(body.omega_y_dot, rates))
    weight = apply(frame.rotation, apply(body.rotation, system.gravity))
    moving = apply(frame.rotation, apply(v_y_dot, rates)) + apply(v_y, accelerations)
    acceleration = moving + np.cross(omega, apply(v_y, rates)) - weight  # (33)
    forces, moments = [acceleration], [np.zeros_like(acceleration)]
    for axis in np.eye(3):
        forces.append(np.cross(alpha, axis) + np.cross(omega, np.cross(omega, axis)))
        moments.append(np.cross(axis, acceleration))
    for row, column in UPPER:
        inertia = np.zeros((3, 3))
        inertia[row, column] = inertia[column, row] = 1.0
        forces.append(np.zeros_like(acceleration))
        moments.append(apply(inertia, alpha) + np.cross(omega, apply(inertia, omega)))  # (40), (41)
    force, moment = np.stack(forces, axis=-2), np.stack(moments, axis=-2)
    found: Numbers = force @ v_y + moment @ omega_y
    return found
