"""The contribution of force elements and loads on points to {F_y}, by partial velocities, Eq. (37)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy
from sympy import Add, Expr, ImmutableMatrix, S

from kanegen.model.body import Point
from kanegen.model.coordinates import Freedom
from kanegen.model.force_elements.elements import (
    Drive,
    End,
    JointFriction,
    JointSpring,
    PointLoad,
    Potential,
    Spring,
)
from kanegen.model.force_elements.names import Place, coordinate_places, speed_places
from kanegen.model.system import System
from kanegen.symbolic.definitions import Definition, Definitions
from kanegen.symbolic.expressions import ExpressionTranslator
from kanegen.symbolic.freedom_motion import FreedomMotions
from kanegen.symbolic.literal.dynamics import BodyEquations, total
from kanegen.symbolic.literal.frames import frame_equations, point_position
from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.state_symbols import StateSymbols
from kanegen.symbolic.symbols import column, expression, point_force, point_moment

Direction = Callable[[ImmutableMatrix], ImmutableMatrix]
"""Returns the unit vector along a vector, (3, 1)."""


@dataclass(frozen=True)
class _PointKinematics:
    """The motion of a point in inertial components.

    Attributes:
        position: (3, 1) position from the inertial origin (m).
        velocity: (3, 1) velocity (m/s).
        partial_velocity: (3, n) partial velocities with respect to {y}.
    """

    position: ImmutableMatrix
    velocity: ImmutableMatrix
    partial_velocity: ImmutableMatrix


@dataclass(frozen=True, eq=False)
class ElementForces:
    """The generalized forces of the force elements of a system and of the loads on its points.

    Attributes:
        system: The tree.
        symbols: The symbols of coordinates and speeds.
        bodies: The equations of its bodies.
        intermediates: Collects the intermediates.
        named: Whether all intermediates are named, or only parts of long expressions.
        direction: Finds the direction of a spring; None where it is the vector between its ends over the
            length.
    """

    system: System
    symbols: StateSymbols
    bodies: Sequence[BodyEquations]
    intermediates: Definitions
    named: bool
    direction: Direction | None = None

    @cached_property
    def total(self) -> ImmutableMatrix:
        """The generalized forces, (n, 1); zeros where there are no elements and no loads on points."""
        self.intermediates.about("Force elements and loads on points")
        none = FiniteMatrix.zeros(len(self.system.freedoms), 1)
        return total([none, *self._joint_forces(), *self._spring_forces(), *self._point_loads()])

    @property
    def definitions(self) -> tuple[Definition, ...]:
        """The definitions of the symbols in `total`, and in what else was asked for."""
        _ = self.total
        return self.intermediates.listed()

    @cached_property
    def stored_energy(self) -> Expr:
        """The energy that springs and potentials store (J); all other elements store none."""
        _ = self.total  # first, so that intermediates have the names that the forces give them
        return Add(*self._energies())

    def _energies(self) -> Iterator[Expr]:
        """Yield the energy of each element that stores some."""
        for element in self.system.force_elements:
            match element:
                case JointSpring(name, stiffness, rest):
                    stretch = self._translator.coordinate(name) - expression(rest)
                    yield expression(stiffness) * stretch**2 / 2
                case Spring():
                    yield expression(element.stiffness) * self._squared_stretch(element) / 2
                case Potential(energy):
                    yield self._translator.written_out(energy)

    def _squared_stretch(self, spring: Spring) -> Expr:
        """Return the square of what a spring is longer than at rest (m^2)."""
        one, two = map(self._kinematics, spring.between)
        way = two.position - one.position
        if not spring.may_be_undefined:
            return way.dot(way)
        return (self._named("length", sympy.sqrt(way.dot(way))) - expression(spring.rest_length)) ** 2

    def point(self, name: str) -> tuple[ImmutableMatrix, ImmutableMatrix]:
        """Return position (m) and velocity (m/s) of a point, (3, 1) each, inertial components."""
        _ = self.total  # first, as above
        kinematics = self._kinematics(name)
        return kinematics.position, kinematics.velocity

    def _joint_forces(self) -> Iterator[ImmutableMatrix]:
        """Yield the forces of elements that act on freedoms; on locked freedoms they are zero."""
        coordinates, speeds = coordinate_places(self.system.bodies), speed_places(self.system.bodies)
        translate = self._translator
        for element in self.system.force_elements:
            match element:
                case JointSpring(name, stiffness, rest, damping):
                    pull = expression(stiffness) * (translate.coordinate(name) - expression(rest))
                    drag = expression(damping) * translate.speed(name)
                    yield self._on_freedom(coordinates[name], -pull - drag)
                case Drive(freedom=name, effort=effort) | JointFriction(freedom=name, effort=effort):
                    yield self._on_freedom(speeds[name], translate.value(effort))
                case Potential(energy):
                    for place, slope in translate.gradient(energy).items():
                        yield self._on_freedom(place, -slope)

    def _spring_forces(self) -> Iterator[ImmutableMatrix]:
        """Yield the forces of springs between points.

        Raises:
            ModelError: If a spring whose direction matters has no length in any state.
        """
        springs = [element for element in self.system.force_elements if isinstance(element, Spring)]
        for number, spring in enumerate(springs, start=1):
            one, two = map(self._kinematics, spring.between)
            stiffness, rest, damping = map(expression, (spring.stiffness, spring.rest_length, spring.damping))
            way = two.position - one.position
            partial_velocity = two.partial_velocity - one.partial_velocity
            pull = stiffness * way
            if spring.may_be_undefined:
                if way.is_zero_matrix:
                    raise spring.without_length(number)
                direction = self._direction(way)
                rate = direction.dot(two.velocity - one.velocity)
                pull += direction * (damping * rate - stiffness * rest)
            yield -partial_velocity.T * pull

    def _direction(self, way: ImmutableMatrix) -> ImmutableMatrix:
        """Return the unit vector along the vector between the ends of a spring, (3, 1)."""
        if self.direction is not None:
            return self.direction(way)
        return way / self._named("length", sympy.sqrt(way.dot(way)))

    def _point_loads(self) -> Iterator[ImmutableMatrix]:
        """Yield the forces of loads on points: those of elements, then those that are inputs."""
        value = self._translator.value
        for element in self.system.force_elements:
            if isinstance(element, PointLoad):
                force, moment = (
                    FiniteMatrix([*map(value, three)]) for three in (element.force, element.moment)
                )
                to_inertial = self._to_inertial(element.point, element.frame)
                yield self._of_point_load(element.point, to_inertial * force, to_inertial * moment)
        for number, (_, point) in enumerate(self.system.points, start=1):
            if point.loads:
                force, moment = (
                    FiniteMatrix([symbol(number, axis) for axis in range(3)])
                    for symbol in (point_force, point_moment)
                )
                to_inertial = self._to_inertial(point.name, point.load_frame)
                yield self._of_point_load(point.name, to_inertial * force, to_inertial * moment)

    def _to_inertial(self, point: str, frame: str) -> ImmutableMatrix:
        """Return the (3, 3) rotation to inertial components from those of the frame of a load on a point."""
        if not frame:
            return FiniteMatrix.eye(3)
        body = self.bodies[self.system.place(point)[0] - 1]
        return (frame_equations(self.system, frame).rotation * body.rotation).T

    def _of_point_load(self, name: str, force: ImmutableMatrix, moment: ImmutableMatrix) -> ImmutableMatrix:
        """Return (n, 1) generalized forces of a force at a point (N) and a moment on its body (N m)."""
        body = self.bodies[self.system.place(name)[0] - 1]
        partial_angular_velocity = body.rotation.T * body.partial_angular_velocity
        return self._kinematics(name).partial_velocity.T * force + partial_angular_velocity.T * moment

    def _on_freedom(self, place: Place, effort: Expr) -> ImmutableMatrix:
        """Return (n, 1) generalized forces of a force or torque on one freedom (N, N m).

        On a coupled freedom it acts on the freedoms that this one follows, times its factors.
        """
        shares = FreedomMotions(self.system, expression).shares(Freedom(*place))
        rows = [effort * shares.get(freedom, S.Zero) for freedom in self.system.freedoms]
        return FiniteMatrix(len(rows), 1, rows)

    def _kinematics(self, end: End) -> _PointKinematics:
        """Return the motion of an end of a spring: a point or frame by name, or inertial coordinates (m)."""
        k, at = self.system.place(end) if isinstance(end, str) else (0, end)
        arm = point_position(self.system, at) if isinstance(at, Point) else column(at)
        if not k:
            still = FiniteMatrix.zeros(3, 1)
            return _PointKinematics(arm, still, FiniteMatrix.zeros(3, len(self.system.freedoms)))
        body, label = self.bodies[k - 1], self._labels[str(end)]
        carried = body.relative_rotation * body.velocity_of_origin
        carried_y = body.relative_rotation * body.partial_velocity_of_origin
        position = body.rotation.T * (body.position_of_origin + arm)
        velocity = body.rotation.T * (carried + skew(body.angular_velocity) * arm)
        partial_velocity = body.rotation.T * (carried_y - skew(arm) * body.partial_angular_velocity)
        return _PointKinematics(
            self._named_matrix(f"p{label}", position),
            self._named_matrix(f"v{label}", velocity),
            self._named_matrix(f"v{label[0]}y{label[1:]}", partial_velocity),
        )

    @cached_property
    def _translator(self) -> ExpressionTranslator:
        """The translation of expressions to SymPy."""
        return ExpressionTranslator(self.system, expression, self.intermediates, self.symbols)

    @cached_property
    def _labels(self) -> dict[str, str]:
        """The ending of the names of quantities of each frame, and of each point, by its name."""
        frames = {name: f"f_{number}" for number, name in enumerate(self.system.frame_names, start=1)}
        return frames | {name: f"P_{number}" for number, name in enumerate(self.system.point_names, start=1)}

    def _named_matrix(self, name: str, value: ImmutableMatrix) -> ImmutableMatrix:
        """Return a matrix with its longer entries named, where intermediates are wanted."""
        rows, columns = value.shape
        places = ((i, j) for i in range(rows) for j in range(columns))
        entries = [self._named(f"{name}_{i + 1}_{j + 1}", value[i, j]) for i, j in places]
        return FiniteMatrix(rows, columns, entries)

    def _named(self, name: str, value: Expr) -> Expr:
        """Return a symbol for an expression, where intermediates are wanted."""
        return self.intermediates.define(name, value) if self.named else value
