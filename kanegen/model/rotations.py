"""Rotation matrices of plain numbers.

Right angles give exact zeros and ones, and plain Python products keep them: signed permutations multiply
without rounding, and the result does not depend on how a BLAS orders or fuses its operations.
"""

from __future__ import annotations

import math

from kanegen.program.constants import sine_cosine

Triple = tuple[float, float, float]
Square = tuple[Triple, Triple, Triple]

ZERO: Triple = (0.0, 0.0, 0.0)
UNIT: Square = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def dot(a: Triple, b: Triple) -> float:
    """Return the scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Triple, b: Triple) -> Triple:
    """Return the vector product of two vectors."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def apply(matrix: Square, v: Triple) -> Triple:
    """Return the product [matrix] {v}."""
    return dot(matrix[0], v), dot(matrix[1], v), dot(matrix[2], v)


def transpose(m: Square) -> Square:
    """Return the transpose [m]^T of a matrix."""
    (a, b, c), (d, e, f), (g, h, i) = m
    return (a, d, g), (b, e, h), (c, f, i)


def product(a: Square, b: Square) -> Square:
    """Return the product [a] [b]."""
    columns = transpose(b)
    return apply(columns, a[0]), apply(columns, a[1]), apply(columns, a[2])


def similar(rotation: Square, tensor: Square) -> Square:
    """Return [rotation] [tensor] [rotation]^T: the components of a tensor in the rotated frame."""
    return product(product(rotation, tensor), transpose(rotation))


def nearest_rotation(m: Square) -> Square:
    """Return the rotation nearest to a matrix that is almost one, by a Newton step; exact zeros stay."""
    (a, b, c), (d, e, f), (g, h, i) = product(transpose(m), m)
    half = ((3 - a) / 2, -b / 2, -c / 2), (-d / 2, (3 - e) / 2, -f / 2), (-g / 2, -h / 2, (3 - i) / 2)
    return product(m, half)


def turn(axis: int, angle: float) -> Square:
    """Return the rotation to a frame turned by a constant `angle` (rad) about basis vector `axis`, from 0."""
    return planar(axis, *sine_cosine(angle))


def planar(axis: int, sine: float, cosine: float) -> Square:
    """Return the rotation to a frame turned about basis vector `axis` by the angle of a sine and a cosine."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    return _with_entries({(axis, axis): 1.0, (j, j): cosine, (j, k): sine, (k, j): -sine, (k, k): cosine})


def rotation_123(angles: Triple) -> Square:
    """Return [R_123] of Eq. (4): from the frame before three body-fixed turns (rad) to the one after."""
    return product(turn(2, angles[2]), product(turn(1, angles[1]), turn(0, angles[0])))


def angles_123(m: Square) -> Triple:
    """Return the angles (rad) of `rotation_123` for a rotation, the middle one from -pi/2 to pi/2.

    The last angle is computed from the rotation that remains after the first, so that both together stay
    accurate near gimbal lock, where neither is well defined.
    """
    first = math.atan2(-m[2][1], m[2][2])
    middle = math.atan2(m[2][0], math.hypot(m[2][1], m[2][2]))
    sine, cosine = math.sin(first), math.cos(first)
    last = math.atan2(cosine * m[0][1] + sine * m[0][2], cosine * m[1][1] + sine * m[1][2])
    return first, middle, last


def rotation_rpy(angles: Triple) -> Square:
    """Return the rotation from a frame turned by roll, pitch, yaw (rad; fixed x, y, z) to the old frame."""
    roll, pitch, yaw = angles
    return transpose(product(turn(0, roll), product(turn(1, pitch), turn(2, yaw))))


def rotation_quaternion(x: float, y: float, z: float, w: float) -> Square:
    """Return the rotation from a frame turned by a quaternion of any length but zero to the old frame."""
    size = max(abs(x), abs(y), abs(z), abs(w))
    x, y, z, w = x / size, y / size, z / size, w / size
    t = 2 / (x * x + y * y + z * z + w * w)
    return (
        (1 - t * (y * y + z * z), t * (x * y - z * w), t * (x * z + y * w)),
        (t * (x * y + z * w), 1 - t * (x * x + z * z), t * (y * z - x * w)),
        (t * (x * z - y * w), t * (y * z + x * w), 1 - t * (x * x + y * y)),
    )


def normalized(v: Triple) -> Triple:
    """Return `v` / |v|; `v` must not be zero."""
    size = max(abs(v[0]), abs(v[1]), abs(v[2]))
    x, y, z = v[0] / size, v[1] / size, v[2] / size
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length


def rotation_to_axis(v: Triple) -> tuple[int, Square]:
    """Return the basis vector i nearest to the unit vector `v`, up to sign, and [B] with [B] {v} = e_i.

    [B] is the identity where `v` is e_i and diagonal with entries +-1 where it is -e_i. Otherwise it is the
    smallest rotation that takes v (or its mirror image, where component i is negative) to e_i.
    """
    i = max(range(3), key=lambda axis: abs(v[axis]))
    j, k = (i + 1) % 3, (i + 2) % 3
    half_turn = UNIT if v[i] > 0 else _with_entries({(i, i): -1.0, (j, j): 1.0, (k, k): -1.0})
    u = apply(half_turn, v)
    near = 1 + u[i]
    smallest = _with_entries(
        {
            (i, i): u[i],
            (i, j): u[j],
            (i, k): u[k],
            (j, i): -u[j],
            (k, i): -u[k],
            (j, j): 1 - u[j] * u[j] / near,
            (k, k): 1 - u[k] * u[k] / near,
            (j, k): -u[j] * u[k] / near,
            (k, j): -u[j] * u[k] / near,
        }
    )
    return i, product(smallest, half_turn)


def _with_entries(entries: dict[tuple[int, int], float]) -> Square:
    """Return the matrix with some entries, the others zero."""

    def row(i: int) -> Triple:
        return entries.get((i, 0), 0.0), entries.get((i, 1), 0.0), entries.get((i, 2), 0.0)

    return row(0), row(1), row(2)
