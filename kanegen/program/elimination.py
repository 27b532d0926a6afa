"""The solution of [A]{z} = {b} for many right sides as instructions, by the factors of [A] = [L]^T [D] [L].

The factors are those of `recursion.symmetric_factors`. Entries that are zero by structure are left out.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from kanegen.program.builder import Builder
from kanegen.program.columns import WIDEST, ColumnSolution

Column = dict[int, int]
"""Numbers of the values of a column by row; rows with a zero are absent."""


class Elimination:
    """The factors [L] and [D] of a symmetric positive definite matrix.

    Where a right side is zero in all rows of a branch, the solution there is a linear function of that in the
    rows further inward, whose coefficients serve all such right sides.

    Args:
        builder: The builder to which instructions are appended.
        factors: Entries of [L] left of its diagonal that are not zero, by row, in the order of elimination.
        inverses: Reciprocals of the entries of [D] by row.
    """

    def __init__(self, builder: Builder, factors: Mapping[int, Column], inverses: Column) -> None:
        self._builder, self._factors, self._inverses = builder, factors, inverses
        self._inward: dict[int, set[int]] = {}
        for k, row in reversed(list(factors.items())):
            self._inward[k] = set(row).union(*(self._inward[i] for i in row))
        self._gains: dict[tuple[int, tuple[int, ...]], Column] = {}

    @classmethod
    def of_matrix(
        cls,
        builder: Builder,
        matrix: Mapping[tuple[int, int], int],
        changed_rows: Mapping[int, Sequence[int]],
        one: int,
    ) -> Elimination:
        """Return the elimination of a matrix.

        Args:
            builder: The builder to which instructions are appended.
            matrix: Entries that are not zero, by pair of rows, the larger first.
            changed_rows: Rows that the elimination of a row may change, by row, in the order of elimination.
            one: The value of the number 1.
        """
        every: dict[int, Column] = {}
        inverses: Column = {}
        a = dict(matrix)
        for k, changed in changed_rows.items():
            row = {i: a[_pair(k, i)] for i in changed if _pair(k, i) in a}
            inverses[k] = inverse = builder.divide(one, a[k, k])
            every[k] = {i: builder.multiply(value, inverse) for i, value in row.items()}
            for i, factor in every[k].items():
                for j, entry in row.items():
                    if j <= i:
                        change = builder.multiply(factor, entry)
                        a[i, j] = builder.subtract(a[i, j], change) if (i, j) in a else builder.negate(change)
        return cls(builder, every, inverses)

    def relabelled(self, places: Mapping[int, int]) -> Elimination:
        """Return the same elimination with other numbers for some rows."""
        factors = {
            places.get(k, k): {places.get(i, i): factor for i, factor in row.items()}
            for k, row in self._factors.items()
        }
        inverses = {places.get(k, k): inverse for k, inverse in self._inverses.items()}
        return Elimination(self._builder, factors, inverses)

    def with_map(self, row: int, components: Column) -> Elimination:
        """Return the elimination with a further row of the result, for the plan of a solution in loops.

        Args:
            row: Its number.
            components: Factors of the rows whose sum it is.
        """
        rows: dict[int, Column] = {}
        own = {i: self._builder.negate(factor) for i, factor in components.items()}
        for k, factors in self._factors.items():
            if k in components and row not in rows:
                rows[row] = own
            rows[k] = factors
        # No right side is divided by its pivot.
        return Elimination(self._builder, rows, {**self._inverses, row: next(iter(self._inverses.values()))})

    @property
    def carriers(self) -> dict[int, tuple[int, ...]]:
        """Rows that the elimination of each row changes, where their factor is not zero by structure."""
        return {k: tuple(factors) for k, factors in self._factors.items()}

    def values_of(self, solution: ColumnSolution, right: Mapping[int, Column], zero: int) -> tuple[int, ...]:
        """Return the values that loops need to solve [A]{z} + {b} = {0} for many columns.

        Args:
            solution: The plan of the loops, with `carriers`.
            right: Elements of {b} that are not zero, by row, by column; columns of the plan that are not
                among them are minus unit columns.
            zero: The value of the number 0.
        """
        factors = [self._factors[k][i] for k, rows in enumerate(solution.carriers) for i in rows]
        for gain in solution.gains:
            coefficients = self._gain(gain.row, gain.known)
            factors += [coefficients[i] for i in gain.carriers]
        inverses = [self._builder.negate(self._inverses[k]) for k in range(solution.rows)]
        unit_columns = {
            column: self._unit_column(column - solution.first_unit, solution)
            for group in solution.groups
            for column in group.columns
            if column not in right
        }
        given = [
            (right.get(column) or unit_columns[column]).get(row, zero)
            for group in solution.groups
            for row in group.given
            for column in group.columns
        ]
        return (*factors, *inverses, *given, *[zero] * (WIDEST - 1))

    def _unit_column(self, row: int, solution: ColumnSolution) -> Column:
        """Return {b} for the column of [A]^-1, or of mapped rows, that belongs to a row of the result."""
        if row in solution.mapped:
            return self._factors[row]
        return {row: self._builder.constant(-1.0)}

    def solve(self, right: Column) -> Column:
        """Return the solution {z} for the right side {b}."""
        make, b = self._builder, dict(right)
        for k, factors in self._factors.items():
            if k in b:
                for i, factor in factors.items():
                    b[i] = self._subtract(b.get(i), make.multiply(factor, b[k]))
        found: Column = {}
        for k, factors in reversed(list(self._factors.items())):
            own = make.multiply(b[k], self._inverses[k]) if k in b else None
            value = self._less_products(own, factors if k in b else self._gain(k, b.keys()), found)
            if value is not None:
                found[k] = value
        return found

    def _gain(self, k: int, known: Collection[int]) -> Column:
        """Return how the solution in a row depends on that in rows further inward, with its sign changed.

        Args:
            k: The row.
            known: Rows; the right side is zero in the row and in all others further inward.
        """
        inward = self._inward[k].intersection(known)
        key = k, tuple(sorted(inward))
        if key not in self._gains:
            make, factors = self._builder, self._factors[k]
            gain = {i: factor for i, factor in factors.items() if i in inward}
            for between in (i for i in factors if i not in inward):
                for i, value in self._gain(between, inward).items():
                    gain[i] = self._subtract(gain.get(i), make.multiply(factors[between], value))
            self._gains[key] = gain
        return self._gains[key]

    def _less_products(self, value: int | None, factors: Column, found: Column) -> int | None:
        """Return a value less the products of factors and a column, row by row; None stands for zero."""
        for i, factor in factors.items():
            if i in found:
                value = self._subtract(value, self._builder.multiply(factor, found[i]))
        return value

    def _subtract(self, value: int | None, change: int) -> int:
        """Return `value` less `change`, where an absent value is zero."""
        return self._builder.negate(change) if value is None else self._builder.subtract(value, change)


def _pair(i: int, j: int) -> tuple[int, int]:
    """Return the key of entry (i, j) of a symmetric matrix, the larger row first."""
    return max(i, j), min(i, j)
