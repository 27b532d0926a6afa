"""Orientations of joints: three angles or a quaternion, Eqs. (2)-(9), (17).

A turn about a basis vector has one sine and one cosine, and matrices of three angles are products of three
turns, so every entry is a sum of plain products. For the sequence 1-2-3 they are the matrices of the notes,
Eqs. (4), (8), (9), (17).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy
from sympy import Expr, ImmutableMatrix, Integer, S

from kanegen.model.coordinates import (
    NOTES,
    SEQUENCES,
    Axes,
    AxisRotations,
    QuaternionRotation,
    Rotation,
)
from kanegen.model.numbers import Matrix, Number, Vector
from kanegen.program.constants import sine_cosine
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.symbols import expression, matrix, rotation_coordinates


@dataclass(frozen=True)
class Angles:
    """An orientation by three successive turns through free or constant angles.

    Attributes:
        axes: Indices, from 0, of the basis vectors about which the three angles turn.
        sines: Sines of the three angles.
        cosines: Cosines of the three angles.
    """

    axes: Axes
    sines: Sequence[Expr]
    cosines: Sequence[Expr]

    @property
    def rotation(self) -> ImmutableMatrix:
        """[R_123] of Eq. (4), (3, 3): components before the three turns to components after them."""
        return self._turn(2) * (self._turn(1) * self._turn(0))

    @property
    def rate_matrix(self) -> ImmutableMatrix:
        """[P^AV_K] of Eq. (17), (3, 3): angle rates to relative angular velocity in body K.

        Its columns are the axes of the three turns in components of body K.
        """
        first = self._turn(2) * self._first_axis
        return FiniteMatrix.hstack(first, self._turn(2) * self._axis(1), self._axis(2))

    def rate_matrix_rate(self, rates: Sequence[Expr]) -> ImmutableMatrix:
        """Return the time derivative of [P^AV_K], (3, 3), below Eq. (20).

        Args:
            rates: Rates of the three angles (rad/s).
        """
        _, u2, u3 = rates
        first = self._turn_rate(2) * self._first_axis * u3
        first += self._turn(2) * self._turn_rate(1) * self._axis(0) * u2
        second = self._turn_rate(2) * self._axis(1) * u3
        return FiniteMatrix.hstack(first, second, sympy.zeros(3, 1))

    @property
    def rate_inverse(self) -> ImmutableMatrix:
        """The inverse of [P^AV_K], Eq. (9); it does not exist where the three axes lie in a plane.

        Between the second and the third turn, the second and the third axis are basis vectors, and the first
        axis has no component along the second.
        """
        _, second, third = self.axes
        across = 3 - second - third
        one = FiniteMatrix.eye(3)[across, :] / self._first_axis[across]
        three = self._axis(2).T - self._first_axis[third] * one
        return FiniteMatrix.vstack(one, self._axis(1).T, three) * self._turn(2).T

    @property
    def _first_axis(self) -> ImmutableMatrix:
        """The first axis in components between the second and the third turn, (3, 1)."""
        return self._turn(1) * self._axis(0)

    def _axis(self, i: int) -> ImmutableMatrix:
        """Return the basis vector about which angle `i` turns, (3, 1)."""
        return FiniteMatrix.eye(3)[:, self.axes[i]]

    def _turn(self, i: int) -> ImmutableMatrix:
        """Return the rotation by angle `i`: components before to components after the turn, (3, 3)."""
        return self._planar(i, 1, self.sines[i], self.cosines[i])

    def _turn_rate(self, i: int) -> ImmutableMatrix:
        """Return the derivative of `_turn(i)` with respect to the angle, (3, 3)."""
        return self._planar(i, 0, self.cosines[i], -self.sines[i])

    def _planar(self, i: int, along: int, sine: Expr, cosine: Expr) -> ImmutableMatrix:
        """Return a matrix in the pattern of a turn about axis `i`, with `along` on the axis."""
        entries = [[S.Zero] * 3 for _ in range(3)]
        k = self.axes[i]
        m, n = (k + 1) % 3, (k + 2) % 3
        entries[k][k] = Integer(along)
        entries[m][m] = entries[n][n] = cosine
        entries[m][n], entries[n][m] = sine, -sine
        return FiniteMatrix(entries)


@dataclass(frozen=True)
class Quaternion:
    """An orientation by four Euler parameters, a scalar and a vector, of any common length but 0.

    They turn body K from the joint frame as the unit quaternion of their direction does (Kane, Likins and
    Levinson 1983, section 1.3, where the scalar comes last).

    Attributes:
        elements: The scalar e0 and the vector e1, e2, e3.
        factor: 2 over their squared length.
    """

    elements: Sequence[Expr]
    factor: Expr

    @property
    def rotation(self) -> ImmutableMatrix:
        """(3, 3): components in the joint frame to components in body K, in place of [R_123]."""
        scalar, vector = self.elements[0], FiniteMatrix(self.elements[1:])
        turned = skew(vector) * skew(vector) - scalar * skew(vector)
        return FiniteMatrix.eye(3) + self.factor * turned

    @property
    def rate_matrix(self) -> ImmutableMatrix:
        """[P^AV_K], (3, 3): the identity, because the speeds are the components of the angular velocity."""
        return FiniteMatrix.eye(3)

    def rate_matrix_rate(self, _: Sequence[Expr]) -> ImmutableMatrix:
        """Time derivative of [P^AV_K], (3, 3): zero."""
        return FiniteMatrix.zeros(3, 3)

    @property
    def rate_inverse(self) -> ImmutableMatrix:
        """(4, 3): relative angular velocity to the rates of the elements, in place of Eq. (9).

        These rates keep the length of the quaternion.
        """
        scalar, vector = self.elements[0], FiniteMatrix(self.elements[1:])
        below = scalar * FiniteMatrix.eye(3) + skew(vector)
        return FiniteMatrix.vstack(-vector.T, below) / 2


Orientation = Angles | Quaternion
"""The orientation of a joint, of either kind."""


def length_factor(number: int, rotation: Rotation) -> ImmutableMatrix:
    """Return 2 over the squared length of the quaternion of a body, (1, 1); empty where it has none."""
    if not isinstance(rotation, QuaternionRotation):
        return FiniteMatrix([])
    squares = sum((element**2 for element in rotation_coordinates(number, rotation)), start=S.Zero)
    return FiniteMatrix([2 / squares])


def orientation(
    number: int,
    rotation: Rotation,
    sines: ImmutableMatrix,
    cosines: ImmutableMatrix,
    factor: ImmutableMatrix,
) -> Orientation:
    """Return the orientation of a body in its joint frame.

    Args:
        number: Number of the body, from 1.
        rotation: The kind of rotation of its joint.
        sines: (3, 1) sines of its angles; empty for a quaternion.
        cosines: (3, 1) cosines of its angles; empty for a quaternion.
        factor: What `length_factor` returns, or symbols for it.
    """
    match rotation:
        case AxisRotations(axes):
            return Angles(axes, list(sines), list(cosines))
        case QuaternionRotation():
            return Quaternion(rotation_coordinates(number, rotation), factor[0])


def skew(vector: ImmutableMatrix) -> ImmutableMatrix:
    """Return the (3, 3) matrix whose product with a column is the cross product of `vector` with it."""
    x, y, z = vector
    return FiniteMatrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def constant_orientation(given: Matrix | Vector) -> ImmutableMatrix:
    """Return a constant orientation, (3, 3), that is given as a matrix or as three 1-2-3 angles (rad)."""
    if isinstance(given[0], tuple):
        return matrix(given)
    values = [constant_sine_cosine(angle) for angle in given]
    return Angles(SEQUENCES[NOTES], [s for s, _ in values], [c for _, c in values]).rotation


def constant_sine_cosine(angle: Number) -> tuple[Expr, Expr]:
    """Return (sin, cos) of a constant angle (rad), exact at right angles; parameters stay symbols."""
    if not isinstance(angle, float):
        return sympy.sin(expression(angle)), sympy.cos(expression(angle))
    sine, cosine = sine_cosine(angle)
    return expression(sine), expression(cosine)
