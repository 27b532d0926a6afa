"""Orientations of bodies in their joint frames: from the coordinates of a joint to unit quaternions and back.

A quaternion is scalar first and turns the body in its joint frame, as Euler parameters do in kanegen. In
shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kanegen.errors import ArrayError
from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.coordinates import ANGLES, AxisRotations
from kanegen.reference.kinematics import rotation_and_rates
from kanegen.reference.matrices import Numbers, renaming

UNIT_LENGTH = 1e-6
"""Largest difference of the length of a quaternion from 1 that counts as rounding."""


@dataclass(frozen=True)
class Orientation:
    """The orientation of one body in its joint frame, with three free angles or a quaternion as coordinates.

    Attributes:
        system: The numbers of the system.
        body: Index of the body, from 0.
    """

    system: SystemArrays
    body: int

    def matrices(self, x: Numbers, speeds: Numbers) -> tuple[Numbers, Numbers, Numbers]:
        """Return the rotation from joint-frame to body components, [P] of Eq. (8), and [Pdot].

        Args:
            x: (..., 3) angles (rad) or (..., 4) Euler parameters.
            speeds: (..., 3) generalized speeds of the orientation (rad/s).
        """
        return rotation_and_rates(self.system, self.body, x, speeds)

    def euler_parameters(self, x: Floats) -> Floats:
        """Return (..., 4) the unit Euler parameters of an orientation by its coordinates.

        Raises:
            ArrayError: If four Euler parameters are zero.
        """
        if x.shape[-1] != len(ANGLES):
            return normalized(x)
        rotation, _, _ = self.matrices(x, np.zeros_like(x))
        return quaternion_of_rotation(rotation)

    def coordinates(self, quaternion: Floats) -> Floats:
        """Return (..., 3) angles (rad) or (..., 4) Euler parameters of an orientation by a quaternion.

        The first and the last angle are from -pi to pi; the middle one is from -pi/2 to pi/2, or from 0 to pi
        where the first and the last axis are the same.

        Raises:
            ArrayError: If a quaternion is not of unit length.
        """
        unit = checked_unit(quaternion)
        rotation = self.system.rotations[self.body]
        if not isinstance(rotation, AxisRotations):
            return unit
        names = renaming(rotation.axes)
        turn = names.after.T @ _rotation_of_quaternion(unit) @ names.before.T
        first, middle, last = _angles_123(turn)
        if names.is_proper_euler:
            middle = middle - np.pi / 2
        angles = names.sign * np.stack([first, middle, last], axis=-1)
        return _positive_middle(angles) if names.is_proper_euler else angles


def normalized(quaternion: Floats) -> Floats:
    """Return quaternions of unit length, from (..., 4) of any length but 0.

    Raises:
        ArrayError: If a quaternion is zero.
    """
    length = np.linalg.norm(quaternion, axis=-1, keepdims=True)
    if not (length > 0).all():
        raise ArrayError("a quaternion of zeros is no orientation.")
    unit: Floats = quaternion / length
    return unit


def checked_unit(quaternion: Floats) -> Floats:
    """Return (..., 4) quaternions whose length is 1 up to rounding, with length 1.

    Raises:
        ArrayError: If a length differs from 1 by more than `UNIT_LENGTH`.
    """
    lengths = np.linalg.norm(quaternion, axis=-1)
    if not (np.abs(lengths - 1) <= UNIT_LENGTH).all():
        worst = lengths.ravel()[np.abs(lengths - 1).argmax()]
        raise ArrayError(f"q: a quaternion has the length {worst:.6g}; it must be 1.")
    return normalized(quaternion)


def quaternion_of_rotation(rotation: Floats) -> Floats:
    """Return (..., 4) the unit quaternion, scalar not negative, of (..., 3, 3) rotations to body components.

    It is the longest of the four multiples of the quaternion that follow from the matrix without roots.
    """
    m = np.swapaxes(rotation, -1, -2)
    diagonal = np.diagonal(m, axis1=-2, axis2=-1)
    trace = diagonal.sum(axis=-1)
    multiples = np.empty((*trace.shape, 4, 4))
    multiples[..., 0, 0] = 1 + trace
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        multiples[..., 0, i + 1] = multiples[..., i + 1, 0] = m[..., k, j] - m[..., j, k]
        multiples[..., i + 1, i + 1] = 1 - trace + 2 * diagonal[..., i]
        multiples[..., i + 1, j + 1] = multiples[..., j + 1, i + 1] = m[..., i, j] + m[..., j, i]
    longest = np.diagonal(multiples, axis1=-2, axis2=-1).argmax(axis=-1)
    unit = normalized(np.take_along_axis(multiples, longest[..., None, None], axis=-2)[..., 0, :])
    return np.where(unit[..., :1] < 0, -unit, unit)


def _rotation_of_quaternion(unit: Floats) -> Floats:
    """Return (..., 3, 3) the rotation to body components of (..., 4) a unit quaternion."""
    scalar, vector = unit[..., 0, None, None], unit[..., 1:]
    x, y, z = np.moveaxis(vector, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*x.shape, 3, 3)
    outer = vector[..., :, None] * vector[..., None, :]
    square = (scalar * scalar - (vector * vector).sum(axis=-1)[..., None, None]) * np.eye(3)
    rotation: Floats = square + 2 * outer - 2 * scalar * cross
    return rotation


def _angles_123(m: Floats) -> tuple[Floats, Floats, Floats]:
    """Return (...,) each of the angles (rad) of [R_123], Eq. (4), from (..., 3, 3) rotations.

    The last one follows from what remains after the first, so that both stay accurate near gimbal lock.
    """
    first = np.arctan2(-m[..., 2, 1], m[..., 2, 2])
    middle = np.arctan2(m[..., 2, 0], np.hypot(m[..., 2, 1], m[..., 2, 2]))
    sine, cosine = np.sin(first), np.cos(first)
    last = np.arctan2(
        cosine * m[..., 0, 1] + sine * m[..., 0, 2], cosine * m[..., 1, 1] + sine * m[..., 1, 2]
    )
    return first, middle, last


def _positive_middle(angles: Floats) -> Floats:
    """Return the proper Euler angles of the same orientation with a middle angle that is not negative."""
    flipped = np.stack(
        [angles[..., 0] + np.pi, -angles[..., 1], angles[..., 2] + np.pi],
        axis=-1,
    )
    flipped = np.where([True, False, True], np.arctan2(np.sin(flipped), np.cos(flipped)), flipped)
    return np.where(angles[..., 1:2] < 0, flipped, angles)
