"""Programs of the outputs that are derivatives, made by differentiating the lowered program of other outputs.

Where speeds are rates of coordinates, a recursion of its own gives the derivatives of {f} and of the
generalized forces of inverse dynamics by {x} and {y} (`recursion.inverse_dynamics_derivatives`). What it
leaves out, and derivatives by parameters, are differentiated instruction by instruction, and so are {f} and
inverse dynamics of other systems. For the solution {ydot} of [A]{ydot} = {f} + {tau} there are two ways.

The derivative by {x}, {y}, a parameter or a load is -[A]^-1 times the derivative of inverse dynamics at
constant {ydot} (Carpentier and Mansard 2018, section III); by {tau} it is [A]^-1. This is cheap, because one
elimination of [A] serves all columns. But where a joint has three angles, [A] is nearly singular next to
gimbal lock, and where {ydot} is refined, [A] is ill-conditioned; the derivative would lose there what {ydot}
does not.

So there the solver itself is differentiated instruction by instruction: with the components of angular
accelerations that it solves for, and with its refinement. It costs less, too, where several bodies translate
freely and rotate, because the solver never couples them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from kanegen.model.system import System
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.columns import column_solution
from kanegen.program.constants import Constants
from kanegen.program.elimination import Column, Elimination
from kanegen.program.ir import Op, Output, Program
from kanegen.program.tangent import Tangent, tangents
from kanegen.recursion.factorisation import carriers
from kanegen.recursion.inverse_dynamics_derivatives import differentiates_solver
from kanegen.recursion.outputs import DERIVATIVES, OUTPUTS
from kanegen.recursion.refinement import UNREFINED, Refinement


def differentiated(
    program: Program,
    system: System,
    outputs: Mapping[str, Output],
    names: Sequence[str],
    constants: Constants,
    refinement: Refinement = UNREFINED,
) -> Program:
    """Return the program with the outputs `names`, of which some are derivatives.

    Args:
        program: Program of the outputs that are differentiated or asked for.
        system: The tree.
        outputs: Outputs of the program, by name.
        names: Names of the outputs of the result, in order.
        constants: Precision of exact numbers.
        refinement: Refinement of {ydot} in the program.
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
            wanted.append(differentiation.output(through_solver=_needs_solver(system, refinement)))
        else:
            wanted.append(outputs[name].renumbered(moved))
    return check(builder.program(wanted))


def _needs_solver(system: System, refinement: Refinement) -> bool:
    """Return whether to differentiate the solver of {ydot} instead of inverse dynamics."""
    return differentiates_solver(system) or refinement.steps > 0


LOOPED = 20_000
"""Operations of a solution for all columns from which loops take the place of straight-line code."""


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
        self._n = len(system.freedoms)
        self._carriers = carriers(system)
        self._zero = builder.constant(constants.quotient(0, 1))
        self._one = builder.constant(constants.quotient(1, 1))

    def output(self, *, through_solver: bool) -> Output:
        """Return the output, added to the builder.

        A derivative of {ydot} exists and is accurate where {ydot} is.

        Args:
            through_solver: Whether a derivative of {ydot} is that of its solver, instruction by instruction.
        """
        base = self._outputs[self._derivative.needs[-1]]
        if "forward_dynamics" not in self._derivative.needs:
            rows = self._rows(base, self._moved)
        elif through_solver:
            rows = self._tangents(base, self._moved, self._columns)
        else:
            return self._solution(base)
        return self._filled(base, rows)

    def _filled(self, base: Output, rows: Sequence[Tangent]) -> Output:
        """Return the output of these rows, which exists where `base` does."""
        width = self._array.row
        values = tuple(row.get(column, self._zero) for row in rows for column in range(width))
        return replace(base.renumbered(self._moved), array=self._array, values=values)

    def _rows(self, output: Output, moved: Mapping[int, int]) -> list[Tangent]:
        """Return the derivatives of the elements of an output, by column, from parts where there are some."""
        if not self._outputs.keys() >= set(self._derivative.parts) or not self._derivative.parts:
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

    def _solution(self, base: Output) -> Output:
        """Return the derivatives of {ydot}: in loops over the columns where these have many operations."""
        needed = self._rows(self._outputs["inverse_dynamics"], self._at_solution())
        elimination = self._elimination()
        tau = self._columns.get("tau", slice(0, 0))
        right = {
            column: {row: need[column] for row, need in enumerate(needed) if column in need}
            for column in range(self._array.row)
            if not tau.start <= column < tau.stop
        }
        solution = column_solution(elimination.carriers, right, tau)
        if sum(solution.operations.values()) >= LOOPED:
            values = elimination.values_of(solution, right, self._zero)
            return replace(base.renumbered(self._moved), array=self._array, values=values, solution=solution)
        solved = {column: self._solved(elimination, one) for column, one in right.items()}
        for row, column in enumerate(range(tau.start, tau.stop)):
            solved[column] = elimination.solve({row: self._one})
        return self._filled(
            base,
            [
                {column: solved[column][row] for column in range(self._array.row) if row in solved[column]}
                for row in range(self._n)
            ],
        )

    def _solved(self, elimination: Elimination, right: Column) -> Column:
        """Return the solution {z} of [A]{z} + {b} = {0} for one column."""
        return {row: self._builder.negate(value) for row, value in elimination.solve(right).items()}

    def _at_solution(self) -> dict[int, int]:
        """Return the values of the program evaluated at the solution {ydot}, by number of the value."""
        solution = [self._moved[value] for value in self._outputs["forward_dynamics"].values]
        moved: dict[int, int] = {}
        for i, instruction in enumerate(self._program.instructions):
            if instruction.op is Op.INPUT and instruction.array == "ydot":
                moved[i] = solution[instruction.index]
            elif all(moved[j] == self._moved[j] for j in instruction.operands):
                moved[i] = self._moved[i]
            else:
                bare = self._builder.copy(instruction.named(""), [moved[j] for j in instruction.operands])
                moved[i] = self._builder.name(bare, f"{instruction.name}_s" if instruction.name else "")
        return moved

    def _elimination(self) -> Elimination:
        """Return the elimination of [A], from the outermost freedom inward."""
        n, values = self._n, self._outputs["mass_matrix"].values
        matrix = {
            (i, j): self._moved[values[n * i + j]]
            for i in range(n)
            for j in range(i + 1)
            if not self._is_zero(values[n * i + j])
        }
        return Elimination(self._builder, matrix, self._carriers, self._one)

    def _is_zero(self, value: int) -> bool:
        """Return whether a value is the number 0."""
        instruction = self._program.instructions[value]
        return instruction.op is Op.CONSTANT and instruction.number == 0
