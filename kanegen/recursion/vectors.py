"""Vectors and symmetric matrices of SymPy scalars, written out so that exact zeros and ones vanish."""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Expr, S

from kanegen.symbolic.definitions import Symmetric, Vector

ZERO = Vector(S.Zero, S.Zero, S.Zero)

INDEX = {(0, 0): "xx", (1, 1): "yy", (2, 2): "zz", (0, 1): "xy", (0, 2): "xz", (1, 2): "yz"}
"""Names of the entries of a symmetric matrix."""


def unit(axis: int) -> Vector:
    """Basis vector `axis` (0, 1, 2)."""
    return Vector(*(S.One if i == axis else S.Zero for i in range(3)))


def add(a: Vector, b: Vector) -> Vector:
    """a + b."""
    return Vector(a.x + b.x, a.y + b.y, a.z + b.z)


def present(a: Vector) -> int:
    """How many components are not zero."""
    return sum(1 for component in a if component != 0)


def negate(a: Vector) -> Vector:
    """-a."""
    return Vector(-a.x, -a.y, -a.z)


def subtract(a: Vector, b: Vector) -> Vector:
    """a - b."""
    return Vector(a.x - b.x, a.y - b.y, a.z - b.z)


def scale(factor: Expr, a: Vector) -> Vector:
    """factor a."""
    return Vector(factor * a.x, factor * a.y, factor * a.z)


def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    return Vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


def dot(a: Sequence[Expr], b: Sequence[Expr]) -> Expr:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def dot_cost(a: Sequence[Expr]) -> int:
    """Operations of a . b for a generic b."""
    terms = [component for component in a if component != 0]
    products = [component for component in terms if component not in (-1, 1)]
    return len(products) + max(len(terms) - 1, 0)


def multiply(matrix: Sequence[Sequence[Expr]], a: Vector) -> Vector:
    """[matrix] {a}."""
    return Vector(*(dot(row, a) for row in matrix))


def entry(i: int, j: int) -> str:
    """Name of entry (i, j) of a symmetric matrix."""
    return INDEX[min(i, j), max(i, j)]


def column(matrix: Symmetric, axis: int) -> Vector:
    """Column `axis` of a symmetric matrix."""
    m = matrix
    return (Vector(m.xx, m.xy, m.xz), Vector(m.xy, m.yy, m.yz), Vector(m.xz, m.yz, m.zz))[axis]


def add_symmetric(a: Symmetric, b: Symmetric) -> Symmetric:
    """a + b."""
    return Symmetric(*(u + v for u, v in zip(a, b, strict=True)))
