"""What a C function needs to know of a program: which values live, where they go, what they are called."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby
from math import prod

from kanegen.program.ir import Array, Op, Program
from kanegen.program.selection import dependencies

LOOPED = 8
"""Neighbouring zeros from which a loop, of a few wide stores, beats one store each."""


def element(array: Array, index: int) -> str:
    """One element of an array in C; in a matrix as `48*row + column`, and so on."""
    terms: list[str] = []
    for axis in range(1, len(array.shape)):
        stride = prod(array.shape[axis:])
        place, index = divmod(index, stride)
        terms.append(f"{stride}*{place}")
    return f"{array.name}[{' + '.join([*terms, str(index)])}]"


def live(program: Program) -> list[int]:
    """Instructions that an output needs, in order."""
    return dependencies(program, program.results())


def places(program: Program, filled: Iterable[Run] = ()) -> dict[int, list[tuple[str, str]]]:
    """For every result the output elements that hold it, without those of the runs `filled`.

    Each is the name of its array and the element in C.
    """
    done = {(run.array, index) for run in filled for index in range(run.start, run.stop)}
    found: dict[int, list[tuple[str, str]]] = {}
    for output in program.outputs:
        for index, value in output.elements():
            if (output.array, index) not in done:
                place = output.array.name, element(output.array, index)
                found.setdefault(value, []).append(place)
    return found


@dataclass(frozen=True, slots=True)
class Run:
    """Elements `start` to before `stop` of a row of an output."""

    array: Array
    start: int
    stop: int

    def loop(self, value: str) -> str:
        """A C loop that fills them."""
        width = self.array.row
        row, start = divmod(self.start, width)
        stop = start + self.stop - self.start
        place = "i" if width == self.array.size else f"{width}*{row} + i"
        return f"for (int i = {start}; i < {stop}; ++i) {self.array.name}[{place}] = {value};"


def zero_runs(program: Program) -> list[Run]:
    """Neighbouring zeros in a row of an output, where they are enough to make a loop worth it."""
    runs: list[Run] = []
    for output in program.outputs:
        width = output.array.row
        zeros = [index for index, value in output.elements() if _is_zero(program, value)]
        # Neighbours in a row have the same distance from their place in the list.
        for _, group in groupby(enumerate(zeros), key=lambda item: (item[1] - item[0], item[1] // width)):
            indices = [index for _, index in group]
            if len(indices) >= LOOPED:
                runs.append(Run(output.array, indices[0], indices[-1] + 1))
    return runs


def _is_zero(program: Program, value: int) -> bool:
    instruction = program.instructions[value]
    return instruction.op is Op.CONSTANT and instruction.number == 0.0


def conditions(program: Program) -> dict[int, int]:
    """For every value that must be positive its place, from 1; the first where it has several.

    A positive number needs no watching and is left out.
    """
    found: dict[int, int] = {}
    for output in program.outputs:
        for place, value in enumerate(output.exists_if_positive, start=1):
            if not program.instructions[value].number > 0.0:
                found.setdefault(value, place)
    return found


def margins(program: Program) -> dict[int, int]:
    """For every value that accuracy needs to be positive its place, from 1; the first of several."""
    found: dict[int, int] = {}
    for output in program.outputs:
        for place, value in enumerate(output.accurate_if_positive, start=1):
            found.setdefault(value, place)
    return found


def uniform(program: Program, shared: Iterable[str]) -> frozenset[int]:
    """Values that are the same in every state: numbers, elements of `shared` arrays, and what follows."""
    common = set(shared)
    found: set[int] = set()
    for i, instruction in enumerate(program.instructions):
        is_source = instruction.op is Op.CONSTANT or instruction.array in common
        if is_source or (instruction.operands and found.issuperset(instruction.operands)):
            found.add(i)
    return frozenset(found)


def partners(program: Program) -> dict[int, int]:
    """For every live sine the live cosine of the same angle, and the other way round."""
    waves = {
        (instruction.op, instruction.operands): i
        for i in live(program)
        if (instruction := program.instructions[i]).op in (Op.SIN, Op.COS)
    }
    other = {Op.SIN: Op.COS, Op.COS: Op.SIN}
    return {i: waves[key] for (op, angle), i in waves.items() if (key := (other[op], angle)) in waves}


def has_sines(program: Program) -> bool:
    """Whether an output needs a sine or a cosine."""
    return any(program.instructions[i].op in (Op.SIN, Op.COS) for i in live(program))


def names(program: Program, taken: Iterable[str]) -> dict[int, str]:
    """For every named instruction the name of its local: an underscore more where the name is taken."""
    used = set(taken)
    found: dict[int, str] = {}
    for i, instruction in enumerate(program.instructions):
        name = instruction.name
        while name in used:
            name += "_"
        if name:
            used.add(name)
            found[i] = name
    return found


def arrays(program: Program) -> Iterator[Array]:
    """Inputs, then outputs."""
    yield from program.inputs
    for output in program.outputs:
        yield output.array
