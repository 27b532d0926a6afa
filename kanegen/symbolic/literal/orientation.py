"""The orientation of one joint as matrices: of three angles, or of a quaternion.

A turn about a basis vector has one sine and one cosine, and what stands here for angles are products of three
turns, so that every entry is a sum of plain products. For the sequence 1-2-3 they are the matrices of the
notes, Eqs. (4), (8), (9), (17).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy
from sympy import Expr, ImmutableMatrix

from kanegen.model.numbers import Number, Parameter
from kanegen.model.sequences import Axes
from kanegen.program.constants import sine_cosine
from kanegen.symbolic.symbols import expression, parameter


@dataclass(frozen=True)
class Angles:
    """Three angles, free or constant.

    Attributes:
        axes: Basis vectors about which they turn, from 0.
        sines: Their sines.
        cosines: Their cosines.
    """

    axes: Axes
    sines: Sequence[Expr]
    cosines: Sequence[Expr]

    @property
    def rotation(self) -> ImmutableMatrix:
        """[R_123] of Eq. (4): components before to components after the three turns."""
        return self._turn(2) * (self._turn(1) * self._turn(0))

    @property
    def rate_matrix(self) -> ImmutableMatrix:
        """[P^AV_K] of Eq. (17): angle rates to relative angular velocity in body K, the axes side by side."""
        first = self._turn(2) * self._first_axis
        return ImmutableMatrix.hstack(first, self._turn(2) * self._axis(1), self._axis(2))

    def rate_matrix_rate(self, rates: Sequence[Expr]) -> ImmutableMatrix:
        """Time derivative of [P^AV_K], below Eq. (20)."""
        _, u2, u3 = rates
        first = self._turn_rate(2) * self._first_axis * u3
        first += self._turn(2) * self._turn_rate(1) * self._axis(0) * u2
        second = self._turn_rate(2) * self._axis(1) * u3
        return ImmutableMatrix.hstack(first, second, sympy.zeros(3, 1))

    @property
    def rate_inverse(self) -> ImmutableMatrix:
        """Inverse of [P^AV_K], Eq. (9); it does not exist where the three axes lie in a plane.

        Between the second turn and the third, the second and third axes are basis vectors, and the first has
        no component along the second.
        """
        _, second, third = self.axes
        across = 3 - second - third
        one = ImmutableMatrix.eye(3)[across, :] / self._first_axis[across]
        three = self._axis(2).T - self._first_axis[third] * one
        return ImmutableMatrix.vstack(one, self._axis(1).T, three) * self._turn(2).T

    @property
    def _first_axis(self) -> ImmutableMatrix:
        """The first axis between the second turn and the third."""
        return self._turn(1) * self._axis(0)

    def _axis(self, i: int) -> ImmutableMatrix:
        """The basis vector about which angle `i` turns, (3, 1)."""
        return ImmutableMatrix.eye(3)[:, self.axes[i]]

    def _turn(self, i: int) -> ImmutableMatrix:
        """Components before to components after the turn by angle `i`."""
        return self._planar(i, 1, self.sines[i], self.cosines[i])

    def _turn_rate(self, i: int) -> ImmutableMatrix:
        """Derivative of the same by the angle."""
        return self._planar(i, 0, self.cosines[i], -self.sines[i])

    def _planar(self, i: int, along: int, sine: Expr, cosine: Expr) -> ImmutableMatrix:
        entries = sympy.zeros(3, 3)
        k = self.axes[i]
        m, n = (k + 1) % 3, (k + 2) % 3
        entries[k, k] = along
        entries[m, m] = entries[n, n] = cosine
        entries[m, n], entries[n, m] = sine, -sine
        return ImmutableMatrix(entries)


@dataclass(frozen=True)
class Quaternion:
    """Four Euler parameters, a scalar and a vector, of any common length but 0.

    They turn body K from the joint frame as a unit quaternion of their direction does (Kane, Likins and
    Levinson 1983, section 1.3, where the scalar comes last).

    Attributes:
        elements: e0, e1, e2, e3.
        factor: 2 over their squared length.
    """

    elements: Sequence[Expr]
    factor: Expr

    @property
    def rotation(self) -> ImmutableMatrix:
        """Components in the joint frame to components in body K, in place of [R_123]."""
        scalar, vector = self.elements[0], ImmutableMatrix(self.elements[1:])
        turned = skew(vector) * skew(vector) - scalar * skew(vector)
        return ImmutableMatrix.eye(3) + self.factor * turned

    @property
    def rate_inverse(self) -> ImmutableMatrix:
        """(4, 3) from the relative angular velocity to the rates of the elements, in place of Eq. (9).

        They keep the length.
        """
        scalar, vector = self.elements[0], ImmutableMatrix(self.elements[1:])
        below = scalar * ImmutableMatrix.eye(3) + skew(vector)
        return ImmutableMatrix.vstack(-vector.T, below) / 2


def skew(vector: ImmutableMatrix) -> ImmutableMatrix:
    """The matrix whose product with a column is the cross product with `vector`."""
    x, y, z = vector
    return ImmutableMatrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def constant_sine_cosine(angle: Number) -> tuple[Expr, Expr]:
    """(sin, cos) of a constant angle (rad), exact at right angles; functions of a parameter's symbol."""
    if isinstance(angle, Parameter):
        symbol = parameter(angle)
        return sympy.sin(symbol), sympy.cos(symbol)
    sine, cosine = sine_cosine(angle)
    return expression(sine), expression(cosine)
