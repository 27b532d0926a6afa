"""Exponential, logarithm, hyperbolic tangent and arctangent in double-double: constants of their header.

e^x is 2^n e^r with n times ln 2 subtracted in parts, and a power series up to |r| = ln 2 / 2. log x is k ln 2
and the series of 2 artanh s with s = (m - 1)/(m + 1), where m is between sqrt(1/2) and sqrt(2). tanh x is the
quotient of the series of sinh and cosh up to 0.55, and 1 - 2/(e^2x + 1) beyond. An angle is that of
`kanegen_atan2` and what remains when the point is turned back by it. Series are cut below 2^-110; terms below
2^-58 of the sum are stored as doubles.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import factorial

import mpmath

from kanegen.c.double_double import Series, parts, series
from kanegen.c.elementary import elementary_header
from kanegen.program.precision import DOUBLE_DOUBLE

_LN2_PARTS = 4
"""Parts of ln 2: three of 33 bits, whose products with n of 20 bits are exact, and the rest."""


def _ln2() -> mpmath.mpf:
    with mpmath.workprec(400):
        return mpmath.log(2)


def _reciprocals(orders: range, exact: int) -> Series:
    """Return the series with reciprocal factorials as coefficients."""
    return series([Fraction(1, factorial(order)) for order in orders], exact)


@dataclass(frozen=True)
class DoubleDoubleElementary:
    """The constants of kanegen_elementary_dd.h as C literals.

    Attributes:
        ln2: ln 2 as a sum, largest part first.
        exp: Series of (e^r - 1 - r)/r^2 in r.
        log: Series of (artanh s - s)/s^3 in s^2.
        sinh: Series of (sinh x - x)/x^3 in x^2.
        cosh: Series of (cosh x - 1)/x^2 in x^2.
    """

    ln2: tuple[str, ...]
    exp: Series
    log: Series
    sinh: Series
    cosh: Series

    @property
    def header(self) -> str:
        """Name of the header without .h."""
        return elementary_header(DOUBLE_DOUBLE)


DOUBLE_DOUBLE_ELEMENTARY = DoubleDoubleElementary(
    ln2=parts(_ln2(), _LN2_PARTS),
    exp=_reciprocals(range(2, 27), 14),
    log=series([Fraction(1, order) for order in range(3, 49, 2)], 11),
    sinh=_reciprocals(range(3, 33, 2), 9),
    cosh=_reciprocals(range(2, 34, 2), 9),
)
"""The constants of the header of elementary functions in double-double."""
