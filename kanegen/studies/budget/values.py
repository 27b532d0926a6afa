"""Numbers and ranges in the tables of a domain; what is none is an `OptionError` that says where."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from kanegen.errors import OptionError
from kanegen.model.arrays import Floats
from kanegen.studies.tradeoff.domain import GRID

_LARGEST = float(np.finfo(GRID.dtype).max)


def number(where: str, value: Any) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise OptionError(f"{where}: {value!r} is not a number.")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise OptionError(f"{where}: {found!r} is not a finite number.")
    return found


def positive(where: str, value: Any) -> float:
    """A finite number that is not negative."""
    found = number(where, value)
    if found < 0:
        raise OptionError(f"{where}: {found!r} is negative.")
    return found


def ends(where: str, value: Any) -> tuple[float, float]:
    """The ends of a range, which for a single number are the same."""
    if not isinstance(value, list):
        fixed = _held(where, value)
        return fixed, fixed
    if len(value) != 2:
        raise OptionError(f"{where}: a range is [low, high], or one number that stays fixed; got {value!r}.")
    low, high = (_held(where, end) for end in value)
    if low > high:
        raise OptionError(f"{where}: the range [{low!r}, {high!r}] is inverted. Write [{high!r}, {low!r}].")
    return low, high


def ends_of_three(where: str, value: Any) -> Floats:
    """(3, 2) those of the ranges of components, from one range or three."""
    if isinstance(value, list) and any(isinstance(item, list) for item in value):
        if len(value) != 3:
            raise OptionError(f"{where}: expected one range or three, got {len(value)}.")
        return np.array([ends(f"{where}[{k}]", item) for k, item in enumerate(value)])
    return np.array([ends(where, value)] * 3)


def _held(where: str, value: Any) -> float:
    """A number that a state can hold."""
    found = number(where, value)
    if abs(found) > _LARGEST:
        raise OptionError(f"{where}: {found!r} is beyond single precision, which all states have.")
    return found
