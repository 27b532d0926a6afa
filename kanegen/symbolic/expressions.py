"""The expressions of force elements in SymPy; shared by both derivations."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import sympy
from sympy import Expr, S

from kanegen.errors import ModelError
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.force_elements.expression import (
    TIME,
    Constant,
    Expression,
    Node,
    Operation,
    Power,
    Variable,
)
from kanegen.model.force_elements.names import Place, variable_places
from kanegen.model.numbers import Number
from kanegen.model.system import System
from kanegen.symbolic.symbols import coordinate, speed, time

_OPERATIONS: dict[str, Callable[..., Expr]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negate": operator.neg,
    "abs": sympy.Abs,
    "cos": sympy.cos,
    "sin": sympy.sin,
    "sqrt": sympy.sqrt,
    "tan": lambda angle: sympy.sin(angle) / sympy.cos(angle),
}
"""SymPy's functions for the operations of expressions."""


@dataclass(frozen=True)
class ExpressionTranslator:
    """Translates expressions of force elements, and the names of coordinates and speeds in them, to SymPy.

    Attributes:
        system: The system to which the force elements belong.
        number: Converts a number of the model to SymPy.
        keeps_locked: Whether locked coordinates stay symbols instead of becoming the numbers they are locked
            at.
    """

    system: System
    number: Callable[[Number], Expr]
    keeps_locked: bool = False

    def value(self, expression: Expression) -> Expr:
        """Return an expression in SymPy.

        Raises:
            ModelError: If the expression divides by zero, or takes the root of a negative number, in every
                state.
        """
        return _finite(self._value(expression.root), expression)

    def gradient(self, energy: Expression) -> dict[Place, Expr]:
        """Return the derivatives of an energy by its coordinates, also locked ones, by place (body, kind).

        Raises:
            ModelError: If a derivative divides by zero, or takes the root of a negative number, in every
                state.
        """
        places = {name: self._places[name] for name in energy.variables}
        locked = {coordinate(*place): self._coordinate(place) for place in places.values()}
        value = replace(self, keeps_locked=True).value(energy)
        return {
            place: _finite(sympy.diff(value, coordinate(*place)).xreplace(locked), energy)
            for place in places.values()
        }

    def coordinate(self, name: str) -> Expr:
        """Return the coordinate of that name (rad, m), or the value at which it is locked."""
        return self._variable(f"x.{name}")

    def speed(self, name: str) -> Expr:
        """Return the speed of that name (rad/s, m/s), zero where it is locked."""
        return self._variable(f"y.{name}")

    def _value(self, node: Node) -> Expr:
        match node:
            case Constant(value):
                return self.number(value)
            case Variable(name):
                return time() if name == TIME else self._variable(name)
            case Power(base, exponent):
                return self._value(base) ** exponent
            case Operation(name, operands):
                return _OPERATIONS[name](*map(self._value, operands))

    def _variable(self, name: str) -> Expr:
        place = self._places[name]
        return self._coordinate(place) if name.startswith("x.") else self._speed(place)

    @cached_property
    def _places(self) -> dict[str, Place]:
        return variable_places(self.system.bodies)

    def _coordinate(self, place: Place) -> Expr:
        k, kind = place
        joint = self.system.bodies[k - 1].joint
        is_symbol = kind >= len(FREEDOMS) or joint.moving[kind] or self.keeps_locked
        return coordinate(k, kind) if is_symbol else self.number(joint.locked[kind])

    def _speed(self, place: Place) -> Expr:
        k, index = place
        joint = self.system.bodies[k - 1].joint
        return speed(k, joint.speed_kinds[index]) if joint.moving[index] else S.Zero


def _finite(value: Expr, expression: Expression) -> Expr:
    """Return `value`, the translation of `expression`, after a test that it is finite and real."""
    if value.has(sympy.zoo, sympy.nan, sympy.oo, sympy.I):
        raise ModelError(
            f"expression {str(expression)!r} has no value: in every state it divides by zero or takes the "
            "root of a negative number."
        )
    return value
