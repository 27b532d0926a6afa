"""The arithmetics in which the reference evaluates expressions of force elements.

`Dual` numbers carry a slope along (forward-mode differentiation by one variable). `Rounded` numbers carry a
bound on their rounding error (running error analysis, Higham 2002, section 3.3), and so do the conditions
that compare them. A dual number may be made of rounded ones. Plain numbers are those of NumPy, also complex
ones, whose imaginary parts carry derivatives. Nothing is shared with the derivation that becomes C.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

Value = Any
"""An array, a `Dual` or a `Rounded` number."""

UNIT = 2.0**-53
"""Unit roundoff of the reference; errors are in units of that of the program, which is as large or larger."""

UNCERTAIN = 2.0**-20
"""How far from 0 a number must be, relative to its error in roundoffs, so that its sign is certain: also in
single precision, and with factors for what the analysis leaves out."""

ANYTHING = 2.0**60
"""An error that stands for every value, where one of two branches is taken and it is uncertain which."""


@dataclass(frozen=True)
class Condition:
    """A condition, and whether it is uncertain because of rounding errors.

    Attributes:
        value: 1 where it holds, 0 where it does not, NaN where it is undefined.
        uncertain: Where rounding errors decide.
    """

    value: Value
    uncertain: Value


def function(name: str, value: Value) -> Value:
    """Return a function of one value in any of the arithmetics, such as `abs` or `sqrt`."""
    if isinstance(value, Dual | Rounded):
        return getattr(value, name)()
    # Complex numbers are real ones whose small imaginary part carries a derivative.
    if name == "abs":
        return value * np.sign(value.real)
    if name == "sign":
        return np.sign(value.real)
    if name == "squared_secant":
        return _squared_secant(value)
    if name == "log":
        return np.where(value.real > 0, np.log(value), np.nan)
    return getattr(np, name)(value)


def arctangent(y: Value, x: Value) -> Value:
    """Return the angle of the point (x, y) in any of the arithmetics; a zero has no sign."""
    if isinstance(y, Dual | Rounded):
        return y.arctangent(x)
    angle = np.arctan2(y.real + 0.0, np.where(x.real == 0, 0.0, x.real))
    if np.iscomplexobj(y) or np.iscomplexobj(x):
        turned = (x.real * y.imag - y.real * x.imag) / (x.real**2 + y.real**2)
        return angle + 1j * turned
    return angle


def chosen(condition: Condition, a: Value, b: Value) -> Value:
    """Return a where a condition holds, b where it does not, NaN where it is undefined, in any arithmetic."""
    if isinstance(a, Dual | Rounded):
        return a.chosen(condition, b)
    return np.where(np.isnan(condition.value), np.nan, np.where(condition.value == 1, a, b))


def smaller(a: Value, b: Value) -> Value:
    """Return the smaller of two values in any of the arithmetics, the first of equal ones."""
    return _extreme(compared(np.less_equal, a, b), a, b)


def larger(a: Value, b: Value) -> Value:
    """Return the larger of two values in any of the arithmetics, the first of equal ones."""
    return _extreme(compared(np.greater_equal, a, b), a, b)


def _extreme(first: Condition, a: Value, b: Value) -> Value:
    """Return one of two values; where rounding errors decide, they are equal, but their slopes are not."""
    if isinstance(a, Dual):
        return Dual(_extreme(first, a.value, b.value), chosen(first, a.slope, b.slope))
    if isinstance(a, Rounded):
        return Rounded(_extreme(first, a.value, b.value), np.maximum(a.error, b.error))
    return chosen(first, a, b)


def compared(compare: Callable[..., Value], a: Value, b: Value) -> Condition:
    """Return the comparison of two numbers in any of the arithmetics."""
    if isinstance(a, Dual):
        return compared(compare, a.value, b.value)
    if isinstance(a, Rounded):
        error = a.error + b.error
        near = np.abs(a.value - b.value) <= UNCERTAIN * error
        return Condition(compared(compare, a.value, b.value).value, near & (error > 0))
    undefined = np.isnan(a.real) | np.isnan(b.real)
    return Condition(np.where(undefined, np.nan, compare(a.real, b.real)), np.zeros_like(undefined))


def both(p: Condition, q: Condition) -> Condition:
    """Return whether two conditions hold; the second does not count where the first does not hold."""
    return Condition(np.where(p.value == 0, 0.0, p.value * q.value), p.uncertain | q.uncertain)


def either(p: Condition, q: Condition) -> Condition:
    """Return whether one of two conditions holds; the second does not count where the first holds."""
    return Condition(np.where(p.value == 1, 1.0, np.maximum(p.value, q.value)), p.uncertain | q.uncertain)


def negated(p: Condition) -> Condition:
    """Return whether a condition does not hold."""
    return Condition(1.0 - p.value, p.uncertain)


def _squared_secant(value: Value) -> Value:
    """Return 1/cosh^2 of a plain number, 0 where the square overflows."""
    return 1 / np.cosh(value) ** 2


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
        """Return the square root; its slope is 0 where that of the operand is."""
        root = function("sqrt", self.value)
        zero = _zero(self.slope)
        still = compared(np.equal, self.slope, zero)
        return Dual(root, chosen(still, zero, self.slope / (root + root)))

    def abs(self) -> Dual:
        """Return the absolute value of the number."""
        return Dual(function("abs", self.value), self.slope * function("sign", self.value))

    def sign(self) -> Dual:
        """Return the sign of the number, whose slope is 0 also where it jumps."""
        return Dual(function("sign", self.value), _zero(self.slope))

    def exp(self) -> Dual:
        """Return e to the power of the number."""
        value = function("exp", self.value)
        return Dual(value, self.slope * value)

    def log(self) -> Dual:
        """Return the natural logarithm of a positive number."""
        return Dual(function("log", self.value), self.slope / self.value)

    def tanh(self) -> Dual:
        """Return the hyperbolic tangent of the number."""
        return Dual(function("tanh", self.value), self.slope * function("squared_secant", self.value))

    def squared_secant(self) -> Dual:
        """Return 1/cosh^2 of the number, the slope of its hyperbolic tangent."""
        value = function("squared_secant", self.value)
        half = value * function("tanh", self.value)
        return Dual(value, -(self.slope * (half + half)))

    def arctangent(self, other: Dual) -> Dual:
        """Return the angle of the point (other, self)."""
        squared = self.value * self.value + other.value * other.value
        turned = self.slope * other.value - self.value * other.slope
        return Dual(arctangent(self.value, other.value), turned / squared)

    def chosen(self, condition: Condition, other: Dual) -> Dual:
        """Return this number where a condition holds, and the other where it does not."""
        value, slope = ((self.value, other.value), (self.slope, other.slope))
        return Dual(chosen(condition, *value), chosen(condition, *slope))


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
        largest = np.sqrt(self.error / UNIT)  # of a root that may be 0
        return _rounded(root, np.fmin(self.error / (2 * np.abs(root)), largest))

    def abs(self) -> Rounded:
        """Return the absolute value of the number."""
        return Rounded(np.abs(self.value), self.error)

    def sign(self) -> Rounded:
        """Return the sign of the number, which is uncertain where the number is."""
        certain = (np.abs(self.value) > UNCERTAIN * self.error) | (self.error == 0)
        return Rounded(np.sign(self.value), np.where(certain, 0.0, ANYTHING))

    def exp(self) -> Rounded:
        """Return e to the power of the number."""
        value = np.exp(self.value)
        return Rounded(value, value * self.error + 2 * value)

    def log(self) -> Rounded:
        """Return the natural logarithm of a positive number."""
        value = np.where(self.value > 0, np.log(self.value), np.nan)
        return Rounded(value, self.error / np.abs(self.value) + 2 * np.abs(value))

    def tanh(self) -> Rounded:
        """Return the hyperbolic tangent of the number."""
        value = np.tanh(self.value)
        return Rounded(value, self.error / np.cosh(self.value) ** 2 + 2 * np.abs(value))

    def squared_secant(self) -> Rounded:
        """Return 1/cosh^2, the slope of the hyperbolic tangent."""
        value = _squared_secant(self.value)
        return Rounded(value, 2 * value * self.error + 8 * value)

    def arctangent(self, other: Rounded) -> Rounded:
        """Return the angle of the point (other, self)."""
        value = arctangent(self.value, other.value)
        size = np.hypot(self.value, other.value)
        moved = np.where(size > 0, (self.error + other.error) / size, 0.0)
        cut = (other.value < 0) & (np.abs(self.value) <= UNCERTAIN * self.error) & (self.error > 0)
        return Rounded(value, moved + 4 * np.abs(value) + np.where(cut, ANYTHING, 0.0))

    def chosen(self, condition: Condition, other: Rounded) -> Rounded:
        """Return this number where a condition holds, and the other where it does not.

        Where rounding errors decide, the error reaches from one number to the other.
        """
        value = chosen(condition, self.value, other.value)
        own = chosen(condition, self.error, other.error)
        jump = np.abs(self.value - other.value) / UNIT + self.error + other.error
        jump = np.where(np.isnan(jump), np.inf, jump)
        return Rounded(value, np.where(condition.uncertain, jump, own))


def _zero(like: Value) -> Value:
    """Return the number 0 in the arithmetic of a slope."""
    if isinstance(like, Dual):
        return Dual(_zero(like.value), _zero(like.slope))
    return Rounded(np.float64(0.0), 0.0) if isinstance(like, Rounded) else np.float64(0.0)


def _rounded(value: Value, error: Value) -> Rounded:
    """Return the result of an operation: `error` comes from its operands, its own rounding is added."""
    return Rounded(value, error + np.abs(value))
