"""What a user may pass, and how it becomes what C can read: contiguous arrays of its type and exact shape."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import ArrayError

Floats = NDArray[np.floating[Any]]
"""Numbers of the precision of a library, or parts of them."""

Shape = tuple[int, ...]

LOADS = {"force": "body", "torque": "body", "point_force": "point", "point_moment": "point"}
"""Arguments with a row for everything of a kind, of which only some take any."""

OPTIONAL = LOADS.keys() | {"tau"}
"""Arguments that may be left out, which is zero."""

FURTHER = {
    "point_force": "in N",
    "point_moment": "in N m",
    "t": "the time in s",
    "prescribed": "(3, {count}) values, rates and second derivatives of {prescribed}",
}
"""Arguments that only some models have, and what they are."""

ARGUMENTS = ("x", "y", "ydot", "tau", "force", "torque", *FURTHER)
"""What a user may pass, in the order in which `Call` takes it."""

COMMON = OPTIONAL | FURTHER.keys()
"""Arguments of which one may serve all states of a batch."""

Values = tuple[object, ...]
"""One for each of `ARGUMENTS`, None where there is none."""


def floats(name: str, value: object, dtype: np.dtype[Any]) -> Floats:
    """`value` as a contiguous array of the type `dtype`, itself if it is one.

    Integers and other floats are rounded to it, and so are lists and arrays in any order of memory; NaN and
    infinity pass.

    Raises:
        ArrayError: If it is ragged, masked, holds anything but real numbers, or one that is too large.
    """
    if type(value) is np.ndarray and value.dtype == dtype and value.flags.carray:
        return value
    if isinstance(value, np.ma.MaskedArray):
        raise ArrayError(f"{name}: masked arrays have no meaning here; fill it first.")
    try:
        array = np.asarray(value)
    except ValueError:
        raise ArrayError(f"{name}: the rows have different lengths.") from None
    if array.dtype.kind not in "iuf":
        raise ArrayError(f"{name}: expected real numbers, got {_kind(value, array)}.")
    try:
        with np.errstate(over="raise", under="ignore"):
            return np.require(array, dtype, ["C_CONTIGUOUS", "ALIGNED"])
    except FloatingPointError:
        raise ArrayError(f"{name}: a number leaves the range of {dtype}.") from None


def state(name: str, value: object, shape: Shape, dtype: np.dtype[Any]) -> Floats:
    """One state, `shape`, or a batch of them, `(B, *shape)`.

    Raises:
        ArrayError: If it is neither.
    """
    array = floats(name, value, dtype)
    if array.shape != shape and array.shape[1:] != shape:
        batch = f"({', '.join(['B', *map(str, shape)])})"
        raise ArrayError(f"{name}: expected shape {shape} or {batch}, got {array.shape}.")
    return array


def companion(
    name: str, value: object, shape: Shape, batch: Shape, dtype: np.dtype[Any], first: str
) -> Floats:
    """What goes with the states of the argument `first`, which is a batch of shape `batch`.

    Raises:
        ArrayError: If the shape is not `(*batch, *shape)`.
    """
    array = floats(name, value, dtype)
    if array.shape != (*batch, *shape):
        raise ArrayError(f"{name}: expected shape {(*batch, *shape)} to go with {first}, got {array.shape}.")
    return array


def required(name: str, value: object, what: str) -> object:
    """What must be passed where a function reads it.

    Raises:
        ArrayError: If it was not.
    """
    if value is None:
        raise ArrayError(f"{name}: it is missing, and the result depends on it. Pass {name}=..., {what}.")
    return value


def load(
    name: str, value: object, shape: Shape, batch: Shape, dtype: np.dtype[Any], unloaded: Mapping[int, str]
) -> Floats:
    """Loads: None for none, `shape` for the same in every state, or `(*batch, *shape)`.

    Args:
        name: Of the argument.
        value: What was passed.
        shape: (N, 3) for loads on bodies, and a last axis for numbers in parts.
        batch: `()` or `(B,)`.
        dtype: Of the numbers.
        unloaded: Rows of what takes no loads, and what it is.

    Raises:
        ArrayError: If the shape is another, or a body that takes no loads would get one.
    """
    full = (*batch, *shape)
    if value is None:
        return np.zeros(full, dtype)
    array = floats(name, value, dtype)
    if array.shape not in (shape, full):
        either = f"{shape} or {full}" if batch else f"{shape}"
        raise ArrayError(f"{name}: expected shape {either}, got {array.shape}.")
    rows = np.moveaxis(array, array.ndim - len(shape), 0) if unloaded else ()
    row = next((row for row in unloaded if rows[row].any()), None)
    if row is not None:
        raise ArrayError(
            f"{name}: row {row} is not zero, but {unloaded[row]} takes no loads. Say that it does in the "
            "model's loads."
        )
    return array if array.shape == full else np.ascontiguousarray(np.broadcast_to(array, full))


def _kind(value: object, array: NDArray[np.generic]) -> str:
    return "None" if value is None else f"an array of {array.dtype}"
