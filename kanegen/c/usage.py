"""Properties of a program that its printed function depends on: live values, their places and their names."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import prod
from types import MappingProxyType

from kanegen.program.ir import Array, Op, Program
from kanegen.program.selection import dependencies

NO_NAMES: Mapping[str, Sequence[str]] = MappingProxyType({})
"""No array has names for its places."""

LOOPED = 48
"""Number of neighbouring zeros from which a loop is faster than one store each: gcc makes of it a string
instruction, which takes longer to begin than a few wide stores."""

JOINED = 16
"""Most numbers between two runs that are tested together, because one more run takes longer."""


def element(array: Array, index: int, names: Sequence[str] = ()) -> str:
    """Return element `index` of an array in C; of a matrix as `A[48*row + column]`.

    Args:
        array: The array.
        index: Place of the element, row-major.
        names: Enumerators of the places, where they have names.
    """
    if names:
        return f"{array.name}[{names[index]}]"
    terms: list[str] = []
    for axis in range(1, len(array.shape)):
        stride = prod(array.shape[axis:])
        place, index = divmod(index, stride)
        terms.append(f"{stride}*{place}")
    return f"{array.name}[{' + '.join([*terms, str(index)])}]"


def live(program: Program) -> list[int]:
    """Return the instructions that an output needs, in order."""
    return dependencies(program, program.results())


def places(
    program: Program, filled: Iterable[Run] = (), named: Mapping[str, Sequence[str]] = NO_NAMES
) -> dict[int, list[tuple[str, str]]]:
    """Return for every result the output elements that hold it: name of the array, and the element in C.

    Args:
        program: The program.
        filled: Runs of elements to leave out.
        named: Enumerators of the places of some arrays, by name of the array.
    """
    done = {(run.array, index) for run in filled for index in range(run.start, run.stop)}
    found: dict[int, list[tuple[str, str]]] = {}
    for output in program.outputs:
        for index, value in output.elements():
            if (output.array, index) not in done:
                place = output.array.name, element(output.array, index, named.get(output.array.name, ()))
                found.setdefault(value, []).append(place)
    return found


@dataclass(frozen=True, slots=True)
class Run:
    """Elements `start` to before `stop` of an output array."""

    array: Array
    start: int
    stop: int

    def loop(self, value: str) -> str:
        """Return a C loop that stores `value` in the elements, which lie in one row."""
        width = self.array.row
        row, start = divmod(self.start, width)
        stop = start + self.stop - self.start
        place = "i" if width == self.array.size else f"{width}*{row} + i"
        return f"for (int i = {start}; i < {stop}; ++i) {{ {self.array.name}[{place}] = {value}; }}"


def zero_runs(program: Program) -> list[Run]:
    """Return the runs of at least `LOOPED` neighbouring zeros in the rows of the outputs."""
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


def variable_runs(parts: Sequence[Program], array: Array, looped: Container[Array] = ()) -> list[Run]:
    """Return runs of elements of an output array, all of which are finite only if the whole array is.

    Constants are finite, and the first of the elements that hold the same value stands for all of them.

    Args:
        parts: The programs that fill the array in turn.
        array: The array.
        looped: Arrays that loops fill.
    """
    if array in looped:
        return [Run(array, 0, array.size)]
    runs: list[Run] = []
    for index in sorted(index for part in parts for index in _first_places(part, array)):
        is_joined = runs and index - runs[-1].stop <= JOINED and _is_filled_between(array, runs[-1], index)
        start = runs.pop().start if is_joined else index
        runs.append(Run(array, start, index + 1))
    return runs


def _is_filled_between(array: Array, run: Run, index: int) -> bool:
    """Return whether all elements from a run to an element are filled, as those of one row are."""
    return not array.is_filled_in_part or run.start // array.row == index // array.row


def _first_places(part: Program, array: Array) -> list[int]:
    """Return, for each value that is no constant, the first element of an output array that holds it."""
    filled = [output for output in part.outputs if output.array.name == array.name]
    elements = sorted(pair for output in filled for pair in output.elements())
    first = {value: index for index, value in reversed(elements)}
    return [index for value, index in first.items() if part.instructions[value].op is not Op.CONSTANT]


def _is_zero(program: Program, value: int) -> bool:
    instruction = program.instructions[value]
    return instruction.op is Op.CONSTANT and instruction.number == 0.0


def conditions(program: Program) -> dict[int, int]:
    """Return the place, from 1, of every value that must be positive; the first of several places.

    A positive constant needs no test and is left out.
    """
    found: dict[int, int] = {}
    for output in program.outputs:
        for place, value in enumerate(output.exists_if_positive, start=1):
            if not program.instructions[value].number > 0.0:
                found.setdefault(value, place)
    return found


def margins(program: Program) -> dict[int, int]:
    """Return the place, from 1, of every value required positive for accuracy; the first of several.

    Where there are several tests for each freedom, they follow each other, each for all freedoms.

    A positive constant needs no test and is left out.
    """
    found: dict[int, int] = {}
    for output in program.outputs:
        freedoms = len(output.exists_if_positive)
        for i, value in enumerate(output.accurate_if_positive):
            if not program.instructions[value].number > 0.0:
                found.setdefault(value, 1 + i % freedoms)
    return found


def uniform(program: Program, shared: Iterable[str]) -> frozenset[int]:
    """Return the values that are the same in every state: functions of constants and of `shared` arrays."""
    common = set(shared)
    found: set[int] = set()
    for i, instruction in enumerate(program.instructions):
        is_source = instruction.op is Op.CONSTANT or instruction.array in common
        if is_source or (instruction.operands and found.issuperset(instruction.operands)):
            found.add(i)
    return frozenset(found)


def partners(program: Program) -> dict[int, int]:
    """Return for every live sine the live cosine of the same angle, and for every cosine the sine."""
    known = {
        (instruction.op, instruction.operands): i
        for i in live(program)
        if (instruction := program.instructions[i]).op in (Op.SIN, Op.COS)
    }
    other = {Op.SIN: Op.COS, Op.COS: Op.SIN}
    return {i: known[key] for (op, angle), i in known.items() if (key := (other[op], angle)) in known}


def has_sines(program: Program) -> bool:
    """Return whether an output needs a sine or a cosine."""
    return has_operations(program, (Op.SIN, Op.COS))


def has_operations(program: Program, operations: Container[Op]) -> bool:
    """Return whether an output needs one of some operations."""
    return any(program.instructions[i].op in operations for i in live(program))


def names(program: Program, taken: Iterable[str]) -> dict[int, str]:
    """Return the name of the local of every named instruction, with underscores where the name is taken."""
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
    """Yield the input arrays, then the output arrays."""
    yield from program.inputs
    for output in program.outputs:
        yield output.array
