"""What a processor with few registers executes for a program, predicted without a compiler.

Values are kept in registers as long as one is free. Where none is, the value that is used again last is left
in memory (Belady 1966), from where it is loaded or read as an operand. A compiler chooses worse, so this does
not count its instructions; but of two orders of one program, the one with clearly fewer gains.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence

from kanegen.program.ir import WORKSPACE, Op, Program

REGISTERS = 15
"""Registers that hold numbers, of a processor with 16, one of which is needed in between."""

_FREE = (Op.INPUT, Op.CONSTANT, Op.NEGATE)
"""Operations without instructions of their own: operands of others, and signs, which others take on."""


def instructions(parts: Sequence[Program]) -> int:
    """Return about how many instructions a processor executes for the parts of a program.

    Counted are operations, stores of results, values that are stored because no register is free, and
    operands that are read from memory, also from the workspace that parts share.

    Example:
        instructions(cut(program))
    """
    return sum(_Registers(part).count() for part in parts)


class _Registers:
    """Registers that hold values of a program, from its first instruction to its last."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._operands = [self._computed(i) for i in range(len(program.instructions))]
        # For each value the instructions that use it, the next one last.
        self._uses: list[list[int]] = [[] for _ in program.instructions]
        for i in range(len(program.instructions) - 1, -1, -1):
            if program.instructions[i].op not in _FREE:
                for j in self._operands[i]:
                    self._uses[j].append(i)
        self._held: set[int] = set()
        self._stored: set[int] = set()
        self._latest: list[tuple[int, int]] = []

    def count(self) -> int:
        """Return the number of instructions."""
        results = set(self._program.results())
        found = sum(x.array == WORKSPACE for x in self._program.instructions)
        for i, instruction in enumerate(self._program.instructions):
            if instruction.op in _FREE:
                continue
            missing = [j for j in self._operands[i] if j not in self._held]
            found += 1 + len(missing) + (i in results)
            for j in missing[1:]:  # an instruction reads one operand from memory itself
                found += self._hold(j)
            for j in self._operands[i]:
                self._used(j)
            found += self._hold(i)
        return found

    def _computed(self, i: int) -> tuple[int, ...]:
        """Return the operands of an instruction that are computed, without signs."""
        every = self._program.instructions
        bare = map(self._without_sign, every[i].operands)
        return tuple(dict.fromkeys(j for j in bare if every[j].op not in _FREE))

    def _without_sign(self, j: int) -> int:
        """Return the value of which value j is the negative, or that value itself."""
        x = self._program.instructions[j]
        return self._without_sign(x.operands[0]) if x.op is Op.NEGATE else j

    def _used(self, j: int) -> None:
        """Record that the next use of value j is over; after the last one its register is free."""
        self._uses[j].pop()
        if not self._uses[j]:
            self._held.discard(j)
        elif j in self._held:
            heapq.heappush(self._latest, (-self._uses[j][-1], j))

    def _hold(self, j: int) -> int:
        """Hold value j in a register if it is used again, and return how many values are stored for that."""
        if not self._uses[j]:
            return 0
        stores = 0
        while len(self._held) >= REGISTERS:
            use, last = heapq.heappop(self._latest)
            if last in self._held and self._uses[last][-1] == -use:
                self._held.discard(last)
                stores += last not in self._stored
                self._stored.add(last)
        self._held.add(j)
        heapq.heappush(self._latest, (-self._uses[j][-1], j))
        return stores
