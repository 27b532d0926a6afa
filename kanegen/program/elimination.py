"""The solution of [A]{z} = {b} for many right sides as instructions, by [A] = [L]^T [D] [L] without fill-in.

The elimination is that of `recursion.factorisation`, applied to values of a program. Entries that are zero by
structure are left out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kanegen.program.builder import Builder
from kanegen.program.columns import ColumnSolution

Column = dict[int, int]
"""Numbers of the values of a column by row; rows with a zero are absent."""


class Elimination:
    """The factors [L] and [D] of a symmetric positive definite matrix.

    Args:
        builder: The builder to which instructions are appended.
        matrix: Entries that are not zero, by pair of rows, the larger first.
        changed_rows: Rows that the elimination of a row may change, by row, in the order of elimination.
        one: The value of the number 1.
    """

    def __init__(
        self,
        builder: Builder,
        matrix: Mapping[tuple[int, int], int],
        changed_rows: Mapping[int, Sequence[int]],
        one: int,
    ) -> None:
        self._builder = builder
        self._changed_rows = changed_rows
        self._factors: dict[int, Column] = {}
        self._inverses: Column = {}
        a = dict(matrix)
        for k, changed in changed_rows.items():
            row = {i: a[_pair(k, i)] for i in changed if _pair(k, i) in a}
            self._inverses[k] = inverse = builder.divide(one, a[k, k])
            self._factors[k] = {i: builder.multiply(value, inverse) for i, value in row.items()}
            for i, factor in self._factors[k].items():
                for j, entry in row.items():
                    if j <= i:
                        a[i, j] = self._subtract(a.get((i, j)), builder.multiply(factor, entry))

    @property
    def carriers(self) -> dict[int, tuple[int, ...]]:
        """Rows that the elimination of each row changes, where their factor is not zero by structure."""
        return {k: tuple(factors) for k, factors in self._factors.items()}

    def values_of(self, solution: ColumnSolution, right: Mapping[int, Column], zero: int) -> tuple[int, ...]:
        """Return the values that loops need to solve [A]{z} + {b} = {0} for many columns.

        Args:
            solution: The plan of the loops, with `carriers`.
            right: Elements of {b} that are not zero, by row, by column.
            zero: The value of the number 0.
        """
        factors = [self._factors[k][i] for k, rows in enumerate(solution.carriers) for i in rows]
        inverses = [self._builder.negate(self._inverses[k]) for k in range(solution.rows)]
        given = [
            right[column].get(row, zero)
            for group in solution.groups
            for row in group.given
            for column in group.columns
        ]
        return (*factors, *inverses, *given)

    def solve(self, right: Column) -> Column:
        """Return the solution {z} for the right side {b}."""
        make, b = self._builder, dict(right)
        for k in self._changed_rows:
            if k in b:
                for i, factor in self._factors[k].items():
                    b[i] = self._subtract(b.get(i), make.multiply(factor, b[k]))
        found: Column = {}
        for k in reversed(list(self._changed_rows)):
            value = make.multiply(b[k], self._inverses[k]) if k in b else None
            for i, factor in self._factors[k].items():
                if i in found:
                    value = self._subtract(value, make.multiply(factor, found[i]))
            if value is not None:
                found[k] = value
        return found

    def _subtract(self, value: int | None, change: int) -> int:
        """Return `value` less `change`, where an absent value is zero."""
        return self._builder.negate(change) if value is None else self._builder.subtract(value, change)


def _pair(i: int, j: int) -> tuple[int, int]:
    """Return the key of entry (i, j) of a symmetric matrix, the larger row first."""
    return max(i, j), min(i, j)
