"""Checks of single values that a caller passes: finite numbers, and ordered collections."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Set
from typing import Any

import numpy as np

from kanegen.errors import ModelError, quoted


def is_plain(value: Any) -> bool:
    """Return whether a value is a real number of Python or NumPy; flags are none."""
    kinds = int | float | np.integer | np.floating
    return isinstance(value, kinds) and not isinstance(value, bool | np.bool_)


def finite(value: Any, label: str) -> float:
    """Return `value` as a finite float; the message calls it `label`.

    Raises:
        ModelError: If `value` is not a real number, or is NaN or infinite.
    """
    if not is_plain(value):
        raise ModelError(f"{label}: {quoted(value)} is not a number.")
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise ModelError(f"{label}: {quoted(result)} is not finite.")
    return result + 0.0  # -0.0 + 0.0 is 0.0: the sign of a zero in a model has no meaning


def listed(value: Any) -> list[Any] | None:
    """Return the items of an ordered collection; None for strings, tables, sets and single values.

    A matrix of SymPy gives its rows, or the entries of its only column.
    """
    sympy = sys.modules.get("sympy")
    if sympy is not None and isinstance(value, sympy.MatrixBase):
        return list(value.flat() if value.cols == 1 else value.tolist())
    if isinstance(value, str | bytes | Mapping | Set) or not isinstance(value, Iterable):
        return None
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return None
    return list(value)
