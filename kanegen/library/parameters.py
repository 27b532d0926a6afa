"""Values of run-time parameters that a call takes: one set, or a set for each state of a batch."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, ModelError, quoted
from kanegen.model.arguments import Floats, floats

Parameters = ArrayLike | Mapping[str, ArrayLike]
"""(P,) or (B, P) values in the order of `Library.parameter_names`, or a number or (B,) values by name."""


def parameter_sets(values: Parameters, usual: Mapping[str, float], dtype: np.dtype[Any]) -> ArrayLike:
    """Return values of all parameters, (P,) or (B, P), in the order of the C array.

    Args:
        values: Values as an array, which is returned as it is, or by name.
        usual: Values by name of the parameters that a table leaves out, in the order of the C array.
        dtype: Type of the numbers.

    Raises:
        ModelError: If there is no parameter of a name.
        ArrayError: If a value by name is neither a number nor a row of numbers, or two rows differ in length.

    Example:
        parameter_sets({"m1": [1.0, 2.0]}, {"m1": 3.0, "m2": 4.0}, np.dtype(float))  # [[1, 4], [2, 4]]
    """
    if not isinstance(values, Mapping):
        return values
    for name in values:
        if name not in usual:
            raise ModelError(f"unknown parameter {quoted(name)}. {did_you_mean(name, usual)}")
    columns = {name: _column(name, values[name], dtype) for name in values}
    rows = {name: len(column) for name, column in columns.items() if column.ndim}
    if len(set(rows.values())) > 1:
        sizes = ", ".join(f"{quoted(name)} {count}" for name, count in rows.items())
        raise ArrayError(f"parameters: the numbers of values for states of a batch differ: {sizes}.")
    every = [columns.get(name, np.asarray(usual[name], dtype)) for name in usual]
    return np.stack(np.broadcast_arrays(*every), axis=-1)


def _column(name: object, value: ArrayLike, dtype: DTypeLike) -> Floats:
    """Return the values of one parameter, () or (B,)."""
    column = floats(f"parameter {quoted(name)}", value, np.dtype(dtype))
    if column.ndim > 1:
        raise ArrayError(f"parameter {quoted(name)}: expected a number or shape (B,), got {column.shape}.")
    return column
