"""The derivatives of {ydot} from the part "forward_dynamics_parts" (`recursion.solution_derivatives`).

The solution in free components comes first, by the factors of [A]; what motion requires is evaluated there.
Every column is then solved for. The maps between {x}, {y}, {tau} and free components are differentiated
instruction by instruction.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from graphlib import TopologicalSorter

from kanegen.program.builder import Builder
from kanegen.program.columns import ColumnSolution, column_solution
from kanegen.program.constants import Constants
from kanegen.program.elimination import Column, Elimination
from kanegen.program.expand import straight_line, with_short_inverses
from kanegen.program.ir import Array, Op, Output, Program
from kanegen.program.tangent import Tangent, seeded_tangents
from kanegen.recursion.solution_derivatives import SolutionRows

LOOPED = 1_000
"""Operations of all columns from which loops take the place of straight-line code."""

SHORT = 12
"""Most related rows of which [A]^-1 is straight-line code beside loops."""

STATE = ("x", "y")
"""Arrays by which the part holds derivatives of what motion requires."""


@dataclass(frozen=True)
class _Loops:
    """A solution in loops.

    Attributes:
        elimination: The elimination of [A], with maps from components to {ydot}.
        right: Right sides with their sign changed, and what is added to mapped rows, by column and row.
        solution: The plan.
    """

    elimination: Elimination
    right: Mapping[int, Column]
    solution: ColumnSolution


class SolutionColumns:
    """The columns of the derivative of {ydot}.

    Args:
        builder: A builder that holds a copy of the program.
        program: The program with the part.
        moved: Value in the builder of each instruction of the program.
        part: The part, an output of the program.
        rows: The rows of the part.
        columns: Columns of the derivative by array.
        constants: Precision of exact numbers.
    """

    def __init__(
        self,
        builder: Builder,
        program: Program,
        moved: Mapping[int, int],
        part: Output,
        rows: SolutionRows,
        columns: Mapping[str, slice],
        constants: Constants,
    ) -> None:
        self._builder, self._program, self._columns = builder, program, columns
        self._part, self._n, self._slices, self._constants = part, rows.freedoms, rows.slices, constants
        self._elimination = self._eliminated(moved)
        found = self._elimination.solve(self._nonzero(self._row("surplus"), moved))
        zero = builder.constant(constants.quotient(0, 1))
        self._solution = [found.get(i, zero) for i in range(self._n)]
        self._moved = self._at_solution(moved)

    def output(self, array: Array, zero: int) -> Output:
        """Return the output of all columns: in loops over the columns where these have many operations.

        Args:
            array: Its array.
            zero: The value of the number 0.
        """
        plan = self._plan()
        values = plan.elimination.values_of(plan.solution, plan.right, zero)
        computed = plan.solution.elements()
        others = [
            row * array.row + column
            for row in range(self._n)
            for column in range(array.row)
            if (row, column) not in computed
        ]
        output = replace(
            self._part.renumbered(self._moved),
            array=array,
            values=(*values, *[zero] * len(others)),
            places=tuple(others),
            solution=plan.solution,
        )
        is_long = sum(plan.solution.operations.values()) >= LOOPED
        if not is_long:
            return straight_line(self._builder, output)
        return with_short_inverses(self._builder, output, SHORT)

    def _plan(self) -> _Loops:
        """Return the solution of all columns, with entries of {ydot} mapped that are no free components."""
        efforts = _by_column(self._tangents("efforts", self._columns.keys() - {"tau"}))
        mapped = [i for i in range(self._n) if not self._is_component(i)]
        place = {i: self._n + k for k, i in enumerate(mapped)}
        maps, added = self._map_of_components(), self._rates(self._columns.keys() - {"tau"}, {})
        elimination = self._elimination.relabelled(place)
        for i in mapped:
            elimination = elimination.with_map(i, {place.get(k, k): value for k, value in maps[i].items()})
        right = {
            column: {place.get(i, i): value for i, value in rows.items()}
            for column, rows in self._right_sides(self._required(), efforts).items()
        }
        for i in mapped:
            for column, value in added[i].items():
                right.setdefault(column, {})[i] = value
        first_unit = self._columns["tau"].start if "tau" in self._columns else None
        solution = column_solution(elimination.carriers, right, first_unit, frozenset(mapped))
        return _Loops(elimination, right, solution)

    def _map_of_components(self) -> list[Tangent]:
        """Return the derivatives of the entries of {ydot} by free components, by place of these in {y}."""
        one = self._builder.constant(self._constants.quotient(1, 1))
        return self._rates((), {i: {i: one} for i in range(self._n)})

    def _rates(self, by: Collection[str], components: Mapping[int, Tangent]) -> list[Tangent]:
        """Return the derivatives of the entries of {ydot}, by column, for those of the free components.

        Args:
            by: Arrays by which the map from components is differentiated.
            components: Derivatives of the components, by place in {y}.
        """
        known = {
            i: components.get(x.index, {})
            for i, x in enumerate(self._program.instructions)
            if x.op is Op.INPUT and x.array == "ydot"
        }
        return self._tangents("rates", by, known)

    def _is_component(self, i: int) -> bool:
        """Return whether an entry of {ydot} is a free component itself."""
        instruction = self._program.instructions[self._row("rates")[i]]
        return instruction.op is Op.INPUT and (instruction.array, instruction.index) == ("ydot", i)

    def _row(self, name: str, row: int = 0) -> Sequence[int]:
        """Return the values of the program in a row of the part, by place in {y}."""
        first = self._n * (self._slices[name].start + row)
        return self._part.values[first : first + self._n]

    def _nonzero(self, values: Sequence[int], moved: Mapping[int, int]) -> Column:
        """Return the values of the builder, without those that are the number 0."""
        return {i: moved[value] for i, value in enumerate(values) if not self._is_zero(value)}

    def _is_zero(self, value: int) -> bool:
        """Return whether a value of the program is the number 0."""
        instruction = self._program.instructions[value]
        return instruction.op is Op.CONSTANT and instruction.number == 0

    def _eliminated(self, moved: Mapping[int, int]) -> Elimination:
        """Return the elimination by the factors of the part; a row comes before all that it changes."""
        factors = {k: self._nonzero(self._row("factors", k), moved) for k in range(self._n)}
        before = {i: [k for k in factors if i in factors[k]] for i in factors}
        order = TopologicalSorter(before).static_order()
        inverses = self._nonzero(self._row("inverse_pivots"), moved)
        return Elimination(self._builder, {k: factors[k] for k in order}, inverses)

    def _at_solution(self, moved: Mapping[int, int]) -> dict[int, int]:
        """Return the values of the program evaluated at the solution, by number of the value."""
        found: dict[int, int] = {}
        for i, instruction in enumerate(self._program.instructions):
            if instruction.op is Op.INPUT and instruction.array == "ydot":
                found[i] = self._solution[instruction.index]
            elif all(found[j] == moved[j] for j in instruction.operands):
                found[i] = moved[i]
            else:
                operands = [found[j] for j in instruction.operands]
                bare = self._builder.copy(instruction.named(""), operands)
                found[i] = self._builder.name(bare, f"{instruction.name}_s" if instruction.name else "")
        return found

    def _required(self) -> dict[int, Column]:
        """Return the derivatives of what motion requires at constant components, by column and row."""
        found: dict[int, Column] = {}
        if "x" in self._columns:
            first = self._columns["x"].start
            for place in range(len(self._columns_of("x"))):
                motion = self._nonzero(self._row("motions", place), self._moved)
                shares = {j: {first + place: share} for j, share in motion.items()}
                self._add_products(found, "by_motion", shares)
        speeds = self._tangents("speeds", self._columns.keys() & set(STATE))
        self._add_products(found, "by_speed", dict(enumerate(speeds)))
        for i, slopes in enumerate(self._tangents("required", self._columns.keys() - {*STATE, "tau"})):
            for column, slope in slopes.items():
                self._add(found, column, i, slope)
        return found

    def _columns_of(self, array: str) -> range:
        """Return the columns of an array."""
        return range(self._columns[array].start, self._columns[array].stop)

    def _add_products(self, found: dict[int, Column], name: str, shares: Mapping[int, Tangent]) -> None:
        """Add derivatives by motions or speeds, times derivatives of these by column.

        Args:
            found: Derivatives by column and row.
            name: Name of the rows of the part that hold the derivatives.
            shares: Derivatives by column of each motion or speed, by place in {y}.
        """
        for i in range(self._n):
            for j, value in self._nonzero(self._row(name, i), self._moved).items():
                for column, share in shares.get(j, {}).items():
                    self._add(found, column, i, self._builder.multiply(share, value))

    def _add(self, found: dict[int, Column], column: int, row: int, value: int) -> None:
        """Add a value to an entry of a column."""
        entries = found.setdefault(column, {})
        entries[row] = self._builder.add(entries[row], value) if row in entries else value

    def _right_sides(
        self, required: Mapping[int, Column], efforts: Mapping[int, Column]
    ) -> dict[int, Column]:
        """Return what is required less efforts, by column."""
        found: dict[int, Column] = {}
        for column in sorted({*required, *efforts}):
            found[column] = dict(required.get(column, {}))
            for row, value in efforts.get(column, {}).items():
                found[column][row] = self._subtracted(found[column].get(row), value)
        return found

    def _subtracted(self, value: int | None, change: int) -> int:
        """Return `value` less `change`, where an absent value is zero."""
        return self._builder.negate(change) if value is None else self._builder.subtract(value, change)

    def _tangents(
        self, name: str, by: Collection[str], known: Mapping[int, Tangent] | None = None
    ) -> list[Tangent]:
        """Return the derivatives of a row of the part, by column, for each place in {y}.

        Args:
            name: Name of the row.
            by: Arrays by which it is differentiated.
            known: Derivatives of instructions of the program that are known.
        """
        wanted, copied = self._row(name), (self._builder, self._program, self._moved)
        seeds = {**self._seeds(by), **(known or {})}
        found = seeded_tangents(*copied, seeds, wanted, self._constants)
        return [found[value] for value in wanted]

    def _seeds(self, by: Collection[str]) -> dict[int, Tangent]:
        """Return the tangents of the inputs of the arrays `by`, each with its column."""
        one = self._builder.constant(self._constants.quotient(1, 1))
        return {
            i: {self._columns[x.array].start + x.index: one}
            for i, x in enumerate(self._program.instructions)
            if x.op is Op.INPUT and x.array in by
        }


def _by_column(rows: Sequence[Tangent]) -> dict[int, Column]:
    """Return the entries of rows by column and row."""
    found: dict[int, dict[int, int]] = {}
    for i, row in enumerate(rows):
        for column, value in row.items():
            found.setdefault(column, {})[i] = value
    return found
