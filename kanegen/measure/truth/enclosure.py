"""Arrays of exact results: midpoints, and radii within which the exact numbers lie."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import ArrayError
from kanegen.measure.truth.balls import arb, arb_mat, ctx
from kanegen.model.arrays import Floats
from kanegen.program.precision import DOUBLE, DOUBLE_DOUBLE, PRECISIONS, Precision

SUBNORMAL = 5e-324
"""The smallest positive double, to which smaller radii are rounded up."""


@dataclass(frozen=True)
class Enclosure:
    """An array of exact numbers, each enclosed in a ball.

    Attributes:
        balls: The balls, row by row.
        shape: Shape of the array.
        bits: Working precision with which the balls were computed.

    Example:
        >>> exact = truth.truth(system, x, y)["forcing"]
        >>> exact.value, exact.radius, exact.distance(library.forcing(x, y))
    """

    balls: tuple[arb, ...]
    shape: tuple[int, ...]
    bits: int

    @cached_property
    def value(self) -> Floats:
        """Midpoints rounded to the nearest doubles; 0 where a ball contains 0."""
        return self._array(0.0 if ball.contains(0) else float(ball) for ball in self.balls)

    @cached_property
    def residue(self) -> Floats:
        """Midpoints less `value`, rounded: `value` and `residue` together are double-doubles."""
        with ctx.workprec(self.bits):
            pairs = zip(self.balls, self.value.ravel(), strict=True)
            return self._array(float(ball.mid() - arb(float(value))) for ball, value in pairs)

    @cached_property
    def radius(self) -> Floats:
        """Upper bounds of the distances of the exact numbers from the midpoints."""
        return self._array(_rounded_up(ball.rad()) for ball in self.balls)

    @property
    def fractions(self) -> tuple[Fraction, ...]:
        """Midpoints as exact fractions, row by row."""
        return tuple(_fraction(ball) for ball in self.balls)

    def distance(self, values: NDArray[Any]) -> Floats:
        """Return upper bounds of |`values` - exact|, infinite where a value is not finite.

        Args:
            values: Floats of any precision, or sums of two along a last axis; taken exactly.

        Raises:
            ArrayError: If `values` have another shape.
        """
        if values.shape not in (self.shape, (*self.shape, 2)):
            raise ArrayError(f"values have shape {values.shape}; expected {self.shape}.")
        with ctx.workprec(self.bits):
            parts = [part.ravel().tolist() for part in precision_of(values, self.shape).parts(values)]
            return self._array(map(_distance, self.balls, zip(*parts, strict=True)))

    def overlaps(self, other: Enclosure) -> bool:
        """Return whether one exact array can lie in both enclosures."""
        return all(a.overlaps(b) for a, b in zip(self.balls, other.balls, strict=True))

    def is_narrow(self, scale: Floats, width: float, floor: float) -> bool:
        """Return whether every radius is small enough.

        Args:
            scale: Factors that take the units away, of the shape of the array.
            width: Largest radius, relative to its entry.
            floor: Least size of an entry, relative to the largest entry after scaling. A smaller entry counts
                as that large, because an entry that is zero has no relative accuracy.
        """
        if not all(ball.is_finite() for ball in self.balls):
            return False
        with ctx.workprec(self.bits):
            scales = [arb(float(factor)) for factor in scale.ravel()]
            scaled = [ball * factor for ball, factor in zip(self.balls, scales, strict=True)]
            least = max(ball.abs_lower() for ball in scaled) * arb(floor)
            return all(ball.rad() <= arb(width) * ball.abs_lower().max(least) for ball in scaled)

    def _array(self, values: Iterable[float]) -> Floats:
        """Return numbers, row by row, as an array of this shape."""
        return np.fromiter(values, np.float64, len(self.balls)).reshape(self.shape)


def enclosure(matrix: arb_mat, shape: tuple[int, ...]) -> Enclosure:
    """Return the enclosure of a matrix that was computed with the current working precision."""
    return Enclosure(tuple(matrix.entries()), shape, ctx.prec)


def precision_of(values: NDArray[Any], shape: tuple[int, ...]) -> Precision:
    """Return the precision of results for numbers of this `shape`; sums of two have one axis more."""
    if values.shape != shape:
        return DOUBLE_DOUBLE
    return next((p for p in PRECISIONS.values() if p.dtype == values.dtype), DOUBLE)


def _distance(ball: arb, parts: Sequence[float]) -> float:
    """Return an upper bound of the distance of a sum of floats from the exact number in a ball."""
    for part in parts:
        if not math.isfinite(part):
            return math.inf
        ball -= arb(part)
    return _rounded_up(ball.abs_upper())


def _rounded_up(size: arb) -> float:
    """Return an upper bound of `size`, which is not negative and has no radius."""
    nearest = float(size)
    if arb(nearest) >= size:
        return nearest
    return max(math.nextafter(nearest, math.inf), SUBNORMAL)


def _fraction(ball: arb) -> Fraction:
    """Return the midpoint of a ball."""
    mantissa, exponent = (int(part) for part in ball.mid().man_exp())
    return Fraction(mantissa) * Fraction(2) ** exponent
