"""Exponential, logarithm, hyperbolic tangent and arctangent in C, and the comparisons of numbers.

Like kanegen's sine and cosine they consist of operations of IEEE arithmetic in a fixed order, and have the
same bits everywhere. With polynomials E, L, T and A:

    e^x    = 2^n e^r,  r = x - n ln 2,  |r| <= ln 2 / 2;  e^r = 1 + r + r^2 E(r)
    log x  = k ln 2 + log(1 + f),  x = 2^k (1 + f),  f from sqrt(1/2) - 1 to sqrt(2) - 1;
             log(1 + f) = f - f^2/2 + s (f^2/2 + s^2 L(s^2)),  s = f/(2 + f)
    tanh x = x + x^3 T(x^2) up to 0.55, and 1 - 2/(e^2x + 1) beyond
    atan q = q + q^3 A(q^2) for 0 <= q <= 1; the other angles of atan2 are 0, pi/2 and pi with and less this
    one

ln 2, pi/2 and pi are sums of two numbers; n times the first part of ln 2 is exact. Where a sum would lose
more than half a unit in the last place, its rounding error is kept: in 1 + r, in k ln 2 + f, and in
1 - 2/(e^2x + 1). A zero has no sign: the angle of (-1, -0.0) is pi, because the equations of a model keep no
signs of zeros.

Errors, in units in the last place of the result, of which half a unit is the last rounding. The polynomials
differ from their functions by less than 0.2 u, which ball arithmetic proves in the tests.

    exp    From 0.7 to 1 the unit is u, and what is added to 1 + r is below 1/16: four roundings of u/32, and
           the polynomial. Below 0.8.
    log    At its worst, next to sqrt(2) with k = -1, the unit is u/2, and four numbers below 1/8 are rounded
           by u/16; s and its product lose 0.07 u. Below 1.2.
    tanh   Up to 0.55, x^3 T is below a tenth of x: three roundings of u/32 and a few of T. Beyond, q is below
           1/2 and rounded by u/4, and e^2x loses 0.3 u, of which 0.4 remain. Below 1.
    atan2  q is rounded by u/2, of which half remains at q = 1; q^3 A is below 0.22 and loses 0.6 u; the sums
           that make the angle are three roundings of u/2. Below 2.5.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.c.polynomial import polynomial
from kanegen.c.simd import SIMD, Simd
from kanegen.program.elementary import PLACES
from kanegen.program.ir import ARITY, CHOICES, TRANSCENDENTAL
from kanegen.program.precision import DOUBLE, DOUBLE_DOUBLE, FLOAT, LONG_DOUBLE, Precision


@dataclass(frozen=True)
class Elementary:
    """The functions of the header `kanegen_elementary` of one precision.

    Attributes:
        precision: Precision of the arithmetic.
        exp: Coefficients of E, lowest first; empty where the functions are those of libm.
        log: Coefficients of L.
        tanh: Coefficients of T.
        atan: Coefficients of A.
        ln2: ln 2 as a sum of two numbers.
        half_pi: pi/2 as a sum of two numbers.
        largest: Number from which e^x is infinite.
        least: Number up to which e^x is 0.
        saturated: Number from which tanh is 1.
    """

    precision: Precision
    exp: tuple[float, ...] = ()
    log: tuple[float, ...] = ()
    tanh: tuple[float, ...] = ()
    atan: tuple[float, ...] = ()
    ln2: tuple[float, float] = (0.0, 0.0)
    half_pi: tuple[float, float] = (0.0, 0.0)
    largest: float = 0.0
    least: float = 0.0
    saturated: float = 0.0

    @property
    def header(self) -> str:
        """Name of the header without .h, another for each precision, so that all may be included."""
        return elementary_header(self.precision)

    @property
    def is_own(self) -> bool:
        """Whether the functions are kanegen's own, not those of libm."""
        return bool(self.exp)

    @property
    def errors(self) -> dict[str, float]:
        """Bounds of the errors in units in the last place, by name of the function."""
        return {op.value: places for op, places in PLACES.items()}

    @property
    def simd(self) -> Simd | None:
        """The SIMD vectors of the precision, None where it has none."""
        return SIMD.get(self.precision)

    @property
    def functions(self) -> list[tuple[str, int]]:
        """Name and number of operands of every function that SIMD vectors have, too."""
        return [(op.value, ARITY[op]) for op in (*CHOICES, *TRANSCENDENTAL)]

    @property
    def exponent_mask(self) -> int:
        """Mask of the low bits of a shifted number that hold the integer n."""
        return 0xFFF if self.precision is DOUBLE else 0x3FF

    @property
    def shift(self) -> float:
        """A number whose addition rounds the other summand to an integer."""
        return 1.5 * 2.0 ** (self.precision.significand_bits - 1)

    @property
    def bias(self) -> int:
        """The biased exponent of the number 1."""
        return (1 << 8 * self.precision.bytes - self.precision.significand_bits - 1) - 1

    @property
    def one_pattern(self) -> int:
        """Bit pattern of the number 1."""
        return self.bias << (self.precision.significand_bits - 1)

    @property
    def root_half_pattern(self) -> int:
        """Bit pattern of the number nearest to the root of 1/2."""
        kind = {4: "f", 8: "d"}[self.precision.bytes]
        return int(struct.pack(f">{kind}", 0.5**0.5).hex(), 16)

    def literal(self, number: float) -> str:
        """Return a literal of a number of either sign."""
        return f"{'-' if number < 0 else ''}{self.precision.literal(abs(number))}"

    def polynomial(self, target: str, coefficients: Sequence[float]) -> list[str]:
        """Return a statement that evaluates a polynomial in z, with many terms in z and zz = z z."""
        return polynomial(target, coefficients, self.precision)


_DOUBLE = Elementary(
    precision=DOUBLE,
    exp=(
        0.5,
        0.16666666666666688,
        0.041666666666666824,
        0.00833333333331392,
        0.0013888888888778273,
        0.00019841269903188551,
        2.4801587556053285e-05,
        2.7557229067004255e-06,
        2.7557076047795616e-07,
        2.5113677247592765e-08,
        2.0971507884094727e-09,
    ),
    log=(
        0.6666666666666735,
        0.39999999999408997,
        0.28571428743832117,
        0.22222198407891877,
        0.18183573745242534,
        0.1531378954756723,
        0.14798751738462239,
    ),
    tanh=(
        -0.3333333333333333,
        0.1333333333333293,
        -0.053968253967948486,
        0.021869488524521048,
        -0.008863235269827196,
        0.0035921243262951605,
        -0.0014557989668921802,
        0.0005897954811872122,
        -0.00023807923002218084,
        9.366107110963723e-05,
        -3.256780640215161e-05,
        7.222849149145003e-06,
    ),
    atan=(
        -0.3333333333333333,
        0.19999999999999563,
        -0.14285714285677775,
        0.1111111110954705,
        -0.09090909050273817,
        0.07692306987721631,
        -0.06666657992241491,
        0.058822737791263596,
        -0.05262605327047782,
        0.04758884020545765,
        -0.04334654089525562,
        0.03953513960042812,
        -0.03569323659909543,
        0.03126740662386495,
        -0.02582614960552464,
        0.019429597923245757,
        -0.012828219521635254,
        0.007153506555610176,
        -0.0032328862336428116,
        0.0011265897180742519,
        -0.00028219087788263614,
        4.5010420989013104e-05,
        -3.4227953892883543e-06,
    ),
    ln2=(0.6931471805592082, 7.371002565167799e-13),
    half_pi=(1.5707963267948966, 6.123233995736766e-17),
    largest=710.0,
    least=-746.0,
    saturated=20.0,
)

_FLOAT = Elementary(
    precision=FLOAT,
    exp=(0.49999994, 0.16666517, 0.041668102, 0.008369165, 0.0013837966),
    log=(0.66666776, 0.39977556, 0.29872006),
    tanh=(-0.33333316, 0.13332544, -0.053847548, 0.021050714, -0.0062428466),
    atan=(
        -0.3333333,
        0.19999887,
        -0.14283462,
        0.11088412,
        -0.089553714,
        0.07168055,
        -0.052747507,
        0.032291237,
        -0.014631881,
        0.004209853,
        -0.00056544115,
    ),
    ln2=(0.69314575, 1.4286068e-06),
    half_pi=(1.5707964, -4.371139e-08),
    largest=89.0,
    least=-104.0,
    saturated=10.0,
)

_LONG_DOUBLE = Elementary(precision=LONG_DOUBLE)
"""Comparisons, and the functions of libm, as sine and cosine are in this precision."""

ELEMENTARY = {one.precision: one for one in (_DOUBLE, _FLOAT, _LONG_DOUBLE)}
"""The functions by precision. The coefficients minimise the largest relative errors of the functions; the
first of them were rounded one after the other, lowest first."""


def elementary_header(precision: Precision) -> str:
    """Return the name of the header of elementary functions in a precision, without .h."""
    return f"kanegen_elementary{'_dd' if precision is DOUBLE_DOUBLE else precision.libm_suffix}"
