"""What the header of vector numbers says in each precision: widths, bit patterns, and how blocks turn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kanegen.program.precision import DOUBLE, FLOAT, Precision


@dataclass(frozen=True)
class Lanes:
    """Numbers of several states side by side in one precision.

    Attributes:
        precision: Of each of them.
        bits: Unsigned integer type of the same size in C.
        bits_suffix: Of its literals.
        widths: How many numbers may stand side by side.
    """

    precision: Precision
    bits: str
    bits_suffix: str
    widths: tuple[int, ...]

    @property
    def header(self) -> str:
        """Name of the header, without .h; both precisions may be used side by side."""
        return f"kanegen_lanes{self.precision.libm_suffix}"

    @property
    def size(self) -> int:
        """Bits of a number."""
        return 8 * self.precision.bytes

    def pattern(self, bits: int) -> str:
        """An integer literal."""
        return f"0x{bits:x}{self.bits_suffix}"

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
)

_FLOAT = Lanes(
    precision=FLOAT,
    bits="uint32_t",
    bits_suffix="U",
    widths=(1, 2, 4, 8, 16),
)

LANES = {lanes.precision: lanes for lanes in (_DOUBLE, _FLOAT)}
