"""The joint of a body: coordinates and speeds, constants, orientation, Eqs. (1)-(9), (17), (22).

The orientation of a joint is either three angles or a quaternion. A turn about a basis vector has one sine
and one cosine, and matrices of three angles are products of three turns, so every entry is a sum of plain
products. For the sequence 1-2-3 they are the matrices of the notes, Eqs. (4), (8), (9), (17).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import sympy
from sympy import Add, Expr, ImmutableMatrix, S, Symbol

from kanegen.model.body import Body
from kanegen.model.coordinates import (
    ANGLES,
    NOTES,
    SEQUENCES,
    TRANSLATIONS,
    Axes,
    AxisRotations,
    Freedom,
    QuaternionRotation,
)
from kanegen.model.numbers import Matrix, Number, Parameter, Vector
from kanegen.model.system import System
from kanegen.program.constants import sine_cosine
from kanegen.symbolic.freedom_motion import FreedomMotions, Shares
from kanegen.symbolic.literal.intermediates import Intermediates
from kanegen.symbolic.symbols import (
    accelerations,
    column,
    expression,
    matrix,
    parameter,
    rotation_coordinates,
    speed,
    speeds,
)


@dataclass(frozen=True, eq=False, repr=False)
class JointEquations:
    """The joint between body K and its lower body J.

    Attributes:
        number: K, from 1.
        system: The tree that the body belongs to.
        lower: The equations of body J; None where J is the ground.
        intermediates: Names the longer entries of matrices, where that is wanted.
    """

    number: int
    system: System
    lower: Self | None
    intermediates: Intermediates

    @property
    def body(self) -> Body:
        """The body as the model describes it."""
        return self.system.bodies[self.number - 1]

    @cached_property
    def sines(self) -> ImmutableMatrix:
        """Sines of the three angles in Eq. (4), (3, 1); numbers where an angle is locked."""
        return self._named("sines", ImmutableMatrix([sine for sine, _ in self._sines_cosines]))

    @cached_property
    def cosines(self) -> ImmutableMatrix:
        """Cosines of the three angles in Eq. (4), (3, 1); numbers where an angle is locked."""
        return self._named("cosines", ImmutableMatrix([cosine for _, cosine in self._sines_cosines]))

    @cached_property
    def joint_orientation(self) -> ImmutableMatrix:
        """[C_K], (3, 3): J components to joint-frame components; the notes have the identity."""
        given = self.body.joint.orientation
        constant = constant_orientation(given)
        return constant if isinstance(given[0], tuple) else self._named("joint_orientation", constant)

    @cached_property
    def offset(self) -> ImmutableMatrix:
        """{q'_K} + [C_K]^T {s'_K}, (3, 1): from O_J to O_K in J components (m), as in Eq. (22)."""
        position = column(self.body.joint.position)
        return self._named("offset", position + self.joint_orientation.T * self._translation)

    @cached_property
    def offset_rate(self) -> ImmutableMatrix:
        """[C_K]^T {sdot'_K}, (3, 1): rate of the offset seen from J, in J components (m/s), Eq. (24)."""
        return self._named("offset_rate", self.joint_orientation.T * self._translation_rate)

    @cached_property
    def rotation_factor(self) -> ImmutableMatrix:
        """2 over the squared length of the quaternion, (1, 1); empty for a joint without a quaternion."""
        if not isinstance(self.body.joint.rotation, QuaternionRotation):
            return ImmutableMatrix([])
        elements = rotation_coordinates(self.number, self.body.joint.rotation)
        squares = sum((element**2 for element in elements), start=S.Zero)
        return self._named("rotation_factor", ImmutableMatrix([2 / squares]))

    def coordinate(self, index: int) -> Expr:
        """Return freedom `index` of `FREEDOMS`: its symbol, or the value at which it is locked (rad, m)."""
        joint = self.body.joint
        if joint.moving[index]:
            return self._motions.coordinate(Freedom(self.number, index))
        return expression(joint.locked[index])

    @property
    def _orientation(self) -> Angles | Quaternion:
        """The rotation of the joint, with its matrices."""
        match self.body.joint.rotation:
            case AxisRotations(axes):
                return Angles(axes, list(self.sines), list(self.cosines))
            case QuaternionRotation() as rotation:
                elements = rotation_coordinates(self.number, rotation)
                return Quaternion(elements, self.rotation_factor[0])

    @property
    def _sines_cosines(self) -> list[tuple[Expr, Expr]]:
        """(sin, cos) of the three angles; empty for a joint with a quaternion."""
        angles = [kind for kind in self.body.joint.rotation.coordinates if kind in ANGLES]
        return [self._sine_cosine(index) for index in angles]

    def _sine_cosine(self, index: int) -> tuple[Expr, Expr]:
        """Return (sin, cos) of angle `index`, numbers where the angle is locked."""
        joint = self.body.joint
        if not joint.moving[index]:
            return constant_sine_cosine(joint.locked[index])
        angle = self.coordinate(index)
        return sympy.sin(angle), sympy.cos(angle)

    @property
    def _turning_speeds(self) -> ImmutableMatrix:
        """(3, 1) rates of the three angles, or the components of the relative angular velocity (rad/s)."""
        return ImmutableMatrix([self._speed(index) for index in ANGLES])

    @property
    def _translation(self) -> ImmutableMatrix:
        """{s'_K}, (3, 1), in joint-frame components (m)."""
        return ImmutableMatrix([self.coordinate(index) for index in TRANSLATIONS])

    @property
    def _translation_rate(self) -> ImmutableMatrix:
        """{sdot'_K}, (3, 1), in joint-frame components (m/s)."""
        return ImmutableMatrix([self._speed(index) for index in TRANSLATIONS])

    def _speed(self, index: int) -> Expr:
        """Return the speed of freedom `index` of `FREEDOMS`, zero where it is locked (rad/s, m/s)."""
        joint = self.body.joint
        if joint.coupled[index]:
            return self._motions.speed(Freedom(self.number, index))
        return speed(self.number, joint.speed_kinds[index]) if joint.moving[index] else S.Zero

    @cached_property
    def _motions(self) -> FreedomMotions:
        """The motion of freedoms, coupled ones in terms of those that they follow."""
        return FreedomMotions(self.system, expression)

    def _prescribed(self, symbol: Callable[[int, int], Symbol], first: int) -> ImmutableMatrix:
        """Return (3, 1) parts of freedoms `first` to `first` + 2 that prescribed motion causes."""
        return ImmutableMatrix(
            [
                Add(
                    *(
                        share * symbol(other.body, other.index)
                        for other, share in self._shares(index).items()
                        if other not in self.system.places
                    )
                )
                for index in range(first, first + 3)
            ]
        )

    def _shares(self, index: int) -> Shares:
        """Return the free and prescribed freedoms that move freedom `index`, with their factors."""
        is_moving = self.body.joint.moving[index]
        return self._motions.shares(Freedom(self.number, index)) if is_moving else {}

    @property
    def _y(self) -> ImmutableMatrix:
        """The column {y} of generalized speeds, (n, 1)."""
        return ImmutableMatrix(speeds(self.system))

    @property
    def _ydot(self) -> ImmutableMatrix:
        """The column {ydot} of their derivatives, (n, 1)."""
        return ImmutableMatrix(accelerations(self.system))

    def _columns(self, block: ImmutableMatrix, first: int) -> ImmutableMatrix:
        """Return (3, n) zeros, with the columns of `block` for the freedoms `first` to `first` + 2.

        The column of a coupled freedom adds to those of the freedoms that it follows, times its factors.
        """
        number = self.system.places
        columns = [sympy.zeros(3, 1)] * len(number)
        for axis in range(3):
            for freedom, share in self._shares(first + axis).items():
                if freedom in number:
                    columns[number[freedom]] += share * block[:, axis]
        return ImmutableMatrix.hstack(*columns)

    def _named(self, quantity: str, value: ImmutableMatrix) -> ImmutableMatrix:
        """Return the matrix of a quantity with its longer entries named, where that is wanted."""
        return self.intermediates.named(quantity, ImmutableMatrix(value))


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
        return ImmutableMatrix.hstack(first, self._turn(2) * self._axis(1), self._axis(2))

    def rate_matrix_rate(self, rates: Sequence[Expr]) -> ImmutableMatrix:
        """Return the time derivative of [P^AV_K], (3, 3), below Eq. (20).

        Args:
            rates: Rates of the three angles (rad/s).
        """
        _, u2, u3 = rates
        first = self._turn_rate(2) * self._first_axis * u3
        first += self._turn(2) * self._turn_rate(1) * self._axis(0) * u2
        second = self._turn_rate(2) * self._axis(1) * u3
        return ImmutableMatrix.hstack(first, second, sympy.zeros(3, 1))

    @property
    def rate_inverse(self) -> ImmutableMatrix:
        """The inverse of [P^AV_K], Eq. (9); it does not exist where the three axes lie in a plane.

        Between the second and the third turn, the second and the third axis are basis vectors, and the first
        axis has no component along the second.
        """
        _, second, third = self.axes
        across = 3 - second - third
        one = ImmutableMatrix.eye(3)[across, :] / self._first_axis[across]
        three = self._axis(2).T - self._first_axis[third] * one
        return ImmutableMatrix.vstack(one, self._axis(1).T, three) * self._turn(2).T

    @property
    def _first_axis(self) -> ImmutableMatrix:
        """The first axis in components between the second and the third turn, (3, 1)."""
        return self._turn(1) * self._axis(0)

    def _axis(self, i: int) -> ImmutableMatrix:
        """Return the basis vector about which angle `i` turns, (3, 1)."""
        return ImmutableMatrix.eye(3)[:, self.axes[i]]

    def _turn(self, i: int) -> ImmutableMatrix:
        """Return the rotation by angle `i`: components before to components after the turn, (3, 3)."""
        return self._planar(i, 1, self.sines[i], self.cosines[i])

    def _turn_rate(self, i: int) -> ImmutableMatrix:
        """Return the derivative of `_turn(i)` with respect to the angle, (3, 3)."""
        return self._planar(i, 0, self.cosines[i], -self.sines[i])

    def _planar(self, i: int, along: int, sine: Expr, cosine: Expr) -> ImmutableMatrix:
        """Return a matrix in the pattern of a turn about axis `i`, with `along` on the axis."""
        entries = sympy.zeros(3, 3)
        k = self.axes[i]
        m, n = (k + 1) % 3, (k + 2) % 3
        entries[k, k] = along
        entries[m, m] = entries[n, n] = cosine
        entries[m, n], entries[n, m] = sine, -sine
        return ImmutableMatrix(entries)


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
        scalar, vector = self.elements[0], ImmutableMatrix(self.elements[1:])
        turned = skew(vector) * skew(vector) - scalar * skew(vector)
        return ImmutableMatrix.eye(3) + self.factor * turned

    @property
    def rate_matrix(self) -> ImmutableMatrix:
        """[P^AV_K], (3, 3): the identity, because the speeds are the components of the angular velocity."""
        return ImmutableMatrix.eye(3)

    def rate_matrix_rate(self, _: Sequence[Expr]) -> ImmutableMatrix:
        """Time derivative of [P^AV_K], (3, 3): zero."""
        return ImmutableMatrix.zeros(3, 3)

    @property
    def rate_inverse(self) -> ImmutableMatrix:
        """(4, 3): relative angular velocity to the rates of the elements, in place of Eq. (9).

        These rates keep the length of the quaternion.
        """
        scalar, vector = self.elements[0], ImmutableMatrix(self.elements[1:])
        below = scalar * ImmutableMatrix.eye(3) + skew(vector)
        return ImmutableMatrix.vstack(-vector.T, below) / 2


def skew(vector: ImmutableMatrix) -> ImmutableMatrix:
    """Return the (3, 3) matrix whose product with a column is the cross product of `vector` with it."""
    x, y, z = vector
    return ImmutableMatrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def constant_orientation(given: Matrix | Vector) -> ImmutableMatrix:
    """Return a constant orientation, (3, 3), that is given as a matrix or as three 1-2-3 angles (rad)."""
    if isinstance(given[0], tuple):
        return matrix(given)
    values = [constant_sine_cosine(angle) for angle in given]
    return Angles(SEQUENCES[NOTES], [s for s, _ in values], [c for _, c in values]).rotation


def constant_sine_cosine(angle: Number) -> tuple[Expr, Expr]:
    """Return (sin, cos) of a constant angle (rad), exact at right angles; a parameter stays a symbol."""
    if isinstance(angle, Parameter):
        symbol = parameter(angle)
        return sympy.sin(symbol), sympy.cos(symbol)
    sine, cosine = sine_cosine(angle)
    return expression(sine), expression(cosine)
