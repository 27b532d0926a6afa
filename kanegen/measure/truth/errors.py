"""Errors of floating-point results against exact ones, one number a state.

- normwise: ||S (v - t)|| / ||S t|| with the factors S of `units`, which take the units away; Euclidean, or
  Frobenius for [A].
- componentwise: the largest |v_i - t_i| / |t_i|. An entry smaller than the unit roundoff times the largest
  (after scaling) counts as that large, because one that is zero has no relative error.
- bits: log2(1 + floats between v_i and the float nearest to t_i), the mean over the entries and the worst.
  What is not finite has all the bits of its type. In more than double precision the error in units of the
  last place stands for the floats between.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.measure.truth.enclosure import SUBNORMAL, Enclosure, precision_of
from kanegen.model.arrays import Floats
from kanegen.program.precision import DOUBLE, Precision
from kanegen.reference.matrices import length


@dataclass(frozen=True)
class Errors:
    """The errors of one output in one state."""

    normwise: float
    componentwise: float
    bits: float
    worst_bits: float


def errors(value: NDArray[Any], truth: Enclosure, scale: Floats, unit_roundoff: float) -> Errors:
    """Compare `value` with the exact `truth`, both of the shape of `scale`.

    Args:
        value: Floats of any precision, or sums of two along a last axis.
        truth: The exact output.
        scale: Factors that take the units away.
        unit_roundoff: Of the program that computed `value`.

    Raises:
        ArrayError: If the shapes differ.
    """
    distance = truth.distance(value)
    scaled, difference = np.abs(truth.value) * scale, distance * scale
    floor = unit_roundoff * scaled.max()
    precision = precision_of(value, truth.shape)
    wide = precision.digits > DOUBLE.digits
    lost = places_lost(distance, truth.value, precision) if wide else bits_lost(value, truth.value)
    return Errors(
        normwise=_ratio(_norm(difference), _norm(scaled)),
        componentwise=max(map(_ratio, difference.ravel(), np.maximum(scaled, floor).ravel())),
        bits=float(lost.mean()),
        worst_bits=float(lost.max()),
    )


def bits_lost(value: NDArray[Any], truth: Floats) -> Floats:
    """log2(1 + floats of the type of `value` between `value` and `truth` rounded to it)."""
    whole = 8.0 * value.dtype.itemsize
    with np.errstate(over="ignore", under="ignore"):
        nearest = truth.astype(value.dtype)
    pairs = zip(_ordinals(value), _ordinals(nearest), np.isfinite(value).ravel(), strict=True)
    lost = [math.log2(1 + abs(a - b)) if finite else whole for a, b, finite in pairs]
    return np.reshape(lost, value.shape)


def places_lost(distance: Floats, truth: Floats, precision: Precision) -> Floats:
    """log2(1 + `distance` in units of the last place of `truth`), at most the bits of the precision."""
    place = np.ldexp(np.spacing(np.abs(truth)), DOUBLE.digits - precision.digits)
    place = np.maximum(place, SUBNORMAL)
    with np.errstate(over="ignore"):
        lost: Floats = np.log2(1 + distance / place)
    return np.minimum(lost, 8.0 * precision.bytes)


def _ordinals(values: NDArray[Any]) -> list[int]:
    """Numbers of the floats, counted upward, both zeros being 0."""
    integers = np.ascontiguousarray(values).ravel().view(f"i{values.dtype.itemsize}").tolist()
    least = -(2 ** (8 * values.dtype.itemsize - 1))
    return [least - number if number < 0 else number for number in integers]


def _norm(values: Floats) -> float:
    return float(length(values.ravel()))


def _ratio(difference: float, size: float) -> float:
    """The quotient: 0 where there is no difference, infinite where there is nothing to compare with."""
    if difference == 0:
        return 0.0
    return float(difference / size) if size > 0 else math.inf
