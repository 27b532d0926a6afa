"""Cut a long program into parts, functions that run one after the other.

A compiler's time grows faster than the length of the function that it compiles. A part ends where the
derivation passes from one body to the next, if such a place is near. Values that later parts need are left in
an array, the workspace. There, too, stand the values from which loops compute outputs after the last part.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from kanegen.program.check import check
from kanegen.program.ir import WORKSPACE, Array, Instruction, Op, Output, Program

LONGEST_PART = 2000
"""Instructions of a part: about where gcc's time leaves the straight line, and the code is no slower."""

SOURCES = (Op.INPUT, Op.CONSTANT)
"""Operations that every part repeats where it needs their values."""


def cut(program: Program, longest: int = LONGEST_PART) -> tuple[Program, ...]:
    """Return the parts of `program`, which together fill its outputs when they run in order.

    Each part reads what earlier ones left in the array `WORKSPACE`, and each element of an output is filled
    by the part that computes it. The last part holds the conditions of all outputs.

    Args:
        program: A program without dead code.
        longest: Instructions that a part may have, inputs and constants not counted; a program that is no
            longer stays whole.
    """
    computed = [i for i, x in enumerate(program.instructions) if x.op not in SOURCES]
    of_loops = values_of_loops(program)
    if len(computed) <= longest and not of_loops:
        return (program,)
    ranges = _ranges(program, computed, longest)
    part_of = {i: number for number, values in enumerate(ranges) for i in values}
    slots = _workspace_slots(program, part_of, len(ranges), len(of_loops))
    size = max((1 + slot for slot in slots.values()), default=0)
    between = Array(WORKSPACE, (max(1, size, len(of_loops)),), "SI", "values between the parts")
    return tuple(
        Part(program, part_of, slots, between, number, is_last=number == len(ranges) - 1).program(values)
        for number, values in enumerate(ranges)
    )


def values_of_loops(program: Program) -> tuple[int, ...]:
    """Return the values from which loops compute outputs; they come first in the workspace."""
    return tuple(
        value
        for output in program.outputs
        if output.solution
        for value in output.values[: output.solution.number_of_values]
    )


def workspace_size(parts: Sequence[Program]) -> int:
    """Return the size of the workspace that `parts` share, 0 without one."""
    arrays = (array for part in parts for array in (*part.inputs, *(o.array for o in part.outputs)))
    return max((array.size for array in arrays if array.name == WORKSPACE), default=0)


def _ranges(program: Program, computed: Sequence[int], longest: int) -> list[Sequence[int]]:
    """Divide `computed` into ranges, each up to the end of a group where one ends in its second half."""
    begins = _group_beginnings(program, computed)
    ranges: list[Sequence[int]] = []
    start = 0
    while len(computed) - start > longest:
        ends = (k for k in range(start + longest, start + longest // 2, -1) if begins[k])
        end = next(ends, start + longest)
        ranges.append(computed[start:end])
        start = end
    return [*ranges, computed[start:]]


def _group_beginnings(program: Program, computed: Sequence[int]) -> list[bool]:
    """Return where groups with one note begin; instructions without a note belong to the next group."""
    notes = [program.instructions[i].note for i in computed]
    for k in range(len(notes) - 2, -1, -1):
        notes[k] = notes[k] or notes[k + 1]
    return [True, *(before != after for before, after in pairwise(notes))]


def _workspace_slots(program: Program, part_of: dict[int, int], parts: int, first: int = 0) -> dict[int, int]:
    """Return a slot of the workspace for every value that later parts read; slots are used again.

    Args:
        program: The whole program.
        part_of: Number of the part of each instruction.
        parts: Number of parts.
        first: The first slot; before it stand the values of loops.
    """
    last = _last_uses(program, part_of, parts)
    slots: dict[int, int] = {}
    free: list[int] = []
    released: list[list[int]] = [[] for _ in range(parts + 1)]
    now, used = 0, first
    for i, part in part_of.items():
        while now < part:
            # What part `now - 1` was the last to read may be overwritten from part `now` on.
            now += 1
            free = sorted(free + released[now], reverse=True)
        if last[i] > part:
            if not free:
                free.append(used)
                used += 1
            slots[i] = free.pop()
            released[last[i] + 1].append(slots[i])
    return slots


def _last_uses(program: Program, part_of: dict[int, int], parts: int) -> dict[int, int]:
    """Return for every value the last part that reads it, or -1; the last part reads all conditions."""
    last = dict.fromkeys(part_of, -1)
    for i, part in part_of.items():
        for j in program.instructions[i].operands:
            if j in part_of:
                last[j] = part
    for output in program.outputs:
        conditions = (*output.exists_if_positive, *output.accurate_if_positive)
        last.update(dict.fromkeys((i for i in conditions if i in part_of), parts - 1))
    return last


class Part:
    """Builds the program of one part of another.

    Args:
        program: The whole program.
        part_of: Number of the part of each instruction.
        slots: Slot in the workspace of each value that needs one.
        workspace: The array of the workspace.
        number: The number of this part, from 0; the first fills what is no computed value.
        is_last: Whether this part tests the conditions of all outputs.
    """

    def __init__(
        self,
        program: Program,
        part_of: dict[int, int],
        slots: dict[int, int],
        workspace: Array,
        number: int,
        *,
        is_last: bool,
    ) -> None:
        self._program = program
        self._part_of = part_of
        self._slots = slots
        self._workspace = workspace
        self._number = number
        self._is_last = is_last
        self._of_loops = values_of_loops(program)
        self._instructions: list[Instruction] = []
        self._moved: dict[int, int] = {}

    def program(self, values: Sequence[int]) -> Program:
        """Return the program that computes the instructions `values` of the whole program."""
        for i in values:
            instruction = self._program.instructions[i]
            operands = tuple(self._value(j) for j in instruction.operands)
            self._append(i, instruction.with_operands(operands))
        outputs = [self._output(output) for output in self._program.outputs]
        left = [(self._slots[i], i) for i in values if i in self._slots]
        left += [(k, i) for k, i in enumerate(self._of_loops) if self._is_own(i)]
        if left:
            kept = tuple(self._value(i) for _, i in left)
            outputs.append(Output(self._workspace, kept, places=tuple(place for place, _ in left)))
        filled = tuple(output for output in outputs if output.values or output.exists_if_positive)
        read = {instruction.array for instruction in self._instructions}
        arrays = (*self._program.inputs, self._workspace)
        inputs = tuple(array for array in arrays if array.name in read)
        return check(Program(inputs, tuple(self._instructions), filled))

    def place(self, i: int) -> int:
        """Return the place, in the program of this part, of an instruction of the whole program."""
        return self._moved[i]

    def _is_own(self, i: int) -> bool:
        """Return whether this part fills what holds value i; the first part fills numbers and inputs."""
        return self._part_of.get(i, 0) == self._number

    def _output(self, output: Output) -> Output:
        """Return the elements of an output that this part fills."""
        own = [(k, i) for k, i in output.elements() if self._is_own(i)]
        values = tuple(self._value(i) for _, i in own)
        existence, accuracy = (
            tuple(self._value(i) for i in conditions) if self._is_last else ()
            for conditions in (output.exists_if_positive, output.accurate_if_positive)
        )
        return Output(output.array, values, existence, tuple(k for k, _ in own), accuracy)

    def _value(self, i: int) -> int:
        """Return value i of the whole program in this part; the workspace holds those of other parts."""
        if i not in self._moved:
            instruction = self._program.instructions[i]
            if instruction.op not in SOURCES:
                name = instruction.name
                instruction = Instruction(Op.INPUT, array=WORKSPACE, index=self._slots[i], name=name)
            self._append(i, instruction)
        return self._moved[i]

    def _append(self, i: int, instruction: Instruction) -> None:
        """Append an instruction to the part and record the number of its value."""
        self._moved[i] = len(self._instructions)
        self._instructions.append(instruction)
