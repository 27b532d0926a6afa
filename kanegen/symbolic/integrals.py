"""Integrals of motion: energy, momenta of ignorable coordinates, and momenta of free trees.

A coordinate is ignorable where neither the energies nor the forces of elements depend on it; its generalized
momentum is then constant (Goldstein 2002, section 2.6). The proof is that the derivatives, expanded into
polynomials of sines and cosines, are zero. Momenta in space are constant where all bodies may be moved or
turned together, and nothing acts from the ground along that motion (Noether's theorem); this is read from the
joints, couplings, rotors and force elements. Every proof holds for all values of run-time parameters, not for
their defaults alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Protocol

import numpy as np
import sympy
from numpy.typing import ArrayLike, NDArray
from sympy import Expr, ImmutableMatrix, S, Symbol

from kanegen.errors import ArrayError, OptionError
from kanegen.model.arguments import floats
from kanegen.model.force_elements import Drive, JointFriction, JointSpring, PointLoad, Potential, Spring
from kanegen.model.system import System
from kanegen.symbolic import notebook
from kanegen.symbolic.closed.form import Simplifier
from kanegen.symbolic.literal.orientation import constant_orientation
from kanegen.symbolic.symbols import column, expression, parameter

AXES = (0, 1, 2)
"""Inertial axes, from 0."""

ROUNDING = 1e-12
"""Rounding errors of the entries of a constant orientation, which files give with all or most digits."""


@dataclass(frozen=True, eq=False)
class IntegralOfMotion:
    """A quantity that stays constant in every motion without efforts and loads as inputs.

    Attributes:
        name: Name, such as "energy" or "momentum of spin".
        expression: The quantity in SymPy (J, kg m^2/s or kg m/s).
        reason: Why it is constant.
        x: Symbols of the coordinates, (m,).
        y: Symbols of the generalized speeds, (n,).
        parameters: Default values of run-time parameters.
        names: LaTeX of the symbols, with which a notebook shows the quantity.
    """

    name: str
    expression: Expr
    reason: str
    x: tuple[Symbol, ...]
    y: tuple[Symbol, ...]
    parameters: Mapping[Symbol, float] = field(default_factory=dict)
    names: Mapping[Symbol, str] = field(default_factory=dict, repr=False)

    def _repr_latex_(self) -> str:
        """The quantity and why it is constant, for a notebook."""
        lines = notebook.equation(self.name, self.expression, self.names, "integral.expression")
        return notebook.display([*lines, f"&{notebook.words(f'is constant: {self.reason}')}"])

    def along(
        self, x: ArrayLike, y: ArrayLike, parameters: Mapping[str, float] | None = None
    ) -> NDArray[np.float64]:
        """Return the values in states, such as those of a trajectory.

        Args:
            x: (..., m) coordinates (rad, m, 1).
            y: (..., n) generalized speeds (rad/s, m/s).
            parameters: Values of run-time parameters by name; the others have their defaults.

        Returns:
            (...) values.

        Raises:
            ArrayError: If `x` and `y` do not fit each other or the system.
            OptionError: If there is no such parameter, or the quantity depends on a prescribed motion.

        Example:
            integral.along(trajectory.x, trajectory.y)
        """
        numbers = dict(self.parameters)
        numbers |= {parameter_of(name, numbers): value for name, value in (parameters or {}).items()}
        value = self.expression.xreplace(numbers)
        if others := sorted(map(str, value.free_symbols - {*self.x, *self.y})):
            raise OptionError(
                f"{self.name}: it depends on the prescribed motion {', '.join(others)} as well. Replace "
                "these symbols in its `expression` by their values."
            )
        places, speeds = row_by_row("x", x, len(self.x)), row_by_row("y", y, len(self.y))
        if places.shape[:-1] != speeds.shape[:-1]:
            raise ArrayError(f"y: expected as many states as x has, {places.shape}, got {speeds.shape}.")
        states = np.concatenate([places, speeds], axis=-1)
        function = sympy.lambdify((*self.x, *self.y), value, "numpy")
        found = function(*np.moveaxis(states, -1, 0))
        return np.broadcast_to(np.asarray(found, np.float64), states.shape[:-1])


def row_by_row(name: str, values: ArrayLike, length: int) -> NDArray[np.float64]:
    """Return values of states, (..., length).

    Raises:
        ArrayError: If they are no real numbers or their last axis has another length.
    """
    array: NDArray[np.float64] = np.asarray(floats(name, values, np.dtype(np.float64)))
    if not array.ndim or array.shape[-1] != length:
        raise ArrayError(f"{name}: expected shape (..., {length}), got {array.shape}.")
    return array


def parameter_of(name: str, known: Mapping[Symbol, float]) -> Symbol:
    """Return the symbol of a parameter by its name.

    Raises:
        OptionError: If there is no such parameter.
    """
    for symbol in known:
        if symbol.name == name:
            return symbol
    raise OptionError(f"parameters: there is no {name!r}. Known are {', '.join(map(str, known)) or 'none'}.")


class Derivation(Protocol):
    """Equations of motion without intermediates, such as `Equations`."""

    @property
    def latex_names(self) -> Mapping[Symbol, str]:
        """LaTeX by symbol, for all symbols of the equations."""

    @property
    def x(self) -> ImmutableMatrix:
        """(m, 1) symbols of the coordinates."""

    @property
    def y(self) -> ImmutableMatrix:
        """(n, 1) symbols of the speeds."""

    @property
    def kinetic_energy(self) -> Expr:
        """Kinetic energy of bodies and motors (J)."""

    @property
    def potential_energy(self) -> Expr:
        """Potential energy of gravity and of force elements (J)."""

    @property
    def gravity_energy(self) -> Expr:
        """Potential energy of gravity alone (J)."""

    @property
    def element_forces(self) -> ImmutableMatrix:
        """(n, 1) generalized forces of force elements and loads."""

    @property
    def loads(self) -> tuple[Symbol, ...]:
        """Symbols of loads on bodies."""

    @property
    def momentum(self) -> ImmutableMatrix:
        """(6, 1) linear momentum, and angular momentum about the mass centre."""

    def angular_momentum(self, about: ImmutableMatrix) -> ImmutableMatrix:
        """Return (3, 1) angular momentum about a point, inertial components."""


@dataclass(frozen=True)
class Integrals:
    """The integrals of motion of a system.

    Attributes:
        system: The system.
        equations: Its equations without intermediates; numbers may be symbols.
        simplifier: Simplifies expressions, and puts numbers in the place of their symbols.
        readable: Whether expressions are short enough after it, as without quaternions.
    """

    system: System
    equations: Derivation
    simplifier: Simplifier
    readable: bool

    def found(self) -> tuple[IntegralOfMotion, ...]:
        """Return the integrals, each once."""
        integrals: list[IntegralOfMotion] = []
        for name, value, reason in (*self._energy(), *self._ignorable(), *self._in_space()):
            short = self._short(value)
            known = [one.expression for one in integrals]
            if short != 0 and not any(self._is_zero(short - s * one) for one in known for s in (1, -1)):
                x, y = tuple(self.equations.x), tuple(self.equations.y)
                defaults = {parameter(one): one.value for one in self.system.parameters}
                names = self.equations.latex_names
                integrals.append(IntegralOfMotion(name, short, reason, x, y, defaults, names))
        return tuple(integrals)

    def _energy(self) -> Iterator[tuple[str, Expr, str]]:
        """Yield the energy, if nothing dissipates it, drives or prescribes a motion."""
        if not self.system.prescribed and not any(map(_does_work, self.system.force_elements)):
            energy = self.equations.kinetic_energy + self.equations.potential_energy
            yield "energy", energy, "only gravity, springs and potentials act"

    def _ignorable(self) -> Iterator[tuple[str, Expr, str]]:
        """Yield the generalized momenta of coordinates on which nothing depends."""
        T, V = self.equations.kinetic_energy, self.equations.gravity_energy
        forces = self.equations.element_forces.xreplace(self._without_loads)
        for place, (speed, name) in enumerate(
            zip(self.system.speeds, self.system.freedom_names, strict=True)
        ):
            if not speed.kind.is_rate:
                continue
            coordinate = self.equations.x[self.system.coordinate_names.index(name)]
            depends = (T.diff(coordinate), V.diff(coordinate), forces[place])
            if all(map(self._is_zero, depends)):
                momentum = T.diff(self.equations.y[place])
                yield f"momentum of {name}", momentum, f"{name} is ignorable"

    def _in_space(self) -> Iterator[tuple[str, Expr, str]]:
        """Yield momenta in space that stay constant because all bodies may be moved or turned together."""
        gravity = [expression(one) for one in self.system.gravity]
        if not self._acts_from_ground(range(6)) and self._is_floating:
            for k in AXES:
                name = f"angular momentum about the mass centre, axis {k + 1}"
                yield name, self.equations.momentum[3 + k], "the tree floats freely"
        for k in AXES:
            shifts = all(self._may_shift(body, k) for body in self._roots)
            if shifts and vanishes(gravity[k]) and not self._acts_from_ground((3, 4, 5)):
                yield (
                    f"linear momentum, axis {k + 1}",
                    self.equations.momentum[k],
                    "nothing acts along this axis",
                )
        point = column(self.system.bodies[self._roots[0] - 1].joint.position)
        for k in AXES:
            about_gravity = all(vanishes(value) for axis, value in enumerate(gravity) if axis != k)
            turns = all(self._may_turn(body, k) for body in self._roots)
            if turns and about_gravity and not self._acts_from_ground(range(6)):
                momentum = self.equations.angular_momentum(point)[k]
                joint = self.system.bodies[self._roots[0] - 1].name
                name = f"angular momentum about axis {k + 1} through the joint of {joint}"
                yield name, momentum, "nothing turns the tree about this axis"

    @cached_property
    def _roots(self) -> list[int]:
        """Numbers of the bodies that are joined to the ground."""
        return [k for k, body in enumerate(self.system.bodies, start=1) if body.lower == 0]

    @property
    def _is_floating(self) -> bool:
        """Whether the tree has one joint to the ground, with six freedoms."""
        return len(self._roots) == 1 and all(self.system.bodies[self._roots[0] - 1].joint.free)

    def _may_shift(self, body: int, axis: int) -> bool:
        """Return whether the joint of a body to the ground lets it move along an inertial axis."""
        joint = self.system.bodies[body - 1].joint
        rows = constant_orientation(joint.orientation)
        return all(joint.free[3 + i] or vanishes(rows[i, axis], ROUNDING) for i in AXES)

    def _may_turn(self, body: int, axis: int) -> bool:
        """Return whether the joint of a body to the ground always lets it turn about an inertial axis."""
        joint = self.system.bodies[body - 1].joint
        rows = constant_orientation(joint.orientation)
        if not all(joint.free[:3]):
            first = next((i for i in AXES if joint.moving[i]), None)
            if first is None or not joint.free[first] or any(v != 0 for v in joint.locked[:first]):
                return False
            if not is_along(rows.row(joint.axes[first]), axis):
                return False
        if all(joint.free[3:]):
            return True
        slides = all(is_along(rows.row(i), axis) for i in AXES if joint.free[3 + i])
        apart = column(joint.position) - column(self.system.bodies[self._roots[0] - 1].joint.position)
        still = all(value == 0 for value in joint.locked[3:])
        return slides and still and is_along(apart, axis, tolerance=0)

    def _acts_from_ground(self, indices: Sequence[int]) -> bool:
        """Return whether anything acts between the ground and a body, along some freedoms of such joints.

        A rotor that such a freedom drives acts on it from the ground, and so does whatever is coupled to it.
        """
        bodies = [self.system.bodies[k - 1] for k in self._roots]
        if any(body.joint.prescribed[i] or body.joint.coupled[i] for body in bodies for i in range(6)):
            return True
        if any(body.joint.armature[i] != 0 for body in bodies for i in indices):
            return True
        driving = [one.freedom for one in self.system.mounted_rotors]
        driving += [freedom for one in self.system.coupled for freedom, _ in one.terms]
        if any(freedom.body in self._roots and freedom.index in indices for freedom in driving):
            return True
        names = {body.name for body in bodies}
        return any(self._is_grounded(element, names) for element in self.system.force_elements)

    def _is_grounded(self, element: Any, names: set[str]) -> bool:
        """Return whether a force element acts between the ground and one of the bodies on it, by name."""
        match element:
            case JointSpring(freedom=name) | Drive(freedom=name) | JointFriction(freedom=name):
                return body_of(name) in names
            case Potential(energy):
                return any(body_of(one.partition(".")[2]) in names for one in energy.variables)
            case PointLoad():
                return True
            case Spring(between=ends):
                return any(not isinstance(end, str) or self.system.place(end)[0] == 0 for end in ends)
        return True

    @property
    def _without_loads(self) -> dict[Symbol, Expr]:
        """Zeros in the place of loads, which are inputs."""
        symbols = {s for s in self.equations.element_forces.free_symbols if s.name.startswith(("FP_", "MP_"))}
        return dict.fromkeys((*symbols, *self.equations.loads), S.Zero)

    def _is_zero(self, value: Expr) -> bool:
        """Return whether an expression is proven to be zero."""
        if value == 0:
            return True
        try:
            return not self.simplifier.expand(value)
        except OptionError:  # it is too long
            return False

    def _short(self, value: Expr) -> Expr:
        """Return an expression in its short form, where it has one."""
        try:
            return self.simplifier.simplify(value) if self.readable else value
        except OptionError:
            return value


def vanishes(value: Expr, tolerance: float = 0.0) -> bool:
    """Return whether an expression is zero whatever its symbols are, or a number within a tolerance of it."""
    return bool(value.is_zero) or (not value.free_symbols and abs(float(value)) <= tolerance)


def is_along(vector: ImmutableMatrix, axis: int, tolerance: float = ROUNDING) -> bool:
    """Return whether a vector has no component beside one of the axes, whatever its symbols are."""
    return all(vanishes(value, tolerance) for i, value in enumerate(vector) if i != axis)


def body_of(name: str) -> str:
    """Return the body of a coordinate or freedom by its name, `<body>.<freedom>`."""
    return name.rpartition(".")[0]


def _does_work(element: Any) -> bool:
    """Return whether an element may add or remove energy beside what it stores."""
    match element:
        case JointSpring(damping=damping) | Spring(damping=damping):
            return damping != 0
        case Potential():
            return False
    return True
