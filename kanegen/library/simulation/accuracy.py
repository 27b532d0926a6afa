"""How good a trajectory is: digits against a reference, and drift of what should be constant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ArrayError, OptionError
from kanegen.model.arrays import Floats


@dataclass(frozen=True)
class Drift:
    """How a quantity that should be constant changes over time.

    Attributes:
        largest: Its largest distance from the first value, relative to `scale`.
        slope: Of the line that fits best (1/s), relative to `scale`: what grows in the long run.
        oscillation: The largest distance from that line, relative to `scale`.
        scale: What counts as one, in the unit of the quantity.
    """

    largest: float
    slope: float
    oscillation: float
    scale: float


def drift(times: Floats, values: Floats, scale: float) -> Drift:
    """The drift of `values` (T,) or (T, k), of which the component that drifts most counts.

    Raises:
        OptionError: If `scale` is not a positive number.
    """
    if not (np.isfinite(scale) and scale > 0):
        raise OptionError(f"scale of a drift: {scale!r} is not a positive number. Say what counts as one.")
    change = (np.reshape(values, (len(times), -1)) - np.reshape(values[0], (1, -1))) / scale
    middle = times - times.mean()
    slope = middle @ change / max(float(middle @ middle), np.finfo(np.float64).tiny)
    rest = change - change.mean(axis=0) - middle[:, None] * slope
    return Drift(
        float(np.abs(change).max()), float(np.abs(slope).max()), float(np.abs(rest).max()), float(scale)
    )


def mescd(found: ArrayLike, reference: ArrayLike, floor: float = 1.0) -> float:
    """Correct digits of the worst number, errors being relative to `floor` + its size.

    It is the mixed-error count of the test sets for initial value problems: the least of
    -log10(|found - reference| / (floor + |reference|)), `floor` being absolute over relative tolerance.

    Args:
        found: Numbers.
        reference: The exact ones, of the same shape.
        floor: Size below which errors count as absolute, in the units of the numbers.

    Raises:
        ArrayError: If the shapes differ.
        OptionError: If `floor` is negative.
    """
    ours, exact = np.asarray(found, np.float64), np.asarray(reference, np.float64)
    if ours.shape != exact.shape:
        raise ArrayError(f"reference: expected shape {ours.shape}, got {exact.shape}.")
    if not floor >= 0:
        raise OptionError(f"floor: {floor!r} is negative.")
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.abs(ours - exact) / (floor + np.abs(exact))
        return float(-np.log10(np.where(ours == exact, 0.0, errors).max(initial=0.0)))
