"""SIMD vectors of one precision: their widths, the bit patterns of their numbers, and transposes of blocks.

The template of the header kanegen_simd.h reads them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kanegen.program.precision import DOUBLE, FLOAT, Precision


@dataclass(frozen=True)
class Simd:
    """Vectors whose lanes hold the numbers of several states, in one precision.

    Attributes:
        precision: Precision of the number in each lane.
        bits: Unsigned integer type in C of the size of a number.
        bits_suffix: Suffix of literals of that type.
        widths: Possible numbers of lanes, each a power of two.
    """

    precision: Precision
    bits: str
    bits_suffix: str
    widths: tuple[int, ...]

    @property
    def header(self) -> str:
        """Name of the header without .h, another for each precision, so that both may be included."""
        return f"kanegen_simd{self.precision.libm_suffix}"

    @property
    def size(self) -> int:
        """Number of bits of a number."""
        return 8 * self.precision.bytes

    def pattern(self, bits: int) -> str:
        """Return a bit pattern as an integer literal of the type `bits`."""
        return f"0x{bits:x}{self.bits_suffix}"

    def carry(self, stored: Precision) -> str:
        """Return what sets the sign when it is added to the pattern of a positive number stored as infinity.

        A double from halfway between the largest float and the next power of two is stored as an infinite
        float.
        """
        if stored.bytes >= self.precision.bytes:
            return self.pattern(self.least_carry)
        half_way = np.float64((2.0 - stored.roundoff) * 2.0**127)
        return self.pattern(self.sign - int(half_way.view(np.uint64)))

    @property
    def infinity(self) -> int:
        """Bit pattern of infinity, all bits of the exponent."""
        return self.sign - self.least_carry

    @property
    def least_carry(self) -> int:
        """Bit pattern of the lowest bit of the exponent; added to `infinity` it gives the sign."""
        return 1 << (self.precision.significand_bits - 1)

    @property
    def sign(self) -> int:
        """Bit pattern of the sign."""
        return 1 << (self.size - 1)

    def holding(self, count: int) -> int:
        """Return the fewest lanes, from those of the narrowest instruction set on, that hold `count` numbers.

        Where none do, these are the lanes of the widest instruction set.
        """
        return next((width for width in self.widths[-3:] if width >= count), self.widths[-1])

    def elements(self, array: str, last: str, width: int) -> list[str]:
        """Return the first `width` elements of an array in C; those beyond the place `last` repeat it."""
        return [f"{array}[0]", *(f"{array}[{k} < {last} ? {k} : {last}]" for k in range(1, width))]

    def exchanges(self, width: int) -> Iterator[tuple[int, int, int]]:
        """Yield the steps of a transpose: two vectors, and the size of the groups that they exchange."""
        for size in self.groups(width):
            yield from ((i, i + size, size) for i in range(width) if not i & size)

    def groups(self, width: int) -> list[int]:
        """Return the sizes of the groups of lanes that a transpose exchanges."""
        return [size for size in self.widths if size < width]

    def even(self, width: int, size: int) -> list[int]:
        """Return the lanes that the first of two vectors has after an exchange, counted through both."""
        return [width + k - size if k & size else k for k in range(width)]

    def odd(self, width: int, size: int) -> list[int]:
        """Return the lanes that the second of two vectors has after an exchange."""
        return [k + size for k in self.even(width, size)]


_DOUBLE = Simd(
    precision=DOUBLE,
    bits="unsigned long long",
    bits_suffix="ULL",
    widths=(1, 2, 4, 8),
)

_FLOAT = Simd(
    precision=FLOAT,
    bits="uint32_t",
    bits_suffix="U",
    widths=(1, 2, 4, 8, 16),
)

SIMD = {simd.precision: simd for simd in (_DOUBLE, _FLOAT)}
"""The SIMD vectors of each precision that has them."""
