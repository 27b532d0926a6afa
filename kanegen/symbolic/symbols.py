"""All SymPy symbols are made here, so that one name always means one symbol; shared by both derivations.

`theta_K_i`, `s_K_i`, `epsilon_K_i` are coordinates, `thetadot_K_i`, `sdot_K_i`, `epsilondot_K_i` their rates,
`omegahat_K_i` components of relative angular velocities, `thetaddot_K_i`, `sddot_K_i`, `omegahatdot_K_i` the
rates of speeds, `F_K_i`, `M_K_i` loads; bodies K and components i count from 1, those of epsilon from 0. A
parameter is the symbol of its own name. Every symbol is real.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import sympy
from sympy import Expr, Float, Integer, Symbol

from kanegen.model.freedoms import FREEDOMS, QUATERNION
from kanegen.model.numbers import Number, Parameter
from kanegen.model.system import System

WHOLE = 2**31
"""Whole numbers below this size become exact integers; larger ones stay binary floating-point numbers."""


def coordinate(body: int, index: int) -> Symbol:
    """Return the coordinate of freedom `index` (0 to 5, as in `FREEDOMS`) of `body`, from 1 (rad, m)."""
    return _freedom("theta", "s", body, index)


def quaternion(body: int) -> tuple[Symbol, ...]:
    """Return the elements e0, e1, e2, e3 of the quaternion of `body`, from 1."""
    return tuple(real(f"epsilon_{body}_{i}") for i in range(len(QUATERNION)))


def quaternion_rate(body: int) -> tuple[Symbol, ...]:
    """Return the time derivatives of the elements of the quaternion of `body` (1/s)."""
    return tuple(real(f"epsilondot_{body}_{i}") for i in range(len(QUATERNION)))


def coordinates(system: System) -> tuple[Symbol, ...]:
    """Return the coordinates {x}."""
    return _elements(system, coordinate, quaternion)


def coordinate_rates(system: System) -> tuple[Symbol, ...]:
    """Return the symbols of {xdot}, the time derivatives of the coordinates."""
    return _elements(system, speed, quaternion_rate)


def speed(body: int, index: int) -> Symbol:
    """Return the time derivative of `coordinate(body, index)` (rad/s, m/s)."""
    return _freedom("thetadot", "sdot", body, index)


def acceleration(body: int, index: int) -> Symbol:
    """Return the time derivative of `speed(body, index)` (rad/s^2, m/s^2)."""
    return _freedom("thetaddot", "sddot", body, index)


def relative_angular_velocity(body: int, axis: int) -> Symbol:
    """Return component `axis` (0 to 2) of the relative angular velocity of Eq. (8), in the body (rad/s)."""
    return real(f"omegahat_{body}_{axis + 1}")


def relative_angular_velocity_rate(body: int, axis: int) -> Symbol:
    """Return the time derivative of `relative_angular_velocity(body, axis)` (rad/s^2)."""
    return real(f"omegahatdot_{body}_{axis + 1}")


def speeds(system: System) -> tuple[Symbol, ...]:
    """Return the generalized speeds {y}."""
    return tuple(
        relative_angular_velocity(f.body, f.axis) if system.spins(f) else speed(f.body, f.index)
        for f in system.freedoms
    )


def accelerations(system: System) -> tuple[Symbol, ...]:
    """Return the symbols of {ydot}, the time derivatives of the generalized speeds."""
    return tuple(
        relative_angular_velocity_rate(f.body, f.axis) if system.spins(f) else acceleration(f.body, f.index)
        for f in system.freedoms
    )


def prescribed(system: System) -> tuple[Symbol, ...]:
    """Return the symbols of prescribed freedoms: all values, then all rates, then all second derivatives."""
    places = [(freedom.body, freedom.index) for freedom in system.prescribed]
    return tuple(symbol(*place) for symbol in (coordinate, speed, acceleration) for place in places)


def force(body: int, axis: int) -> Symbol:
    """Return component `axis` (0 to 2) of {F'_K}, the force at G_K in body components (N)."""
    return real(f"F_{body}_{axis + 1}")


def torque(body: int, axis: int) -> Symbol:
    """Return component `axis` (0 to 2) of {M'_K}, the torque on body K in body components (N m)."""
    return real(f"M_{body}_{axis + 1}")


def point_force(number: int, axis: int) -> Symbol:
    """Return component `axis` (0 to 2) of the force at point `number`, from 1, in inertial components (N)."""
    return real(f"FP_{number}_{axis + 1}")


def point_moment(number: int, axis: int) -> Symbol:
    """Return component `axis` (0 to 2) of the moment on the body of a point, in inertial components (N m)."""
    return real(f"MP_{number}_{axis + 1}")


def time() -> Symbol:
    """Return the time (s)."""
    return real("t")


def generalized_force(body: int, index: int) -> Symbol:
    """Return the generalized force on freedom `index` of `body`, beside loads and gravity (N m, N)."""
    return real(f"tau_{body}_{index + 1}")


def parameter(value: Parameter) -> Symbol:
    """Return the symbol of a run-time parameter."""
    return real(value.name)


def expression(value: Number) -> Expr:
    """Return a number of a model in SymPy without rounding.

    A parameter is its symbol. A whole number below `WHOLE` is an `Integer`, so that zeros and ones vanish
    from products; every other float is a `Float` of the same 53 bits.
    """
    if isinstance(value, Parameter):
        return parameter(value)
    if value.is_integer() and abs(value) < WHOLE:
        return Integer(int(value))
    return Float(value, precision=53)


def column(values: Sequence[Number]) -> sympy.ImmutableMatrix:
    """Return numbers of a model as a column."""
    return sympy.ImmutableMatrix([expression(value) for value in values])


def matrix(values: Sequence[Sequence[Number]]) -> sympy.ImmutableMatrix:
    """Return numbers of a model, row by row, as a matrix."""
    return sympy.ImmutableMatrix([[expression(value) for value in row] for row in values])


def real(name: str) -> Symbol:
    """Return the real symbol of that name."""
    return Symbol(name, real=True)


def _elements(
    system: System, single: Callable[[int, int], Symbol], four: Callable[[int], Sequence[Symbol]]
) -> tuple[Symbol, ...]:
    """Return a symbol for each element of {x}.

    Args:
        system: The system with the coordinates.
        single: Makes the symbol of an angle or a translation from the body and the index of the freedom.
        four: Makes the four symbols of the quaternion of a body.
    """
    first = len(FREEDOMS)
    return tuple(
        single(c.body, c.index) if c.index < first else four(c.body)[c.index - first]
        for c in system.coordinates
    )


def _freedom(angle: str, translation: str, body: int, index: int) -> Symbol:
    """Return the symbol of a freedom, whose name begins with `angle` or `translation`."""
    return real(f"{angle if index < 3 else translation}_{body}_{index % 3 + 1}")
