"""The reduced angle of kanegen's sine and cosine: which operations are exact, and what the others lose.

An angle is reduced to r = angle - n pi/2 with pi/2 as a sum of parts. Products of n with parts of few bits
are exact, and so is a difference of multiples of a power of two g that is at most 2^p g, in p bits.
`reduction` checks these conditions for angles between successive powers of two. What is left is
r = high - excess plus a small error.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from fractions import Fraction

import mpmath

from kanegen.c.sincos import Sincos

_CONTEXT = mpmath.mp.clone()
_CONTEXT.prec = 400
_HALF_PI = Fraction(int(_CONTEXT.floor(_CONTEXT.ldexp(_CONTEXT.pi / 2, 300)))) / 2**300
_BELOW = Fraction(1, 2**299)
"""More than the error of `_HALF_PI`."""

UNREDUCED = 0.785
"""Angle (rad) up to which n is 0 and r is the angle."""


@dataclass(frozen=True)
class Reduction:
    """The reduced angle r of angles up to a limit: |r - (high - excess)| <= error.

    Attributes:
        largest: Bound of |high| and of |r|.
        excess: Bound of |excess|.
        error: Bound of the error.
    """

    largest: float
    excess: float
    error: float


@functools.cache
def reduction(sincos: Sincos) -> Reduction:
    """Return bounds for all angles up to the limit of `sincos`.

    Raises:
        ArithmeticError: If an operation that has to be exact may not be.
    """
    limit = Fraction(float(sincos.limit))
    found = []
    power = Fraction(1, 2)
    while power < limit:
        found.append(_between(sincos, power, min(2 * power, limit)))
        power *= 2
    return Reduction(*(max(getattr(one, name) for one in found) for name in ("largest", "excess", "error")))


def _between(sincos: Sincos, power: Fraction, end: Fraction) -> Reduction:
    """Return the bounds for angles from a power of two to `end`, which is at most twice as much."""
    precision = sincos.precision
    bits, u = precision.significand_bits, Fraction(precision.roundoff)
    turns = math.ceil(end / _HALF_PI + Fraction(51, 100))
    largest = _HALF_PI * (Fraction(1, 2) + end / _HALF_PI * 3 * u) + _BELOW
    parts = [Fraction(float(precision.dtype.type(part))) for part in sincos.parts]
    cut = -1 if sincos.plain else -2
    grid, covered = 2 * power / 2**bits, Fraction(0)
    for part in parts[:cut]:
        _require(turns * _odd(part) < 2**bits)
        grid, covered = min(grid, _unit(part)), covered + part
        _require(largest + turns * abs(_HALF_PI - covered) <= 2**bits * grid)
    first = largest + turns * abs(_HALF_PI - covered)
    left_out = turns * (abs(_HALF_PI - sum(parts)) + _BELOW)
    last = turns * parts[-1]
    if sincos.plain:
        high = (largest + left_out) * (1 + 3 * u)
        return _rounded_up(high, Fraction(0), u * last * (1 + u) + u * _binade(first + last) + left_out)
    second = turns * parts[-2]
    _require(turns * _odd(parts[-2]) < 2**bits)
    finest = min(grid, _unit(parts[-2]))
    high = first + second
    inexact = _binade(2**bits * finest) * 2 / 2**bits  # least unit in the last place of a rounded `high`
    _require(second + u * _binade(high) <= 2**bits * min(grid, inexact))
    _require(u * _binade(high) <= 2**bits * finest)
    lost = u * _binade(high)
    excess = (lost + last * (1 + u)) * (1 + u)
    return _rounded_up(largest + excess + left_out, excess, u * last + u * (lost + last * (1 + u)) + left_out)


def _rounded_up(largest: Fraction, excess: Fraction, error: Fraction) -> Reduction:
    """Return bounds as doubles, none smaller than it is."""
    return Reduction(*(math.nextafter(float(bound), math.inf) for bound in (largest, excess, error)))


def _require(condition: bool) -> None:
    """Make sure that an operation is exact.

    Raises:
        ArithmeticError: If it may not be.
    """
    if not condition:
        raise ArithmeticError("the parts of pi/2 in kanegen.c.sincos have too many bits for their limit")


def _odd(number: Fraction) -> int:
    """Return the odd integer whose product with a power of two is a number > 0 of finite binary digits."""
    whole = number.numerator
    return whole // (whole & -whole)


def _unit(number: Fraction) -> Fraction:
    """Return the largest power of two of which a number is a multiple."""
    return number / _odd(number)


def _binade(number: Fraction) -> Fraction:
    """Return the largest power of two that is no larger than a number > 0."""
    exponent = number.numerator.bit_length() - number.denominator.bit_length()
    power = Fraction(2) ** exponent
    return power if power <= number else power / 2
