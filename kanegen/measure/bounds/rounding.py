"""Bounds of single rounding errors: half a unit in the last place of the largest possible result.

For results up to r that is u 2^floor(log2 r), with the unit roundoff u, or half the smallest subnormal number
where that is more. Sign changes are exact. So are products with powers of two, unless they underflow.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from kanegen.measure.bounds.arithmetic import Step
from kanegen.measure.bounds.intervals import Intervals, up_product, up_sum
from kanegen.model.arrays import Floats
from kanegen.program.constants import MULTIPRECISION
from kanegen.program.elementary import PLACES, SUBNORMAL_PLACES
from kanegen.program.ir import Op
from kanegen.program.precision import DOUBLE, Precision


class Sines(Protocol):
    """The errors of one implementation of sine and cosine."""

    def error(self, is_sine: bool, angle: Intervals, magnitude: Floats) -> Floats:
        """Return bounds of the errors of sines or cosines.

        Args:
            is_sine: Whether it is the sine.
            angle: (B,) ranges of the angle.
            magnitude: (B,) bounds of the exact results.
        """
        ...


_TINY = 5e-324
"""The smallest double."""


@dataclass(frozen=True)
class Roundings:
    """The rounding errors of steps.

    Attributes:
        sines: Errors of sine and cosine by precision.
    """

    sines: Mapping[Precision, Sines]

    def of(
        self, step: Step, steps: Sequence[Step], operands: Sequence[Intervals], magnitude: Floats
    ) -> Floats:
        """Return a bound of the rounding error of one step.

        Args:
            step: The step.
            steps: All steps.
            operands: (B,) ranges of the computed operands.
            magnitude: (B,) bounds of the result before it is rounded.
        """
        precision = step.precision
        match step.op:
            case Op.INPUT | Op.NEGATE | Op.ABS | Op.SIGN | Op.MIN | Op.MAX | Op.SELECT:
                return np.zeros(())
            case Op.EXP | Op.LOG | Op.TANH | Op.ATAN2:
                places = up_product(half_ulp(magnitude, precision), np.asarray(2 * PLACES[step.op]))
                subnormal = np.asarray(2 * SUBNORMAL_PLACES * smallest_error(precision))
                return _beyond_range(up_sum([places, subnormal]), magnitude, precision)
            case Op.CONSTANT:
                return np.asarray(constant_error(step))
            case Op.SIN | Op.COS:
                return self.sines[precision].error(step.op is Op.SIN, operands[0], magnitude)
            case Op.MULTIPLY if any(_is_power_of_two(steps[j]) for j in step.operands):
                return _beyond_range(np.full_like(magnitude, smallest_error(precision)), magnitude, precision)
        return _beyond_range(half_ulp(magnitude, precision), magnitude, precision)


def half_ulp(magnitude: Floats, precision: Precision) -> Floats:
    """Return the largest error of rounding a number up to `magnitude` to nearest."""
    _, exponent = np.frexp(magnitude)
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        below = np.ldexp(1.0, exponent - 1)
        beyond = np.nextafter(magnitude - below, np.inf)
        upper, lower = (np.ldexp(precision.roundoff, exponent - k) for k in (1, 2))
        half: Floats = np.where(magnitude > 0.0, np.minimum(upper, np.maximum(lower, beyond)), 0.0)
    return np.maximum(half, smallest_error(precision))


def smallest_error(precision: Precision) -> float:
    """Return an upper bound of half the smallest subnormal number of a precision."""
    return float(np.finfo(np.float32).smallest_subnormal) / 2 if precision.significand_bits < 53 else _TINY


def constant_error(step: Step) -> float:
    """Return a bound of the difference between the exact value of a constant and that in C."""
    exact, precision = MULTIPRECISION.mpf(step.number), step.precision
    if precision.significand_bits > DOUBLE.significand_bits:
        return float(abs(exact)) * precision.roundoff * (1 + 2.0**-40) + _TINY
    gap = abs(exact - step.value_in_c)
    return 0.0 if gap == 0 else math.nextafter(float(gap), math.inf)


def largest(precision: Precision) -> float:
    """Return the largest finite number of a precision, or of double where that is smaller."""
    return float(np.finfo(np.float32 if precision.significand_bits < 53 else np.float64).max)


def _beyond_range(error: Floats, magnitude: Floats, precision: Precision) -> Floats:
    """Return `error`, infinite where a result may be beyond the largest number."""
    return np.where(magnitude < largest(precision), error, np.inf)


def _is_power_of_two(step: Step) -> bool:
    """Return whether a step is a constant that is a power of two in C, up to the sign."""
    return step.op is Op.CONSTANT and abs(math.frexp(step.value_in_c)[0]) == 0.5
