"""From a program to the statements of a C function.

Named inputs are loaded first. Every other value is computed where its instruction stands: a named one, or
one used more than once, into a const local; one used once inside the expression that uses it. An output is
stored as soon as its value is known, so that few values have to be kept.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from kanegen.c.expression import Expression, Level, apply, literal
from kanegen.c.layout import BREAK, WIDTH, comment, wrap
from kanegen.program.ir import Array, Instruction, Op, Program

LONGEST = 16
"""Operations in one C expression; longer ones are cut by numbered locals."""

LIBM = frozenset({"sin", "cos", "sqrt"})
"""Functions that a body calls, whose names no local may take."""


def statements(program: Program) -> list[str]:
    """The lines of a C function that evaluates `program`, without its braces."""
    return _Body(program).lines()


def element(array: Array, index: int) -> str:
    """One element of an array in C; in a matrix as `48*row + column`."""
    if len(array.shape) != 2:
        return f"{array.name}[{index}]"
    row, column = divmod(index, array.shape[1])
    return f"{array.name}[{array.shape[1]}*{row} + {column}]"


class _Body:
    """The statements so far, and for every value how later ones refer to it."""

    def __init__(self, program: Program) -> None:
        self._instructions = program.instructions
        self._live = _live(program)
        self._uses = Counter(j for i in self._live for j in program.instructions[i].operands)
        self._places = _places(program)
        self._arrays = {array.name: array for array in program.inputs}
        self._names = _names(program)
        self._taken = set(self._names.values()) | _reserved(program)
        self._numbered = 0
        self._expressions: dict[int, Expression] = {}
        self._lines: list[str] = []
        self._last_note = ""

    def lines(self) -> list[str]:
        loads = {i for i in self._live if i in self._names and self._instructions[i].op is Op.INPUT}
        self._mark_unused_inputs()
        for i in sorted(loads):
            self._define(i)
        for i in self._live:
            if i not in loads:
                self._define(i)
            self._store(i)
        return self._lines

    def _mark_unused_inputs(self) -> None:
        read = {self._instructions[i].array for i in self._live}
        self._lines += [f"    (void){name};" for name in self._arrays if name not in read]

    def _define(self, i: int) -> None:
        """Compute value i into a local, or keep its expression for the only place that needs it."""
        self._note(self._instructions[i].note)
        expression = self._expression(self._instructions[i])
        needed_again = self._uses[i] > 1 or (self._uses[i] == 1 and i in self._places)
        if i in self._names:
            expression = self._local(self._names[i], expression)
        elif needed_again and expression.operations:
            expression = self._local(self._next_name(), expression)
        self._expressions[i] = expression

    def _expression(self, instruction: Instruction) -> Expression:
        if instruction.op is Op.CONSTANT:
            return literal(instruction.number)
        if instruction.op is Op.INPUT:
            return Expression(element(self._arrays[instruction.array], instruction.index))
        return apply(instruction.op, self._operands(instruction.operands))

    def _operands(self, values: Sequence[int]) -> tuple[Expression, ...]:
        """Their expressions, cut so that one more operation keeps within `LONGEST`."""
        while sum(self._expressions[j].operations for j in values) >= LONGEST:
            longest = max(values, key=lambda j: self._expressions[j].operations)
            self._expressions[longest] = self._local(self._next_name(), self._expressions[longest])
        return tuple(self._expressions[j] for j in values)

    def _local(self, name: str, expression: Expression) -> Expression:
        self._lines += wrap(f"const double {name} = {expression};")
        return Expression(name)

    def _next_name(self) -> str:
        self._numbered += 1
        while f"t{self._numbered}" in self._taken:
            self._numbered += 1
        return f"t{self._numbered}"

    def _note(self, note: str) -> None:
        """A comment line where a group of instructions with the same note begins."""
        if note and note != self._last_note:
            self._lines += ["", *comment(note)] if self._lines else comment(note)
            self._last_note = note

    def _store(self, i: int) -> None:
        """Fill the outputs that hold value i, several on a line: `A[1] = A[3] = value;`."""
        expression = self._expressions[i]
        chain: list[str] = []
        for place in self._places.get(i, []):
            width = len(f"    {' = '.join([*chain, place])} = {expression};")
            if chain and width > WIDTH and expression.level is Level.ATOM:
                self._lines += wrap(_assignment(chain, expression))
                chain = []
            chain.append(place)
        if chain:
            self._lines += wrap(_assignment(chain, expression))


def _assignment(chain: Sequence[str], expression: Expression) -> str:
    return "".join(f"{target} ={BREAK}" for target in chain) + f"{expression};"


def _live(program: Program) -> list[int]:
    """Instructions that an output needs, in order."""
    needed = [False] * len(program.instructions)
    for value in program.results():
        needed[value] = True
    for i in range(len(needed) - 1, -1, -1):
        if needed[i]:
            for operand in program.instructions[i].operands:
                needed[operand] = True
    return [i for i, is_needed in enumerate(needed) if is_needed]


def _places(program: Program) -> dict[int, list[str]]:
    """For every result the output elements that hold it."""
    places: dict[int, list[str]] = {}
    for output in program.outputs:
        for index, value in enumerate(output.values):
            places.setdefault(value, []).append(element(output.array, index))
    return places


def _reserved(program: Program) -> frozenset[str]:
    return LIBM | {array.name for array in _arrays(program)}


def _arrays(program: Program) -> Iterator[Array]:
    yield from program.inputs
    for output in program.outputs:
        yield output.array


def _names(program: Program) -> dict[int, str]:
    """For every named instruction the name of its local: an underscore more where the name is taken."""
    taken = set(_reserved(program))
    names: dict[int, str] = {}
    for i, instruction in enumerate(program.instructions):
        name = instruction.name
        while name in taken:
            name += "_"
        if name:
            taken.add(name)
            names[i] = name
    return names
