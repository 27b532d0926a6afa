"""Numbers of a model: plain floats, or named parameters that get their values at run time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.errors import ModelError, counted, quoted
from kanegen.model.names import check_identifier


@dataclass(frozen=True)
class Parameter:
    """A number of a model that gets its value at run time.

    Attributes:
        name: A C identifier, unique within a system.
        value: Default value, in the unit of the quantity that the parameter replaces.

    Raises:
        ModelError: If the name is no C identifier or the value is not finite.

    Example:
        payload = kg.Parameter("payload", 1.5)  # kg, where a mass is expected
    """

    name: str
    value: float

    def __post_init__(self) -> None:
        check_identifier(self.name, "parameter name")
        object.__setattr__(self, "value", finite(self.value, f"parameter {quoted(self.name)}"))


Number = float | Parameter
"""A number of a model: fixed, or a run-time parameter."""

Vector = tuple[Number, Number, Number]
"""(3,) numbers of a model."""

Matrix = tuple[Vector, Vector, Vector]
"""(3, 3) numbers of a model, row by row."""


def finite(value: Any, label: str) -> float:
    """Return `value` as a finite float; the message calls it `label`.

    Raises:
        ModelError: If `value` is not a real number, or is NaN or infinite.
    """
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.integer | np.floating):
        raise ModelError(f"{label}: {quoted(value)} is not a number.")
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise ModelError(f"{label}: {quoted(result)} is not finite.")
    return result + 0.0  # -0.0 + 0.0 is 0.0: the sign of a zero in a model has no meaning


def number(value: Any, label: str) -> Number:
    """Return a parameter unchanged, and anything else as a finite float."""
    return value if isinstance(value, Parameter) else finite(value, label)


def listed(value: Any) -> list[Any] | None:
    """Return the items of an ordered collection; None for strings, tables, sets and single values."""
    if isinstance(value, str | bytes | Mapping | Set) or not isinstance(value, Iterable):
        return None
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return None
    return list(value)


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
    """Return the value of a number: of a parameter its default, of a float the float itself."""
    return value.value if isinstance(value, Parameter) else value


def toml_number(value: Number) -> float | str:
    """Return a number as a model file holds it: the number itself, or the name of its parameter."""
    return value.name if isinstance(value, Parameter) else value
