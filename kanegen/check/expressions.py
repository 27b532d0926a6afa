"""Expressions of force elements in NumPy: values, slopes, and how far rounding can carry them.

Nothing is shared with the derivation but the text: slopes come from forward differences of the second kind,
dual numbers, and the size of rounding from a running error analysis (Higham 2002, section 3.3), both carried
along with the value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.force_elements.expression import Constant, Expression, Node, Operation, Variable
from kanegen.numbers import value_of

Value = Any
"""An array, a `Dual` or a `Rounded`."""


def evaluate(
    expression: Expression, variables: Mapping[str, Value], constant: Callable[[float], Value]
) -> Value:
    """The value of an expression.

    Args:
        expression: It; parameters stand at their defaults.
        variables: Values by name.
        constant: What stands for a number.
    """
    return _evaluated(expression.root, variables, constant)


def _evaluated(node: Node, variables: Mapping[str, Value], constant: Callable[[float], Value]) -> Value:
    if isinstance(node, Constant):
        return constant(value_of(node.value))
    if isinstance(node, Variable):
        return variables[node.name]
    if node.operator == "^":
        base, exponent = node.operands
        assert isinstance(exponent, Constant)
        return _power(_evaluated(base, variables, constant), int(value_of(exponent.value)), constant)
    operands = [_evaluated(operand, variables, constant) for operand in node.operands]
    return _applied(node, operands)


def _applied(node: Operation, operands: list[Value]) -> Value:
    match node.operator, operands:
        case "+", [a, b]:
            return a + b
        case "-", [a, b]:
            return a - b
        case "*", [a, b]:
            return a * b
        case "/", [a, b]:
            return a / b
        case "negate", [a]:
            return -a
        case "tan", [a]:
            return _function("sin", a) / _function("cos", a)
        case name, [a]:
            return _function(name, a)
    raise ValueError(node.operator)


def _function(name: str, value: Value) -> Value:
    if isinstance(value, Dual | Rounded):
        return getattr(value, name)()
    if name == "abs":
        # Complex numbers are real ones with a small imaginary part that carries a derivative.
        return value * np.sign(value.real)
    return getattr(np, name)(value)


def _power(base: Value, exponent: int, constant: Callable[[float], Value]) -> Value:
    result = constant(1.0)
    for _ in range(abs(exponent)):
        result = result * base
    return result if exponent >= 0 else constant(1.0) / result


@dataclass(frozen=True)
class Dual:
    """A value and its slope by one variable."""

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
        """Of an angle in rad."""
        return Dual(_function("sin", self.value), self.slope * _function("cos", self.value))

    def cos(self) -> Dual:
        """Of an angle in rad."""
        return Dual(_function("cos", self.value), -(self.slope * _function("sin", self.value)))

    def sqrt(self) -> Dual:
        """Of what is positive."""
        root = _function("sqrt", self.value)
        return Dual(root, self.slope / (root + root))

    def abs(self) -> Dual:
        """Its magnitude."""
        size = _function("abs", self.value)
        return Dual(size, self.slope * (self.value / size))


@dataclass(frozen=True)
class Rounded:
    """A value and how many units of roundoff it may be off after the operations that made it."""

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
        """Of an angle in rad."""
        return _rounded(np.sin(self.value), np.abs(np.cos(self.value)) * self.error)

    def cos(self) -> Rounded:
        """Of an angle in rad."""
        return _rounded(np.cos(self.value), np.abs(np.sin(self.value)) * self.error)

    def sqrt(self) -> Rounded:
        """Of what is positive."""
        root = np.sqrt(self.value)
        return _rounded(root, self.error / (2 * np.abs(root)))

    def abs(self) -> Rounded:
        """Its magnitude."""
        return Rounded(np.abs(self.value), self.error)


def _rounded(value: Value, error: Value) -> Rounded:
    return Rounded(value, error + np.abs(value))
