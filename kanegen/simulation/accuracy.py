"""Accuracy of a trajectory: correct digits against a reference, and drift of conserved quantities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ArrayError, OptionError
from kanegen.model.arrays import Floats


@dataclass(frozen=True)
class Drift:
    """How a quantity that should be constant changes over time, relative to a scale.

    Attributes:
        largest: Largest distance from the first value, over `scale`.
        slope: Slope of the line of best fit, 1/s, over `scale`: the growth in the long run.
        oscillation: Largest distance from that line, over `scale`.
        scale: The value that counts as one, in the unit of the quantity.
    """

    largest: float
    slope: float
    oscillation: float
    scale: float


def drift(times: Floats, values: Floats, scale: float) -> Drift:
    """Return the drift of a quantity; of a vector, that of the component that drifts most.

    Args:
        times: (T,) times, s.
        values: (T,) or (T, k) values at these times.
        scale: The value that counts as one, in the unit of `values`.

    Raises:
        OptionError: If `scale` is not a positive number.
    """
    if not (np.isfinite(scale) and scale > 0):
        raise OptionError(f"scale of a drift: {scale!r} is not a positive number. Give a positive scale.")
    change = (np.reshape(values, (len(times), -1)) - np.reshape(values[0], (1, -1))) / scale
    middle = times - times.mean()
    slope = middle @ change / max(float(middle @ middle), np.finfo(np.float64).tiny)
    rest = change - change.mean(axis=0) - middle[:, None] * slope
    return Drift(
        float(np.abs(change).max()), float(np.abs(slope).max()), float(np.abs(rest).max()), float(scale)
    )


def mescd(found: ArrayLike, reference: ArrayLike, floor: float = 1.0) -> float:
    """Return the number of correct digits of the least correct number.

    This is the mixed-error significant correct digits of the test sets for initial value problems: the least
    of -log10(|found - reference| / (floor + |reference|)), where `floor` is the absolute over the relative
    tolerance.

    Args:
        found: Computed numbers.
        reference: Exact numbers, of the same shape.
        floor: Size below which errors count as absolute, in the unit of the numbers.

    Raises:
        ArrayError: If the shapes differ.
        OptionError: If `floor` is negative.

    Example:
        digits = mescd([0.333, 0.667], [1 / 3, 2 / 3])
    """
    ours, exact = np.asarray(found, np.float64), np.asarray(reference, np.float64)
    if ours.shape != exact.shape:
        raise ArrayError(f"reference: expected shape {ours.shape}, got {exact.shape}.")
    if not floor >= 0:
        raise OptionError(f"floor: {floor!r} is negative.")
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.abs(ours - exact) / (floor + np.abs(exact))
        return float(-np.log10(np.where(ours == exact, 0.0, errors).max(initial=0.0)))
