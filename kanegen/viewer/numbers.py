"""Arrays for pages: checked as doubles, and encoded as base64."""

from __future__ import annotations

import base64

import numpy as np

from kanegen.errors import ArrayError
from kanegen.model import arguments
from kanegen.model.arrays import Floats


def doubles(name: str, values: object) -> Floats:
    """Return numbers as doubles.

    Raises:
        ArrayError: If they are no real numbers.

    Example:
        doubles("times", [0, 1, 2])
    """
    return np.asarray(arguments.floats(name, values, np.dtype(np.float64)), np.float64)


def checked(name: str, values: object, shape: tuple[int, ...] | None) -> Floats:
    """Return finite numbers of a shape; None is any shape.

    Raises:
        ArrayError: If they have another shape, or one is not finite.

    Example:
        checked("times", [0, 1, 2], (3,))
    """
    array = doubles(name, values)
    if shape is not None and array.shape != shape:
        raise ArrayError(f"{name}: expected shape {shape}, got {array.shape}.")
    if not np.isfinite(array).all():
        raise ArrayError(f"{name}: a number is not finite.")
    return array


def encoded(name: str, values: Floats, kind: str) -> str:
    """Return finite numbers as base64 of a type of NumPy, such as "<f4".

    Raises:
        ArrayError: If the type cannot hold a number because it is too large.

    Example:
        encoded("times", np.zeros(3), "<f8")
    """
    with np.errstate(over="ignore"):  # what overflows is found below
        array = np.ascontiguousarray(values).astype(kind)
    if not np.isfinite(array).all():
        raise ArrayError(
            f"{name}: {np.abs(values).max():.3g} is too large; a page holds numbers up to "
            f"{np.finfo(kind).max:.2g} here."
        )
    return base64.b64encode(array.tobytes()).decode("ascii")
