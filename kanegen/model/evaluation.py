"""The value of an expression of numbers and parameters, before any rounding.

Sums, products, quotients and powers are exact fractions; roots, sines and so on have 320 bits. A value is
rounded once, when it becomes a double. So 0.1*3 - 0.3 is what the three doubles make, and 1/12 a twelfth.
"""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from kanegen.errors import ModelError, quoted
from kanegen.model.expression_text import text_of
from kanegen.model.nodes import COMPARISONS, PI, Leaf, Node, Operation, Power, Variable, folded
from kanegen.program.constants import MULTIPRECISION, as_fraction

Exact = Any
"""A `Fraction`, or a number of `MULTIPRECISION`; a condition is True or False."""

LARGEST = Fraction(sys.float_info.max)
"""No part of an expression may be larger: it would be infinite in C."""

VANISHING = 2.0**-300
"""A sine, cosine or tangent that is smaller, or a relative difference, in 320 bits, is zero."""

_COMPARING = (*COMPARISONS, "sign")
"""Operations whose value jumps where numbers are equal."""

_EXACT: dict[str, Callable[..., Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negate": operator.neg,
    "abs": abs,
    "sign": lambda a: Fraction((a > 0) - (a < 0)),
    "min": lambda a, b: b if b < a else a,
    "max": lambda a, b: b if b > a else a,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "not": operator.not_,
}
"""Operations that are exact for fractions."""


@dataclass(frozen=True)
class _Undefined:
    """The value of a part that has none, with the reason."""

    reason: str


def exact_value(root: Node) -> Exact:
    """Return the value of a tree without variables, parameters at their defaults.

    Sines, cosines and tangents that vanish but for the rounding of pi are zero, and a tangent at its pole is
    infinite.

    Raises:
        ModelError: If it has none: a part divides by zero, is the tangent of a right angle, takes the root
            or the logarithm of a number that has none, or is larger than any double.
    """
    found = folded(root, _leaf, _operation)
    if isinstance(found, _Undefined):
        raise ModelError(found.reason)
    return found


def relative_loss(root: Node, exact: Exact) -> float:
    """Return by how much a value that is computed in doubles misses `exact`, relative to it.

    It is large where terms nearly cancel. Where `exact` is zero there is no relative error: 0 is returned.
    """
    if not exact:
        return 0.0
    found = folded(root, lambda leaf: float(_leaf(leaf)), _in_doubles)
    return float(abs(Fraction(found) / _fraction(exact) - 1)) if math.isfinite(found) else math.inf


def is_double(value: Exact) -> bool:
    """Return whether a value is a fraction that a double holds without rounding."""
    return isinstance(value, Fraction) and abs(value) <= LARGEST and Fraction(float(value)) == value


def multiprecise(value: Exact) -> Any:
    """Return a value as a number of `MULTIPRECISION`."""
    return MULTIPRECISION.mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else value


def _leaf(node: Leaf) -> Exact:
    """Return the value of a number; a parameter has its default."""
    if isinstance(node, Variable):
        raise ModelError(f"{quoted(node.name)} is no number: only parameters may stand here.")
    value = node.value if isinstance(node.value, int | float) else node.value.value
    return Fraction(value)


def _operation(node: Operation | Power, operands: list[Exact]) -> Exact:
    """Return the value of an operation, or why it has none."""
    if isinstance(node, Operation) and node.operator in ("if", "and", "or"):
        return _chosen(node.operator, *operands)
    undefined = next((one for one in operands if isinstance(one, _Undefined)), None)
    if undefined:
        return undefined
    try:
        value = _computed(node, operands)
    except ZeroDivisionError:
        return _without_value(node, "divides by zero")
    except ArithmeticError as error:
        return _without_value(node, str(error))
    if not isinstance(value, bool) and abs(_fraction(value)) > LARGEST:
        return _without_value(node, "is larger than any double")
    return value


def _in_doubles(node: Operation | Power, operands: list[Any]) -> Any:
    """Return the value of an operation in doubles, as C computes it; NaN where a part has none."""
    try:
        match node:
            case Power(_, exponent):
                return operands[0] ** exponent
            case Operation("if" | "and" | "or" as name):
                return _chosen(name, *operands)
            case Operation(name) if name in _EXACT:
                return float(_EXACT[name](*operands))
            case Operation(name):
                return getattr(math, name)(*operands) if operands else math.pi
    except (ArithmeticError, ValueError):
        return math.nan


def _chosen(name: str, condition: Exact, first: Exact, second: Exact = None) -> Exact:
    """Return a choice or a condition of two; what it does not need may be undefined."""
    if isinstance(condition, _Undefined):
        return condition
    if name == "if":
        return first if condition else second
    return first if condition == (name == "and") else condition


def _computed(node: Operation | Power, operands: list[Exact]) -> Exact:
    """Return the value of an operation on defined numbers.

    Raises:
        ZeroDivisionError: If it divides by zero.
        ArithmeticError: If it has no value for another reason, which the message says.
    """
    if isinstance(node, Power):
        return operands[0] ** node.exponent
    if node.operator not in _EXACT:
        return _function(node.operator, [multiprecise(one) for one in operands])
    if all(isinstance(one, Fraction | bool) for one in operands):
        return _EXACT[node.operator](*operands)
    operands = [multiprecise(one) for one in operands]
    if node.operator in ("+", "-", *_COMPARING) and _are_equal(node.operator, operands):
        if node.operator in _COMPARING:
            raise ArithmeticError("compares numbers that differ in no digit, though they need not be equal,")
        return Fraction(0)
    return _EXACT[node.operator](*operands)


def _are_equal(name: str, operands: list[Any]) -> bool:
    """Return whether two numbers, or one and zero, are equal up to the rounding of 320 bits."""
    first, second = operands if len(operands) == 2 else (operands[0], MULTIPRECISION.mpf(0))
    if name == "+":
        second = -second
    largest = max(abs(first), abs(second)) if len(operands) == 2 else 1
    return bool(abs(first - second) <= VANISHING * largest)


def _function(name: str, operands: list[Any]) -> Any:
    """Return the value of a function in 320 bits."""
    if name == PI:
        return +MULTIPRECISION.pi
    first = operands[0]
    if name == "sqrt" and first < 0:
        raise ArithmeticError("takes the root of a negative number")
    if name == "log" and first <= 0:
        raise ArithmeticError("takes the logarithm of a number that is not positive")
    if name == "exp" and first > 1000:
        raise ArithmeticError("is larger than any double")
    if name == "exp" and first < -10000:
        return MULTIPRECISION.mpf(0)
    if name in ("sqrt", "sin", "tan", "tanh") and not first:
        return Fraction(0)
    if name in ("cos", "exp") and not first:
        return Fraction(1)
    value = getattr(MULTIPRECISION, name)(*operands)
    if name == "tan" and abs(value) * VANISHING > 1:
        raise ArithmeticError("is infinite")
    return Fraction(0) if name in ("sin", "cos", "tan") and abs(value) < VANISHING else value


def _fraction(value: Exact) -> Fraction:
    """Return a value as a fraction."""
    return value if isinstance(value, Fraction) else as_fraction(value)


def _without_value(node: Node, reason: str) -> _Undefined:
    """Return that a part of an expression has no value, with its text."""
    return _Undefined(f"{quoted(text_of(node))} {reason} at the default values of the parameters.")
