"""The joint below a body: its six freedoms, its constants, Eqs. (1), (4) and (22).

A body's equations come in five layers, each a class that extends the one before: the joint (here), then
`angular`, `remainder`, `linear` and `dynamics`. Everything is computed on first use and kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import sympy
from sympy import Expr, ImmutableMatrix, S, Symbol

from kanegen.model.body import Body
from kanegen.model.coordinates import Freedom
from kanegen.model.sequences import NOTES, SEQUENCES
from kanegen.model.system import System
from kanegen.symbolic.literal.orientation import Angles, Quaternion, constant_sine_cosine
from kanegen.symbolic.naming import Names
from kanegen.symbolic.symbols import (
    accelerations,
    column,
    coordinate,
    expression,
    matrix,
    quaternion,
    relative_angular_velocity,
    speed,
    speeds,
)


@dataclass(frozen=True, eq=False, repr=False)
class JointEquations:
    """How body K can move on its lower body J.

    Attributes:
        number: K.
        system: The tree that it belongs to.
        lower: The same of body J; None where J is the ground.
        names: Names of intermediates.
    """

    number: int
    system: System
    lower: Self | None
    names: Names

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
        """[C_K], from J components to joint-frame components; the notes have [I], so that Eq. (4) is all."""
        given = self.body.joint.orientation
        if isinstance(given[0], tuple):
            return matrix(given)
        pairs = [constant_sine_cosine(angle) for angle in given]
        turned = Angles(SEQUENCES[NOTES], [s for s, _ in pairs], [c for _, c in pairs])
        return self._named("joint_orientation", turned.rotation)

    @cached_property
    def offset(self) -> ImmutableMatrix:
        """{q'_K} + [C_K]^T {s'_K}, from O_J to O_K in J components (m), as in Eq. (22)."""
        position = column(self.body.joint.position)
        return self._named("offset", position + self.joint_orientation.T * self._translation)

    @cached_property
    def offset_rate(self) -> ImmutableMatrix:
        """[C_K]^T {sdot'_K}, as seen from and resolved in J (m/s), as in Eq. (24)."""
        return self._named("offset_rate", self.joint_orientation.T * self._translation_rate)

    @cached_property
    def quaternion_factor(self) -> ImmutableMatrix:
        """2 over the squared length of the quaternion, (1, 1); empty where there is none."""
        if not self.body.joint.is_quaternion:
            return ImmutableMatrix([])
        squares = sum((element**2 for element in quaternion(self.number)), start=S.Zero)
        return self._named("quaternion_factor", ImmutableMatrix([2 / squares]))

    @property
    def _orientation(self) -> Angles | Quaternion:
        if self.body.joint.is_quaternion:
            return Quaternion(quaternion(self.number), self.quaternion_factor[0])
        return self._angles

    @property
    def _angles(self) -> Angles:
        return Angles(self.body.joint.axes, list(self.sines), list(self.cosines))

    @property
    def _sines_cosines(self) -> list[tuple[Expr, Expr]]:
        """Of the angles; none where a quaternion stands in their place."""
        return [] if self.body.joint.is_quaternion else [self._sine_cosine(index) for index in range(3)]

    @property
    def _turning_speeds(self) -> ImmutableMatrix:
        if self.body.joint.spins:
            return ImmutableMatrix([relative_angular_velocity(self.number, axis) for axis in range(3)])
        return ImmutableMatrix([self._rate(index) for index in range(3)])

    @property
    def _translation(self) -> ImmutableMatrix:
        return ImmutableMatrix([self.coordinate(index) for index in range(3, 6)])

    @property
    def _translation_rate(self) -> ImmutableMatrix:
        return ImmutableMatrix([self._rate(index) for index in range(3, 6)])

    def coordinate(self, index: int) -> Expr:
        """Freedom `index` of `body.FREEDOMS`: its symbol, or the value at which it is locked."""
        joint = self.body.joint
        return coordinate(self.number, index) if joint.moving[index] else expression(joint.locked[index])

    def _rate(self, index: int) -> Expr:
        return speed(self.number, index) if self.body.joint.moving[index] else S.Zero

    def _told(self, symbol: Callable[[int, int], Symbol], first: int) -> ImmutableMatrix:
        """(3, 1) the symbols of freedoms `first` to `first` + 2 that are prescribed, zeros for the others."""
        told = self.body.joint.prescribed
        three = range(first, first + 3)
        return ImmutableMatrix([symbol(self.number, i) if told[i] else S.Zero for i in three])

    def _sine_cosine(self, index: int) -> tuple[Expr, Expr]:
        joint = self.body.joint
        if not joint.moving[index]:
            return constant_sine_cosine(joint.locked[index])
        angle = coordinate(self.number, index)
        return sympy.sin(angle), sympy.cos(angle)

    @property
    def _y(self) -> ImmutableMatrix:
        return ImmutableMatrix(speeds(self.system))

    @property
    def _ydot(self) -> ImmutableMatrix:
        return ImmutableMatrix(accelerations(self.system))

    def _columns(self, block: ImmutableMatrix, first: int) -> ImmutableMatrix:
        """(3, n): the columns of a 3 x 3 `block` where freedoms `first` to `first` + 2 of this body stand."""
        number = self.system.places
        columns = [sympy.zeros(3, 1)] * len(number)
        for axis in range(3):
            freedom = Freedom(self.number, first + axis)
            if freedom in number:
                columns[number[freedom]] = block[:, axis]
        return ImmutableMatrix.hstack(*columns)

    def _named(self, name: str, value: ImmutableMatrix) -> ImmutableMatrix:
        return self.names.apply(name, ImmutableMatrix(value))
