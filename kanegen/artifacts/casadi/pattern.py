"""Sparse matrices of CasADi: which entries are stored, and where they stand in arrays of generated code."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from kanegen.program.ir import Array


@dataclass(frozen=True)
class Pattern:
    """The shape of a matrix and the entries that may differ from zero, in compressed columns.

    Attributes:
        rows: Number of rows.
        columns: Number of columns.
        entries: Row and column of each entry that is stored, column by column.
    """

    rows: int
    columns: int
    entries: tuple[tuple[int, int], ...]

    @classmethod
    def where(cls, rows: int, columns: int, is_stored: Callable[[int, int], bool]) -> Pattern:
        """Return the pattern of the entries (row, column) for which `is_stored` is true."""
        places = ((row, column) for column in range(columns) for row in range(rows))
        return cls(rows, columns, tuple(place for place in places if is_stored(*place)))

    @classmethod
    def dense(cls, rows: int, columns: int) -> Pattern:
        """Return the pattern of a matrix without zeros."""
        return cls.where(rows, columns, lambda row, column: True)

    @classmethod
    def empty(cls, rows: int, columns: int) -> Pattern:
        """Return the pattern of a matrix of zeros."""
        return cls(rows, columns, ())

    @property
    def compressed(self) -> tuple[int, ...]:
        """The numbers by which CasADi describes the pattern.

        They are rows and columns, then 1 for a dense matrix; for others the place of the first entry of each
        column, the number of entries, and the row of each entry.
        """
        if len(self.entries) == self.rows * self.columns:
            return self.rows, self.columns, 1
        ends = [sum(entry[1] < column for entry in self.entries) for column in range(self.columns + 1)]
        return self.rows, self.columns, *ends, *(row for row, _ in self.entries)


def matrix_shape(array: Array) -> tuple[int, int]:
    """Return rows and columns of the matrix of an array: all axes but the last one count the rows.

    A vector is a column, and a number a matrix of one entry.

    Example:
        >>> matrix_shape(Array("frame_jacobians", (2, 6, 7), "", ""))
        (12, 7)
    """
    if len(array.shape) < 2:
        return array.size, 1
    return array.size // array.row, array.row
