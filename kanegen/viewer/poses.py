"""Poses of all bodies by the reference in NumPy, for pictures that no script draws."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.arrays import Floats, SystemArrays
from kanegen.reference.kinematics import kinematics


def body_poses(arrays: SystemArrays, x: ArrayLike, prescribed: ArrayLike = ()) -> tuple[Floats, Floats]:
    """Return the poses of the ground and of all bodies in one state.

    Args:
        arrays: The numbers of the tree.
        x: (m,) coordinates (rad, m, 1).
        prescribed: (p,) values of the prescribed freedoms (rad, m).

    Returns:
        (N + 1, 3, 3) rotations from components of each body to inertial ones, and (N + 1, 3) inertial
        positions of the origins O_K (m).

    Example:
        rotations, origins = body_poses(system.values(), system.neutral_coordinates)
    """
    values = np.asarray(prescribed, np.float64)
    motion = np.stack([values, 0 * values, 0 * values])
    still = np.zeros(int(arrays.free.sum()))
    bodies = kinematics(arrays, np.asarray(x, np.float64), still, motion)
    rotations = [np.eye(3), *(body.rotation.T for body in bodies)]
    origins = [np.zeros(3), *(body.rotation.T @ body.position for body in bodies)]
    return np.array(rotations), np.array(origins)


def wxyz(rotation: Floats) -> Floats:
    """Return a rotation matrix as (4,) quaternion w, x, y, z of length 1.

    The largest element is computed from the diagonal and the others from it, so that none is a small
    difference (Shepperd 1978).

    Example:
        wxyz(np.eye(3))  # [1, 0, 0, 0]
    """
    m = rotation
    squares = np.array([1 + np.trace(m), *(1 + 2 * m.diagonal() - np.trace(m))])
    largest = int(np.argmax(squares))
    turns = (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1])
    sums = (m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1])
    table = (
        (squares[0], *turns),
        (turns[0], squares[1], sums[0], sums[1]),
        (turns[1], sums[0], squares[2], sums[2]),
        (turns[2], sums[1], sums[2], squares[3]),
    )
    found = np.array(table[largest])
    return np.asarray(found / np.linalg.norm(found), np.float64)
