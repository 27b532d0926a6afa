"""Operators and functions of numbers that are known at run time only; what they make is an expression.

NumPy calls the methods for arrays of such numbers, and `numpy.cos(angle)` calls `angle.cos()`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

_E = TypeVar("_E")


class Arithmetic(ABC, Generic[_E]):
    """A number with the operators of Python and the functions of expressions; every result is an `_E`."""

    @abstractmethod
    def combined(self, operator: str, *operands: object) -> _E:
        """Return an operation, one of `nodes.Operation`, on numbers.

        Returns `NotImplemented` where an operand is no number, so that Python asks the other operand.
        """

    @abstractmethod
    def __pow__(self, exponent: object) -> _E:
        """Return a power, whose exponent is a whole number."""

    def __add__(self, other: object) -> _E:
        return self.combined("+", self, other)

    def __radd__(self, other: object) -> _E:
        return self.combined("+", other, self)

    def __sub__(self, other: object) -> _E:
        return self.combined("-", self, other)

    def __rsub__(self, other: object) -> _E:
        return self.combined("-", other, self)

    def __mul__(self, other: object) -> _E:
        return self.combined("*", self, other)

    def __rmul__(self, other: object) -> _E:
        return self.combined("*", other, self)

    def __truediv__(self, other: object) -> _E:
        return self.combined("/", self, other)

    def __rtruediv__(self, other: object) -> _E:
        return self.combined("/", other, self)

    def __neg__(self) -> _E:
        return self.combined("negate", self)

    def __pos__(self) -> Arithmetic[_E]:
        return self

    def __abs__(self) -> _E:
        return self.combined("abs", self)

    def sin(self) -> _E:
        """Return the sine of an angle (rad)."""
        return self.combined("sin", self)

    def cos(self) -> _E:
        """Return the cosine of an angle (rad)."""
        return self.combined("cos", self)

    def tan(self) -> _E:
        """Return the tangent of an angle (rad)."""
        return self.combined("tan", self)

    def tanh(self) -> _E:
        """Return the hyperbolic tangent of a number."""
        return self.combined("tanh", self)

    def arctan2(self, x: object) -> _E:
        """Return the angle of the point (x, self), from -pi to pi (rad)."""
        return self.combined("atan2", self, x)

    def sqrt(self) -> _E:
        """Return the square root of a number."""
        return self.combined("sqrt", self)

    def exp(self) -> _E:
        """Return e to the power of a number."""
        return self.combined("exp", self)

    def log(self) -> _E:
        """Return the natural logarithm of a positive number."""
        return self.combined("log", self)
