"""What the header of vector numbers says in each precision: widths, constants and polynomials.

The angle less n pi/2 is computed with pi/2 in parts. Those before the last have so few bits that n times
them is exact up to the largest angle: 33 bits for n of 20 bits in double precision, 11 bits for n of 13 bits
in single precision. The polynomials are minimax in the relative error of sine and cosine over |r| <= pi/4 and
a little more; in single precision the coefficients were rounded one after the other, lowest first:

    sin r = r + r^3 S(r^2),   cos r = 1 - r^2/2 + r^4 C(r^2)
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

from kanegen.precision import DOUBLE, FLOAT, Precision


@dataclass(frozen=True)
class Lanes:
    """Numbers of several states side by side in one precision.

    Attributes:
        precision: Of each of them.
        bits: Unsigned integer type of the same size in C.
        bits_suffix: Of its literals.
        widths: How many numbers may stand side by side.
        limit: Largest angle whose sine and cosine are computed here, rad, as a literal without suffix.
        places: Their largest error in units of the last place.
        parts: pi/2 as a sum, largest first.
        sine: Coefficients of S, highest first.
        cosine: Coefficients of C, highest first.
    """

    precision: Precision
    bits: str
    bits_suffix: str
    widths: tuple[int, ...]
    limit: str
    places: str
    parts: tuple[float, ...]
    sine: tuple[float, ...]
    cosine: tuple[float, ...]

    @property
    def header(self) -> str:
        """Name of the header, without .h; both precisions may be used side by side."""
        return f"kanegen_lanes{self.precision.suffix}"

    @property
    def size(self) -> int:
        """Bits of a number."""
        return 8 * self.precision.bytes

    @property
    def shift(self) -> float:
        """A number that leaves no bits after the point when it is added."""
        return 1.5 * 2.0 ** (self.precision.digits - 1)

    def pattern(self, bits: int) -> str:
        """An integer literal."""
        return f"0x{bits:x}{self.bits_suffix}"

    def limit_pattern(self) -> str:
        """The bits of `limit`."""
        kind = {4: "f", 8: "d"}[self.precision.bytes]
        return self.pattern(int(struct.pack(f">{kind}", float(self.limit)).hex(), 16))

    def horner(self, target: str, coefficients: tuple[float, ...]) -> Iterator[str]:
        """Statements that compute a polynomial in z, whose coefficients have alternating signs."""
        first, second, *others = coefficients
        a, b = (self.precision.literal(abs(c)) for c in (first, second))
        yield f"{target} = {f'{a}*z - {b}' if first > 0 else f'{b} - {a}*z'};"
        for c in others:
            yield f"{target} = {target}*z {'-' if c < 0 else '+'} {self.precision.literal(abs(c))};"

    def exchanges(self, width: int) -> Iterator[tuple[int, int, int]]:
        """For the transpose of a block: numbers of two vectors and the size of the groups they exchange."""
        for size in self.groups(width):
            yield from ((i, i + size, size) for i in range(width) if not i & size)

    def groups(self, width: int) -> list[int]:
        """Sizes of the groups of lanes that are exchanged."""
        return [size for size in self.widths if size < width]

    def even(self, width: int, size: int) -> list[int]:
        """Lanes of two vectors, one after the other, that the first one has after an exchange."""
        return [width + k - size if k & size else k for k in range(width)]

    def odd(self, width: int, size: int) -> list[int]:
        """Lanes of two vectors that the second one has after an exchange."""
        return [k + size for k in self.even(width, size)]


_DOUBLE = Lanes(
    precision=DOUBLE,
    bits="unsigned long long",
    bits_suffix="ULL",
    widths=(1, 2, 4, 8),
    limit="1e6",
    places="0.78",
    parts=(1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21),
    sine=(
        1.5895432977575737e-10,
        -2.5050734385294444e-08,
        2.7557313538498496e-06,
        -0.0001984126982935851,
        0.00833333333332184,
        -0.1666666666666663,
    ),
    cosine=(
        -1.1358749175037828e-11,
        2.087570539522327e-09,
        -2.7557314217035785e-07,
        2.4801587289002076e-05,
        -0.0013888888888873342,
        0.041666666666666595,
    ),
)

_FLOAT = Lanes(
    precision=FLOAT,
    bits="uint32_t",
    bits_suffix="U",
    widths=(1, 2, 4, 8, 16),
    limit="1e4",
    places="0.80",
    parts=(1.5703125, 0.0004837513, 7.5495336e-08, 2.563344e-12),
    sine=(-0.00019507883, 0.008332106, -0.16666654),
    cosine=(2.4432102e-05, -0.0013887308, 0.041666646),
)

LANES = {lanes.precision: lanes for lanes in (_DOUBLE, _FLOAT)}
