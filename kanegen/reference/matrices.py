"""The small matrices of the notes, for any batch of states and any type of number.

One written-out form serves all twelve sequences of axes: axes a-b-c are 1-2-3 in a frame whose basis vectors
have other names, and where that frame is left-handed, angles count the other way round. A sequence a-b-a ends
with a turn about a, which is a turn about the third axis between two quarter turns about b: the first of
these adds to the middle angle, the second remains at the end.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.model.arrays import Floats


@dataclass(frozen=True)
class Renaming:
    """The map from the sequence of axes 1-2-3 to another sequence.

    With {phi} = `sign` {theta}, and a quarter turn more for phi_2 where `is_proper_euler`, the rotation of
    the sequence is [after] [R_123(phi)] [before], and its angle-rate matrix is [after] [P_123(phi)].

    Attributes:
        before: (3, 3) from joint-frame components to those of the other names.
        after: (3, 3) back to body components, after the quarter turn that remains.
        sign: Sign of the angles, 1 or -1.
        is_proper_euler: Whether the last axis is the first.
    """

    before: Floats
    after: Floats
    sign: int
    is_proper_euler: bool


def renaming(axes: tuple[int, ...]) -> Renaming:
    """Return the map from the sequence 1-2-3 to the sequence about `axes`, indices from 0."""
    first, second, last = axes
    third = 3 - first - second
    names: Floats = np.eye(3)[[first, second, third]]
    sign = round(float(np.linalg.det(names)))
    left = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]) if last == first else np.eye(3)
    return Renaming(names, names.T @ left, sign, last == first)


Numbers = NDArray[Any]
"""Real or complex numbers of any type; in shapes, `...` is the batch: nothing, or (B,)."""


def skew(v: Numbers) -> Numbers:
    """Return the (..., 3, 3) skew matrix of (..., 3): `skew(a) @ b` is the cross product of a and b."""
    zero = np.zeros_like(v[..., 0])
    return _matrix(
        [zero, -v[..., 2], v[..., 1]],
        [v[..., 2], zero, -v[..., 0]],
        [-v[..., 1], v[..., 0], zero],
    )


def length(vectors: Numbers, axis: int = -1) -> Numbers:
    """Return the Euclidean lengths of real vectors, without overflow or underflow of the squares."""
    lengths: Numbers = np.hypot.reduce(vectors, axis=axis)
    return lengths


def apply(matrix: Numbers, vector: Numbers) -> Numbers:
    """Return the (..., m) product of an (..., m, n) matrix and an (..., n) vector."""
    product: Numbers = (matrix @ vector[..., None])[..., 0]
    return product


def transposed(matrix: Numbers) -> Numbers:
    """Return the (..., n, m) transposed matrix."""
    return np.swapaxes(matrix, -1, -2)


def sines_cosines(angles: Numbers, renaming: Renaming) -> tuple[Numbers, Numbers]:
    """Return (3, ...) sines and cosines of the angles {phi} of a renaming, from (..., 3) joint angles."""
    sines = renaming.sign * np.moveaxis(np.sin(angles), -1, 0)
    cosines = np.moveaxis(np.cos(angles), -1, 0)
    if renaming.is_proper_euler:
        (s1, s2, s3), (c1, c2, c3) = sines, cosines
        return np.stack([s1, c2, s3]), np.stack([c1, -s2, c3])
    return sines, cosines


def rotation_123(sines: Numbers, cosines: Numbers) -> Numbers:
    """Return the (..., 3, 3) rotation of Eq. (4), from (3, ...) sines and cosines of the angles."""
    (s1, s2, s3), (c1, c2, c3) = sines, cosines
    return _matrix(
        [c2 * c3, c1 * s3 + s1 * s2 * c3, s1 * s3 - c1 * s2 * c3],
        [-c2 * s3, c1 * c3 - s1 * s2 * s3, s1 * c3 + c1 * s2 * s3],
        [s2, -s1 * c2, c1 * c2],
    )


def rotation_by_quaternion(elements: Numbers) -> Numbers:
    """Return the (..., 3, 3) rotation from the joint frame by (..., 4) Euler parameters, after Rodrigues."""
    scalar, vector = elements[..., 0, None, None], elements[..., 1:]
    row, column = vector[..., None, :], vector[..., :, None]
    across, along = scalar * skew(vector), row @ column
    squared_turn = (scalar * scalar - along) * np.eye(3) + 2 * (column @ row - across)
    rotation: Numbers = squared_turn / (scalar * scalar + along)
    return rotation


def angle_rate_matrix(sines: Numbers, cosines: Numbers) -> Numbers:
    """Return the (..., 3, 3) angle-rate matrix [P^AV] of Eq. (17), from (3, ...) sines and cosines."""
    (_, s2, s3), (_, c2, c3) = sines, cosines
    zero = np.zeros_like(s2)
    return _matrix([c2 * c3, s3, zero], [-c2 * s3, c3, zero], [s2, zero, zero + 1])


def angle_rate_matrix_dot(sines: Numbers, cosines: Numbers, rates: Numbers) -> Numbers:
    """Return the (..., 3, 3) time derivative of [P^AV], below Eq. (20), with (..., 3) angle rates."""
    (_, s2, s3), (_, c2, c3) = sines, cosines
    _, d2, d3 = np.moveaxis(rates, -1, 0)
    zero = np.zeros_like(s2)
    return _matrix(
        [-(s2 * c3 * d2 + c2 * s3 * d3), c3 * d3, zero],
        [s2 * s3 * d2 - c2 * c3 * d3, -s3 * d3, zero],
        [c2 * d2, zero, zero],
    )


def _matrix(*rows: list[Numbers]) -> Numbers:
    """Return the matrix of rows of entries that have the shape of the batch."""
    entries = [np.asarray(entry) for row in rows for entry in row]
    matrix: Numbers = np.empty((*entries[0].shape, len(rows), len(rows[0])), np.result_type(*entries))
    for place, entry in enumerate(entries):
        matrix[..., place // len(rows[0]), place % len(rows[0])] = entry
    return matrix
