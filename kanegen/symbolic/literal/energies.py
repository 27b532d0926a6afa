"""Kinetic and potential energy, momentum and mass centre of all bodies, as sums over the bodies."""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Add, Expr, ImmutableMatrix, S

from kanegen.model.system import System
from kanegen.symbolic.literal.dynamics import BodyEquations
from kanegen.symbolic.literal.motors import MotorEquations
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.symbols import column

HALF = S.Half


def kinetic_energy(bodies: Sequence[BodyEquations], motors: MotorEquations) -> Expr:
    """Return the sum of m v_G^2 / 2 + {omega}^T [I_G] {omega} / 2 over the bodies, and that of motors (J)."""
    terms = [motors.kinetic_energy]
    for body in bodies:
        v, omega = body.velocity_of_center, body.angular_velocity
        terms.append(HALF * body.mass * v.dot(v) + HALF * omega.dot(body.inertia * omega))
    return Add(*terms)


def gravity_energy(system: System, bodies: Sequence[BodyEquations]) -> Expr:
    """Return minus the sum of m g . p_G over the bodies (J)."""
    gravity = column(system.gravity)
    return Add(*(-body.mass * gravity.dot(_center(body)) for body in bodies))


def mass_center(bodies: Sequence[BodyEquations]) -> ImmutableMatrix:
    """Return the position of the mass centre of all bodies, (3, 1), inertial components (m)."""
    moment = sum((body.mass * _center(body) for body in bodies), FiniteMatrix.zeros(3, 1))
    return FiniteMatrix(moment / Add(*(body.mass for body in bodies)))


def linear_momentum(bodies: Sequence[BodyEquations]) -> ImmutableMatrix:
    """Return the sum of m {v_G} over the bodies, (3, 1), inertial components (kg m/s)."""
    parts = (body.mass * body.rotation.T * body.velocity_of_center for body in bodies)
    return FiniteMatrix(sum(parts, FiniteMatrix.zeros(3, 1)))


def angular_momentum(
    bodies: Sequence[BodyEquations], motors: MotorEquations, about: ImmutableMatrix
) -> ImmutableMatrix:
    """Return the angular momentum of all bodies about a point, (3, 1), inertial components (kg m^2/s).

    It is the sum of [I_G]{omega} + ({p_G} - {p}) x m {v_G}, and of the spin of rotors in their carriers.

    Args:
        bodies: The equations of the bodies.
        motors: The motors.
        about: (3, 1) position {p} of the point from the inertial origin, inertial components (m).
    """
    total = FiniteMatrix.zeros(3, 1)
    for body in bodies:
        velocity = body.mass * body.rotation.T * body.velocity_of_center
        total += body.rotation.T * body.inertia * body.angular_velocity
        total += (_center(body) - about).cross(velocity)
    for carrier, momentum in motors.spins:
        total += bodies[carrier - 1].rotation.T * momentum
    return FiniteMatrix(total)


def _center(body: BodyEquations) -> ImmutableMatrix:
    """Return {p_G} of a body from the inertial origin, (3, 1), inertial components (m)."""
    return FiniteMatrix(body.rotation.T * body.position_of_center)
