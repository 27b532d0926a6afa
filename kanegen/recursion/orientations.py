"""The turns that orient a body: about an axis, by a quaternion, by a constant matrix, or several as one.

The rates of a quaternion stand here too, so that a new kind of rotation is written in this module alone.
"""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Expr, Rational, S

from kanegen.model.coordinates import QuaternionRotation, Rotation
from kanegen.recursion.turns import MatrixTurn, PlanarTurn, Turn, WholeTurn
from kanegen.recursion.vectors import add, cross, dot, scale, unit
from kanegen.symbolic.definitions import AXES, Definitions, Vector
from kanegen.symbolic.symbols import rotation_coordinates


def planar(axis: int, sine: Expr, cosine: Expr) -> Turn:
    """A turn about basis vector `axis`; right angles become signed permutations, which cost nothing."""
    if sine != 0 and cosine != 0:
        return PlanarTurn(axis, sine, cosine)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rows = [[S.Zero] * 3 for _ in range(3)]
    rows[axis][axis] = S.One
    rows[j][j] = rows[k][k] = cosine
    rows[j][k], rows[k][j] = sine, -sine
    return MatrixTurn((Vector(*rows[0]), Vector(*rows[1]), Vector(*rows[2])))


def rotated_as_a_whole(body: int, rotation: Rotation, definitions: Definitions) -> MatrixTurn:
    """Return the turn by a rotation that is not made of turns about axes, from the joint frame to body K.

    Raises:
        TypeError: If the rotation is made of turns about axes.
    """
    match rotation:
        case QuaternionRotation():
            return _by_quaternion(body, rotation_coordinates(body, rotation), definitions)
    raise TypeError(rotation)


def _by_quaternion(body: int, elements: Sequence[Expr], definitions: Definitions) -> MatrixTurn:
    """The turn by a quaternion of any length but 0, from the frame that it turns to the turned one.

    Twice the products of its elements, over their squared length, make up the matrix.
    """
    scalar, *vector = elements
    squared = sum((element * element for element in elements), start=S.Zero)
    factor = definitions.define(f"eh_{body}", 2 / squared)
    scaled = [definitions.define(f"eh_{body}_{i}", factor * one) for i, one in enumerate(vector, start=1)]
    turn = [definitions.define(f"es_{body}_{i}", scalar * one) for i, one in enumerate(scaled, start=1)]
    square = [a * b for a, b in zip(scaled, vector, strict=True)]
    square = [definitions.define(f"ee_{body}_{i}{i}", value) for i, value in enumerate(square, start=1)]
    rows = [[S.One] * 3 for _ in range(3)]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        product = definitions.define(f"ee_{body}_{i + 1}{j + 1}", scaled[i] * vector[j])
        rows[i][i] = S.One - (square[j] + square[k])
        rows[i][j], rows[j][i] = product + turn[k], product - turn[k]
    named = [definitions.vector(f"R_{body}_{AXES[i]}", Vector(*row)) for i, row in enumerate(rows)]
    return MatrixTurn((named[0], named[1], named[2]))


def constant_turns(matrix: Sequence[Sequence[Expr]]) -> tuple[Turn, ...]:
    """The turns that make up a constant orientation [C_K]; none for the identity."""
    rows = [Vector(*row) for row in matrix]
    if rows == [unit(0), unit(1), unit(2)]:
        return ()
    for axis in range(3):
        j, k = (axis + 1) % 3, (axis + 2) % 3
        alone = rows[axis] == unit(axis) and rows[j][axis] == rows[k][axis] == S.Zero
        if alone and rows[j][j] == rows[k][k] and rows[j][k] == -rows[k][j]:
            return (planar(axis, sine=rows[j][k], cosine=rows[j][j]),)
    return (MatrixTurn((rows[0], rows[1], rows[2])),)


def whole(name: str, parts: Sequence[Turn], definitions: Definitions) -> WholeTurn:
    """Turns one after the other as one; `name` is for the rows of its matrix."""
    columns = [unit(axis) for axis in range(3)]
    for i, part in enumerate(parts, start=1):
        turned = [part.up(column) for column in columns]
        rows = [
            definitions.vector(f"{name}_{i}_{axis}", Vector(*(column[j] for column in turned)))
            for j, axis in enumerate(AXES)
        ]
        columns = [Vector(*(row[j] for row in rows)) for j in range(3)]
    return WholeTurn(MatrixTurn((rows[0], rows[1], rows[2])), tuple(parts))


def rotation_rates(body: int, rotation: Rotation, omega: Vector) -> tuple[Expr, ...]:
    """Return the rates of the coordinates of a rotation that is not made of turns about axes.

    Args:
        body: Number of body K.
        rotation: Its rotation in the joint frame.
        omega: Relative angular velocity, in K (rad/s).

    Raises:
        TypeError: If the rotation is made of turns about axes.
    """
    match rotation:
        case QuaternionRotation():
            return _quaternion_rates(rotation_coordinates(body, rotation), omega)
    raise TypeError(rotation)


def _quaternion_rates(quaternion: Sequence[Expr], omega: Vector) -> tuple[Expr, ...]:
    """Return the rates of a quaternion, which keep its length, from the angular velocity in K (rad/s)."""
    scalar, *elements = quaternion
    vector, half = Vector(*elements), scale(Rational(1, 2), omega)
    return (-dot(vector, half), *add(scale(scalar, half), cross(vector, half)))
