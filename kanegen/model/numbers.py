"""Numbers of a model: plain floats, or named parameters that stay open until run time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.errors import ModelError
from kanegen.model.names import check_identifier


@dataclass(frozen=True)
class Parameter:
    """A number that the generated code takes at run time.

    Attributes:
        name: A C identifier, unique within a system.
        value: Default, in the unit of the place where the parameter stands.
    """

    name: str
    value: float

    def __post_init__(self) -> None:
        check_identifier(self.name, "parameter name")
        object.__setattr__(self, "value", finite(self.value, f"parameter {self.name!r}"))


Number = float | Parameter
Vector = tuple[Number, Number, Number]
Matrix = tuple[Vector, Vector, Vector]


def finite(value: Any, what: str) -> float:
    """`value` as a finite float.

    Raises:
        ModelError: If it is not a real number, or is NaN or infinite.
    """
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.integer | np.floating):
        raise ModelError(f"{what}: {value!r} is not a number.")
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise ModelError(f"{what}: {result!r} is not finite.")
    return result + 0.0  # -0.0 + 0.0 is 0.0: the sign of a zero in a model has no meaning


def number(value: Any, what: str) -> Number:
    """`value` as a finite float, or the `Parameter` that it is."""
    return value if isinstance(value, Parameter) else finite(value, what)


def listed(value: Any) -> list[Any] | None:
    """The items of something that has an order; None of a string, a table, a set and whatever is no list."""
    if isinstance(value, str | bytes | Mapping | Set) or not isinstance(value, Iterable):
        return None
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return None
    return list(value)


def numbers(value: Any, shape: tuple[int, ...], what: str) -> Any:
    """`value` as nested tuples of `Number` with exactly `shape`.

    Args:
        value: Nested sequences or an array; entries are numbers or parameters.
        shape: Length of every level; `()` is a single number.
        what: Name of the quantity, for the message.

    Raises:
        ModelError: If the shape differs or an entry is not a finite number.
    """
    if not shape:
        return number(value, what)
    items = listed(value)
    if items is None:
        raise ModelError(f"{what}: expected {_describe(shape)}, got {value!r}.")
    if len(items) != shape[0]:
        raise ModelError(f"{what}: expected {_describe(shape)}, got {len(items)} entries.")
    return tuple(numbers(item, shape[1:], f"{what}[{i}]") for i, item in enumerate(items))


def _describe(shape: tuple[int, ...]) -> str:
    kind = "numbers" if len(shape) == 1 else "table of numbers"
    return f"{' x '.join(str(length) for length in shape)} {kind}"


def map_numbers(value: Any, function: Callable[[Number], Any]) -> Any:
    """`function` applied to every number of nested tuples, keeping their nesting."""
    if isinstance(value, tuple):
        return tuple(map_numbers(item, function) for item in value)
    return function(value)


def value_of(value: Number) -> float:
    """The number itself, or a parameter's default."""
    return value.value if isinstance(value, Parameter) else value


def toml_number(value: Number) -> float | str:
    """Return a number as a model file holds it: the number itself, or the name of its parameter."""
    return value.name if isinstance(value, Parameter) else value
