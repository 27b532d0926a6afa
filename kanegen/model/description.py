"""What a system is: its fields, and the freedoms, coordinates and parameters that follow from them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from kanegen.errors import ModelError
from kanegen.model.body import Body
from kanegen.model.coordinates import Coordinate, Freedom
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.expression import TIME
from kanegen.model.freedoms import FREEDOMS, QUATERNION
from kanegen.model.joint import Joint
from kanegen.model.numbers import Number, Parameter, Vector, map_numbers
from kanegen.model.point import Point

GRAVITY: Vector = (0.0, 0.0, -9.81)
"""Default gravity, inertial components, m/s^2."""


@dataclass(frozen=True)
class Description:
    """The fields of a `System`."""

    name: str
    bodies: tuple[Body, ...]
    gravity: Vector = GRAVITY
    force_elements: tuple[ForceElement, ...] = ()
    poses: tuple[str, ...] | None = None
    reactions: tuple[str, ...] | None = None

    @property
    def number_of_bodies(self) -> int:
        """N."""
        return len(self.bodies)

    @cached_property
    def connection(self) -> tuple[int, ...]:
        """The connection array: `connection[K-1]` is the lower body of body K."""
        return tuple(body.lower for body in self.bodies)

    @cached_property
    def freedoms(self) -> tuple[Freedom, ...]:
        """The freedoms in the order of {y}: those of angles of all bodies, then of translations (Eq. 1)."""
        return self._ordered(lambda joint: joint.free)

    @cached_property
    def prescribed(self) -> tuple[Freedom, ...]:
        """The freedoms whose motion is an input, in the same order."""
        return self._ordered(lambda joint: joint.prescribed)

    def _ordered(self, which: Callable[[Joint], tuple[bool, ...]]) -> tuple[Freedom, ...]:
        """Some freedoms of each joint in the order of Eq. (1)."""
        every = [
            Freedom(k, index)
            for k, body in enumerate(self.bodies, start=1)
            for index, is_one in enumerate(which(body.joint))
            if is_one
        ]
        return tuple(f for f in every if f.is_angle) + tuple(f for f in every if not f.is_angle)

    @cached_property
    def places(self) -> dict[Freedom, int]:
        """The place of every freedom in {y}, from 0."""
        return {freedom: i for i, freedom in enumerate(self.freedoms)}

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """{x}: as the freedoms, but with the four of a quaternion where its joint has one."""
        found: list[Coordinate] = []
        for freedom in self.freedoms:
            if not (freedom.is_angle and self.bodies[freedom.body - 1].joint.is_quaternion):
                found.append(Coordinate(freedom.body, freedom.index))
            elif freedom.index == 0:
                four = range(len(FREEDOMS), len(FREEDOMS) + len(QUATERNION))
                found += [Coordinate(freedom.body, index) for index in four]
        return tuple(found)

    @cached_property
    def coordinate_places(self) -> dict[Coordinate, int]:
        """The place of every coordinate in {x}, from 0."""
        return {coordinate: i for i, coordinate in enumerate(self.coordinates)}

    def coordinate_place(self, body: int, index: int) -> int:
        """The place of a coordinate in {x}, from 0.

        Args:
            body: From 1.
            index: Counts `FREEDOMS`, and `QUATERNION` behind them.

        Raises:
            KeyError: If {x} does not hold it.
        """
        return self.coordinate_places[Coordinate(body, index)]

    @cached_property
    def points(self) -> tuple[tuple[int, Point], ...]:
        """The points of all bodies, body by body, each with the number of its body."""
        return tuple((k, point) for k, body in enumerate(self.bodies, start=1) for point in body.points)

    def spins(self, freedom: Freedom) -> bool:
        """Whether the speed at the place of `freedom` is a component of a relative angular velocity."""
        return freedom.is_angle and self.bodies[freedom.body - 1].joint.spins

    @property
    def speeds_are_rates(self) -> bool:
        """Whether {xdot} = {y}, Eq. (45)."""
        return not any(body.joint.spins for body in self.bodies)

    @cached_property
    def depends_on_time(self) -> bool:
        """Whether a force element does."""
        return any(
            TIME in expression.variables
            for element in self.force_elements
            for expression in element.expressions()
        )

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The run-time parameters, each once, in the order of first use."""
        found: dict[str, Parameter] = {}

        def collect(value: Number) -> None:
            if isinstance(value, Parameter) and found.setdefault(value.name, value) != value:
                raise ModelError(
                    f"parameter {value.name!r} has two values, {found[value.name].value!r} and "
                    f"{value.value!r}. One name, one value."
                )

        map_numbers(self.gravity, collect)
        for body in self.bodies:
            joint = body.joint
            map_numbers((body.mass, body.inertia, body.mass_center), collect)
            map_numbers(tuple(point.position for point in body.points), collect)
            map_numbers((joint.position, joint.orientation, joint.locked), collect)
        for element in self.force_elements:
            for value in element.numbers():
                collect(value)
        return tuple(found.values())
