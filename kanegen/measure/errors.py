"""The error of one output, state by state; `compare` says what the numbers mean."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import ArrayError
from kanegen.model.arrays import Floats


@dataclass(frozen=True)
class StateErrors:
    """One output in B states; every field is (B,). The last three are of the worst entry."""

    normwise: Floats
    componentwise: Floats
    cancellation: Floats
    finite: NDArray[np.bool_]
    entry: NDArray[np.int64]
    value: Floats
    reference: Floats


def state_errors(
    value: NDArray[Any], truth: Floats, size: Floats, scale: Floats, limit: float
) -> StateErrors:
    """Compare `value` with `truth`; what is not finite counts as an infinite error.

    Args:
        value: (B, ...) what a library computed.
        truth: (B, ...) what the reference computed.
        size: (B, ...) magnitudes of the terms of `truth`.
        scale: (B, ...) factors that take the units away.
        limit: Relative to the norm of `size`, the norm of a `truth` that is nothing but rounding.

    Raises:
        ArrayError: If `value` has another shape than `truth`.
    """
    if np.shape(value) != truth.shape:
        raise ArrayError(f"the library returned shape {np.shape(value)}; expected {truth.shape}.")
    value, truth, size, scale = (array.reshape(len(truth), -1) for array in (value, truth, size, scale))
    finite = np.isfinite(value) & np.isfinite(truth)
    difference = np.full(truth.shape, np.inf)
    np.abs(np.subtract(value, truth, where=finite, out=difference), out=difference)
    ratio = _quotient(difference, size)
    rows, entry = np.arange(len(truth)), ratio.argmax(axis=1)
    norm, size_norm = _norm(truth * scale), _norm(size * scale)
    return StateErrors(
        normwise=_quotient(_norm(difference * scale), np.where(norm > limit * size_norm, norm, size_norm)),
        componentwise=ratio[rows, entry],
        cancellation=_quotient(size_norm, norm),
        finite=np.all(finite, axis=1),
        entry=entry,
        value=value[rows, entry],
        reference=truth[rows, entry],
    )


def _norm(values: Floats) -> Floats:
    """(B,) Euclidean norms."""
    norm: Floats = np.linalg.norm(values, axis=1)
    return norm


def _quotient(a: Floats, b: Floats) -> Floats:
    """The quotient of `a` and `b`: 0 where `a` is 0, infinite where it cannot be computed."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        quotient = np.where(a == 0, 0.0, a / b)
    return np.where(np.isnan(quotient), np.inf, quotient)


def joined(batches: list[StateErrors]) -> StateErrors:
    """The errors of several batches as those of one."""
    names = [field.name for field in fields(StateErrors)]
    return StateErrors(**{name: np.concatenate([getattr(part, name) for part in batches]) for name in names})
