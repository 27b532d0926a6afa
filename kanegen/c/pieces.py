"""Pieces of a long file of C, which compilers can compile at the same time.

A compiler needs minutes for a file with long functions, and one processor. So the parts of its functions
stand in pieces: with `-DKANEGEN_PIECE=0` a compiler sees the functions alone, and with each number from 1 one
piece of their parts. Without this macro it compiles the whole file. The parts are the same functions either
way, so that all results have the same bits.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from kanegen.program.ir import Program

Part = tuple[list[str], list[str]]
"""Lines of the prototype of a function that another calls, and those between its braces."""

LENGTH = 10_000
"""Instructions of a piece, on average, from which it is worth a compiler: about two seconds of gcc."""

MOST = 8
"""Pieces of a file at most, since each of their compilers reads the whole file."""


@dataclass(frozen=True)
class Pieces:
    """The parts of all functions of a file by the piece in which they stand.

    Attributes:
        parts: Parts of every piece; () where the file is not divided, and parts stand before their functions.
    """

    parts: tuple[tuple[Part, ...], ...] = ()

    @property
    def number(self) -> int:
        """Number of pieces with parts, 0 where the file is not divided."""
        return len(self.parts)

    @property
    def prototypes(self) -> list[list[str]]:
        """Lines of the prototype of every part."""
        return [prototype for piece in self.parts for prototype, _ in piece]


def number_of_pieces(functions: Iterable[Sequence[Program]]) -> int:
    """Return the number of pieces of a file, 0 where it is too short to be divided.

    Args:
        functions: The parts of every function; one that is not cut is its only part.
    """
    cut = [part for parts in functions if len(parts) > 1 for part in parts]
    number = min(sum(len(part.instructions) for part in cut) // LENGTH, MOST)
    return number if number > 1 else 0


def divided(parts: Sequence[Part], number: int) -> Pieces:
    """Return parts, in order, in at most `number` pieces of about as many lines each; in none for 0."""
    if number == 0:
        return Pieces()
    pieces: list[list[Part]] = [[] for _ in range(number)]
    lines = sum(len(body) for _, body in parts)
    before = 0
    for prototype, body in parts:
        middle = before + len(body) // 2
        pieces[number * middle // lines].append((prototype, body))
        before += len(body)
    return Pieces(tuple(tuple(piece) for piece in pieces if piece))
