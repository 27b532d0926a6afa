"""Vectors, symmetric matrices and wrenches of SymPy scalars, in which exact zeros and ones vanish."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.symbolic.definitions import Definitions, Symmetric, Vector

Rows = tuple[Vector, Vector, Vector]
"""A 3 x 3 matrix, row by row."""

ZERO = Vector(S.Zero, S.Zero, S.Zero)

INDEX = {(0, 0): "xx", (1, 1): "yy", (2, 2): "zz", (0, 1): "xy", (0, 2): "xz", (1, 2): "yz"}
"""Names of the entries of a symmetric matrix by row and column."""


def unit(axis: int) -> Vector:
    """Return the basis vector of `axis` (0, 1, 2)."""
    return Vector(*(S.One if i == axis else S.Zero for i in range(3)))


def add(a: Vector, b: Vector) -> Vector:
    """Return the sum a + b of two vectors."""
    return Vector(a.x + b.x, a.y + b.y, a.z + b.z)


def count_nonzero(a: Vector) -> int:
    """Return the number of components that are not zero."""
    return sum(1 for component in a if component != 0)


def negate(a: Vector) -> Vector:
    """Return a vector with its sign changed."""
    return Vector(-a.x, -a.y, -a.z)


def subtract(a: Vector, b: Vector) -> Vector:
    """Return the difference a - b of two vectors."""
    return Vector(a.x - b.x, a.y - b.y, a.z - b.z)


def scale(factor: Expr, a: Vector) -> Vector:
    """Return the vector a times a scalar."""
    return Vector(factor * a.x, factor * a.y, factor * a.z)


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product a x b."""
    return Vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


def dot(a: Sequence[Expr], b: Sequence[Expr]) -> Expr:
    """Return the scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def dot_cost(a: Sequence[Expr]) -> int:
    """Return the number of operations of a . b for a vector b without zeros."""
    terms = [component for component in a if component != 0]
    products = [component for component in terms if component not in (-1, 1)]
    return len(products) + max(len(terms) - 1, 0)


def multiply(matrix: Sequence[Sequence[Expr]], a: Vector) -> Vector:
    """Return the product of a matrix, given by rows, and a vector."""
    return Vector(*(dot(row, a) for row in matrix))


def entry(i: int, j: int) -> str:
    """Return the name of entry (i, j) of a symmetric matrix."""
    return INDEX[min(i, j), max(i, j)]


def column(matrix: Symmetric, axis: int) -> Vector:
    """Return column `axis` of a symmetric matrix."""
    m = matrix
    return (Vector(m.xx, m.xy, m.xz), Vector(m.xy, m.yy, m.yz), Vector(m.xz, m.yz, m.zz))[axis]


def rows(matrix: Symmetric) -> Rows:
    """Return the rows of a symmetric matrix."""
    return column(matrix, 0), column(matrix, 1), column(matrix, 2)


def add_symmetric(a: Symmetric, b: Symmetric) -> Symmetric:
    """Return the sum of two symmetric matrices."""
    return Symmetric(*(u + v for u, v in zip(a, b, strict=True)))


@dataclass(frozen=True)
class Wrench:
    """A force and a moment about the origin of a body, in its frame.

    Attributes:
        force: {F} (N).
        moment: {M} (N m).
    """

    force: Vector = ZERO
    moment: Vector = ZERO

    def plus(self, other: Wrench, name: str, definitions: Definitions) -> Wrench:
        """Return the sum of two wrenches, with a symbol for every component."""
        both = Wrench(add(self.force, other.force), add(self.moment, other.moment))
        return both.named(name, definitions)

    def named(self, name: str, definitions: Definitions) -> Wrench:
        """Return the same wrench with a symbol for every component."""
        force = definitions.vector(f"pF_{name}", self.force)
        return Wrench(force, definitions.vector(f"pN_{name}", self.moment))
