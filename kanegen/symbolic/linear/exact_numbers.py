"""Numbers that stay exact while a model is evaluated in a state, and that are written short at the end."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np
import sympy
from sympy import Expr, Integer, Rational, S

from kanegen.errors import OptionError, quoted
from kanegen.model.expression import Expression, Parameter
from kanegen.model.grammar import parse_number
from kanegen.symbolic import functions, symbols
from kanegen.symbolic.closed.coefficients import expression, fraction

DIGITS = 40
"""Digits of values of functions that are no rational numbers, such as the sine of 0.3."""

DUST = Rational(1, 10**30)
"""Size below which a number is the rounding error of a zero, beside others of the same sum."""

_SYMPY: Mapping[type[Expr], Callable[..., Expr]] = {
    functions.exp: sympy.exp,
    functions.log: sympy.log,
    functions.tanh: sympy.tanh,
    functions.atan2: sympy.atan2,
    functions.sign: sympy.sign,
    functions.minimum: sympy.Min,
    functions.maximum: sympy.Max,
}
"""SymPy's own functions, which take the place of those of expressions where the arguments are numbers."""


def exact_value(value: Any, label: str, known: Mapping[str, Parameter], is_angle: bool = False) -> Expr:
    """Return a value of a state in SymPy.

    A float is the shortest decimal number that reads back to it; an angle that is the float nearest to a
    multiple of a quarter turn is that multiple, so that `math.pi` is pi. Expressions of SymPy and of
    parameters stay. A text is an expression of parameters, read by the grammar of model files.

    Args:
        value: A number, an expression, or a text.
        label: Name of the value, for messages.
        known: Parameters that a text may name.
        is_angle: Whether the value is an angle (rad).

    Raises:
        OptionError: If the value is none of these, or not finite.
        ModelError: If a text is no expression of parameters.
    """
    if isinstance(value, str):
        value = parse_number(value, known)
    if isinstance(value, Parameter | Expression):
        found = symbols.expression(value)
    elif isinstance(value, sympy.Basic):
        found = value
    elif isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool):
        found = sympy.sympify(value.item() if isinstance(value, np.generic) else value)
    else:
        raise OptionError(f"{label}: {quoted(value)} is neither a number nor an expression.")
    if not isinstance(found, Expr) or found.is_finite is False or found is sympy.nan:
        raise OptionError(f"{label}: {quoted(str(found))} is no finite number.")
    if is_angle and found.is_Float:
        turns = round(float(found) / (math.pi / 2))
        if turns and float(found) == turns * (math.pi / 2):
            return turns * sympy.pi / 2
    return exact(found)


def exact(value: Expr) -> Expr:
    """Return an expression in which every number is exact: rational, or a root such as sqrt(3)/2.

    Values of other functions at numbers are rational numbers of `DIGITS` digits.
    """
    floats = value.atoms(sympy.Float)
    if floats:
        value = value.xreplace({one: _rational(fraction(one)) for one in floats})
    for kind, function in _SYMPY.items():
        if value.has(kind):
            value = value.replace(kind, lambda *a, f=function, k=kind: _at_numbers(f, k, a))
    return _without_functions_of_numbers(value)


def short(value: Expr) -> Expr:
    """Return an expression with long rational numbers as floats: 0.1 stays 1/10, and 1/3 stays 1/3."""
    long = [one for one in value.atoms(sympy.Rational) if not one.is_Integer or abs(one.p) >= 2**31]
    return value.xreplace({one: expression(Fraction(int(one.p), int(one.q))) for one in long})


def _rational(value: Fraction) -> Expr:
    return Rational(value.numerator, value.denominator)


def _at_numbers(function: Callable[..., Expr], kind: type[Expr], arguments: tuple[Expr, ...]) -> Expr:
    """Return a function of expressions, evaluated by SymPy where all arguments are numbers."""
    numeric = all(argument.is_number for argument in arguments)
    return function(*arguments) if numeric else kind(*arguments)


def _without_functions_of_numbers(value: Expr) -> Expr:
    """Return an expression with functions of numbers, such as sin(3/10), as rational numbers."""
    if value.is_Rational or not value.has(sympy.Function, sympy.exp):
        return value
    if value.is_number:
        return _approximated(value)
    found = {one for one in value.atoms(sympy.Function) if one.is_number}
    return value.xreplace({one: _approximated(one) for one in found})


def _approximated(value: Expr) -> Expr:
    """Return a number with `DIGITS` digits as a rational number."""
    number = value.evalf(DIGITS)
    if not number.is_Float:
        return number
    if abs(number) < DUST:
        return S.Zero
    sign, mantissa, exponent, _ = number._mpf_
    size = Integer(int(mantissa)) * Integer(2) ** exponent
    return -size if sign else size
