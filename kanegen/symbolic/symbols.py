"""The symbols of the notes, of loads and of parameters; shared by both derivations.

`theta_K_i`, `s_K_i`, `epsilon_K_i` are coordinates, `thetadot_K_i`, `sdot_K_i`, `epsilondot_K_i` their rates,
`omegahat_K_i` components of relative angular velocities, `thetaddot_K_i`, `sddot_K_i`, `omegahatdot_K_i` the
rates of speeds, `F_K_i`, `M_K_i` loads; bodies K and components i count from 1, those of epsilon from 0. A
parameter is the symbol of the same name. One name always means one symbol, and every symbol is real.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy
from sympy import Expr, Float, Integer, Symbol

from kanegen.model.coordinates import COORDINATE_KINDS, SPEED_KINDS, Rotation
from kanegen.model.expression import Expression
from kanegen.model.numbers import Number, Parameter
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.operations import of_parameters

EXACT_INTEGER_LIMIT = 2**31
"""Whole numbers below this size become exact integers; larger ones stay binary floating-point numbers."""


def coordinate(body: int, kind: int) -> Symbol:
    """Return a coordinate of `body` (from 1); `kind` counts `COORDINATE_KINDS` (rad, m, 1)."""
    entry = COORDINATE_KINDS[kind]
    return real(f"{entry.symbol}_{body}_{entry.number}")


def coordinate_rate(body: int, kind: int) -> Symbol:
    """Return the time derivative of `coordinate(body, kind)` (rad/s, m/s, 1/s)."""
    entry = COORDINATE_KINDS[kind]
    return real(f"{entry.symbol}dot_{body}_{entry.number}")


def rotation_coordinates(body: int, rotation: Rotation) -> tuple[Symbol, ...]:
    """Return the coordinates that orient `body` (from 1) in its joint frame."""
    return tuple(coordinate(body, kind) for kind in rotation.coordinates)


def speed(body: int, kind: int) -> Symbol:
    """Return a generalized speed of `body` (from 1); `kind` counts `SPEED_KINDS` (rad/s, m/s)."""
    entry = SPEED_KINDS[kind]
    return real(f"{entry.symbol}_{body}_{entry.number}")


def acceleration(body: int, kind: int) -> Symbol:
    """Return the time derivative of `speed(body, kind)` (rad/s^2, m/s^2)."""
    entry = SPEED_KINDS[kind]
    return real(f"{entry.derivative}_{body}_{entry.number}")


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
    """Return the symbol of the time (s)."""
    return real("t")


def generalized_force(body: int, index: int) -> Symbol:
    """Return the generalized force on freedom `index` of `body`, beside loads and gravity (N m, N)."""
    return real(f"tau_{body}_{index + 1}")


def parameter(value: Parameter) -> Symbol:
    """Return the symbol of a run-time parameter."""
    return real(value.name)


def expression(value: Number) -> Expr:
    """Return a number of a model in SymPy without rounding.

    A parameter is its symbol, and an expression of parameters one of their symbols, whose fractions stay
    fractions. A whole number below `EXACT_INTEGER_LIMIT` is an `Integer`, so that zeros and ones vanish from
    products; every other float is a `Float` of the same 53 bits.
    """
    if isinstance(value, Parameter):
        return parameter(value)
    if isinstance(value, Expression):
        return of_parameters(value, expression)
    if value.is_integer() and abs(value) < EXACT_INTEGER_LIMIT:
        return Integer(int(value))
    return Float(value, precision=53)


def column(values: Sequence[Number]) -> sympy.ImmutableMatrix:
    """Return numbers of a model as a column."""
    return FiniteMatrix([expression(value) for value in values])


def matrix(values: Sequence[Sequence[Number]]) -> sympy.ImmutableMatrix:
    """Return numbers of a model, row by row, as a matrix."""
    return FiniteMatrix([[expression(value) for value in row] for row in values])


def real(name: str) -> Symbol:
    """Return the real symbol of that name."""
    return Symbol(name, real=True)
