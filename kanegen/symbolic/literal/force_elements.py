"""What force elements and loads on points add to {F_y}, by partial velocities of points, Eq. (37)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy
from sympy import Expr, ImmutableMatrix, S

from kanegen.model.coordinates import Freedom
from kanegen.model.force_elements.elements import Drive, End, JointSpring, PointLoad, Potential, Spring
from kanegen.model.force_elements.names import Place, coordinate_places, speed_places
from kanegen.model.system import System
from kanegen.symbolic.definitions import Definition, Definitions
from kanegen.symbolic.literal.dynamics import BodyEquations, total
from kanegen.symbolic.literal.expressions import Variables
from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.symbols import column, expression, point_force, point_moment


@dataclass(frozen=True)
class _Place:
    """A point in inertial components.

    Attributes:
        position: (3, 1) where it is (m).
        velocity: (3, 1) of it (m/s).
        velocity_y: (3, n) its partial velocities.
    """

    position: ImmutableMatrix
    velocity: ImmutableMatrix
    velocity_y: ImmutableMatrix


@dataclass(frozen=True, eq=False)
class ElementForces:
    """What they add.

    Attributes:
        system: The tree.
        bodies: The equations of its bodies.
        named: Takes the intermediates; None where nothing is named.
    """

    system: System
    bodies: Sequence[BodyEquations]
    named: Definitions | None

    @property
    def total(self) -> ImmutableMatrix:
        """(n, 1) generalized forces; zeros where there are no elements and no loads on points."""
        return self._derived[0]

    @property
    def definitions(self) -> tuple[Definition, ...]:
        """What the symbols in `total` stand for beside those of the bodies."""
        return self._derived[1]

    @cached_property
    def _derived(self) -> tuple[ImmutableMatrix, tuple[Definition, ...]]:
        none = ImmutableMatrix.zeros(len(self.system.freedoms), 1)
        forces = total([none, *self._efforts(), *self._pulls(), *self._loads()])
        return forces, () if self.named is None else self.named.listed()

    def _efforts(self) -> Iterator[ImmutableMatrix]:
        """On freedoms; on locked ones they move nothing."""
        coordinates, speeds = coordinate_places(self.system.bodies), speed_places(self.system.bodies)
        for element in self.system.force_elements:
            match element:
                case JointSpring(name, stiffness, rest, damping):
                    pull = expression(stiffness) * (self._variables.coordinate(name) - expression(rest))
                    drag = expression(damping) * self._variables.rate(name)
                    yield self._on(coordinates[name], -pull - drag)
                case Drive(name, effort):
                    yield self._on(speeds[name], self._variables.value(effort))
                case Potential(energy):
                    for place, slope in self._variables.slopes(energy).items():
                        yield self._on(place, -slope)

    def _pulls(self) -> Iterator[ImmutableMatrix]:
        """Of springs between points."""
        for spring in self.system.force_elements:
            if isinstance(spring, Spring):
                one, two = map(self._place, spring.between)
                stiffness, rest, damping = map(
                    expression, (spring.stiffness, spring.rest_length, spring.damping)
                )
                way = two.position - one.position
                velocity_y = two.velocity_y - one.velocity_y
                length = self._value("length", sympy.sqrt(way.dot(way)))
                rate = way.dot(two.velocity - one.velocity) / length
                yield velocity_y.T * way * (-(stiffness * (length - rest) + damping * rate) / length)

    def _loads(self) -> Iterator[ImmutableMatrix]:
        """On points, by elements and by the caller."""
        value = self._variables.value
        for element in self.system.force_elements:
            if isinstance(element, PointLoad):
                force, moment = (
                    ImmutableMatrix([*map(value, three)]) for three in (element.force, element.moment)
                )
                yield self._loaded(element.point, force, moment)
        for number, (_, point) in enumerate(self.system.points, start=1):
            if point.loads:
                force, moment = (
                    ImmutableMatrix([symbol(number, axis) for axis in range(3)])
                    for symbol in (point_force, point_moment)
                )
                yield self._loaded(point.name, force, moment)

    def _loaded(self, name: str, force: ImmutableMatrix, moment: ImmutableMatrix) -> ImmutableMatrix:
        """A force at a point and a moment on its body."""
        _, body, _ = self._points[name]
        turning_y = body.rotation.T * body.partial_angular_velocity
        return self._place(name).velocity_y.T * force + turning_y.T * moment

    def _on(self, place: Place, effort: Expr) -> ImmutableMatrix:
        """An effort on a freedom."""
        rows = [effort if Freedom(*place) == freedom else S.Zero for freedom in self.system.freedoms]
        return ImmutableMatrix(len(rows), 1, rows)

    def _place(self, end: End) -> _Place:
        if not isinstance(end, str):
            still = ImmutableMatrix.zeros(3, 1)
            return _Place(column(end), still, ImmutableMatrix.zeros(3, len(self.system.freedoms)))
        number, body, arm = self._points[end]
        carried = body.relative_rotation * body.velocity_of_origin
        carried_y = body.relative_rotation * body.partial_velocity_of_origin
        position = body.rotation.T * (body.position_of_origin + arm)
        velocity = body.rotation.T * (carried + skew(body.angular_velocity) * arm)
        velocity_y = body.rotation.T * (carried_y - skew(arm) * body.partial_angular_velocity)
        return _Place(
            self._matrix(f"pP_{number}", position),
            self._matrix(f"vP_{number}", velocity),
            self._matrix(f"vPy_{number}", velocity_y),
        )

    @cached_property
    def _variables(self) -> Variables:
        return Variables(self.system, expression)

    @cached_property
    def _points(self) -> dict[str, tuple[int, BodyEquations, ImmutableMatrix]]:
        """By name its number, its body and where it is there (m)."""
        return {
            point.name: (number, self.bodies[k - 1], column(point.position))
            for number, (k, point) in enumerate(self.system.points, start=1)
        }

    def _matrix(self, name: str, value: ImmutableMatrix) -> ImmutableMatrix:
        rows, columns = value.shape
        places = ((i, j) for i in range(rows) for j in range(columns))
        entries = [self._value(f"{name}_{i + 1}_{j + 1}", value[i, j]) for i, j in places]
        return ImmutableMatrix(rows, columns, entries)

    def _value(self, name: str, value: Expr) -> Expr:
        return value if self.named is None else self.named.define(name, value)
