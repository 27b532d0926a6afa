"""Kane's equations of a tree, derived literally as the notes write them: the form to read.

    equations = derive(system)
    equations.A, equations.f              # Eqs. (43), (44): [A]{ydot} = {f}
    equations.bodies[2].rotation          # [R_3]: bodies[k] is body k + 1
    equations.closed_form()               # simplified [A] and {f} of a small tree

Matrices are computed on first use. Where a tree has many freedoms, intermediate quantities are named by
symbols, so that no expression grows; `equations.definitions` lists what the symbols stand for. C comes from
the recursive derivation instead; both have equal values.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from sympy import Expr, ImmutableMatrix, Rational, Symbol

from kanegen.errors import OptionError, counted
from kanegen.model.coordinates import ORIENTATIONS
from kanegen.model.system import System
from kanegen.symbolic.closed.directions import Directions
from kanegen.symbolic.closed.form import ClosedForm, Simplifier, close
from kanegen.symbolic.closed.named_numbers import with_named_numbers
from kanegen.symbolic.definitions import Definition, Definitions
from kanegen.symbolic.literal.dynamics import BodyEquations, total
from kanegen.symbolic.literal.force_elements import Direction, ElementForces
from kanegen.symbolic.literal.intermediates import Intermediates
from kanegen.symbolic.literal.motors import MotorEquations
from kanegen.symbolic.literal.numeric import NumericEquations, numeric
from kanegen.symbolic.state_symbols import StateSymbols, of_system
from kanegen.symbolic.symbols import force, parameter, torque

MOST_FREEDOMS = 8
"""Number of freedoms up to which closed forms are made."""

MOST_FREEDOMS_WITHOUT_NAMES = 6
"""Number of freedoms up to which `derive` writes everything out; beyond, it names intermediates."""


@dataclass(frozen=True, eq=False)
class Equations:
    """[A]{ydot} = {f} of a system and everything that leads to it.

    Example:
        equations = kg.derive(kg.load("models/double_pendulum.toml"))
        equations.A[0, 1]
        equations.bodies[1].rotation

    Attributes:
        system: The system whose equations they are.
        symbols: The symbols of coordinates and speeds: the names that the model gives to freedoms, or those
            of the notes.
        intermediates: Whether intermediate quantities are named by symbols.
        bodies: The equations of each body; `bodies[k]` is body k + 1.
    """

    system: System
    symbols: StateSymbols
    intermediates: bool
    bodies: tuple[BodyEquations, ...]

    def __repr__(self) -> str:
        """The name of the system, its number of bodies and its number of freedoms."""
        bodies, freedoms = counted(len(self.bodies), "body", "bodies"), counted(len(self.y), "freedom")
        return f"<Equations of {self.system.name}: {bodies}, {freedoms}>"

    @cached_property
    def x(self) -> ImmutableMatrix:
        """{x}, a column: free angles (rad) or quaternions, then free translations (m), Eq. (1)."""
        return ImmutableMatrix(self.symbols.coordinates(self.system))

    @cached_property
    def y(self) -> ImmutableMatrix:
        """{y}, (n, 1): generalized speeds (rad/s, m/s), Eq. (1)."""
        return ImmutableMatrix(self.symbols.speeds(self.system))

    @cached_property
    def xdot(self) -> ImmutableMatrix:
        """{xdot}, a column as long as {x}: Eq. (45), or Eq. (9) where speeds are angular velocities."""
        rates: dict[int, Iterator[Expr]] = {}
        for body in self.bodies:
            if not body.body.joint.speeds_are_rates:
                rates[body.number] = iter(body.angle_rate_inverse * body.relative_angular_velocity)
        return ImmutableMatrix(
            [
                next(rates[c.body])
                if c.body in rates and not c.is_translation
                else self.symbols.speed(c.body, c.index)
                for c in self.system.coordinates
            ]
        )

    @cached_property
    def ydot(self) -> ImmutableMatrix:
        """{ydot}, (n, 1): the unknowns of Eq. (42) (rad/s^2, m/s^2)."""
        return ImmutableMatrix(self.symbols.accelerations(self.system))

    @cached_property
    def prescribed(self) -> ImmutableMatrix:
        """Values (rad, m), rates and second derivatives of the prescribed freedoms, (3, p)."""
        return ImmutableMatrix(3, len(self.system.prescribed), self.symbols.prescribed(self.system))

    @cached_property
    def loads(self) -> tuple[Symbol, ...]:
        """The load symbols `F_K_i` and `M_K_i` (N, N m) of the bodies that take loads."""
        loaded = [body.number for body in self.bodies if body.body.loads]
        return tuple(load(k, axis) for k in loaded for load in (force, torque) for axis in range(3))

    @cached_property
    def A(self) -> ImmutableMatrix:
        """[A], (n, n): the generalized mass matrix, Eq. (43), with the inertia of motors."""
        return total([*(body.mass_matrix for body in self.bodies), self._motors.mass_matrix])

    @cached_property
    def f(self) -> ImmutableMatrix:
        """{f}, (n, 1): the right side, Eq. (44), with weight, loads and force elements as its forces."""
        return total([*(body.forcing for body in self.bodies), self._motors.forcing, self.element_forces])

    @cached_property
    def generalized_forces(self) -> ImmutableMatrix:
        """{F_y}, (n, 1): the part of {f} from weight, loads and force elements, Eq. (37)."""
        return total([*(body.generalized_forces for body in self.bodies), self.element_forces])

    @cached_property
    def element_forces(self) -> ImmutableMatrix:
        """The part of {F_y} from force elements and loads on points, (n, 1)."""
        return self._elements.total

    @property
    def _motors(self) -> MotorEquations:
        """The inertia of motors."""
        return MotorEquations(self.system, self.symbols, self.bodies)

    @cached_property
    def _elements(self) -> ElementForces:
        """The generalized forces of force elements and loads on points."""
        return self._element_forces_along(None)

    def _element_forces_along(self, direction: Direction | None) -> ElementForces:
        """Return the generalized forces of force elements, with the directions of springs by a function."""
        parameters = [parameter.name for parameter in self.system.parameters]
        names = Definitions(parameters, taken=self.symbols.reserved)
        return ElementForces(self.system, self.symbols, self.bodies, names, self.intermediates, direction)

    @property
    def _start(self) -> dict[Symbol, Expr]:
        """The default values of the parameters, as exact numbers."""
        return {parameter(each): Rational(repr(each.value)) for each in self.system.parameters}

    @cached_property
    def definitions(self) -> tuple[Definition, ...]:
        """The definitions of all intermediates in order of evaluation.

        If `intermediates` is False, only parts of long expressions of force elements have names.
        """
        of_bodies = tuple(definition for body in self.bodies for definition in body.definitions)
        return of_bodies + self._elements.definitions

    def closed_form(self, everywhere: bool = False) -> ClosedForm:
        """Return [A] and {f} without intermediates, simplified.

        A spring whose ends stay on a line has a direction that jumps where they meet. By default the form has
        the direction of {x} = {0} and says where that is right, in `conditions`.

        Example:
            equations = kg.derive(kg.load("models/double_pendulum.toml"))
            equations.closed_form().A[0, 1]  # l2*m2*(l1*cos(q2) + l2)

        Args:
            everywhere: Whether the form must hold in every state, with the signs of such lengths in it.

        Raises:
            OptionError: If there are more than `MOST_FREEDOMS` freedoms or there is a quaternion, or an entry
                is too long to read.
        """
        if len(self.y) > MOST_FREEDOMS:
            raise OptionError(
                f"system {self.system.name!r} has {len(self.y)} freedoms; closed forms are written for at "
                f"most {MOST_FREEDOMS}. Read equations.A, equations.f and equations.definitions instead."
            )
        others = [
            body.joint.coordinates for body in self.system.bodies if body.joint.coordinates != ORIENTATIONS[0]
        ]
        if others:
            raise OptionError(
                f"system {self.system.name!r} has a {others[0]}; closed forms are written in sines and "
                'cosines. Take the coordinates "angles", or read equations.A, equations.f and '
                "equations.definitions."
            )
        literal = derive(self.system, intermediates=False)
        system, numbers = with_named_numbers(self.system)
        named = literal if system is self.system else derive(system, intermediates=False)
        motion = [*literal.y, *self.loads, *self.prescribed[1:, :]]
        simplifier = Simplifier(literal.bodies, motion, numbers)
        directions = Directions(simplifier, named._start, everywhere)
        f = total([*(body.forcing for body in named.bodies), named._motors.forcing])
        forces = named._element_forces_along(directions.along)
        if forces.definitions:
            raise OptionError(
                f"system {self.system.name!r}: what its force elements add is too long to be read without "
                "intermediates. Print it with intermediates instead (closed=False), or read equations.A, "
                "equations.f and equations.definitions."
            )
        A, f = close(simplifier, named.A, f, forces.total, lambda: literal.element_forces)
        return ClosedForm(A, f, tuple(dict.fromkeys(directions.conditions)))

    def lambdify(self) -> NumericEquations:
        """Return NumPy functions of [A] and {f} for small tasks; the library of `kg.build` is faster by far.

        Example:
            equations = kg.derive(kg.load("models/double_pendulum.toml"))
            equations.lambdify().forcing([0.1, 0.2], [0.0, 0.0])
        """
        return numeric(self.system, self.symbols, self.A, self.f, self.definitions)


def derive(system: System, intermediates: bool | None = None) -> Equations:
    """Derive Kane's equations of `system` in SymPy.

    Example:
        equations = derive(kg.load("models/eight_body.toml"), intermediates=True)
        equations.definitions[0]

    Args:
        system: A tree of bodies.
        intermediates: Whether to name intermediate quantities by symbols; by default, only if there are more
            than `MOST_FREEDOMS_WITHOUT_NAMES` freedoms.

    Returns:
        The equations; their matrices are derived when they are first read.
    """
    if intermediates is None:
        intermediates = len(system.freedoms) > MOST_FREEDOMS_WITHOUT_NAMES
    symbols = of_system(system)
    taken = symbols.reserved.union(parameter.name for parameter in system.parameters)
    bodies: list[BodyEquations] = []
    for number, body in enumerate(system.bodies, start=1):
        lower = bodies[body.lower - 1] if body.lower else None
        names = Intermediates(number, body.lower, intermediates, taken)
        bodies.append(BodyEquations(number, system, lower, symbols, names))
    return Equations(system, symbols, intermediates, tuple(bodies))
