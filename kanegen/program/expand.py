"""The same program without loops, for what reads or evaluates instructions one by one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import inf

from kanegen.program.arrange import arrange
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.columns import ColumnGroup, ColumnSolution
from kanegen.program.count import count
from kanegen.program.ir import Module, Output, Program

LONGEST_STRAIGHT = 60_000
"""Operations of a program from which loops also compute SIMD lanes: straight-line code of this length no
longer fits into caches of instructions."""


def expanded(program: Program) -> Program:
    """Return the program with the loops of its outputs as straight-line code, in which they compute the same.

    Every operation has the same operands in the same order, so that no bit of a result differs.
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
        outputs.append(straight_line(builder, same))
    return check(builder.program(outputs))


def has_loops(module: Module) -> bool:
    """Return whether loops compute an output of a function."""
    return any(one.solution for program in module.functions.values() for one in program.outputs)


def expanded_module(module: Module, longest: float = inf) -> Module:
    """Return a module whose programs have no loops, but for programs that would be too long.

    Args:
        module: The programs.
        longest: Operations of a program from which its loops stay.
    """
    functions = {}
    for name, program in module.functions.items():
        has_any = any(one.solution for one in program.outputs)
        stays = not has_any or sum(count(program).values()) >= longest
        functions[name] = program if stays else arrange(expanded(program))
    return replace(module, functions=functions)


def straight_line(builder: Builder, output: Output) -> Output:
    """Return an output of a builder's program with its loops, if any, as instructions of the builder."""
    solution = output.solution
    if solution is None:
        return output
    expansion = _Expansion(builder, solution, output.values)
    width = output.array.size // solution.stored
    elements = dict(output.elements())
    for group, right in expansion.groups():
        for place, column in enumerate(group.columns):
            for row, value in expansion.column(group, place, right).items():
                elements[width * row + column] = value
    for tree in solution.inverses:
        elements |= expansion.elements_of_inverse(tree, width)
    values = tuple(elements[place] for place in range(output.array.size))
    return replace(output, values=values, places=None, solution=None)


def with_short_inverses(builder: Builder, output: Output, longest: int) -> Output:
    """Return an output of a builder's program with parts of [A]^-1 that have few rows as instructions.

    Args:
        builder: The builder.
        output: The output, which loops compute.
        longest: Most rows of a part that becomes instructions.
    """
    solution = output.solution
    if solution is None:
        return output
    short = [tree for tree in solution.inverses if len(tree) <= longest]
    width, elements = output.array.size // solution.stored, dict(output.elements())
    expansion = _Expansion(builder, solution, output.values)
    for tree in short:
        elements |= expansion.elements_of_inverse(tree, width)
    left = tuple(tree for tree in solution.inverses if tree not in short)
    places = tuple(sorted(elements))
    values = (*output.values[: solution.number_of_values], *(elements[place] for place in places))
    return replace(output, values=values, places=places, solution=replace(solution, inverses=left))


class _Expansion:
    """The loops of one solution as instructions.

    Args:
        builder: The builder to which they are appended.
        solution: The plan.
        values: Numbers of the values that it needs.
    """

    def __init__(self, builder: Builder, solution: ColumnSolution, values: Sequence[int]) -> None:
        self._builder, self._solution = builder, solution
        rest = iter(values)
        self._factors = [[(i, next(rest)) for i in carriers] for carriers in solution.sums]
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
        """Return the solution for one column of a group, by row of the result.

        Args:
            group: The group.
            place: Place of the column in the group.
            right: Elements of {b} of the group, row by row.
        """
        make, count = self._builder, len(group.columns)
        z = {row: right[k * count + place] for k, row in enumerate(group.given)}
        for k in group.reduced:
            for i, factor in self._factors[k]:
                self._subtract(z, i, make.multiply(factor, z[k]))
            z[k] = make.multiply(z[k], self._inverses[k])
        for k, number in zip(group.solved, group.sums, strict=True):
            for i, factor in self._factors[number]:
                if i in z:
                    self._subtract(z, k, make.multiply(factor, z[i]))
        return {row: z[row] for row in group.solved if row < self._solution.stored}

    def elements_of_inverse(self, tree: Sequence[int], width: int) -> dict[int, int]:
        """Return the elements of the result, whose rows have this width, that are elements of [A]^-1."""
        stored, first = self._solution.stored, self._solution.first_unit
        return {
            width * row + first + column: value
            for (row, column), value in self._inverse(tree).items()
            if row < stored and column < stored
        }

    def _inverse(self, tree: Sequence[int]) -> dict[tuple[int, int], int]:
        """Return the elements of [A]^-1 and of mapped rows, by row and column, in the rows of a tree."""
        found: dict[tuple[int, int], int] = {}
        for place, k in enumerate(tree):
            for j in (*tree[:place], k):
                own: dict[int, int] = {}
                if j == k and k not in self._solution.mapped:
                    own[k] = self._builder.negate(self._inverses[k])
                for i, factor in self._factors[k]:
                    self._subtract(own, k, self._builder.multiply(factor, found[i, j]))
                found[k, j] = found[j, k] = own[k]
        return found

    def _subtract(self, z: dict[int, int], row: int, change: int) -> None:
        """Subtract a value from an element, which is zero where it is absent."""
        z[row] = self._builder.subtract(z[row], change) if row in z else self._builder.negate(change)
