"""Values for a row of names, as a user gives them: all in order, or some by name."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, OptionError, quoted
from kanegen.model.numbers import listed


def in_order(label: str, given: Any, names: Sequence[str], defaults: Sequence[Any]) -> list[Any]:
    """Return one value for each name.

    Args:
        label: Name of the argument, for messages.
        given: All values in the order of the names; a table of values by name; or None.
        names: The names.
        defaults: Values of the names that a table leaves out, and of all where nothing is given.

    Raises:
        OptionError: If there is no such name.
        ArrayError: If there is another number of values than of names.

    Example:
        in_order("x", {"pole": 0.3}, ("cart", "pole"), (0.0, 0.0))  # [0.0, 0.3]
    """
    if given is None:
        return list(defaults)
    if isinstance(given, Mapping):
        for name in given:
            if name not in names:
                raise OptionError(f"{label}: there is no {quoted(name)}. {did_you_mean(name, names)}")
        return [given.get(name, default) for name, default in zip(names, defaults, strict=True)]
    values = listed(given)
    if values is None or len(values) != len(names):
        raise ArrayError(
            f"{label}: expected {len(names)} values in the order {', '.join(names[:12])}, or a table of "
            f"values by name, got {quoted(given)}."
        )
    return values


def finite_in_order(label: str, given: Any, names: Sequence[str], defaults: Sequence[float]) -> list[float]:
    """Return one finite number for each name, with the arguments of `in_order`.

    Raises:
        OptionError: If there is no such name, or a value is no finite number.
        ArrayError: If there is another number of values than of names.

    Example:
        finite_in_order("y", {"spin": 400.0}, ("tilt", "spin"), (0.0, 0.0))  # [0.0, 400.0]
    """
    return [
        _finite(label, name, value)
        for name, value in zip(names, in_order(label, given, names, defaults), strict=True)
    ]


def _finite(label: str, name: str, value: Any) -> float:
    """Return a value as a finite number."""
    try:
        number = math.nan if isinstance(value, str) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise OptionError(
            f"{label}: the value of {quoted(name)} is {quoted(value)}, which is no finite number."
        )
    return number
