"""Cut a long program into pieces that run one after the other.

A compiler's time grows faster than the function it compiles. Pieces end where the derivation passes from one
body to the next, if such a place is near; what a later piece needs waits in an array, the workspace.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from kanegen.program.check import check
from kanegen.program.ir import Array, Instruction, Op, Output, Program

WORKSPACE = "w"

LONGEST = 2000
"""Instructions of a piece: about where gcc's time leaves the straight line, and the code is no slower."""

_SOURCES = (Op.INPUT, Op.CONSTANT)
"""Instructions that every piece has for itself."""


def cut(program: Program, longest: int = LONGEST) -> tuple[Program, ...]:
    """Programs whose one after the other fill the outputs of `program`.

    Each reads what earlier ones left in the array `WORKSPACE`, and each element of an output is filled by
    the one that computes it. What is watched is named by the last.

    Args:
        program: Without dead code.
        longest: Instructions that a piece may have; a program that is no longer stays whole.
    """
    computed = [i for i, x in enumerate(program.instructions) if x.op not in _SOURCES]
    if len(computed) <= longest:
        return (program,)
    ranges = _ranges(program, computed, longest)
    home = {i: piece for piece, values in enumerate(ranges) for i in values}
    slots = _slots(program, home, len(ranges))
    between = Array(WORKSPACE, (1 + max(slots.values(), default=0),), "SI", "values between the pieces")
    return tuple(
        _Piece(program, home, slots, between, piece).made(values) for piece, values in enumerate(ranges)
    )


def workspace(pieces: Sequence[Program]) -> int:
    """Size of the array that `pieces` have in common, 0 without one."""
    arrays = (array for piece in pieces for array in (*piece.inputs, *(o.array for o in piece.outputs)))
    return max((array.size for array in arrays if array.name == WORKSPACE), default=0)


def _ranges(program: Program, computed: Sequence[int], longest: int) -> list[Sequence[int]]:
    """Neighbouring instructions, up to the end of a group with one note where one ends in the second half."""
    begins = _beginnings(program, computed)
    ranges: list[Sequence[int]] = []
    start = 0
    while len(computed) - start > longest:
        ends = (k for k in range(start + longest, start + longest // 2, -1) if begins[k])
        end = next(ends, start + longest)
        ranges.append(computed[start:end])
        start = end
    return [*ranges, computed[start:]]


def _beginnings(program: Program, computed: Sequence[int]) -> list[bool]:
    """Where a group begins; what has no note belongs to the next that has."""
    notes = [program.instructions[i].note for i in computed]
    for k in range(len(notes) - 2, -1, -1):
        notes[k] = notes[k] or notes[k + 1]
    return [True, *(before != after for before, after in pairwise(notes))]


def _slots(program: Program, home: dict[int, int], pieces: int) -> dict[int, int]:
    """A place in the workspace for every value that leaves its piece, free again after its last use."""
    last = dict.fromkeys(home, -1)
    for i, piece in home.items():
        for j in program.instructions[i].operands:
            if j in home:
                last[j] = piece
    for output in program.outputs:
        watched = (*output.positive, *output.margins)
        last.update(dict.fromkeys((i for i in watched if i in home), pieces - 1))
    slots: dict[int, int] = {}
    free: list[int] = []
    released: list[list[int]] = [[] for _ in range(pieces + 1)]
    now = used = 0
    for i, piece in home.items():
        while now < piece:
            # What piece `now - 1` was the last to read may be overwritten from piece `now` on.
            now += 1
            free = sorted(free + released[now], reverse=True)
        if last[i] > piece:
            if not free:
                free.append(used)
                used += 1
            slots[i] = free.pop()
            released[last[i] + 1].append(slots[i])
    return slots


class _Piece:
    """One program in the making."""

    def __init__(
        self,
        program: Program,
        home: dict[int, int],
        slots: dict[int, int],
        workspace: Array,
        piece: int,
    ) -> None:
        self._program = program
        self._home = home
        self._slots = slots
        self._workspace = workspace
        self._piece = piece
        self._instructions: list[Instruction] = []
        self._moved: dict[int, int] = {}

    def made(self, values: Sequence[int]) -> Program:
        for i in values:
            instruction = self._program.instructions[i]
            operands = tuple(self._value(j) for j in instruction.operands)
            self._add(i, replace(instruction, operands=operands))
        is_last = self._piece == max(self._home.values())
        outputs = [self._output(output, is_last) for output in self._program.outputs]
        kept = [i for i in values if i in self._slots]
        if kept:
            places = tuple(self._slots[i] for i in kept)
            outputs.append(Output(self._workspace, tuple(self._moved[i] for i in kept), places=places))
        filled = tuple(output for output in outputs if output.values or output.positive)
        read = {instruction.array for instruction in self._instructions}
        arrays = (*self._program.inputs, self._workspace)
        inputs = tuple(array for array in arrays if array.name in read)
        return check(Program(inputs, tuple(self._instructions), filled))

    def _output(self, output: Output, is_last: bool) -> Output:
        """What this piece fills; numbers and inputs are stored by the first."""
        mine = [(k, i) for k, i in output.elements() if self._home.get(i, 0) == self._piece]
        values = tuple(self._value(i) for _, i in mine)
        positive, margins = (
            tuple(self._value(i) for i in watched) if is_last else ()
            for watched in (output.positive, output.margins)
        )
        return Output(output.array, values, positive, tuple(k for k, _ in mine), margins)

    def _value(self, i: int) -> int:
        """Value i in this piece, brought in where it is not from here."""
        if i not in self._moved:
            instruction = self._program.instructions[i]
            if instruction.op not in _SOURCES:
                name = instruction.name
                instruction = Instruction(Op.INPUT, array=WORKSPACE, index=self._slots[i], name=name)
            self._add(i, instruction)
        return self._moved[i]

    def _add(self, i: int, instruction: Instruction) -> None:
        self._moved[i] = len(self._instructions)
        self._instructions.append(instruction)
