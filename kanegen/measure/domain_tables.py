"""Ranges of states in tables of plain data, such as TOML files: names, kinds and bodies to ends of a box.

A range is [low, high], or one number that stays fixed; in Python also a tuple or an array. Tables of
coordinates, speeds and generalized forces have ranges by the name of an element, or by a kind: "angles",
"translations", "quaternions". Tables of loads have them by the name of a body or point, or for "all" of them:
one range, or one for each component.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.model.arrays import Floats
from kanegen.model.coordinates import COORDINATE_KINDS

UNITS_OF_KINDS = {kind.group: kind.unit for kind in COORDINATE_KINDS}
"""Keys that set the range of all coordinates of one kind, with the unit of this kind."""

ALL_ROWS = "all"
"""Key that sets the loads of all bodies or points that take loads."""

Precise = tuple[float, str]
"""Largest number that a state may hold, and the name of its precision in error messages."""

DOUBLE_NUMBERS: Precise = (float(np.finfo(np.float64).max), "double precision")
"""Any finite double."""


def set_ranges(
    where: str,
    system_name: str,
    units: Mapping[str, str],
    table: Mapping[str, Any],
    low: Floats,
    high: Floats,
    largest: Precise = DOUBLE_NUMBERS,
) -> None:
    """Write the ranges of a table of x, y, ydot or tau into the ends of a box.

    Ranges of a kind, such as "angles", come first, so that the range of a single element overrides them.

    Args:
        where: Beginning of error messages.
        system_name: Name of the system in error messages.
        units: Unit of every element, by its name.
        table: Ranges by the name of an element or of a kind.
        low: Lower ends of the box from the first element on; changed in place.
        high: Upper ends of the box from the first element on; changed in place.
        largest: Largest number of a state.

    Raises:
        OptionError: If a key is unknown or a value is no range.
    """
    table = _without_nesting(table)
    require_known_keys(where, table, (*units, *UNITS_OF_KINDS))
    for kind, unit in UNITS_OF_KINDS.items():
        if kind in table and kind not in units:
            lowest, highest = read_range(f"{where}.{kind}", table[kind], largest)
            places = [place for place, own in enumerate(units.values()) if own == unit]
            if not places:
                raise OptionError(f"{where}.{kind}: system {system_name!r} has no {kind}.")
            low[places], high[places] = lowest, highest
    for place, name in enumerate(units):
        if name in table:
            low[place], high[place] = read_range(f"{where}.{name}", table[name], largest)


def set_load_ranges(
    where: str,
    rows: Mapping[str, int],
    table: Mapping[str, Any],
    low: Floats,
    high: Floats,
    largest: Precise = DOUBLE_NUMBERS,
) -> None:
    """Write the ranges of a table of forces or torques into the ends of a box.

    The range of "all" comes first, so that the range of a single row overrides it.

    Args:
        where: Beginning of error messages.
        rows: Row of every body or point that takes loads, by its name.
        table: Ranges by the name of a body or point.
        low: Lower ends of the box from the first component on; changed in place.
        high: Upper ends of the box from the first component on; changed in place.
        largest: Largest number of a state.

    Raises:
        OptionError: If a key is unknown or a value is no range.
    """
    table = _without_nesting(table)
    require_known_keys(where, table, (*rows, *((ALL_ROWS,) if rows else ())))
    for key in sorted(table, key=lambda key: key != ALL_ROWS):
        for name, row in rows.items():
            if name == key or (key == ALL_ROWS and ALL_ROWS not in rows):
                own = slice(3 * row, 3 * row + 3)
                low[own], high[own] = _three_ranges(f"{where}.{key}", table[key], largest).T


def require_table(where: str, name: str, value: Any) -> Mapping[str, Any]:
    """Return `value` if it is a table.

    Raises:
        OptionError: If `value` is no table.
    """
    if not isinstance(value, Mapping):
        raise OptionError(f"{where}: {name}: write a table [{name}], or keys such as {name}.angles.")
    return value


def require_known_keys(where: str, table: Mapping[str, Any], known: tuple[str, ...]) -> None:
    """Require that every key of a table is known.

    Raises:
        OptionError: If a key is unknown; the message names the key and the most similar known one.
    """
    for key in table:
        if key not in known:
            raise OptionError(f"{where}: unknown key {quoted(key)}. {did_you_mean(key, known)}")


def _without_nesting(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table whose tables of ranges are ranges by names with dots.

    TOML takes the dots in `x.head.e0 = [0, 1]` for tables in each other; the name in {x} is "head.e0".
    """
    found: dict[str, Any] = {}
    for key, value in table.items():
        inner = _without_nesting(value) if isinstance(value, Mapping) else {}
        found |= {f"{key}.{name}": own for name, own in inner.items()} if inner else {key: value}
    return found


def finite_number(where: str, value: Any) -> float:
    """Return `value` as a finite number.

    Raises:
        OptionError: If it is none.
    """
    value = _plain(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise OptionError(f"{where}: {quoted(value)} is not a number.")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise OptionError(f"{where}: {found!r} is not a finite number.")
    return found


def non_negative(where: str, value: Any) -> float:
    """Return `value` as a finite number that is not negative.

    Raises:
        OptionError: If it is none.
    """
    found = finite_number(where, value)
    if found < 0:
        raise OptionError(f"{where}: {found!r} is negative.")
    return found


def read_range(where: str, value: Any, largest: Precise = DOUBLE_NUMBERS) -> tuple[float, float]:
    """Return the ends of a range [low, high]; both ends of a single number are this number.

    Raises:
        OptionError: If the value is neither, or an end is larger than `largest`.
    """
    value = _plain(value)
    if not isinstance(value, list):
        fixed = _number_of_state(where, value, largest)
        return fixed, fixed
    if len(value) != 2:
        raise OptionError(
            f"{where}: a range is [low, high], or one number that stays fixed; got {quoted(value)}."
        )
    low, high = (_number_of_state(where, end, largest) for end in value)
    if low > high:
        raise OptionError(f"{where}: the range [{low!r}, {high!r}] is inverted. Write [{high!r}, {low!r}].")
    return low, high


def _three_ranges(where: str, value: Any, largest: Precise) -> Floats:
    """Return the (3, 2) ends of the ranges of three components, from one range or from three.

    Raises:
        OptionError: If the value is neither.
    """
    value = _plain(value)
    if isinstance(value, list) and any(isinstance(item, list) for item in value):
        if len(value) != 3:
            raise OptionError(f"{where}: expected one range or three, got {len(value)}.")
        return np.array([read_range(f"{where}[{k}]", item, largest) for k, item in enumerate(value)])
    return np.array([read_range(where, value, largest)] * 3)


def _plain(value: Any) -> Any:
    """Return a tuple or an array as a list of its items, and a number of NumPy as a plain one."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [_plain(item) for item in value] if isinstance(value, tuple | list) else value


def _number_of_state(where: str, value: Any, largest: Precise) -> float:
    """Return `value` as a finite number that a state may hold.

    Raises:
        OptionError: If it is none.
    """
    found = finite_number(where, value)
    most, precision = largest
    if abs(found) > most:
        raise OptionError(f"{where}: {found!r} is beyond {precision}, which all states have.")
    return found
