"""Programs of the outputs that are derivatives, made by differentiating the lowered program of other outputs.

A recursion of its own gives the derivatives of {f} and of the generalized forces of inverse dynamics by {x}
and {y} (`recursion.inverse_dynamics_derivatives`). What it leaves out, and derivatives by parameters, are
differentiated instruction by instruction. For the solution {ydot} of [A]{ydot} = {f} + {tau} there are two
ways. The derivative by {x}, {y}, a parameter or a load is -[A]^-1 times the derivative of inverse dynamics at
constant {ydot} (`solution_columns`). This is cheap, because one elimination of [A] serves all columns. Long
chains have a recursion of their own, by articulated bodies, where that costs less
(`recursion.articulated_rows`).

But where {ydot} is refined, or has a solver that is more accurate than this elimination, the derivative would
lose what {ydot} does not. There the solver itself is differentiated instruction by instruction, with its
refinement. It costs less, too, where several bodies translate freely and rotate, because the solver never
couples them. `recursion.outputs` and `conditioning` decide by deriving the part that the first way needs.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from kanegen.lowering.solution_columns import SolutionColumns
from kanegen.model.system import System
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.constants import Constants
from kanegen.program.ir import Op, Output, Program
from kanegen.program.tangent import Tangent, tangents
from kanegen.recursion.articulated_rows import ArticulatedRows
from kanegen.recursion.outputs import DERIVATIVES, OUTPUTS, SOLUTION_PARTS
from kanegen.recursion.solution_derivatives import SolutionRows


def differentiated(
    program: Program,
    system: System,
    outputs: Mapping[str, Output],
    names: Sequence[str],
    constants: Constants,
) -> Program:
    """Return the program with the outputs `names`, of which some are derivatives.

    Args:
        program: Program of the outputs that are differentiated or asked for.
        system: The tree.
        outputs: Outputs of the program, by name.
        names: Names of the outputs of the result, in order.
        constants: Precision of exact numbers.
    """
    if not DERIVATIVES.keys() & set(names):
        return program
    builder = Builder(program.inputs)
    moved: dict[int, int] = {}
    for i, instruction in enumerate(program.instructions):
        moved[i] = builder.copy(instruction, [moved[j] for j in instruction.operands])
    wanted = []
    for name in names:
        if name in DERIVATIVES:
            differentiation = _Differentiation(builder, program, moved, system, outputs, constants, name)
            wanted.append(differentiation.output())
        else:
            wanted.append(outputs[name].renumbered(moved))
    return check(builder.program(wanted))


class _Differentiation:
    """The differentiation of a program for one output, in a builder that holds a copy of the program."""

    def __init__(
        self,
        builder: Builder,
        program: Program,
        moved: Mapping[int, int],
        system: System,
        outputs: Mapping[str, Output],
        constants: Constants,
        name: str,
    ) -> None:
        self._builder, self._program, self._moved = builder, program, moved
        self._outputs, self._constants = outputs, constants
        self._derivative = DERIVATIVES[name]
        self._array = OUTPUTS[name].array(system)
        self._columns = self._derivative.columns_of(system)
        self._solution_rows = SolutionRows(len(system.coordinates), len(system.freedoms))
        self._zero = builder.constant(constants.quotient(0, 1))

    def output(self) -> Output:
        """Return the output, added to the builder.

        A derivative of {ydot} exists and is accurate where {ydot} is.
        """
        base = self._outputs[self._derivative.needs[-1]]
        if SOLUTION_PARTS in self._derivative.parts and SOLUTION_PARTS in self._outputs:
            copied = self._builder, self._program, self._moved, self._outputs[SOLUTION_PARTS]
            columns = SolutionColumns(*copied, self._solution_rows, self._columns, self._constants)
            return columns.output(self._array, self._zero)
        if self._derivative.alternative in self._outputs:
            base = self._outputs[self._derivative.alternative]
            rows = self._rows_of_articulated_bodies(base)
        else:
            rows = self._rows(base, self._moved)
        width = self._array.row
        values = tuple(row.get(column, self._zero) for row in rows for column in range(width))
        return replace(base.renumbered(self._moved), array=self._array, values=values)

    def _rows(self, output: Output, moved: Mapping[int, int]) -> list[Tangent]:
        """Return the derivatives of the elements of an output, by column, from parts where there are some."""
        if not self._derivative.parts or not self._outputs.keys() >= set(self._derivative.parts):
            return self._tangents(output, moved, self._columns)
        by_state, of_elements = (self._outputs[part] for part in self._derivative.parts)
        further = self._tangents(of_elements, moved, self._columns.keys() & {"x", "y"})
        others = self._tangents(output, moved, self._columns.keys() - {"x", "y"})
        rows = []
        for place, (more, other) in enumerate(zip(further, others, strict=True)):
            row = dict(self._known(by_state, place, moved))
            for column, slope in more.items():
                row[column] = self._builder.add(row[column], slope) if column in row else slope
            rows.append(row | other)
        return rows

    def _rows_of_articulated_bodies(self, part: Output) -> list[Tangent]:
        """Return the derivatives of the entries of {ydot}, by column, from a part of `ArticulatedRows`.

        The part has them for constant efforts on freedoms. {tau} and force elements change the efforts, and
        [A]^-1 says what that does to {ydot}.
        """
        n, moved = part.array.row, self._moved
        first = {name: rows.start for name, rows in ArticulatedRows(n).slices.items()}
        efforts = replace(part, values=part.values[n * first["efforts"] :][:n])
        slopes = self._tangents(efforts, moved, self._columns)
        rows = []
        for i in range(n):
            row = dict[int, int]()
            for name, array in (("by_coordinate", "x"), ("by_speed", "y")):
                start = self._columns[array].start
                row |= {start + j: value for j, value in self._known(part, first[name] + i, moved)}
            for j, entry in self._known(part, first["inverse"] + i, moved):
                for column, slope in slopes[j].items():
                    change = self._builder.multiply(entry, slope)
                    row[column] = self._builder.add(row[column], change) if column in row else change
            rows.append(row)
        return rows

    def _known(self, by_state: Output, row: int, moved: Mapping[int, int]) -> Iterator[tuple[int, int]]:
        """Yield column and value of each derivative that a part holds in one of its rows."""
        width = by_state.array.row
        for column, value in enumerate(by_state.values[width * row : width * (row + 1)]):
            if not self._is_zero(value):
                yield column, moved[value]

    def _tangents(self, output: Output, moved: Mapping[int, int], by: Collection[str]) -> list[Tangent]:
        """Return the derivatives of the elements of an output with respect to some arrays, by column."""
        directions = dict(self._directions(by))
        found = tangents(self._builder, self._program, moved, directions, output.values, self._constants)
        return [found[value] for value in output.values]

    def _directions(self, by: Collection[str]) -> Iterator[tuple[int, int]]:
        """Yield the input values of the arrays `by`, each with its column."""
        for i, instruction in enumerate(self._program.instructions):
            if instruction.op is Op.INPUT and instruction.array in by:
                yield i, self._columns[instruction.array].start + instruction.index

    def _is_zero(self, value: int) -> bool:
        """Return whether a value is the number 0."""
        instruction = self._program.instructions[value]
        return instruction.op is Op.CONSTANT and instruction.number == 0
