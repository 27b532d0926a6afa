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

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

from sympy import Expr, ImmutableMatrix, Rational, Symbol

from kanegen.errors import OptionError, counted
from kanegen.model.coordinates import ORIENTATIONS
from kanegen.model.system import System
from kanegen.symbolic import notebook
from kanegen.symbolic.closed.directions import Directions
from kanegen.symbolic.closed.form import ClosedForm, Simplifier, close
from kanegen.symbolic.closed.named_numbers import with_named_numbers
from kanegen.symbolic.definitions import Definition, Definitions
from kanegen.symbolic.integrals import IntegralOfMotion, Integrals
from kanegen.symbolic.linear.linearization import linear_model
from kanegen.symbolic.linear.outputs import Quantity, of_points
from kanegen.symbolic.linear.state import State, Values
from kanegen.symbolic.linear.symbolic_model import SymbolicLinearModel
from kanegen.symbolic.literal import energies
from kanegen.symbolic.literal.dynamics import BodyEquations, total
from kanegen.symbolic.literal.force_elements import Direction, ElementForces
from kanegen.symbolic.literal.intermediates import Intermediates
from kanegen.symbolic.literal.motors import MotorEquations
from kanegen.symbolic.literal.numeric import NumericEquations, numeric
from kanegen.symbolic.printers import latex_names
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

    def _repr_latex_(self) -> str:
        """[A] and {f} for a notebook: the closed form of a small tree, else entries with intermediates."""
        return notebook.display([r"[A]\,\lbrace\dot{y}\rbrace &= \lbrace f\rbrace", *self._shown()])

    def _shown(self) -> Iterator[str]:
        """Return the lines of [A] and {f} that a notebook shows."""
        if len(self.x) <= MOST_FREEDOMS_WITHOUT_NAMES:
            with suppress(OptionError):
                return self.closed_form().lines("equations.closed_form()")
        named = self if self.intermediates else derive(self.system, intermediates=True)
        return ClosedForm(named.A, named.f, names=named.latex_names).lines("equations")

    @cached_property
    def latex_names(self) -> Mapping[Symbol, str]:
        """The LaTeX of the symbols of coordinates, speeds, loads, intermediates and parameters."""
        return latex_names(self.system, self.symbols, self.bodies)

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

    @cached_property
    def kinetic_energy(self) -> Expr:
        """T, the kinetic energy of bodies and motors (J), from velocities by Eqs. (11), (27)."""
        return energies.kinetic_energy(self.bodies, self._motors)

    @cached_property
    def potential_energy(self) -> Expr:
        """V, the potential energy of gravity, Eq. (23), and of springs and potentials (J).

        That of gravity is zero where all mass centres are at the inertial origin.
        """
        return self.gravity_energy + self._elements.stored_energy

    @cached_property
    def gravity_energy(self) -> Expr:
        """The part of V from gravity, minus the sum of m g . p_G over the bodies (J)."""
        return energies.gravity_energy(self.system, self.bodies)

    @cached_property
    def generalized_momenta(self) -> ImmutableMatrix:
        """{p} = [A]{y}, (n, 1): derivatives of T by the speeds (kg m^2/s, kg m/s).

        Prescribed motions add terms without {y} to the derivatives of T, which [A]{y} leaves out.
        """
        return ImmutableMatrix(self.A * self.y)

    @cached_property
    def mass_center(self) -> ImmutableMatrix:
        """{p_C}, (3, 1): the mass centre of all bodies, inertial components (m)."""
        return energies.mass_center(self.bodies)

    @cached_property
    def momentum(self) -> ImmutableMatrix:
        """(6, 1) linear momentum (kg m/s), then angular momentum about the mass centre (kg m^2/s).

        Components are inertial.
        """
        angular = self.angular_momentum(self.mass_center)
        return ImmutableMatrix.vstack(energies.linear_momentum(self.bodies), angular)

    def angular_momentum(self, about: ImmutableMatrix) -> ImmutableMatrix:
        """Return the angular momentum of all bodies about a point, (3, 1) (kg m^2/s).

        Args:
            about: (3, 1) position of the point from the inertial origin, inertial components (m).

        Example:
            equations.angular_momentum(sympy.zeros(3, 1))[2]
        """
        return energies.angular_momentum(self.bodies, self._motors, about)

    def point_position(self, name: str) -> ImmutableMatrix:
        """Return {p_P} of a point or frame, Eq. (22), (3, 1), inertial components (m).

        Example:
            equations.point_position("tip")[2]
        """
        return self._elements.point(name)[0]

    def point_velocity(self, name: str) -> ImmutableMatrix:
        """Return {v_P} of a point or frame, Eq. (27), (3, 1), inertial components (m/s).

        Example:
            equations.point_velocity("tip")[2]
        """
        return self._elements.point(name)[1]

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """Outputs of the table that have an expression here, by name."""
        points = self.system.point_names
        return {
            "point_positions": lambda: of_points(points, self.point_position),
            "point_velocities": lambda: of_points(points, self.point_velocity),
            "kinetic_energy": lambda: self.kinetic_energy,
            "potential_energy": lambda: self.potential_energy,
            "momentum": lambda: self.momentum,
            "mass_center": lambda: self.mass_center,
        }

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

    @property
    def definitions(self) -> tuple[Definition, ...]:
        """The definitions of all intermediates in order of evaluation.

        If `intermediates` is False, only parts of long expressions of force elements have names. Energies and
        points that were asked for may add some at the end.
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
        turned = [body.joint.orientation for body in self.system.bodies]
        kept = turned == [body.joint.orientation for body in system.bodies]
        simplifier = Simplifier((named if kept else literal).bodies, motion, numbers)
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
        return ClosedForm(A, f, tuple(dict.fromkeys(directions.conditions)), named.latex_names)

    def linearize(
        self,
        x: Values = None,
        y: Values = None,
        tau: Values = None,
        *,
        inputs: Iterable[str] | str | None = None,
        outputs: Iterable[str] | str = (),
        prescribed: Values = None,
    ) -> SymbolicLinearModel:
        """Return the linear model of small deviations from a state, in symbols.

        Values of the state are numbers, SymPy expressions or symbols, all in order or some by name. A float
        counts as the shortest decimal number that reads back to it, and one that is nearest to a multiple of
        pi/2 as that multiple where it is an angle. A symbol stands for values at which no force jumps.
        Prescribed motions are held at their values, loads are zero, and the time is the symbol t.

        Args:
            x: (m,) coordinates (rad, m, 1); those that are not given are neutral, see
                `System.neutral_coordinates`.
            y: (n,) generalized speeds (rad/s, m/s); those that are not given are 0.
            tau: (n,) generalized forces (N m, N); those that are not given are 0.
            inputs: Names of the freedoms on which a control acts; by default all of them.
            outputs: Names of outputs such as "point_positions" or "kinetic_energy", or of single states such
                as "x.pole".
            prescribed: (p,) values of prescribed freedoms, or (3 p,) with their rates and second derivatives;
                those that are not given are 0.

        Raises:
            ArrayError: If there is another number of values than of names.
            OptionError: If a name does not exist, or something is undefined in the state.
            SingularError: If [A] is singular in the state.

        Example:
            model = kg.derive(system).linearize({"pole": sympy.pi}, inputs=["cart_position"])
            model.A
        """
        system, numbers = with_named_numbers(self.system)
        state = State.of(self.system, x, y, tau, prescribed)
        return linear_model(derive(system, intermediates=True), state, numbers.values, inputs, outputs)

    def integrals_of_motion(self) -> tuple[IntegralOfMotion, ...]:
        """Return what stays constant in every motion without efforts and loads: energy and momenta.

        These are the energy, generalized momenta of ignorable coordinates, and momenta in space, as far as
        they are proven from the structure and from derivatives that are zero. A motion may have others.

        Raises:
            OptionError: If there are more than `MOST_FREEDOMS` freedoms.

        Example:
            for one in kg.derive(kg.load("models/spinning_top.toml")).integrals_of_motion():
                print(one.name, one.expression, one.reason)
        """
        if len(self.y) > MOST_FREEDOMS:
            raise OptionError(
                f"system {self.system.name!r} has {len(self.y)} freedoms; integrals of motion are written "
                f"for at most {MOST_FREEDOMS}."
            )
        literal = derive(self.system, intermediates=False)
        system, numbers = with_named_numbers(self.system)
        simplifier = Simplifier(literal.bodies, [*literal.y, *self.prescribed[1:, :]], numbers)
        readable = len(self.x) == len(self.y)  # without quaternions
        named = derive(system, intermediates=False) if readable else literal
        return Integrals(self.system, named, simplifier, readable).found()

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
