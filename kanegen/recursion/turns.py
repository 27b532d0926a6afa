"""Changes of frame along a joint, one elementary turn at a time.

[R_123] of Eq. (4) is the product of three planar turns. Passing vectors through them one by one costs no
more than multiplying by the product, shows every angle's axis as a unit vector of some frame, and needs no
matrix to be formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from sympy import Expr

from kanegen.recursion.vectors import INDEX, column, dot, dot_cost, entry, multiply
from kanegen.symbolic.definitions import Definitions, Symmetric, Vector


class Turn(Protocol):
    """A constant or variable change between a lower and an upper frame."""

    @property
    def cost(self) -> int:
        """Operations that it takes to turn a vector."""
        ...

    def up(self, v: Vector) -> Vector:
        """Lower components to upper components."""
        ...

    def down(self, v: Vector) -> Vector:
        """Upper components to lower components."""
        ...

    def down_symmetric(self, definitions: Definitions, name: str, m: Symmetric) -> Symmetric:
        """[T]^T [m] [T]: a symmetric matrix from upper to lower components, named `name`."""
        ...


@dataclass(frozen=True)
class PlanarTurn:
    """A turn of the upper frame about a basis vector that both frames share."""

    axis: int
    sine: Expr
    cosine: Expr

    @property
    def cost(self) -> int:
        """Operations that it takes to turn a vector."""
        return 6

    def up(self, v: Vector) -> Vector:
        """Lower components to upper components."""
        return self._turn(v, self.sine)

    def down(self, v: Vector) -> Vector:
        """Upper components to lower components."""
        return self._turn(v, -self.sine)

    def _turn(self, v: Vector, s: Expr) -> Vector:
        _, j, k = self._axes
        c = self.cosine
        result = list(v)
        result[j] = c * v[j] + s * v[k]
        result[k] = c * v[k] - s * v[j]
        return Vector(*result)

    @property
    def _axes(self) -> tuple[int, int, int]:
        return self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3

    def down_symmetric(self, definitions: Definitions, name: str, m: Symmetric) -> Symmetric:
        """[T]^T [m] [T] in 15 operations, where the product of matrices takes 30.

        With p = s (m_kk - m_jj) - 2 c m_jk the turned block is m_jj + s p, m_kk - s p, -(c p + m_jk);
        the couplings with the axis turn as a vector.
        """
        i, j, k = self._axes
        s, c = self.sine, self.cosine
        jj, kk, jk = (getattr(m, entry(a, b)) for a, b in ((j, j), (k, k), (j, k)))
        difference = definitions.define(f"{name}_d", kk - jj)
        twice = definitions.define(f"{name}_2c", 2 * c)
        p = definitions.define(f"{name}_p", s * difference - twice * jk)
        t = definitions.define(f"{name}_t", s * p)
        new = {
            entry(i, i): getattr(m, entry(i, i)),
            entry(j, j): jj + t,
            entry(k, k): kk - t,
            entry(j, k): -(c * p + jk),
        }
        ij, ik = getattr(m, entry(i, j)), getattr(m, entry(i, k))
        new[entry(i, j)] = c * ij - s * ik
        new[entry(i, k)] = s * ij + c * ik
        return definitions.symmetric(name, Symmetric(**new))


@dataclass(frozen=True)
class MatrixTurn:
    """A turn given by its matrix, lower to upper components."""

    matrix: tuple[Vector, Vector, Vector]

    @property
    def cost(self) -> int:
        """Operations that it takes to turn a vector."""
        return sum(dot_cost(row) for row in self.matrix)

    @property
    def _transpose(self) -> tuple[Vector, ...]:
        return tuple(Vector(*(row[j] for row in self.matrix)) for j in range(3))

    def up(self, v: Vector) -> Vector:
        """Lower components to upper components."""
        return multiply(self.matrix, v)

    def down(self, v: Vector) -> Vector:
        """Upper components to lower components."""
        return multiply(self._transpose, v)

    def down_symmetric(self, definitions: Definitions, name: str, m: Symmetric) -> Symmetric:
        """[T]^T [m] [T], through the product [m] [T]."""
        columns = self._transpose  # columns of [T]
        products = [
            definitions.vector(f"{name}_{'abc'[j]}", multiply([column(m, i) for i in range(3)], columns[j]))
            for j in range(3)
        ]
        new = {name_ij: dot(columns[i], products[j]) for (i, j), name_ij in INDEX.items()}
        return definitions.symmetric(name, Symmetric(**new))


@dataclass(frozen=True)
class WholeTurn:
    """Several turns at once, for a joint in which nothing happens between them.

    Vectors turn by the matrix, which costs less than three planar turns; a symmetric matrix by the parts.
    """

    whole: MatrixTurn
    parts: tuple[Turn, ...]

    @property
    def cost(self) -> int:
        """Operations that it takes to turn a vector."""
        return self.whole.cost

    def up(self, v: Vector) -> Vector:
        """Lower components to upper components."""
        return self.whole.up(v)

    def down(self, v: Vector) -> Vector:
        """Upper components to lower components."""
        return self.whole.down(v)

    def down_symmetric(self, definitions: Definitions, name: str, m: Symmetric) -> Symmetric:
        """[T]^T [m] [T]: a symmetric matrix from upper to lower components, named `name`."""
        for i, part in reversed(list(enumerate(self.parts, start=1))):
            m = part.down_symmetric(definitions, f"{name}_{i}", m)
        return m
