"""Double-double arithmetic: the constants of the header kanegen_double_double.h.

A double-double number is the exact sum of two doubles. Its sine and cosine need pi/2 in parts and power
series.

The parts of pi/2 before the last have 33 bits, so that n times a part is exact for n of 20 bits, enough for
angles up to 1e6 rad. With seven parts, n pi/2 is known to 2^-230, which leaves 100 bits of the smallest
difference between a double-double number below 1e6 and a multiple of pi/2. The truncation error of the series
is below 2^-118 for angles up to pi/4; terms below 2^-58 of the sum are stored as doubles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import Any

import mpmath

from kanegen.program.constants import as_fraction
from kanegen.program.precision import double_double_parts

DECLARATION = """#ifndef KANEGEN_DOUBLE_DOUBLE
#define KANEGEN_DOUBLE_DOUBLE
/* The exact sum of two doubles; `high` is the double nearest to it. */
typedef struct {
    double high;
    double low;
} kanegen_double_double;
#endif"""
"""Declaration of the type in C; several headers may contain it."""

_PARTS = 7
_PART_BITS = 33


@dataclass(frozen=True)
class Series:
    """Coefficients of a power series, highest order first.

    Attributes:
        tail: Coefficients of the high orders, as literals of doubles.
        head: Coefficients of the low orders that follow, each as the literals of two doubles.
    """

    tail: tuple[str, ...]
    head: tuple[tuple[str, str], ...]


def _alternating(orders: Sequence[int], exact_count: int) -> Series:
    """Return alternating reciprocal factorials of `orders`, the last `exact_count` as two doubles each."""
    return series(
        [Fraction((-1) ** (k + 1), factorial(order)) for k, order in enumerate(orders)], exact_count
    )


def series(coefficients: Sequence[Fraction], exact_count: int) -> Series:
    """Return the series of coefficients, lowest order first, the first `exact_count` as two doubles each."""
    exact = coefficients[::-1]
    heads = (double_double_parts(coefficient) for coefficient in exact[-exact_count:])
    return Series(
        tuple(repr(float(coefficient)) for coefficient in exact[:-exact_count]),
        tuple((repr(high), repr(low)) for high, low in heads),
    )


def parts(number: Any, count: int) -> tuple[str, ...]:
    """Return literals of doubles that sum to a number below 2; all but the last have `_PART_BITS` bits."""
    rest, found = as_fraction(number), []
    for k in range(count - 1):
        unit = Fraction(1, 2 ** (_PART_BITS * (k + 1) - 1))
        part = rest // unit * unit
        found.append(float(part))
        rest -= part
    return tuple(map(repr, (*found, float(rest))))


def _half_pi() -> Any:
    with mpmath.workprec(400):
        return mpmath.pi / 2


@dataclass(frozen=True)
class DoubleDoubleHeader:
    """The constants of kanegen_double_double.h as C literals.

    Attributes:
        declaration: Declaration of the type.
        limit: Largest angle whose sine and cosine are computed, rad.
        reciprocal: 2/pi.
        parts: pi/2 as a sum, largest part first.
        series: Series of sine and cosine in z = r^2, by the name of the variable in C.
    """

    declaration: str = DECLARATION
    limit: str = "1e6"
    reciprocal: str = repr(0.6366197723675814)
    parts: tuple[str, ...] = parts(_half_pi(), _PARTS)
    series: tuple[tuple[str, Series], ...] = (
        ("S", _alternating(range(3, 31, 2), 8)),  # sin r = r + r z S(z), z = r^2
        ("C", _alternating(range(2, 32, 2), 9)),  # cos r = 1 + z C(z)
    )

    @property
    def declared(self) -> str:
        """The declaration of the type for cffi, which reads no preprocessor lines."""
        lines = self.declaration.splitlines(keepends=True)
        return "".join(line for line in lines if not line.startswith("#"))


DOUBLE_DOUBLE_HEADER = DoubleDoubleHeader()
"""The constants of the header of double-double arithmetic."""
