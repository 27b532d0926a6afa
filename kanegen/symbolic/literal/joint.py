"""The joint of a body: its coordinates and speeds, its constants and its offset, Eqs. (1), (22), (24)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import sympy
from sympy import Add, Expr, ImmutableMatrix, S, Symbol

from kanegen.model.body import Body
from kanegen.model.coordinates import ANGLES, TRANSLATIONS, Freedom
from kanegen.model.system import System
from kanegen.symbolic.freedom_motion import FreedomMotions, Shares
from kanegen.symbolic.literal.intermediates import Intermediates
from kanegen.symbolic.literal.orientation import (
    Orientation,
    constant_orientation,
    constant_sine_cosine,
    length_factor,
    orientation,
)
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.state_symbols import StateSymbols
from kanegen.symbolic.symbols import column, expression

NOTHING = FiniteMatrix.zeros(3, 1)
"""What prescribed motion causes where nothing is prescribed."""


@dataclass(frozen=True, eq=False, repr=False)
class JointEquations:
    """The joint between body K and its lower body J.

    Attributes:
        number: K, from 1.
        system: The tree that the body belongs to.
        lower: The equations of body J; None where J is the ground.
        symbols: The symbols of coordinates and speeds.
        intermediates: Names the longer entries of matrices, where that is wanted.
    """

    number: int
    system: System
    lower: Self | None
    symbols: StateSymbols
    intermediates: Intermediates

    @property
    def body(self) -> Body:
        """The body as the model describes it."""
        return self.system.bodies[self.number - 1]

    @cached_property
    def sines(self) -> ImmutableMatrix:
        """Sines of the three angles in Eq. (4), (3, 1); numbers where an angle is locked."""
        return self._named("sines", FiniteMatrix([sine for sine, _ in self._sines_cosines]))

    @cached_property
    def cosines(self) -> ImmutableMatrix:
        """Cosines of the three angles in Eq. (4), (3, 1); numbers where an angle is locked."""
        return self._named("cosines", FiniteMatrix([cosine for _, cosine in self._sines_cosines]))

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
        return self._named("rotation_factor", length_factor(self.number, self.body.joint.rotation))

    def coordinate(self, index: int) -> Expr:
        """Return freedom `index` of `FREEDOMS`: its symbol, or the value at which it is locked (rad, m)."""
        joint = self.body.joint
        if joint.moving[index]:
            return self._motions.coordinate(Freedom(self.number, index))
        return expression(joint.locked[index])

    @property
    def _orientation(self) -> Orientation:
        """The rotation of the joint, with its matrices."""
        rotation = self.body.joint.rotation
        return orientation(self.number, rotation, self.sines, self.cosines, self.rotation_factor)

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
        return FiniteMatrix([self._speed(index) for index in ANGLES])

    @property
    def _translation(self) -> ImmutableMatrix:
        """{s'_K}, (3, 1), in joint-frame components (m)."""
        return FiniteMatrix([self.coordinate(index) for index in TRANSLATIONS])

    @property
    def _translation_rate(self) -> ImmutableMatrix:
        """{sdot'_K}, (3, 1), in joint-frame components (m/s)."""
        return FiniteMatrix([self._speed(index) for index in TRANSLATIONS])

    def _speed(self, index: int) -> Expr:
        """Return the speed of freedom `index` of `FREEDOMS`, zero where it is locked (rad/s, m/s)."""
        joint = self.body.joint
        if joint.coupled[index]:
            return self._motions.speed(Freedom(self.number, index))
        is_moving = joint.moving[index]
        return self.symbols.speed(self.number, joint.speed_kinds[index]) if is_moving else S.Zero

    @cached_property
    def _motions(self) -> FreedomMotions:
        """The motion of freedoms, coupled ones in terms of those that they follow."""
        return FreedomMotions(self.system, expression, self.symbols)

    def _prescribed(self, symbol: Callable[[int, int], Symbol], first: int) -> ImmutableMatrix:
        """Return (3, 1) parts of freedoms `first` to `first` + 2 that prescribed motion causes."""
        return FiniteMatrix(
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
        return FiniteMatrix(self.symbols.speeds(self.system))

    @property
    def _ydot(self) -> ImmutableMatrix:
        """The column {ydot} of their derivatives, (n, 1)."""
        return FiniteMatrix(self.symbols.accelerations(self.system))

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
        return FiniteMatrix.hstack(*columns)

    def _named(self, quantity: str, value: ImmutableMatrix) -> ImmutableMatrix:
        """Return the matrix of a quantity with its longer entries named, where that is wanted."""
        return self.intermediates.named(quantity, FiniteMatrix(value))
