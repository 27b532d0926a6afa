"""Equations (1)-(35) of the notes: positions, velocities and partial velocities of all bodies.

Every body has its partial velocity matrices of size (3, 6N) and their time derivatives, computed outward from
those of its lower body. They have columns for locked and prescribed freedoms, too, which `equations` drops.

The arithmetic is that of the state: float64, longdouble, complex (for complex-step derivatives), or object
arrays of high-precision numbers that have `sin` and `cos`. In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from kanegen.model.arrays import SystemArrays
from kanegen.model.coordinates import SPEEDS, QuaternionRotation
from kanegen.reference.freedoms import (
    UNPRESCRIBED,
    full_order,
    orientations_and_translations,
    rates_of_bodies,
)
from kanegen.reference.matrices import (
    Numbers,
    angle_rate_matrix,
    angle_rate_matrix_dot,
    apply,
    renaming,
    rotation_123,
    rotation_by_quaternion,
    sines_cosines,
    skew,
    transposed,
)


@dataclass(frozen=True)
class BodyKinematics:
    """The kinematics of one body K with lower body J, in SI units.

    The last axis of a name that ends in `_y` or `_y_dot` runs over all 6N speeds in the order of Eq. (1):
    angle rates of all bodies, then translation rates of all bodies.

    Attributes:
        relative_rotation: (..., 3, 3) `[^J R_K]`, from J to K: Eq. (4) times the constant `[C_K]`.
        rotation: (..., 3, 3) `[R_K]`, from inertial to body components, Eq. (3).
        rate_matrix: (..., 3, 3) angle-rate matrix `[P_K^AV]`, Eq. (17).
        rate_matrix_dot: (..., 3, 3) time derivative of `[P_K^AV]`, below Eq. (20).
        relative_omega: (..., 3) angular velocity relative to J, Eq. (8), in K.
        offset: (..., 3) `q'_K + s'_K`, from O_J to O_K, in J.
        offset_dot: (..., 3) time derivative of `s'_K`, in J.
        position: (..., 3) position of O_K, `p'_{O_K}`, Eq. (22), in K.
        center_position: (..., 3) position of G_K, `p'_{G_K}`, Eq. (23), in K.
        omega_y: (..., 3, 6N) partial angular velocities `[omega'_{K,y}]`, Eq. (15), in K.
        omega_y_dot: (..., 3, 6N) time derivative of `omega_y`, Eq. (20), in K.
        omega: (..., 3) angular velocity, Eq. (18), in K.
        origin_y: (..., 3, 6N) partial velocities of O_K, `[v'_{O_K,y}]`, Eq. (28), in J.
        origin_y_dot: (..., 3, 6N) time derivative of `origin_y`, Eq. (35), in J.
        center_y: (..., 3, 6N) partial velocities of G_K, `[v'_{G_K,y}]`, Eq. (32), in K.
        center_y_dot: (..., 3, 6N) time derivative of `center_y`, Eq. (34), in K.
        center_velocity: (..., 3) velocity of G_K, `{v'_{G_K}}`, Eq. (31), in K.
    """

    relative_rotation: Numbers
    rotation: Numbers
    rate_matrix: Numbers
    rate_matrix_dot: Numbers
    relative_omega: Numbers
    offset: Numbers
    offset_dot: Numbers
    position: Numbers
    center_position: Numbers
    omega_y: Numbers
    omega_y_dot: Numbers
    omega: Numbers
    origin_y: Numbers
    origin_y_dot: Numbers
    center_y: Numbers
    center_y_dot: Numbers
    center_velocity: Numbers


def kinematics(
    system: SystemArrays, x: Numbers, y: Numbers, prescribed: Numbers = UNPRESCRIBED
) -> tuple[BodyKinematics, ...]:
    """Return the kinematics of bodies 1 to N.

    Where the speeds of a body's angles are components of its relative angular velocity, [P_K^AV] is the
    identity and its time derivative zero.

    Args:
        system: The numbers of the tree.
        x: (..., m) coordinates (rad, m, 1).
        y: (..., n) generalized speeds (rad/s, m/s).
        prescribed: (..., 3, p) values, rates and second derivatives of the prescribed freedoms.
    """
    count = len(system.mass)
    speeds = full_order(system, y, prescribed[..., 1, :])
    orientations, translations = orientations_and_translations(system, x, prescribed[..., 0, :])
    rates, translation_rates = rates_of_bodies(speeds)
    bodies = [_ground(count, speeds.dtype)]
    for k in range(count):
        state = (orientations[k], rates[..., k, :], translations[k], translation_rates[..., k, :])
        bodies.append(_body(system, k, bodies[system.connection[k]], state, speeds))
    return tuple(bodies[1:])


def _body(
    system: SystemArrays,
    k: int,
    lower: BodyKinematics,
    state: tuple[Numbers, Numbers, Numbers, Numbers],
    speeds: Numbers,
) -> BodyKinematics:
    """Return the kinematics of one body from those of its lower body.

    Args:
        system: The numbers of the tree.
        k: Index of the body, from 0.
        lower: Kinematics of its lower body.
        state: Orientation, (..., 3) angular speeds, (..., 3) translation, (..., 3) translation rates.
        speeds: (..., 6N) speeds in the order of Eq. (1).
    """
    orientation, rates, *_ = state
    r_tilde = skew(system.mass_center[k])

    turn, rate_matrix, rate_matrix_dot = rotation_and_rates(system, k, orientation, rates)
    relative_omega = apply(rate_matrix, rates)  # (8)
    rotate = turn @ system.joint_orientation[k]  # (4)
    rotate_dot = transposed(skew(relative_omega)) @ rotate  # (7)

    omega_y = rotate @ lower.omega_y + _block(rate_matrix, k, speeds)  # (15), (16)
    omega_y_dot = (  # (20)
        rotate @ lower.omega_y_dot + rotate_dot @ lower.omega_y + _block(rate_matrix_dot, k, speeds)
    )

    offset, offset_dot, origin_y, origin_y_dot = _origin(system, k, lower, state[2:], speeds)
    center_y = rotate @ origin_y - r_tilde @ omega_y  # (32)
    center_y_dot = rotate @ origin_y_dot + rotate_dot @ origin_y - r_tilde @ omega_y_dot  # (34)
    position = apply(rotate, lower.position + offset)  # (22)
    return BodyKinematics(
        relative_rotation=rotate,
        rotation=rotate @ lower.rotation,  # (3)
        rate_matrix=rate_matrix,
        rate_matrix_dot=rate_matrix_dot,
        relative_omega=relative_omega,
        offset=offset,
        offset_dot=offset_dot,
        position=position,
        center_position=position + system.mass_center[k],  # (23)
        omega_y=omega_y,
        omega_y_dot=omega_y_dot,
        omega=apply(omega_y, speeds),  # (18)
        origin_y=origin_y,
        origin_y_dot=origin_y_dot,
        center_y=center_y,
        center_y_dot=center_y_dot,
        center_velocity=apply(center_y, speeds),  # (31)
    )


def _origin(
    system: SystemArrays,
    k: int,
    lower: BodyKinematics,
    state: tuple[Numbers, ...],
    speeds: Numbers,
) -> tuple[Numbers, Numbers, Numbers, Numbers]:
    """Return the offset of O_K from O_J, its rate, [v_O,y], Eq. (28), and [dv_O,y/dt], Eq. (35), in J.

    The arguments are those of `_body`, except that `state` holds the translation and its rates alone.
    """
    translation, translation_rates = state
    joint_to_lower = system.joint_orientation[k].T
    offset = system.joint_position[k] + apply(joint_to_lower, translation)
    offset_dot = apply(joint_to_lower, translation_rates)
    lower_rotate_dot = transposed(skew(lower.relative_omega)) @ lower.relative_rotation
    origin_y = (  # (28)-(30)
        lower.relative_rotation @ lower.origin_y
        - skew(offset) @ lower.omega_y
        + _block(joint_to_lower, len(system.mass) + k, speeds)
    )
    origin_y_dot = (  # (35)
        lower.relative_rotation @ lower.origin_y_dot
        + lower_rotate_dot @ lower.origin_y
        - skew(offset_dot) @ lower.omega_y
        - skew(offset) @ lower.omega_y_dot
    )
    return offset, offset_dot, origin_y, origin_y_dot


def rotation_and_rates(
    system: SystemArrays, k: int, orientation: Numbers, rates: Numbers
) -> tuple[Numbers, Numbers, Numbers]:
    """Return (..., 3, 3) matrices of a joint: its rotation, Eq. (4), [P_K^AV], Eq. (17), and its rate.

    Args:
        system: The numbers of the tree.
        k: Index of the body, from 0.
        orientation: (..., 3) angles (rad) or (..., 4) Euler parameters of the body in its joint frame.
        rates: (..., 3) generalized speeds of the orientation (rad/s).
    """
    rotation = system.rotations[k]
    if isinstance(rotation, QuaternionRotation):
        turn = rotation_by_quaternion(orientation)
        still = np.zeros_like(turn)
        return turn, still + np.eye(3), still
    names = renaming(rotation.axes)
    turns = sines_cosines(orientation, names)
    turn = names.after @ rotation_123(*turns) @ names.before
    if system.speeds[k] != SPEEDS[0]:
        still = np.zeros_like(turn)
        return turn, still + np.eye(3), still
    rate_matrix = names.after @ angle_rate_matrix(*turns)
    return turn, rate_matrix, names.after @ angle_rate_matrix_dot(*turns, names.sign * rates)


def _ground(bodies: int, dtype: np.dtype[Any]) -> BodyKinematics:
    """Return the kinematics of the ground, body 0, at rest: zeros and identities."""
    zeros = {field.name: np.zeros(3, dtype) for field in fields(BodyKinematics)}
    columns = {name: np.zeros((3, 6 * bodies), dtype) for name in zeros if name.endswith(("_y", "_y_dot"))}
    identities = {name: np.eye(3, dtype=dtype) for name in ("relative_rotation", "rotation")}
    squares = {name: np.zeros((3, 3), dtype) for name in ("rate_matrix", "rate_matrix_dot")}
    return BodyKinematics(**{**zeros, **columns, **identities, **squares})


def _block(square: Numbers, number: int, speeds: Numbers) -> Numbers:
    """Return (..., 3, 6N) zeros with `square` (..., 3, 3) as the 3 x 3 partition `number`, from 0."""
    columns = np.zeros((*square.shape[:-2], 3, speeds.shape[-1]), np.result_type(square, speeds))
    columns[..., 3 * number : 3 * number + 3] = square
    return columns
