"""The same program without loops, for what reads or evaluates instructions one by one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.columns import ColumnGroup, ColumnSolution
from kanegen.program.ir import Module, Output, Program


def expanded(program: Program) -> Program:
    """Return the program with the loops of its outputs as straight-line code, in which they compute the same.

    Every operation has the same operands in the same order, so that no bit of a result differs but the sign
    of a zero: where a loop subtracts from zero, the sign of the other operand is changed.
    """
    if all(output.solution is None for output in program.outputs):
        return program
    builder = Builder(program.inputs)
    moved: list[int] = []
    for instruction in program.instructions:
        moved.append(builder.copy(instruction, [moved[j] for j in instruction.operands]))
    outputs = []
    for output in program.outputs:
        same = output.renumbered(moved)
        outputs.append(_solved(builder, same, output.solution) if output.solution else same)
    return check(builder.program(outputs))


def has_loops(module: Module) -> bool:
    """Return whether loops compute an output of a function."""
    return any(one.solution for program in module.functions.values() for one in program.outputs)


def expanded_module(module: Module) -> Module:
    """Return a module whose programs have no loops."""
    return replace(module, functions={name: expanded(one) for name, one in module.functions.items()})


def _solved(builder: Builder, output: Output, solution: ColumnSolution) -> Output:
    """Return an output whose loops become instructions of a builder."""
    expansion = _Expansion(builder, solution, output.values)
    width = output.array.size // solution.stored
    elements = [expansion.zero] * output.array.size
    for group, right in expansion.groups():
        for place, column in enumerate(group.columns):
            for row, value in expansion.column(group, place, right).items():
                if row < solution.stored:
                    elements[width * row + column] = value
    for i, j in solution.mirrored:
        elements[width * i + solution.first_unit + j] = elements[width * j + solution.first_unit + i]
    return replace(output, values=tuple(elements), solution=None)


class _Expansion:
    """The loops of one solution as instructions.

    Args:
        builder: The builder to which they are appended.
        solution: The plan.
        values: Numbers of the values that it needs.
    """

    def __init__(self, builder: Builder, solution: ColumnSolution, values: Sequence[int]) -> None:
        self._builder, self._solution = builder, solution
        self.zero = builder.constant(0.0)
        self._minus_one = builder.constant(-1.0)
        rest = iter(values)
        self._factors = [[(i, next(rest)) for i in carriers] for carriers in solution.carriers]
        self._inverses = [next(rest) for _ in range(solution.rows)]
        self._right = list(rest)

    def groups(self) -> Iterator[tuple[ColumnGroup, Sequence[int]]]:
        """Yield each group of columns with its elements of {b}, row by row."""
        start = 0
        for group in self._solution.groups:
            stop = start + len(group.given) * len(group.columns)
            yield group, self._right[start:stop]
            start = stop

    def column(self, group: ColumnGroup, place: int, right: Sequence[int]) -> dict[int, int]:
        """Return the solution for one column of a group, by row.

        Args:
            group: The group.
            place: Place of the column in the group.
            right: Elements of {b} of the group, row by row.
        """
        make, count = self._builder, len(group.columns)
        z = {row: right[k * count + place] for k, row in enumerate(group.given)}
        if group.is_of_inverse:
            z = {group.columns[place] - self._solution.first_unit: self._minus_one}
        for k in group.reduced:
            if k in z:
                for i, factor in self._factors[k]:
                    self._subtract(z, i, make.multiply(factor, z[k]))
                z[k] = make.multiply(z[k], self._inverses[k])
        for k in group.solved:
            for i, factor in self._factors[k]:
                if i in z:
                    self._subtract(z, k, make.multiply(factor, z[i]))
        return {row: z[row] for row in group.solved if row in z}

    def _subtract(self, z: dict[int, int], row: int, change: int) -> None:
        """Subtract a value from an element, which is zero where it is absent."""
        z[row] = self._builder.subtract(z[row], change) if row in z else self._builder.negate(change)
