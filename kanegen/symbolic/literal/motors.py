"""What motors add to [A] and {f}: reflected inertias, and rotors that spin in the bodies that carry them.

A rotor of inertia J about the unit vector {e}, fixed in carrier C, with the gear ratio n, has the angular
momentum {h} y more than if it stood still in C, where {h} = J n {e} and y is the rate of the freedom that it
drives. Its time derivative is {h} {ydot} + {omega_C} x {h} y, and a torque J n ({e}^T {domega_C/dt} +
n {ydot}) at the freedom spins it, Eqs. (40), (41).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from sympy import Add, Expr, ImmutableMatrix, S

from kanegen.model.coordinates import Freedom
from kanegen.model.rotor import MountedRotor
from kanegen.model.system import System
from kanegen.symbolic.freedom_motion import FreedomMotions
from kanegen.symbolic.literal.dynamics import BodyEquations, total
from kanegen.symbolic.literal.frames import frame_equations
from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.state_symbols import StateSymbols
from kanegen.symbolic.symbols import column, expression


@dataclass(frozen=True, eq=False)
class MotorEquations:
    """What the motors of a system add to its equations.

    Attributes:
        system: The tree.
        symbols: The symbols of coordinates and speeds.
        bodies: The equations of its bodies.
    """

    system: System
    symbols: StateSymbols
    bodies: Sequence[BodyEquations]

    @property
    def mass_matrix(self) -> ImmutableMatrix:
        """(n, n) the part of [A] that belongs to motors.

        A coupled freedom with the factor a_i on freedom i adds its reflected inertia times a_i a_j.
        """
        parts = [inertia * rates * rates.T for inertia, rates in self._reflected()]
        return total([FiniteMatrix.zeros(self._n, self._n), *parts, *self._coupled()])

    @property
    def forcing(self) -> ImmutableMatrix:
        """(n, 1) the part of {f} that belongs to rotors, and to motors that prescribed motion accelerates."""
        return total([FiniteMatrix.zeros(self._n, 1), *self._accelerated(), *self._required()])

    @property
    def kinetic_energy(self) -> Expr:
        """Kinetic energy of motors beside that of rotors that stand still in their carriers (J).

        A reflected inertia J has J y^2 / 2, and a rotor {h}^T {omega_C} y beside that.
        """
        reflected = [inertia * self._speed(one) ** 2 / 2 for one, inertia in self._inertias()]
        return Add(*reflected, *(self.bodies[k - 1].angular_velocity.dot(spin) for k, spin in self.spins))

    def _speed(self, freedom: Freedom) -> Expr:
        """Return the speed against which a reflected inertia acts: a rate, or a component of omega_hat."""
        if freedom in self.system.places:
            speed = self.system.speed_of(freedom)
            return self.symbols.speed(speed.body, speed.index)
        return self._motions.speed(freedom)

    @property
    def spins(self) -> Iterator[tuple[int, ImmutableMatrix]]:
        """Number of the carrier of each rotor, and the angular momentum {h} y of its spin, (3, 1), there."""
        for one, _, momentum in self._spinning():
            yield one.body, momentum * self._motions.speed(one.freedom)

    @property
    def _n(self) -> int:
        """The number of free freedoms."""
        return len(self.system.freedoms)

    @cached_property
    def _motions(self) -> FreedomMotions:
        """The motion of all freedoms, coupled ones by those that they follow."""
        return FreedomMotions(self.system, expression, self.symbols)

    def _inertias(self) -> Iterator[tuple[Freedom, Expr]]:
        """Yield each freedom that moves with the reflected inertia of its motor, or of a rotor."""
        for freedom in self.system.moving_places:
            yield freedom, expression(self.system.bodies[freedom.body - 1].joint.armature[freedom.index])
        for one in self.system.mounted_rotors:
            if one.freedom in self.system.moving_places:
                yield one.freedom, expression(one.rotor.inertia) * expression(one.rotor.ratio) ** 2

    def _reflected(self) -> Iterator[tuple[Expr, ImmutableMatrix]]:
        """Yield reflected inertias with the (n, 1) rates of their freedoms for unit {y}."""
        for freedom, inertia in self._inertias():
            if inertia != 0:
                yield inertia, self._rates(freedom)

    def _accelerated(self) -> Iterator[ImmutableMatrix]:
        """Yield the inertia forces of reflected inertias that prescribed motion accelerates."""
        for freedom, inertia in self._inertias():
            if inertia != 0:
                yield -inertia * self._prescribed_acceleration(freedom) * self._rates(freedom)

    def _coupled(self) -> Iterator[ImmutableMatrix]:
        """Yield what couples rotors with the rotation of their carriers in [A], Eq. (43)."""
        for one, rates, momentum in self._spinning():
            row = momentum.T * self.bodies[one.body - 1].partial_angular_velocity
            yield rates * row + row.T * rates.T

    def _required(self) -> Iterator[ImmutableMatrix]:
        """Yield what couples rotors with the rotation of their carriers in {f}, Eq. (44)."""
        for one, rates, momentum in self._spinning():
            carrier, rate = self.bodies[one.body - 1], self._motions.speed(one.freedom)
            moment = momentum * self._prescribed_acceleration(one.freedom)
            moment += skew(carrier.angular_velocity) * momentum * rate
            about_axis = momentum.dot(carrier.angular_acceleration_bias)
            yield -carrier.partial_angular_velocity.T * moment - rates * about_axis

    def _spinning(self) -> Iterator[tuple[MountedRotor, ImmutableMatrix, ImmutableMatrix]]:
        """Yield each rotor in a body, with the (n, 1) rates of its freedom for unit {y} and (3, 1) {h}."""
        for one in self.system.mounted_rotors:
            if one.body and one.freedom in self.system.moving_places:
                size = expression(one.rotor.inertia) * expression(one.rotor.ratio)
                axis = frame_equations(self.system, one.frame).rotation.T * column(one.direction)
                yield one, self._rates(one.freedom), size * axis

    def _rates(self, freedom: Freedom) -> ImmutableMatrix:
        """Return the (n, 1) rates of a freedom for unit {y}."""
        shares = self._motions.shares(freedom)
        return FiniteMatrix(self._n, 1, [shares.get(one, S.Zero) for one in self.system.freedoms])

    def _prescribed_acceleration(self, freedom: Freedom) -> Expr:
        """Return the part of the second derivative of a freedom that prescribed motion causes."""
        shares = self._motions.shares(freedom).items()
        acceleration = self.symbols.acceleration
        driven = (share * acceleration(f.body, f.index) for f, share in shares if f not in self.system.places)
        return Add(*driven)
