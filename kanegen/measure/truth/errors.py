"""Errors of floating-point results of one state against exact ones.

- normwise: ||S (v - t)|| / ||S t|| with the factors S of `units`; Euclidean, or Frobenius for [A].
- absolute: ||S (v - t)||, in the unit that the factors S leave: m/s^2 for accelerations.
- largest: the largest |v_i - t_i|, each in the unit of its entry.
- componentwise: the largest |v_i - t_i| / |t_i|. An entry smaller than the unit roundoff times the largest
  one (after scaling) counts as that large, because an entry that is zero has no relative error.
- bits: log2(1 + number of floats between v_i and the float nearest to t_i), the mean over the entries and
  the largest. An entry that is not finite has lost all bits of its type. In more than double precision the
  error in units of the last place stands for the number of floats.
- backward: the largest row of [A]{ydot} - {f} - {tau}, each over the magnitudes of its terms, in units of
  N u. No rounding explains a value above `LARGEST_BACKWARD_ERROR`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.measure.errors import quotient, scaled_norm
from kanegen.measure.truth.enclosure import SUBNORMAL, Enclosure, precision_of
from kanegen.model.arrays import Flags, Floats
from kanegen.model.system import System
from kanegen.program.precision import DOUBLE, Precision

LARGEST_BACKWARD_ERROR = 10.0
"""Largest backward error of a correct program, in units of N u; a larger one means a wrong program."""

Wide = NDArray[np.longdouble]
"""Numbers with more digits than a double, where the platform has them."""

_RESOLUTION = 6 * float(np.finfo(np.longdouble).eps)
"""Least unit roundoff of a backward error: the resolution of long doubles for a body of six freedoms."""


@dataclass(frozen=True)
class Units:
    """Factors that take the units from accelerations and forces, so that they can be put into one norm.

    The unit of an angle and that of a translation differ by a length. The length that the tree has in a state
    is the root of the mean moment of inertia that an angle moves over the mean mass that a translation moves;
    both stand on the diagonal of [A]. Where there are only angles, or only translations, no error depends on
    this length.

    Attributes:
        acceleration: (n,) factors after which all accelerations are in m/s^2.
    """

    acceleration: Floats

    @property
    def force(self) -> Floats:
        """(n,) factors after which all generalized forces are in N."""
        return 1 / self.acceleration

    def of(self, output: str) -> Floats:
        """Return the factors of an output, in its shape; after them [A] is in kg."""
        if output == "mass_matrix":
            return np.outer(self.force, self.force)
        return self.acceleration if output == "forward_dynamics" else self.force


def units(system: System, diagonal: Floats) -> Units:
    """Return the factors in a state where [A] has the `diagonal` (n,)."""
    angles = np.array([freedom.is_angle for freedom in system.freedoms])
    length = np.sqrt(_mean(diagonal, angles) / _mean(diagonal, ~angles))
    return Units(np.where(angles, length if 0 < length < np.inf else 1.0, 1.0))


@dataclass(frozen=True)
class StateErrors:
    """Errors of one output in one state.

    Attributes:
        normwise: Normwise error.
        componentwise: Componentwise error.
        bits: Mean number of bits lost.
        worst_bits: Largest number of bits lost.
        absolute: Norm of the error after the units are taken away.
        largest: Largest error of an entry, in the unit of the entry.
    """

    normwise: float
    componentwise: float
    bits: float
    worst_bits: float
    absolute: float
    largest: float


@dataclass(frozen=True)
class Residual:
    """The equations [A]{ydot} = {f} + {tau} of one state, which tell a wrong solution from a rounded one.

    Attributes:
        matrix: (n, n) [A].
        right: (n,) {f} + {tau}.
        matrix_terms: (n, n) magnitudes of the terms that [A] is summed from.
        right_terms: (n,) magnitudes of the terms of the right-hand side.
        bodies: N.
    """

    matrix: Wide
    right: Wide
    matrix_terms: Floats
    right_terms: Floats
    bodies: int

    def backward_error(self, ydot: NDArray[Any], unit_roundoff: float) -> float:
        """Return the backward error of accelerations, in units of N u.

        Args:
            ydot: (n,) floats of any precision, or (n, 2) sums of two.
            unit_roundoff: u of the program that computed them.
        """
        parts = precision_of(ydot, self.right.shape).parts(ydot)
        solution = np.sum([part.astype(np.longdouble) for part in parts], axis=0)
        left = np.abs(self.matrix @ solution - self.right)
        terms = self.matrix_terms @ np.abs(solution) + self.right_terms
        with np.errstate(invalid="ignore", divide="ignore"):
            shares = np.where(left == 0, 0.0, left / terms)
        return float(shares.max()) / (self.bodies * max(unit_roundoff, _RESOLUTION))


def errors(value: NDArray[Any], truth: Enclosure, scale: Floats, unit_roundoff: float) -> StateErrors:
    """Return the errors of a result against the exact one, both of the shape of `scale`.

    Args:
        value: Floats of any precision, or sums of two along a last axis.
        truth: Exact output.
        scale: Factors that take the units away.
        unit_roundoff: Unit roundoff of the program that computed `value`.

    Raises:
        ArrayError: If the shapes differ.

    Example:
        >>> exact = truth.truth(system, x, y)
        >>> truth.errors(library.forcing(x, y), exact["forcing"], exact.units.of("forcing"), 2.0**-53)
    """
    distance = truth.distance(value)
    scaled = np.abs(truth.value) * scale
    floor = unit_roundoff * scaled.max()
    precision = precision_of(value, truth.shape)
    wide = precision.significand_bits > DOUBLE.significand_bits
    lost = places_lost(distance, truth.value, precision) if wide else bits_lost(value, truth.value)
    factors = scale[np.newaxis]
    absolute, size = (scaled_norm(values[np.newaxis], factors) for values in (distance, truth.value))
    return StateErrors(
        normwise=float(quotient(absolute, size)[0]),
        componentwise=float(quotient(distance * scale, np.maximum(scaled, floor)).max()),
        bits=float(lost.mean()),
        worst_bits=float(lost.max()),
        absolute=float(absolute[0]),
        largest=float(distance.max()),
    )


def bits_lost(value: NDArray[Any], truth: Floats) -> Floats:
    """Return log2(1 + number of floats between `value` and `truth` rounded to the type of `value`)."""
    whole = 8.0 * value.dtype.itemsize
    with np.errstate(over="ignore", under="ignore"):
        nearest = truth.astype(value.dtype)
    pairs = zip(_ordinals(value), _ordinals(nearest), np.isfinite(value).ravel(), strict=True)
    lost = [math.log2(1 + abs(a - b)) if finite else whole for a, b, finite in pairs]
    return np.reshape(lost, value.shape)


def places_lost(distance: Floats, truth: Floats, precision: Precision) -> Floats:
    """Return log2(1 + `distance` in last places of `truth`), at most the bits of the precision."""
    place = np.ldexp(np.spacing(np.abs(truth)), DOUBLE.significand_bits - precision.significand_bits)
    place = np.maximum(place, SUBNORMAL)
    with np.errstate(over="ignore"):
        lost: Floats = np.log2(1 + distance / place)
    return np.minimum(lost, 8.0 * precision.bytes)


def _ordinals(values: NDArray[Any]) -> list[int]:
    """Return the numbers of the floats, counted upward; both zeros have the number 0."""
    integers = np.ascontiguousarray(values).ravel().view(f"i{values.dtype.itemsize}").tolist()
    least = -(2 ** (8 * values.dtype.itemsize - 1))
    return [least - number if number < 0 else number for number in integers]


def _mean(values: Floats, selected: Flags) -> float:
    """Return the mean of the selected values, 1 where none is selected."""
    return float(np.mean(values[selected])) if selected.any() else 1.0
