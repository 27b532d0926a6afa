"""Changes of frame along a joint, one elementary turn at a time.

[R_123] of Eq. (4) is the product of three planar turns. Passing vectors through them one by one costs no more
than multiplying by the product, makes the axis of every angle a basis vector of some frame, and forms no
matrix. Constant turns, rotations by a quaternion, and several turns as one are matrices. A new kind of
rotation, with the rates of its coordinates, is added in this module alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from sympy import Add, Expr, Rational, S

from kanegen.model.coordinates import QuaternionRotation, Rotation
from kanegen.recursion.vectors import (
    INDEX,
    Rows,
    add,
    column,
    cross,
    dot,
    dot_cost,
    entry,
    multiply,
    scale,
    unit,
)
from kanegen.symbolic.definitions import AXES, Definitions, Symmetric, Vector
from kanegen.symbolic.symbols import rotation_coordinates


class Turn(Protocol):
    """A constant or variable change between a lower and an upper frame."""

    @property
    def cost(self) -> int:
        """Number of operations that turn a vector."""
        ...

    @property
    def reversed(self) -> Turn:
        """The turn from the upper frame to the lower one."""
        ...

    def up(self, v: Vector) -> Vector:
        """Return upper components of a vector from its lower components."""
        ...

    def down(self, v: Vector) -> Vector:
        """Return lower components of a vector from its upper components."""
        ...

    def down_symmetric(self, definitions: Definitions, name: str, m: Symmetric) -> Symmetric:
        """Return [T]^T [m] [T], a symmetric matrix in lower components from its upper ones, named `name`."""
        ...

    def down_matrix(self, definitions: Definitions, name: str, m: Rows) -> Rows:
        """Return [T]^T [m] [T] for any matrix in upper components, row by row, named `name`."""
        ...


@dataclass(frozen=True)
class PlanarTurn:
    """A turn of the upper frame about a basis vector that both frames share.

    Attributes:
        axis: The basis vector, 0 to 2.
        sine: Sine of the angle.
        cosine: Cosine of the angle.
        angle: The angle, if it depends on {x} (rad).
    """

    axis: int
    sine: Expr
    cosine: Expr
    angle: Expr | None = None

    @property
    def cost(self) -> int:
        """Number of operations that turn a vector."""
        return 6

    @property
    def reversed(self) -> Turn:
        """The turn from the upper frame to the lower one."""
        return replace(self, sine=-self.sine, angle=None if self.angle is None else -self.angle)

    def up(self, v: Vector) -> Vector:
        """Return upper components of a vector from its lower components."""
        return self._turn(v, self.sine)

    def down(self, v: Vector) -> Vector:
        """Return lower components of a vector from its upper components."""
        return self._turn(v, -self.sine)

    def _turn(self, v: Vector, s: Expr) -> Vector:
        """Return a vector turned by the angle with the sine `s` and the cosine of this turn."""
        _, j, k = self._axes
        c = self.cosine
        result = list(v)
        result[j] = c * v[j] + s * v[k]
        result[k] = c * v[k] - s * v[j]
        return Vector(*result)

    @property
    def _axes(self) -> tuple[int, int, int]:
        """The axis of the turn and the two axes after it in cyclic order."""
        return self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3

    def down_symmetric(self, definitions: Definitions, name: str, m: Symmetric) -> Symmetric:
        """Return [T]^T [m] [T] in 15 operations, where the product of matrices takes 30.

        With p = s (m_kk - m_jj) - 2 c m_jk the turned block is m_jj + s p, m_kk - s p, -(c p + m_jk);
        the couplings with the axis turn as a vector.
        """
        i, j, k = self._axes
        s, c = self.sine, self.cosine
        jj, kk, jk = (getattr(m, entry(a, b)) for a, b in ((j, j), (k, k), (j, k)))
        difference = definitions.define(f"{name}_d", kk - jj)
        twice = definitions.define(f"C2_{str(c).partition('_')[2]}", 2 * c)
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

    def down_matrix(self, definitions: Definitions, name: str, m: Rows) -> Rows:
        """Return [T]^T [m] [T] in 23 operations, where the product of matrices takes 36.

        With p = s (m_kk - m_jj) - c (m_jk + m_kj) the turned block is m_jj + s p, m_kk - s p, and off the
        diagonal -(c p + m_kj), -(c p + m_jk); the couplings with the axis turn as vectors.
        """
        i, j, k = self._axes
        s, c = self.sine, self.cosine
        difference = definitions.define(f"{name}_d", m[k][k] - m[j][j])
        both = definitions.define(f"{name}_b", m[j][k] + m[k][j])
        p = definitions.define(f"{name}_p", s * difference - c * both)
        along, across = definitions.define(f"{name}_t", s * p), definitions.define(f"{name}_q", c * p)
        new = [[S.Zero] * 3 for _ in range(3)]
        new[i][i] = m[i][i]
        new[j][j], new[k][k] = m[j][j] + along, m[k][k] - along
        new[j][k], new[k][j] = -(across + m[k][j]), -(across + m[j][k])
        new[i][j], new[i][k] = c * m[i][j] - s * m[i][k], s * m[i][j] + c * m[i][k]
        new[j][i], new[k][i] = c * m[j][i] - s * m[k][i], s * m[j][i] + c * m[k][i]
        return _named_rows(name, new, definitions)


@dataclass(frozen=True)
class MatrixTurn:
    """A turn that is given by its matrix from lower to upper components.

    Attributes:
        matrix: The matrix, row by row.
        change: The matrix less the identity, without cancellation, if it depends on {x}.
    """

    matrix: Rows
    change: Rows | None = None

    @property
    def cost(self) -> int:
        """Number of operations that turn a vector."""
        return sum(dot_cost(row) for row in self.matrix)

    @property
    def reversed(self) -> MatrixTurn:
        """The turn from the upper frame to the lower one."""
        x, y, z = self._transpose
        return MatrixTurn((x, y, z))

    @property
    def _transpose(self) -> tuple[Vector, ...]:
        """The rows of the transposed matrix."""
        return tuple(Vector(*(row[j] for row in self.matrix)) for j in range(3))

    def up(self, v: Vector) -> Vector:
        """Return upper components of a vector from its lower components."""
        return multiply(self.matrix, v)

    def down(self, v: Vector) -> Vector:
        """Return lower components of a vector from its upper components."""
        return multiply(self._transpose, v)

    def down_symmetric(self, definitions: Definitions, name: str, m: Symmetric) -> Symmetric:
        """Return [T]^T [m] [T], through the product [m] [T]."""
        columns = self._transpose  # columns of [T]
        products = [
            definitions.vector(f"{name}_{'abc'[j]}", multiply([column(m, i) for i in range(3)], columns[j]))
            for j in range(3)
        ]
        new = {name_ij: dot(columns[i], products[j]) for (i, j), name_ij in INDEX.items()}
        return definitions.symmetric(name, Symmetric(**new))

    def down_matrix(self, definitions: Definitions, name: str, m: Rows) -> Rows:
        """Return [T]^T [m] [T], through the product [m] [T]."""
        columns = self._transpose
        products = [definitions.vector(f"{name}_{'abc'[j]}", multiply(m, columns[j])) for j in range(3)]
        return _named_rows(name, [[dot(left, right) for right in products] for left in columns], definitions)


@dataclass(frozen=True)
class ComposedTurn:
    """Several successive turns as one, for a joint without quantities between them.

    Vectors pass by the product, which costs less than three planar turns; symmetric matrices part by part.

    Attributes:
        product: The product of all parts.
        parts: The turns from below.
    """

    product: MatrixTurn
    parts: tuple[Turn, ...]

    @property
    def cost(self) -> int:
        """Number of operations that turn a vector."""
        return self.product.cost

    @property
    def reversed(self) -> ComposedTurn:
        """The turn from the upper frame to the lower one."""
        return ComposedTurn(self.product.reversed, tuple(part.reversed for part in reversed(self.parts)))

    def up(self, v: Vector) -> Vector:
        """Return upper components of a vector from its lower components."""
        return self.product.up(v)

    def down(self, v: Vector) -> Vector:
        """Return lower components of a vector from its upper components."""
        return self.product.down(v)

    def down_symmetric(self, definitions: Definitions, name: str, m: Symmetric) -> Symmetric:
        """Return [T]^T [m] [T], a symmetric matrix in lower components from its upper ones, named `name`."""
        for i, part in reversed(list(enumerate(self.parts, start=1))):
            m = part.down_symmetric(definitions, f"{name}_{i}", m)
        return m

    def down_matrix(self, definitions: Definitions, name: str, m: Rows) -> Rows:
        """Return [T]^T [m] [T] for any matrix in upper components, row by row, named `name`."""
        for i, part in reversed(list(enumerate(self.parts, start=1))):
            m = part.down_matrix(definitions, f"{name}_{i}", m)
        return m


def _named_rows(name: str, rows: Sequence[Sequence[Expr]], definitions: Definitions) -> Rows:
    """Return a matrix with a symbol for every entry."""
    x, y, z = (
        definitions.vector(f"{name}_{axis}", Vector(*row)) for axis, row in zip(AXES, rows, strict=True)
    )
    return x, y, z


def planar_turn(axis: int, sine: Expr, cosine: Expr, angle: Expr | None = None) -> Turn:
    """Return a turn about a basis vector; right angles become signed permutations, which cost nothing.

    Args:
        axis: The basis vector, 0 to 2.
        sine: Sine of the angle.
        cosine: Cosine of the angle.
        angle: The angle, if it depends on {x} (rad).
    """
    if sine != 0 and cosine != 0:
        return PlanarTurn(axis, sine, cosine, angle)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rows = [[S.Zero] * 3 for _ in range(3)]
    rows[axis][axis] = S.One
    rows[j][j] = rows[k][k] = cosine
    rows[j][k], rows[k][j] = sine, -sine
    return MatrixTurn((Vector(*rows[0]), Vector(*rows[1]), Vector(*rows[2])))


def rotation_as_a_whole(body: int, rotation: Rotation, definitions: Definitions) -> MatrixTurn:
    """Return the turn by a rotation that is not made of turns about axes, from the joint frame to body K.

    Raises:
        TypeError: If the rotation is made of turns about axes.
    """
    match rotation:
        case QuaternionRotation():
            return _by_quaternion(body, rotation_coordinates(body, rotation), definitions)
    raise TypeError(rotation)


def _by_quaternion(body: int, elements: Sequence[Expr], definitions: Definitions) -> MatrixTurn:
    """Return the turn by a quaternion of any length whose square is finite and not 0; NaN for others.

    Twice the products of its elements, over their squared length, make up the matrix.
    """
    scalar, *vector = elements
    factor = _twice_reciprocal(body, elements, definitions)
    scaled = [definitions.define(f"eh_{body}_{i}", factor * one) for i, one in enumerate(vector, start=1)]
    turn = [definitions.define(f"es_{body}_{i}", scalar * one) for i, one in enumerate(scaled, start=1)]
    square = [a * b for a, b in zip(scaled, vector, strict=True)]
    square = [definitions.define(f"ee_{body}_{i}{i}", value) for i, value in enumerate(square, start=1)]
    rows, change = ([[S.One] * 3 for _ in range(3)] for _ in range(2))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        product = definitions.define(f"ee_{body}_{i + 1}{j + 1}", scaled[i] * vector[j])
        rows[i][i], change[i][i] = S.One - (square[j] + square[k]), -(square[j] + square[k])
        rows[i][j], rows[j][i] = product + turn[k], product - turn[k]
        change[i][j], change[j][i] = rows[i][j], rows[j][i]
    named = [definitions.vector(f"R_{body}_{AXES[i]}", Vector(*row)) for i, row in enumerate(rows)]
    less_one = [Vector(*row) for row in change]
    return MatrixTurn((named[0], named[1], named[2]), (less_one[0], less_one[1], less_one[2]))


def rotation_rates(body: int, rotation: Rotation, omega: Vector) -> tuple[Expr, ...]:
    """Return the rates of the coordinates of a rotation that is not made of turns about axes.

    Args:
        body: Number of body K.
        rotation: Rotation of body K in the joint frame.
        omega: Relative angular velocity, in K (rad/s).

    Raises:
        TypeError: If the rotation is made of turns about axes.
    """
    match rotation:
        case QuaternionRotation():
            return _quaternion_rates(rotation_coordinates(body, rotation), omega)
    raise TypeError(rotation)


def _quaternion_rates(quaternion: Sequence[Expr], omega: Vector) -> tuple[Expr, ...]:
    """Return the rates of a quaternion from the angular velocity in K (rad/s); its length stays constant."""
    scalar, *elements = quaternion
    vector, half = Vector(*elements), scale(Rational(1, 2), omega)
    return (-dot(vector, half), *add(scale(scalar, half), cross(vector, half)))


def turnings_as_a_whole(body: int, rotation: Rotation, definitions: Definitions) -> tuple[Vector, ...]:
    """Return the rotations, in K, for unit changes of coordinates of a rotation that is not made of turns.

    Args:
        body: Number of body K.
        rotation: Rotation of body K in the joint frame.
        definitions: Definitions that the intermediates of `rotation_as_a_whole` were added to.

    Raises:
        TypeError: If the rotation is made of turns about axes.
    """
    match rotation:
        case QuaternionRotation():
            return _quaternion_turnings(body, rotation_coordinates(body, rotation), definitions)
    raise TypeError(rotation)


def _quaternion_turnings(
    body: int, quaternion: Sequence[Expr], definitions: Definitions
) -> tuple[Vector, ...]:
    """Return the rotations, in K, for unit changes of the elements of a quaternion of any length.

    These invert `_quaternion_rates`. A change of the length alone turns nothing.
    """
    factor = _twice_reciprocal(body, quaternion, definitions)
    scalar, *elements = (definitions.define(f"eh_{body}_{i}", factor * e) for i, e in enumerate(quaternion))
    vector = Vector(*elements)
    whole = scale(-S.One, vector)
    return (whole, *(add(scale(scalar, unit(i)), cross(unit(i), vector)) for i in range(3)))


def _twice_reciprocal(body: int, quaternion: Sequence[Expr], definitions: Definitions) -> Expr:
    """Return 2 over the squared length s of a quaternion.

    Where s overflows, 2 / s would be 0 and the rotation the identity; (3 - s (1 / s)) (1 / s) is the same
    number elsewhere, and NaN there. A length too small for a square has an infinite reciprocal.
    """
    squared = definitions.define(f"eq_{body}", Add(*(element * element for element in quaternion)))
    inverse = definitions.define(f"ei_{body}", 1 / squared)
    one = definitions.define(f"en_{body}", squared * inverse)
    return definitions.define(f"eh_{body}", inverse * (3 - one))


def constant_turns(matrix: Sequence[Sequence[Expr]]) -> tuple[Turn, ...]:
    """Return the turns that make up a constant orientation [C_K]; none for the identity."""
    rows = [Vector(*row) for row in matrix]
    if rows == [unit(0), unit(1), unit(2)]:
        return ()
    for axis in range(3):
        j, k = (axis + 1) % 3, (axis + 2) % 3
        alone = rows[axis] == unit(axis) and rows[j][axis] == rows[k][axis] == S.Zero
        if alone and rows[j][j] == rows[k][k] and rows[j][k] == -rows[k][j]:
            return (planar_turn(axis, sine=rows[j][k], cosine=rows[j][j]),)
    return (MatrixTurn((rows[0], rows[1], rows[2])),)


def composed(name: str, parts: Sequence[Turn], definitions: Definitions) -> ComposedTurn:
    """Return several turns, listed from below, as one; `name` is the prefix of the rows of its matrix."""
    columns = [unit(axis) for axis in range(3)]
    for i, part in enumerate(parts, start=1):
        turned = [part.up(column) for column in columns]
        rows = [
            definitions.vector(f"{name}_{i}_{axis}", Vector(*(column[j] for column in turned)))
            for j, axis in enumerate(AXES)
        ]
        columns = [Vector(*(row[j] for row in rows)) for j in range(3)]
    return ComposedTurn(MatrixTurn((rows[0], rows[1], rows[2])), tuple(parts))


def is_identity(turn: Turn) -> bool:
    """Return whether a turn is the identity."""
    return all(turn.up(unit(axis)) == unit(axis) for axis in range(3))
