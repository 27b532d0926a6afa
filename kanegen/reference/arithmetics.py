"""Numbers that carry along more than their value: a slope, or how far rounding may have taken them.

`Dual` is forward-mode differentiation by one variable, `Rounded` a running error analysis (Higham 2002,
section 3.3). What they hold may be arrays, and a dual number may be one of rounded ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Value = Any
"""An array, a `Dual` or a `Rounded`."""


def function(name: str, value: Value) -> Value:
    """`abs`, `cos`, `sin` or `sqrt` of any of these."""
    if isinstance(value, Dual | Rounded):
        return getattr(value, name)()
    if name == "abs":
        # Complex numbers are real ones with a small imaginary part that carries a derivative.
        return value * np.sign(value.real)
    return getattr(np, name)(value)


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
        return Dual(function("sin", self.value), self.slope * function("cos", self.value))

    def cos(self) -> Dual:
        """Of an angle in rad."""
        return Dual(function("cos", self.value), -(self.slope * function("sin", self.value)))

    def sqrt(self) -> Dual:
        """Of what is positive."""
        root = function("sqrt", self.value)
        return Dual(root, self.slope / (root + root))

    def abs(self) -> Dual:
        """Its magnitude."""
        size = function("abs", self.value)
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
