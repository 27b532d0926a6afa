"""Arrays that a caller passes: their names, and their conversion to contiguous arrays that C can read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.errors import ArrayError

Floats = NDArray[np.floating[Any]]
"""Numbers in the precision of a library; a double-double number is its two parts along a last axis."""

Shape = tuple[int, ...]

LOADS = {"force": "body", "torque": "body", "point_force": "point", "point_moment": "point"}
"""Load arguments with one row for each body or point, of which only some may take loads."""

OPTIONAL = LOADS.keys() | {"tau"}
"""Arguments that may be left out, which means zero."""

MODEL_DEPENDENT = {
    "point_force": "in N",
    "point_moment": "in N m",
    "t": "the time in s",
    "prescribed": "(3, {count}) values, rates and second derivatives of {prescribed}",
}
"""Arguments that only some models have, and descriptions of them for error messages."""

OF_PRODUCTS = ("weights", "direction", "state_direction")
"""Arguments of products with derivatives alone."""

ARGUMENTS = ("x", "y", "ydot", *OF_PRODUCTS, "tau", "force", "torque", *MODEL_DEPENDENT)
"""Names of all arguments, in the order of the C functions and of the methods of `Library`."""

STEP = {"step": "the length of the step in s"}
"""The argument of functions that follow a motion, and its description for error messages."""

SHAREABLE = OPTIONAL | MODEL_DEPENDENT.keys() | STEP.keys()
"""Arguments that may have one value for all states of a batch."""

Values = tuple[object, ...]
"""Values of the arguments of one function, in order, None where the caller passed none."""


class LoadInputs(TypedDict, total=False):
    """Loads on points and the time, as keyword arguments, each with or without an axis for the batch.

    Attributes:
        point_force: (P, 3) or (B, P, 3) force on each point that takes loads (N), in inertial components or
            those of its `load_frame`; None means zero.
        point_moment: (P, 3) or (B, P, 3) moment on the body of each such point, inertial components (N m).
        t: () or (B,) time (s), where a force element depends on it.
    """

    point_force: ArrayLike | None
    point_moment: ArrayLike | None
    t: ArrayLike


class NamedInputs(LoadInputs, total=False):
    """Inputs that only some systems have, as keyword arguments: those of `LoadInputs`, motion, parameters.

    Attributes:
        prescribed: (3, p) or (B, 3, p) values (rad, m), rates and second derivatives of the prescribed
            freedoms, in the order of `prescribed_names`.
        parameters: Run-time parameters for this call in place of those of the library: (P,) in the order of
            `parameter_names`, or (B, P) for each state of a batch, which takes a library that was built with
            `parameters_by_state`; or a number or (B,) values by name of the parameter.
    """

    prescribed: ArrayLike
    parameters: ArrayLike | Mapping[str, ArrayLike] | None


def floats(name: str, value: object, dtype: np.dtype[Any]) -> Floats:
    """Return `value` as a contiguous array of type `dtype`; an array that is one already is not copied.

    Integers and other floats are rounded to the type; NaN and infinity pass.

    Args:
        name: Name of the argument, used in error messages.
        value: What the caller passed.
        dtype: Type of the numbers.

    Raises:
        ArrayError: If `value` is ragged or masked, or contains anything but real numbers in the range of the
            type.
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
    """Return an argument that is one state, `shape`, or a batch of states, `(B, *shape)`.

    Raises:
        ArrayError: If the argument has neither shape.
    """
    array = floats(name, value, dtype)
    if array.shape != shape and array.shape[1:] != shape:
        batch = f"({', '.join(['B', *map(str, shape)])})"
        raise ArrayError(f"{name}: expected shape {shape} or {batch}, got {array.shape}.")
    return array


def companion(
    name: str, value: object, shape: Shape, batch: Shape, dtype: np.dtype[Any], first: str
) -> Floats:
    """Return an argument with one value for each state of the argument `first`.

    Args:
        name: Name of the argument, used in error messages.
        value: What the caller passed.
        shape: Shape for one state.
        batch: Shape of the batch: `()` or `(B,)`.
        dtype: Type of the numbers.
        first: Name of the argument that sets the batch.

    Raises:
        ArrayError: If the shape is not `(*batch, *shape)`.
    """
    array = floats(name, value, dtype)
    if array.shape != (*batch, *shape):
        raise ArrayError(f"{name}: expected shape {(*batch, *shape)} to go with {first}, got {array.shape}.")
    return array


def required(name: str, value: object, label: str) -> object:
    """Return the value of an argument on which the result depends.

    Raises:
        ArrayError: If the caller passed none; the message describes the argument by `label`.
    """
    if value is None:
        raise ArrayError(f"{name}: missing, but the result depends on this input. Pass {name}=..., {label}.")
    return value


def load(
    name: str, value: object, shape: Shape, batch: Shape, dtype: np.dtype[Any], unloaded: Mapping[int, str]
) -> Floats:
    """Return loads of shape `(*batch, *shape)`.

    Args:
        name: Name of the argument, used in error messages.
        value: None for no loads, `shape` for the same loads in every state, or `(*batch, *shape)`.
        shape: (N, 3) for loads on bodies; numbers in parts have a further last axis.
        batch: Shape of the batch: `()` or `(B,)`.
        dtype: Type of the numbers.
        unloaded: Rows of bodies or points that take no loads, with their names.

    Raises:
        ArrayError: If the shape is another, or a row that takes no loads is not zero.
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
            f"{name}: row {row} is not zero, but {unloaded[row]} takes no loads. Enter it among the loads of "
            "the model."
        )
    return array if array.shape == full else np.ascontiguousarray(np.broadcast_to(array, full))


def _kind(value: object, array: NDArray[np.generic]) -> str:
    """Return the description of a wrong argument for an error message."""
    return "None" if value is None else f"an array of {array.dtype}"
