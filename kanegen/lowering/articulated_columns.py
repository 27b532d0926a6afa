"""The derivatives of {ydot} from the part "forward_dynamics_by_state" (`recursion.articulated_rows`).

The part has them for constant efforts on freedoms. {tau} and force elements change the efforts, and [A]^-1
says what that does to {ydot}.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from kanegen.program.builder import Builder
from kanegen.program.constants import Constants
from kanegen.program.ir import Array, Op, Output, Program
from kanegen.program.tangent import Tangent, tangents
from kanegen.recursion.articulated_rows import ArticulatedRows


class ArticulatedColumns:
    """The columns of the derivative of {ydot}.

    Args:
        builder: A builder that holds a copy of the program.
        program: The program with the part.
        moved: Value in the builder of each instruction of the program.
        part: The part, an output of the program.
        columns: Columns of the derivative by array: those of {x}, {y} and {tau}.
        constants: Precision of exact numbers.
    """

    def __init__(
        self,
        builder: Builder,
        program: Program,
        moved: Mapping[int, int],
        part: Output,
        columns: Mapping[str, slice],
        constants: Constants,
    ) -> None:
        self._builder, self._program, self._moved = builder, program, moved
        self._part, self._columns, self._constants = part, columns, constants
        self._n = part.array.row
        self._rows = ArticulatedRows(self._n).slices

    def output(self, array: Array, zero: int) -> Output:
        """Return the output of all columns.

        Args:
            array: Its array.
            zero: The value of the number 0.
        """
        efforts = self._effort_slopes()
        rows = [self._row(i, efforts) for i in range(self._n)]
        values = tuple(row.get(column, zero) for row in rows for column in range(array.row))
        return replace(self._part.renumbered(self._moved), array=array, values=values)

    def _row(self, i: int, efforts: list[Tangent]) -> Tangent:
        """Return the derivatives of an entry of {ydot}, by column.

        Args:
            i: Place of the entry.
            efforts: Derivatives of the efforts by column.
        """
        make, row = self._builder, dict[int, int]()
        for name, array in (("by_coordinate", "x"), ("by_speed", "y")):
            first = self._columns[array].start
            row |= {first + j: value for j, value in self._nonzero(name, i).items()}
        inverse = self._nonzero("inverse", i)
        for j, entry in inverse.items():
            for column, slope in efforts[j].items():
                change = make.multiply(entry, slope)
                row[column] = make.add(row[column], change) if column in row else change
        return row

    def _effort_slopes(self) -> list[Tangent]:
        """Return the derivatives of the efforts by column, by place in {y}."""
        directions = {
            i: self._columns[x.array].start + x.index
            for i, x in enumerate(self._program.instructions)
            if x.op is Op.INPUT and x.array in self._columns
        }
        wanted = self._values("efforts", 0)
        copied = self._builder, self._program, self._moved
        found = tangents(*copied, directions, wanted, self._constants)
        return [found[value] for value in wanted]

    def _values(self, name: str, row: int) -> tuple[int, ...]:
        """Return the values of the program in a row of the part, by place."""
        first = self._n * (self._rows[name].start + row)
        return self._part.values[first : first + self._n]

    def _nonzero(self, name: str, row: int) -> dict[int, int]:
        """Return the values of the builder in a row of the part, by place, without those that are 0."""
        values = enumerate(self._values(name, row))
        return {j: self._moved[v] for j, v in values if not self._builder.is_zero(self._moved[v])}
