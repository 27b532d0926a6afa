"""What force elements and loads on points add to {F_y}, by partial velocities of points, Eq. (37)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy
from sympy import Expr, ImmutableMatrix

from kanegen.force_elements import Drive, JointSpring, PointLoad, Potential, Spring
from kanegen.force_elements.elements import End
from kanegen.force_elements.names import coordinate_places, speed_places
from kanegen.symbolic.definitions import Definition, Definitions
from kanegen.symbolic.dynamics import BodyEquations, total
from kanegen.symbolic.expressions import Variables
from kanegen.symbolic.orientation import skew
from kanegen.symbolic.symbols import column, expression, point_force, point_moment
from kanegen.system import Freedom, System


@dataclass(frozen=True)
class _Place:
    """A point in inertial components: where it is (m), its velocity (m/s), (3, n) its partial velocities."""

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

    @cached_property
    def total(self) -> ImmutableMatrix:
        """(n, 1) generalized forces; zeros where there are no elements and no loads on points."""
        none = ImmutableMatrix.zeros(len(self.system.freedoms), 1)
        return total([none, *self._efforts(), *self._pulls(), *self._loads()])

    @property
    def definitions(self) -> tuple[Definition, ...]:
        """What the symbols in `total` stand for beside those of the bodies."""
        return () if self.named is None or self.total is None else self.named.listed()

    def _efforts(self) -> Iterator[ImmutableMatrix]:
        """On freedoms; on locked ones they move nothing."""
        variables, bodies = Variables(self.system, expression), self.system.bodies
        places, speed = coordinate_places(bodies), speed_places(bodies)
        for element in self.system.force_elements:
            match element:
                case JointSpring(name, stiffness, rest, damping):
                    pull = expression(stiffness) * (variables.coordinate(name) - expression(rest))
                    drag = expression(damping) * variables.rate(name)
                    yield self._on(Freedom(*places[name]), -pull - drag)
                case Drive(name, effort):
                    yield self._on(Freedom(*speed[name]), variables.value(effort))
                case Potential(energy):
                    for place, slope in variables.slopes(energy).items():
                        yield self._on(Freedom(*place), -slope)

    def _pulls(self) -> Iterator[ImmutableMatrix]:
        """Of springs between points."""
        for spring in self.system.force_elements:
            if isinstance(spring, Spring):
                one, two = (self._place(end) for end in spring.between)
                stiffness, rest, damping = map(
                    expression, (spring.stiffness, spring.rest_length, spring.damping)
                )
                way = two.position - one.position
                velocity_y = two.velocity_y - one.velocity_y
                length = self._value("length", sympy.sqrt(way.dot(way)))
                rate = way.dot(two.velocity - one.velocity) / length
                yield velocity_y.T * way * (-(stiffness * (length - rest) + damping * rate) / length)

    def _loads(self) -> Iterator[ImmutableMatrix]:
        """On points."""
        variables = Variables(self.system, expression)
        for element in self.system.force_elements:
            if isinstance(element, PointLoad):
                force, moment = (
                    ImmutableMatrix([variables.value(one) for one in three])
                    for three in (element.force, element.moment)
                )
                yield self._loaded(element.point, force, moment)
        for number, (_, point) in enumerate(self.system.points, start=1):
            if point.loads:
                force, moment = (
                    ImmutableMatrix([symbol(number, axis) for axis in range(3)])
                    for symbol in (point_force, point_moment)
                )
                yield self._loaded(point.name, force, moment)

    def _loaded(self, point: str, force: ImmutableMatrix, moment: ImmutableMatrix) -> ImmutableMatrix:
        k = next(k for k, known in self.system.points if known.name == point)
        body = self.bodies[k - 1]
        turning_y = body.rotation.T * body.partial_angular_velocity
        return self._place(point).velocity_y.T * force + turning_y.T * moment

    def _place(self, end: End) -> _Place:
        if not isinstance(end, str):
            still = ImmutableMatrix.zeros(3, 1)
            return _Place(column(end), still, ImmutableMatrix.zeros(3, len(self.system.freedoms)))
        k, point = next((k, point) for k, point in self.system.points if point.name == end)
        body, arm = self.bodies[k - 1], column(point.position)
        carried = body.relative_rotation * body.partial_velocity_of_origin
        velocity_y = body.rotation.T * (carried - skew(arm) * body.partial_angular_velocity)
        position = body.rotation.T * (body.position_of_origin + arm)
        carried = body.relative_rotation * body.velocity_of_origin
        velocity = body.rotation.T * (carried + skew(body.angular_velocity) * arm)
        number = self.system.point_names.index(end) + 1
        return _Place(
            self._matrix(f"pP_{number}", position),
            self._matrix(f"vP_{number}", velocity),
            self._matrix(f"vPy_{number}", velocity_y),
        )

    def _matrix(self, name: str, value: ImmutableMatrix) -> ImmutableMatrix:
        rows, columns = value.shape
        places = ((i, j) for i in range(rows) for j in range(columns))
        entries = [self._value(f"{name}_{i + 1}_{j + 1}", value[i, j]) for i, j in places]
        return ImmutableMatrix(rows, columns, entries)

    def _value(self, name: str, value: Expr) -> Expr:
        return value if self.named is None else self.named.define(name, value)

    def _on(self, freedom: Freedom, effort: Expr) -> ImmutableMatrix:
        rows = [effort if freedom == other else sympy.S.Zero for other in self.system.freedoms]
        return ImmutableMatrix(len(rows), 1, rows)
