"""Rotations and their angles, against products of elementary matrices."""

from __future__ import annotations

import numpy as np
import pytest

from kanegen.model.rotations import angles_123, rotation_123


def elementary(axis: int, angle: float) -> np.ndarray:
    """Return the matrix from a frame to the frame after a turn about a basis vector (rad)."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[[j, k], [j, k]] = np.cos(angle)
    matrix[j, k], matrix[k, j] = np.sin(angle), -np.sin(angle)
    return matrix


@pytest.mark.parametrize("from_lock", [None, 1e-3, 1e-9, 0.0])
def test_angles_give_their_rotation_back(from_lock: float | None) -> None:
    """Away from gimbal lock these are the angles themselves, next to it other angles of the same rotation."""
    rng = np.random.default_rng(1)
    for _ in range(200):
        first, middle, last = rng.uniform(-np.pi, np.pi, 3) * [1.0, 0.5, 1.0]
        if from_lock is not None:
            middle = np.copysign(np.pi / 2 - from_lock, middle)
        matrix = elementary(2, last) @ elementary(1, middle) @ elementary(0, first)
        np.testing.assert_allclose(rotation_123((first, middle, last)), matrix, atol=1e-15)
        angles = angles_123(matrix.tolist())
        if from_lock is None and abs(middle) < 1.5:
            np.testing.assert_allclose(angles, (first, middle, last), atol=1e-13)
        again = elementary(2, angles[2]) @ elementary(1, angles[1]) @ elementary(0, angles[0])
        np.testing.assert_allclose(again, matrix, atol=2e-15)
