"""Expressions of force elements: their values, their slopes, and bounds on the rounding of both.

An expression is evaluated in any arithmetic that has the operations of the grammar: in NumPy numbers, in
`Dual` numbers, which carry a slope along (forward-mode differentiation by one variable), and in `Rounded`
numbers, which carry a bound on their rounding error (running error analysis, Higham 2002, section 3.3). A
dual number may be made of rounded ones. Nothing is shared with the derivation that becomes C but the parsed
expression.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from kanegen.model.force_elements.expression import Constant, Expression, Leaf, Operation, Power, folded
from kanegen.model.numbers import value_of
from kanegen.reference.matrices import Numbers

Value = Any
"""An array, a `Dual` or a `Rounded` number."""


def function(name: str, value: Value) -> Value:
    """Return `abs`, `cos`, `sin` or `sqrt` of a value in any of the arithmetics."""
    if isinstance(value, Dual | Rounded):
        return getattr(value, name)()
    if name == "abs":
        # Complex numbers are real ones whose small imaginary part carries a derivative.
        return value * np.sign(value.real)
    return getattr(np, name)(value)


@dataclass(frozen=True)
class Dual:
    """A value and its slope, the derivative by one variable."""

    value: Value
    slope: Value

    def __add__(self, other: Dual) -> Dual:
        return Dual(self.value + other.value, self.slope + other.slope)

    def __sub__(self, other: Dual) -> Dual:
        return Dual(self.value - other.value, self.slope - other.slope)

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.slope)

    def __mul__(self, other: Dual) -> Dual:
        return Dual(self.value * other.value, self.slope * other.value + self.value * other.slope)

    def __truediv__(self, other: Dual) -> Dual:
        quotient = self.value / other.value
        return Dual(quotient, (self.slope - quotient * other.slope) / other.value)

    def sin(self) -> Dual:
        """Return the sine of an angle (rad)."""
        return Dual(function("sin", self.value), self.slope * function("cos", self.value))

    def cos(self) -> Dual:
        """Return the cosine of an angle (rad)."""
        return Dual(function("cos", self.value), -(self.slope * function("sin", self.value)))

    def sqrt(self) -> Dual:
        """Return the square root of a positive value."""
        root = function("sqrt", self.value)
        return Dual(root, self.slope / (root + root))

    def abs(self) -> Dual:
        """Return the absolute value of the number."""
        size = function("abs", self.value)
        return Dual(size, self.slope * (self.value / size))


@dataclass(frozen=True)
class Rounded:
    """A value and a bound on its error, in units of roundoff, from all operations that computed it."""

    value: Value
    error: Value

    def __add__(self, other: Rounded) -> Rounded:
        return _rounded(self.value + other.value, self.error + other.error)

    def __sub__(self, other: Rounded) -> Rounded:
        return _rounded(self.value - other.value, self.error + other.error)

    def __neg__(self) -> Rounded:
        return Rounded(-self.value, self.error)

    def __mul__(self, other: Rounded) -> Rounded:
        error = np.abs(self.value) * other.error + np.abs(other.value) * self.error
        return _rounded(self.value * other.value, error)

    def __truediv__(self, other: Rounded) -> Rounded:
        quotient = self.value / other.value
        return _rounded(quotient, (self.error + np.abs(quotient) * other.error) / np.abs(other.value))

    def sin(self) -> Rounded:
        """Return the sine of an angle (rad)."""
        return _rounded(np.sin(self.value), np.abs(np.cos(self.value)) * self.error)

    def cos(self) -> Rounded:
        """Return the cosine of an angle (rad)."""
        return _rounded(np.cos(self.value), np.abs(np.sin(self.value)) * self.error)

    def sqrt(self) -> Rounded:
        """Return the square root of a positive value."""
        root = np.sqrt(self.value)
        return _rounded(root, self.error / (2 * np.abs(root)))

    def abs(self) -> Rounded:
        """Return the absolute value of the number."""
        return Rounded(np.abs(self.value), self.error)


def _rounded(value: Value, error: Value) -> Rounded:
    """Return the result of an operation: `error` comes from its operands, its own rounding is added."""
    return Rounded(value, error + np.abs(value))


Variables = Mapping[str, Numbers]
"""Values of the variables of an expression by name."""

_OPERATIONS: dict[str, Callable[..., Value]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negate": operator.neg,
    "tan": lambda angle: function("sin", angle) / function("cos", angle),
    **{name: partial(function, name) for name in ("abs", "cos", "sin", "sqrt")},
}


def value(expression: Expression, variables: Variables) -> tuple[Numbers, Numbers]:
    """Return the value of an expression, and the bound on its error in units of roundoff."""
    rounded = {name: Rounded(values, 0.0) for name, values in variables.items()}
    with np.errstate(all="ignore"):
        exact = evaluate(expression, variables, np.float64)
        return exact, evaluate(expression, rounded, lambda number: _precise(np.float64(number))).error


def slope(expression: Expression, variables: Variables, by: str) -> tuple[Numbers, Numbers]:
    """Return the derivative of an expression by a variable, and the bound on its error in roundoffs."""
    moved = {name: 1.0 if name == by else 0.0 for name in variables}
    exact = {name: Dual(values, moved[name]) for name, values in variables.items()}
    rounded = {name: Dual(_precise(values), _precise(moved[name])) for name, values in variables.items()}
    zero = np.float64(0.0)
    with np.errstate(all="ignore"):
        found = evaluate(expression, exact, lambda number: Dual(np.float64(number), zero)).slope
        parts = evaluate(
            expression, rounded, lambda number: Dual(_precise(np.float64(number)), _precise(zero))
        )
    return found, parts.slope.error


def evaluate(
    expression: Expression, variables: Mapping[str, Value], constant: Callable[[float], Value]
) -> Value:
    """Return the value of an expression in any arithmetic.

    Args:
        expression: Expression, whose parameters stand at their defaults.
        variables: Values of the variables by name.
        constant: Function that makes a value of the arithmetic from a number.
    """

    def leaf(node: Leaf) -> Value:
        return constant(value_of(node.value)) if isinstance(node, Constant) else variables[node.name]

    def operation(node: Operation | Power, operands: list[Value]) -> Value:
        if isinstance(node, Power):
            return _power(operands[0], node.exponent, constant(1.0))
        return _OPERATIONS[node.operator](*operands)

    return folded(expression.root, leaf, operation)


def _power(base: Value, exponent: int, one: Value) -> Value:
    """Return a whole power by repeated multiplication; `one` is the number 1 of the arithmetic."""
    result = one
    for _ in range(abs(exponent)):
        result = result * base
    return result if exponent >= 0 else one / result


def _precise(value: Value) -> Rounded:
    """Return a number without error."""
    return Rounded(value, 0.0)
