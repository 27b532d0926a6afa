"""Sine and cosine in C: accurate shared ones, polynomials of a chosen degree, or those of the C library.

An angle up to `limit` is reduced by n pi/2 with pi/2 in parts. Parts before the last have so few bits that n
times a part is exact: 37 bits for n of 16 bits in double precision, 11 bits for n of 13 bits in single
precision. The rounding error of the last difference is kept as a second number. Larger angles are reduced
with integers: the digits of 2/pi that matter, times the bits of the angle.
"""

from __future__ import annotations

import functools
import struct
from collections.abc import Sequence
from dataclasses import dataclass

import mpmath

from kanegen.c.minimax import Minimax, minimax
from kanegen.c.polynomial import SHORT, polynomial
from kanegen.program.precision import DOUBLE, FLOAT, Precision

AHEAD = 64
"""Zero bits before 2/pi in the table of its bits, so that small exponents need no special case."""

DIGITS = 6
"""Number of digits of 32 bits of 2/pi that an angle is multiplied by."""


@dataclass(frozen=True)
class Sincos:
    """The computation of sine and cosine in one precision.

    Attributes:
        name: Name in `options.SINCOS`.
        precision: Precision of the angles and of the arithmetic.
        limit: Largest angle that is reduced with parts of pi/2, rad, as a literal without suffix.
        parts: pi/2 as a sum, largest part first.
        sine: Coefficients in r^2, lowest first, of (r - sin r)/r^3; if `plain`, of (sin r - r)/r^3.
        cosine: Coefficients of (cos r - 1 + r^2/2)/r^4; if `plain`, of (cos r - 1)/r^2.
        error: The largest error as text.
        plain: Whether the reduced angle r is one number, not the sum of two.
    """

    name: str
    precision: Precision
    limit: str
    parts: tuple[float, ...]
    sine: tuple[float, ...]
    cosine: tuple[float, ...]
    error: str
    plain: bool = False

    @property
    def header(self) -> str:
        """Name of the C function for one angle, and of its header without .h."""
        return f"kanegen_sincos{self.precision.libm_suffix}"

    @property
    def degree(self) -> int:
        """Degree of the polynomial of the sine."""
        return 2 * len(self.sine) + 1

    @property
    def takes_squares(self) -> bool:
        """Whether the polynomials use zz = z z."""
        return not self.plain or len(self.cosine) > SHORT

    @property
    def shift(self) -> float:
        """A number whose addition rounds the other summand to an integer."""
        return 1.5 * 2.0 ** (self.precision.significand_bits - 1)

    @property
    def exponent_bits(self) -> int:
        """Number of bits of the exponent of a number."""
        return 8 * self.precision.bytes - self.precision.significand_bits

    @property
    def bias(self) -> int:
        """The biased exponent of the number 1."""
        return (1 << self.exponent_bits - 1) - 1

    @property
    def first_place(self) -> int:
        """The offset from the exponent of an angle to the first bit of the table that matters.

        The angle is m 2^(exponent - bias - digits + 1), the table 2/pi 2^-AHEAD. Bits whose products are
        multiples of 4 turn the angle by whole turns.
        """
        return self.bias + self.precision.significand_bits - 1 - AHEAD + 2

    @property
    def two_over_pi(self) -> list[str]:
        """Literals of 32 bits each, most significant first: `AHEAD` zero bits, then those of 2/pi."""
        last = 2**self.exponent_bits - 2 - self.first_place
        count = last // 32 + DIGITS + 1
        bits = 32 * count - AHEAD
        with mpmath.workprec(bits + 64):
            whole = int(mpmath.floor(mpmath.ldexp(2 / mpmath.pi, bits)))
        return [f"0x{whole >> 32 * (count - 1 - k) & 0xFFFFFFFF:08x}U" for k in range(count)]

    @property
    def limit_pattern(self) -> int:
        """The bit pattern of `limit`."""
        kind = {4: "f", 8: "d"}[self.precision.bytes]
        return int(struct.pack(f">{kind}", float(self.limit)).hex(), 16)

    def polynomial(self, target: str, coefficients: Sequence[float]) -> list[str]:
        """Return a statement that evaluates a polynomial in z, with many terms in z and zz = z z."""
        return polynomial(target, coefficients, self.precision)


_DOUBLE = Sincos(
    name="shared",
    precision=DOUBLE,
    limit="1e5",
    parts=(1.5707963267923333, 2.5633441515839558e-12, 1.0562999066987428e-23),
    sine=(
        0.1666666666666663,
        -0.00833333333332184,
        0.0001984126982935851,
        -2.7557313538498496e-06,
        2.5050734385294444e-08,
        -1.5895432977575737e-10,
    ),
    cosine=(
        0.041666666666666595,
        -0.0013888888888873342,
        2.4801587289002076e-05,
        -2.7557314217035785e-07,
        2.087570539522327e-09,
        -1.1358749175037828e-11,
    ),
    error="0.81 of the last place",
)

_FLOAT = Sincos(
    name="shared",
    precision=FLOAT,
    limit="1e4",
    parts=(1.5703125, 0.0004837513, 7.5495336e-08, 2.563344e-12),
    sine=(0.16666654, -0.008332106, 0.00019507883),
    cosine=(0.041666646, -0.0013887308, 2.4432102e-05),
    error="0.81 of the last place",
)

SHARED = {sincos.precision: sincos for sincos in (_DOUBLE, _FLOAT)}
"""The accurate sine and cosine of each precision. The coefficients minimise the largest relative error over
|r| <= pi/4 and a little more; in single precision they were rounded one after the other, lowest first."""


def sincos_named(name: str, precision: Precision) -> Sincos | None:
    """Return the sine and cosine called `name` in `options.SINCOS`; None for those of the C library."""
    shared = SHARED.get(precision)
    if name == "shared" or shared is None:
        return shared
    degree = name.partition("-")[2]
    return _polynomials(int(degree), shared) if degree else None


@functools.cache
def _polynomials(degree: int, shared: Sincos) -> Sincos:
    """Return polynomials of this degree, too inaccurate to gain by a second number for r."""
    found = minimax(degree, shared.precision)
    *exact, last, rest = shared.parts
    return Sincos(
        f"polynomial-{degree}",
        shared.precision,
        shared.limit,
        (*exact, float(shared.precision.dtype.type(last + rest))),
        found.sine,
        found.cosine,
        _in_words(found, shared.precision),
        plain=True,
    )


def _in_words(found: Minimax, precision: Precision) -> str:
    """Return both errors as text, 5% larger than they are, so that two digits do not understate them."""
    sine, cosine = (f"{1.05 * error:.1e}" for error in (found.sine_error, found.cosine_error))
    return f"{sine} (sine) and {cosine} (cosine), beside {2.0 * precision.roundoff:.1e} by roundoff"
