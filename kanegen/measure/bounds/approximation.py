"""Proven bounds of the errors of polynomials for sine and cosine, without rounding.

The difference between a polynomial and a Taylor polynomial of high degree has rational coefficients. On an
interval it lies between its least and its largest Bernstein coefficient; intervals are halved to make that
tight. What the Taylor polynomial leaves out alternates and decreases, so it is below its first term.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from fractions import Fraction
from math import comb, factorial

TERMS = 14
"""Number of terms of the Taylor polynomials in z = r^2."""

PARTS = 64
"""Number of equal parts of an interval."""

_SLACK = 1 + 2.0**-40
"""More than the rounding errors of a product of a few doubles."""


def series(first: int) -> list[Fraction]:
    """Return the coefficients 1/first!, -1/(first+2)!, ... of sine or cosine after its first terms."""
    return [Fraction((-1) ** k, factorial(first + 2 * k)) for k in range(TERMS)]


@functools.cache
def largest_error(coefficients: tuple[float, ...], first: int, sign: int, power: int, end: Fraction) -> float:
    """Return a bound of r^power |polynomial(z) - sign (1/first! - z/(first+2)! + ...)| for z up to `end`.

    It holds for every z = r^2 from 0 to `end`.

    Args:
        coefficients: Coefficients of the polynomial, lowest first.
        first: The factorial that the series begins with.
        sign: Sign of the series.
        power: Power of r.
        end: Largest z, below 1.
    """
    exact = [sign * term for term in series(first)]
    padded = [*map(Fraction, coefficients), *[Fraction(0)] * (TERMS - len(coefficients))]
    difference = [a - b for a, b in zip(padded, exact, strict=True)]
    left_out = end**TERMS / factorial(first + 2 * TERMS)
    width = end / PARTS
    scaled = [term * width**k for k, term in enumerate(difference)]
    denominator = math.lcm(*(term.denominator for term in scaled))
    numerators = [int(term * denominator) for term in scaled]
    bounds = (
        math.sqrt((k + 1) * width) ** power * float(_largest(numerators, k) / denominator + left_out)
        for k in range(PARTS)
    )
    return max(bounds) * _SLACK


def _largest(polynomial: Sequence[int], start: int) -> Fraction:
    """Return the largest magnitude of the Bernstein coefficients on an interval of length 1."""
    degree = len(polynomial) - 1
    moved = [
        sum(comb(j, k) * polynomial[j] * start ** (j - k) for j in range(k, degree + 1))
        for k in range(degree + 1)
    ]
    common = math.lcm(*(comb(degree, k) for k in range(degree + 1)))
    shares = [common // comb(degree, k) * term for k, term in enumerate(moved)]
    sums = (sum(comb(i, k) * shares[k] for k in range(i + 1)) for i in range(degree + 1))
    return Fraction(max(map(abs, sums)), common)
