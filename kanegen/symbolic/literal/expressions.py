"""Expressions of force elements in SymPy."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import sympy
from sympy import Expr, S

from kanegen.errors import ModelError
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
from kanegen.model.freedoms import FREEDOMS
from kanegen.model.numbers import Number
from kanegen.model.system import System
from kanegen.symbolic.symbols import coordinate, quaternion, relative_angular_velocity, speed, time

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


@dataclass(frozen=True)
class Variables:
    """What names in force elements are in SymPy.

    Attributes:
        system: Of which.
        number: How its numbers are written.
        opened: Whether locked coordinates stay symbols.
    """

    system: System
    number: Callable[[Number], Expr]
    opened: bool = False

    def value(self, expression: Expression) -> Expr:
        """An expression.

        Raises:
            ModelError: If it divides by zero, or takes the root of a negative number, in every state.
        """
        return _existing(self._value(expression.root), expression)

    def slopes(self, energy: Expression) -> dict[Place, Expr]:
        """The derivatives of an energy by the coordinates that it depends on, locked ones included.

        Raises:
            ModelError: As `value`.
        """
        places = {name: self._places[name] for name in energy.variables}
        held = {coordinate(*place): self._coordinate(place) for place in places.values()}
        value = replace(self, opened=True).value(energy)
        return {
            place: _existing(sympy.diff(value, coordinate(*place)).xreplace(held), energy)
            for place in places.values()
        }

    def coordinate(self, name: str) -> Expr:
        """A coordinate, or the value at which it is locked."""
        return self._variable(f"x.{name}")

    def rate(self, name: str) -> Expr:
        """A speed; zero where it is locked."""
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
        k, index = place
        joint = self.system.bodies[k - 1].joint
        if index >= len(FREEDOMS):
            return quaternion(k)[index - len(FREEDOMS)]
        is_open = joint.moving[index] or self.opened
        return coordinate(k, index) if is_open else self.number(joint.locked[index])

    def _speed(self, place: Place) -> Expr:
        k, index = place
        joint = self.system.bodies[k - 1].joint
        if not joint.moving[index]:
            return S.Zero
        return relative_angular_velocity(k, index) if joint.spins and index < 3 else speed(k, index)


def _existing(value: Expr, expression: Expression) -> Expr:
    if value.has(sympy.zoo, sympy.nan, sympy.oo, sympy.I):
        raise ModelError(
            f"expression {str(expression)!r} has no value: in every state it divides by zero or takes the "
            "root of a negative number."
        )
    return value
