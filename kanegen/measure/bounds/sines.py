"""Proven errors of sine and cosine: those of kanegen itself, and those that are assumed of a C library.

kanegen's sine and cosine are a reduced angle, two polynomials and a last rounding. What precedes the last
rounding is bounded on intervals of the reduced angle: the rounding errors of the polynomials by the same
sweeps as those of a model, their difference to the functions by `approximation`, the angle by `reduction`.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from kanegen.c.polynomial import SHORT
from kanegen.c.sincos import Sincos
from kanegen.measure.bounds.approximation import largest_error
from kanegen.measure.bounds.arithmetic import Step
from kanegen.measure.bounds.intervals import Intervals, up_sum
from kanegen.measure.bounds.ranges import ranges
from kanegen.measure.bounds.reduction import UNREDUCED, reduction
from kanegen.measure.bounds.relations import Relations
from kanegen.measure.bounds.rounding import Roundings, half_ulp
from kanegen.measure.bounds.sensitivities import Dependents, output_errors
from kanegen.model.arrays import Floats
from kanegen.program.ir import Op
from kanegen.program.precision import Precision

BOXES = 64
"""Number of intervals of the reduced angle."""

_SUBNORMAL = 2.0**-149
"""The smallest subnormal number of single precision, the largest of all precisions."""

_LARGEST_SINE = 0.71
"""More than the sine of every reduced angle."""

_LEAST_COSINE = 0.7
"""Less than the cosine of every reduced angle."""


@dataclass(frozen=True)
class LibmSines:
    """Sine and cosine of a C library, which are assumed to err by at most one unit in the last place.

    Attributes:
        precision: Precision of the arithmetic.
    """

    precision: Precision

    def error(self, is_sine: bool, angle: Intervals, magnitude: Floats) -> Floats:
        """Return bounds of the errors; see `rounding.Sines`."""
        _, exponent = np.frexp(np.minimum(magnitude, 0.75))
        unit: Floats = np.ldexp(2 * self.precision.roundoff, exponent - 1)
        return np.maximum(unit, _SUBNORMAL)


@dataclass(frozen=True)
class PolynomialErrors:
    """What precedes the last rounding of both polynomials, for reduced angles up to ends.

    Attributes:
        ends: (k,) ends of intervals of |r|, increasing.
        sine: (k,) bounds of the error of the sine for |r| up to each end.
        cosine: (k,) bounds of the error of the cosine.
    """

    ends: Floats
    sine: Floats
    cosine: Floats

    def up_to(self, errors: Floats, angle: Floats) -> Floats:
        """Return the bounds among `errors` for reduced angles up to `angle`."""
        found: Floats = errors[np.minimum(np.searchsorted(self.ends, angle), len(self.ends) - 1)]
        return found


@dataclass(frozen=True)
class KanegenSines:
    """kanegen's own sine and cosine.

    Attributes:
        sincos: Their coefficients.
        unreduced: Errors for angles up to `UNREDUCED`.
        reduced: Errors for all other angles up to the limit.
    """

    sincos: Sincos
    unreduced: PolynomialErrors
    reduced: PolynomialErrors

    def error(self, is_sine: bool, angle: Intervals, magnitude: Floats) -> Floats:
        """Return bounds of the errors; see `rounding.Sines`."""
        size = angle.magnitude
        own = self.unreduced.sine if is_sine else self.unreduced.cosine
        largest = np.minimum(magnitude, _LARGEST_SINE) if is_sine else magnitude
        near = self._rounded(self.unreduced.up_to(own, size), largest)
        reduced = self.reduced
        odd = np.minimum(magnitude, _LARGEST_SINE)
        by_sine = self._rounded(reduced.up_to(reduced.sine, 1.12 * odd + 1e-12), odd)
        by_cosine = self._rounded(reduced.cosine[-1], magnitude)
        far = np.where(magnitude < _LEAST_COSINE, by_sine, np.maximum(by_sine, by_cosine))
        found = np.where(size <= UNREDUCED, near, np.maximum(far, near))
        return np.where(size <= float(self.sincos.limit), found, np.inf)

    def _rounded(self, before: Floats, magnitude: Floats) -> Floats:
        """Return bounds `before` with the last rounding added.

        A result beyond the next power of two above `magnitude` is no farther from it than `before`.
        """
        precision, exact = self.sincos.precision, np.minimum(magnitude, 1.0)
        last = np.minimum(
            half_ulp(up_sum([exact, before]), precision), np.maximum(half_ulp(exact, precision), before)
        )
        return up_sum([last, before])


@functools.cache
def kanegen_sines(sincos: Sincos) -> KanegenSines:
    """Return the proven errors of one of kanegen's implementations."""
    found = reduction(sincos)
    return KanegenSines(
        sincos,
        _polynomial_errors(sincos, UNREDUCED, 0.0, 0.0),
        _polynomial_errors(sincos, found.largest, found.excess, found.error),
    )


def _polynomial_errors(sincos: Sincos, largest: float, excess: float, error: float) -> PolynomialErrors:
    """Return the errors for reduced angles of which excess and error are bounded."""
    ends = np.linspace(0.0, largest, BOXES + 1)
    ends[-1] = largest
    angle = Intervals(ends[None, :-1], ends[None, 1:])
    beside = Intervals(np.full((1, BOXES), -excess), np.full((1, BOXES), excess))
    box = {"high": angle, "excess": beside}
    end = Fraction(float(np.nextafter(largest * largest, np.inf)))
    neglected = error + (excess + error) ** 2
    series = (3, 1, 3), (4, 1, 4)
    if sincos.plain:
        series = (3, -1, 3), (2, -1, 2)
    errors = []
    for (first, sign, power), coefficients, code, slope in (
        (series[0], sincos.sine, _sine_steps(sincos), largest**4 / 24),
        (series[1], sincos.cosine, _cosine_steps(sincos), largest**3 / 6),
    ):
        rounding = _rounding_errors(code, box, sincos.precision)
        exact = tuple(float(sincos.precision.dtype.type(c)) for c in coefficients)
        rest = largest_error(exact, first, sign, power, end) + neglected + excess * slope
        errors.append(np.maximum.accumulate(up_sum([rounding, np.asarray(rest * (1 + 2.0**-40))])))
    return PolynomialErrors(ends[1:], *errors)


@dataclass(frozen=True)
class _Code:
    """The operations of one polynomial.

    Attributes:
        steps: Steps; the last is the result.
        exact: Numbers of steps whose rounding error is corrected later, or counted as the last rounding.
        added: Numbers of the steps to which the correction is added, with a rounding error of its own.
    """

    steps: tuple[Step, ...]
    exact: tuple[int, ...]
    added: tuple[int, ...] = ()


def _rounding_errors(code: _Code, box: dict[str, Intervals], precision: Precision) -> Floats:
    """Return (BOXES,) bounds of the rounding errors of a polynomial without its last rounding."""
    relations, roundings = Relations(code.steps), Roundings({})
    found = ranges(code.steps, relations, box, roundings)
    corrected = [np.zeros(BOXES) if i in code.exact else e for i, e in enumerate(found.rounding)]
    last = Dependents(code.steps, [len(code.steps) - 1])
    errors = output_errors(code.steps, relations, replace(found, rounding=corrected), last)
    own = [
        half_ulp(up_sum([found.computed[i].magnitude, np.asarray(precision.roundoff)]), precision)
        for i in code.added
    ]
    return up_sum([errors[0], *own])


class _Writer:
    """Steps in the order of the C of `sincos.jinja`."""

    def __init__(self, precision: Precision) -> None:
        self._precision = precision
        self.steps: list[Step] = []
        self.high = self._append(Step(Op.INPUT, (), precision, array="high"))
        self.excess = self._append(Step(Op.INPUT, (), precision, array="excess"))

    def constant(self, number: float) -> int:
        """Append a coefficient, which C holds in the precision of the arithmetic."""
        rounded = float(self._precision.dtype.type(number))
        return self._append(Step(Op.CONSTANT, (), self._precision, number=rounded))

    def apply(self, op: Op, a: int, b: int) -> int:
        """Append an operation on two values."""
        return self._append(Step(op, (a, b), self._precision))

    def polynomial(self, coefficients: Sequence[float], z: int) -> int:
        """Append a polynomial as `Sincos.polynomial` writes it."""
        pairs = len(coefficients) > SHORT
        power = self.apply(Op.MULTIPLY, z, z) if pairs else z
        total: int | None = None
        for k in reversed(range(0, len(coefficients), 2 if pairs else 1)):
            terms = self.constant(coefficients[k])
            if pairs and k + 1 < len(coefficients):
                product = self.apply(Op.MULTIPLY, self.constant(coefficients[k + 1]), z)
                terms = self.apply(Op.ADD, terms, product)
            if total is not None:
                terms = self.apply(Op.ADD, terms, self.apply(Op.MULTIPLY, power, total))
            total = terms
        assert total is not None
        return total

    def _append(self, step: Step) -> int:
        self.steps.append(step)
        return len(self.steps) - 1


def _sine_steps(sincos: Sincos) -> _Code:
    """Return high (1 + z S), or high - (excess even + S (z high)); the last rounding does not count here."""
    write = _Writer(sincos.precision)
    z = write.apply(Op.MULTIPLY, write.high, write.high)
    if sincos.plain:
        inner = write.apply(
            Op.ADD,
            write.constant(1.0),
            write.apply(Op.MULTIPLY, z, write.polynomial(sincos.sine, z)),
        )
        last = write.apply(Op.MULTIPLY, write.high, inner)
        return _Code(tuple(write.steps), (last,))
    even = write.apply(Op.SUBTRACT, write.constant(1.0), write.apply(Op.MULTIPLY, write.constant(0.5), z))
    odd = write.apply(Op.MULTIPLY, write.polynomial(sincos.sine, z), write.apply(Op.MULTIPLY, z, write.high))
    small = write.apply(Op.ADD, write.apply(Op.MULTIPLY, write.excess, even), odd)
    last = write.apply(Op.SUBTRACT, write.high, small)
    return _Code(tuple(write.steps), (last,))


def _cosine_steps(sincos: Sincos) -> _Code:
    """Return 1 + z C, or even + (1 - even - half + (C zz + excess high)), whose 1 - even - half is exact.

    That difference is the rounding error of even = 1 - half, so that even counts as exact.
    """
    write = _Writer(sincos.precision)
    z = write.apply(Op.MULTIPLY, write.high, write.high)
    if sincos.plain:
        product = write.apply(Op.MULTIPLY, z, write.polynomial(sincos.cosine, z))
        last = write.apply(Op.ADD, write.constant(1.0), product)
        return _Code(tuple(write.steps), (last,))
    even = write.apply(Op.SUBTRACT, write.constant(1.0), write.apply(Op.MULTIPLY, write.constant(0.5), z))
    fourth = write.apply(Op.MULTIPLY, write.polynomial(sincos.cosine, z), write.apply(Op.MULTIPLY, z, z))
    small = write.apply(Op.ADD, fourth, write.apply(Op.MULTIPLY, write.excess, write.high))
    last = write.apply(Op.ADD, even, small)
    return _Code(tuple(write.steps), (even, last), (small,))
