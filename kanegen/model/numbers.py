"""Numbers of a model: plain floats, named parameters that get their values at run time, expressions of these.

Whoever needs the value of a number asks `value_of`, or `parameters_of` for what it depends on.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from kanegen.errors import QUOTED, ModelError, counted, excerpt, quoted, warn
from kanegen.model.evaluation import Exact
from kanegen.model.expression import Expression, Parameter
from kanegen.model.finite import finite, is_plain, listed
from kanegen.model.sympy_numbers import is_sympy

__all__ = [
    "Matrix",
    "Number",
    "Parameter",
    "Vector",
    "described",
    "exact_value_of",
    "factor_text",
    "finite",
    "is_fixed",
    "listed",
    "map_numbers",
    "number",
    "numbers",
    "parameters_of",
    "toml_number",
    "value_of",
    "with_parameters_changed",
]

Number = float | Parameter | Expression
"""A number of a model: fixed, a run-time parameter, or an expression of numbers and parameters."""

LOST = 1e-12
"""Relative error of a number in doubles from which it is reported: thousands of rounding errors."""

Vector = tuple[Number, Number, Number]
"""(3,) numbers of a model."""

Matrix = tuple[Vector, Vector, Vector]
"""(3, 3) numbers of a model, row by row."""


def number(value: Any, label: str, warns: bool = True) -> Number:
    """Return a number of a model; an expression that is exactly a double becomes this double.

    Symbols of SymPy become parameters without a default value, which the system must give.

    Args:
        value: The number.
        label: Name of the quantity, for messages.
        warns: Whether lost digits are reported; not where the number is checked once more in its place.

    Raises:
        ModelError: If it is neither a finite number nor an expression that has a value at the defaults of its
            parameters and depends on nothing else.

    Warns:
        KanegenWarning: If so many digits are lost in an expression that results are not accurate.
    """
    if isinstance(value, Parameter):
        return value
    if is_plain(value):
        return finite(value, label)
    if isinstance(value, Fraction) or is_sympy(value):
        try:
            value = Expression.of(value)
        except ModelError as error:
            raise ModelError(f"{label}: {error}") from None
    if not isinstance(value, Expression):
        return finite(value, label)
    if value.variables:
        raise ModelError(
            f"{label}: {quoted(str(value))} depends on {quoted(value.variables[0])}, but a number of a model "
            "may depend on parameters only."
        )
    if value.is_open:
        return value.simplest
    try:
        finite(value.value, label)
    except ModelError as error:
        raise ModelError(f"{label}: {error}") from None
    if warns and value.parameters and value.loss > LOST:
        warn(
            f"{label}: {quoted(str(value))} loses digits: computed in doubles at the default values, it is "
            f"off by {value.loss:.0e} of itself, because terms nearly cancel in it or leave the range of "
            "doubles. Write it in another form."
        )
    return value.simplest


def numbers(value: Any, shape: tuple[int, ...], label: str) -> Any:
    """Return `value` as nested tuples of `Number` with exactly `shape`.

    Args:
        value: Nested sequences or an array; entries are numbers or parameters.
        shape: Length of every level; `()` is a single number.
        label: Name of the quantity, for the message.

    Raises:
        ModelError: If the shape differs or an entry is not a finite number.
    """
    if not shape:
        return number(value, label)
    items = listed(value)
    if items is None:
        raise ModelError(f"{label}: expected {_describe(shape)}, got {quoted(value)}.")
    if len(items) != shape[0]:
        raise ModelError(
            f"{label}: expected {_describe(shape)}, got {counted(len(items), 'entry', 'entries')}."
        )
    return tuple(numbers(item, shape[1:], f"{label}[{i}]") for i, item in enumerate(items))


def _describe(shape: tuple[int, ...]) -> str:
    """Return a shape in words."""
    kind = "numbers" if len(shape) == 1 else "table of numbers"
    return f"{' x '.join(str(length) for length in shape)} {kind}"


def map_numbers(value: Any, function: Callable[[Number], Any]) -> Any:
    """Return nested tuples with `function` applied to every number in them."""
    if isinstance(value, tuple):
        return tuple(map_numbers(item, function) for item in value)
    return function(value)


def value_of(value: Number) -> float:
    """Return the value of a number, with parameters at their defaults, rounded once."""
    return float(value) if isinstance(value, int | float) else value.value


def exact_value_of(value: Number) -> Exact:
    """Return the value of a number before rounding: a fraction, or a number of 320 bits."""
    return value.exact if isinstance(value, Expression) else Fraction(value_of(value))


def parameters_of(value: Number) -> tuple[Parameter, ...]:
    """Return the parameters of a number, each once."""
    if isinstance(value, Expression):
        return value.parameters
    return (value,) if isinstance(value, Parameter) else ()


def is_fixed(value: Number) -> bool:
    """Return whether a number depends on no parameter."""
    return not parameters_of(value)


def with_parameters_changed(value: Number, change: Callable[[Parameter], Number]) -> Number:
    """Return a number with `change` applied to its parameters."""

    def changed(one: float | Parameter) -> Number:
        return change(one) if isinstance(one, Parameter) else one

    return number(value.map_numbers(changed), "number") if isinstance(value, Expression) else changed(value)


def factor_text(value: Number) -> str:
    """Return a number as people read it before a name or a unit: an expression in brackets."""
    return f"({value})" if isinstance(value, Expression) else str(toml_number(value))


def toml_number(value: Number) -> float | str:
    """Return a number as a model file holds it: the number itself, or the text of its expression."""
    if isinstance(value, Parameter):
        return value.name
    return str(value) if isinstance(value, Expression) else value


def described(value: Number) -> str:
    """Return a number for a message: its value, after its text where it is an expression or a parameter."""
    shown = quoted(value_of(value))
    return shown if isinstance(value, float) else f"{excerpt(str(toml_number(value)), QUOTED)} = {shown}"
