"""The plan of a solution in loops: [A]{z} + {b} = {0} for many columns {b} with one elimination of [A].

As straight-line code such a solution has a statement for every pair of related rows and every column, which
for forty freedoms is a megabyte of code. The plan is what loops need instead: for each row the rows that its
elimination changes, and for columns whose elements are zero in the same rows, the rows that are visited. So
zeros that are known when the code is generated are not computed.

The factors are those of [A] = [L]^T [D] [L], from the outermost row inward. Columns of the solution with
{b} = -{e}, where {e} is a column of the unit matrix, are columns of [A]^-1; of these, one of two elements
that symmetry makes equal is computed, and the other is copied.

Some rows of the result may be mapped: each is its own element of {b} less products of its factors with
components, rows of [A] that are no rows of the result.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

LANES = 2
"""Columns in a vector, for the decision which groups to join: those of the narrowest vectors of doubles."""

VECTORS = 4
"""Most vectors of columns that are computed at once, so that one sum need not wait for another."""

LATENCY = 2.5
"""Vectors of columns below which a step takes no less time, because each sum waits for the one before it."""


@dataclass(frozen=True, slots=True)
class ColumnGroup:
    """Columns that are solved together, because their elements are zero in the same rows.

    Attributes:
        columns: The columns, in increasing order.
        given: Rows of {b}, or of what is added to mapped rows, that are computed; () for columns of [A]^-1,
            where {b} is minus a unit column.
        reduced: Rows that may differ from zero on the way inward, in the order of elimination.
        solved: Rows of {z} that are computed, in the order outward.
    """

    columns: tuple[int, ...]
    given: tuple[int, ...]
    reduced: tuple[int, ...]
    solved: tuple[int, ...]

    @property
    def is_of_inverse(self) -> bool:
        """Whether the solutions are columns of [A]^-1."""
        return not self.given


@dataclass(frozen=True)
class ColumnSolution:
    """The plan of the solution of [A]{z} + {b} = {0} for many columns.

    The values that it needs are, in this order: the factors, row by row; -1 over the pivot of each row; and
    the elements of {b}, group by group, of each group row by row.

    Attributes:
        order: The rows in the order of elimination; a mapped row comes before its components.
        carriers: For each row the rows that its elimination changes, in the order in which it changes them;
            for a mapped row the components that it maps.
        groups: Groups of columns; all elements of columns in no group, and of rows that are not solved, are 0
            unless they are mirrored.
        mapped: The mapped rows.
        first_unit: Column of the solution for minus the unit column of row 0, if there are such columns.
    """

    order: tuple[int, ...]
    carriers: tuple[tuple[int, ...], ...]
    groups: tuple[ColumnGroup, ...]
    mapped: frozenset[int] = frozenset()
    first_unit: int = 0

    @property
    def rows(self) -> int:
        """Number of rows, with those that are components and no rows of the result."""
        return len(self.carriers)

    @property
    def stored(self) -> int:
        """Number of rows of the result; those behind them are components."""
        return self.rows - len(self.mapped)

    @property
    def outward(self) -> tuple[int, ...]:
        """The rows with unit columns, outward: all of the result but mapped ones."""
        return tuple(row for row in reversed(self.order) if row < self.stored and row not in self.mapped)

    @property
    def number_of_factors(self) -> int:
        """Number of elements of [L] below the diagonal that differ from zero."""
        return sum(map(len, self.carriers))

    @property
    def number_of_values(self) -> int:
        """Number of values that the solution needs."""
        given = sum(len(group.given) * len(group.columns) for group in self.groups)
        return self.number_of_factors + self.rows + given

    @property
    def table_entries(self) -> int:
        """Number of entries of the tables of rows and columns that stand in the code."""
        lists = ((*g.columns, *g.given, *g.reduced, *g.solved) for g in self.groups)
        lengths = sum(4 + len(one) for one in lists)
        return self.number_of_factors + 3 * self.rows + lengths + len(self.mirrored)

    @cached_property
    def mirrored(self) -> tuple[tuple[int, int], ...]:
        """Rows (i, j) of [A]^-1: element (i, j) is copied from (j, i), which is computed."""
        outward = self.outward
        computed = [(group.columns, frozenset(group.solved)) for group in self.groups if group.is_of_inverse]
        solved = {column - self.first_unit: rows for columns, rows in computed for column in columns}
        found = []
        for place, i in enumerate(outward):
            found += (
                [(i, j) for j in outward[:place] if i not in solved[j] and j in solved[i]] if solved else []
            )
        return tuple(found)

    @property
    def products(self) -> int:
        """Number of multiplications of one evaluation."""
        return self._sums + sum(len(group.columns) * len(group.reduced) for group in self.groups)

    @property
    def _sums(self) -> int:
        return sum(
            len(group.columns) * sum(len(self.carriers[k]) for k in (*group.reduced, *group.solved))
            for group in self.groups
        )

    @property
    def operations(self) -> dict[str, int]:
        """Operations of one evaluation by kind, as `count` has them: what the loops execute for a column."""
        return {"add": self._sums, "multiply": self.products}


def column_solution(
    carriers: Mapping[int, Sequence[int]],
    given: Mapping[int, Iterable[int]],
    unit_columns: slice = slice(0, 0),
    mapped: frozenset[int] = frozenset(),
) -> ColumnSolution:
    """Return the plan of a solution.

    Args:
        carriers: Rows that the elimination of each row changes, by row, in the order of elimination.
        given: Rows of {b} that differ from zero, by column; a column without any is left out.
        unit_columns: Columns of [A]^-1, as many as rows of the result; () for none. Those of mapped rows are
            among `given`.
        mapped: The mapped rows; the last rows, as many, are components.
    """
    order = tuple(carriers)
    lists = tuple(tuple(carriers[row]) for row in range(len(order)))
    by_rows: dict[tuple[tuple[int, ...], tuple[int, ...]], list[int]] = {}
    for column in sorted(given):
        reduced = _reduced(order, lists, [row for row in given[column] if row not in mapped])
        added = tuple(row for row in sorted(given[column]) if row in mapped)
        if reduced or added:
            by_rows.setdefault((reduced, added), []).append(column)
    groups = []
    for (reduced, added), columns in by_rows.items():
        rows = tuple(sorted({row for column in columns for row in given[column]}))
        solved = _solved(order, lists, (*reduced, *added))
        groups.append(ColumnGroup(tuple(columns), rows, reduced, solved))
    units = []
    with_units = [row for row in order if row < len(order) - len(mapped) and row not in mapped]
    for row in with_units if unit_columns.stop > unit_columns.start else ():
        reduced = _reduced(order, lists, [row])
        needed = _solved(order, lists, reduced)
        wanted = _with_inward(lists, (*needed[: needed.index(row) + 1], *mapped.intersection(needed)))
        solved = tuple(one for one in needed if one in wanted)
        units.append(ColumnGroup((unit_columns.start + row,), (), reduced, solved))
    joined = (*_joined(groups, order, lists), *_joined(units, order, lists))
    return ColumnSolution(order, lists, joined, mapped, unit_columns.start)


def _reduced(
    order: Sequence[int], carriers: Sequence[Sequence[int]], given: Iterable[int]
) -> tuple[int, ...]:
    """Return the rows that differ from zero on the way inward, in the order of elimination."""
    found = set(given)
    for row in order:
        if row in found:
            found.update(carriers[row])
    return tuple(row for row in order if row in found)


def _solved(
    order: Sequence[int], carriers: Sequence[Sequence[int]], reduced: Sequence[int]
) -> tuple[int, ...]:
    """Return the rows of the solution that differ from zero, in the order outward.

    Args:
        order: The rows in the order of elimination.
        carriers: For each row the rows that its elimination changes.
        reduced: Rows that differ from zero on the way inward, and mapped rows to which something is added.
    """
    found: dict[int, None] = {}
    given = frozenset(reduced)
    for row in reversed(order):
        if row in given or any(other in found for other in carriers[row]):
            found[row] = None
    return tuple(found)


def _with_inward(carriers: Sequence[Sequence[int]], rows: Iterable[int]) -> set[int]:
    """Return rows of a solution with all further inward from which they are computed."""
    found: set[int] = set()
    left = list(rows)
    while left:
        row = left.pop()
        if row not in found:
            found.add(row)
            left += carriers[row]
    return found


def _joined(
    groups: Iterable[ColumnGroup], order: Sequence[int], carriers: Sequence[Sequence[int]]
) -> list[ColumnGroup]:
    """Return groups of which neighbours are joined, as long as the loops become faster.

    Neighbours have their outermost rows next to each other in the order of elimination.

    Args:
        groups: The groups.
        order: The rows in the order of elimination.
        carriers: For each row the rows that its elimination changes.
    """
    places = {row: place for place, row in enumerate(order)}
    found = sorted(
        groups, key=lambda group: (places[(group.reduced or group.solved)[0]], -len(group.reduced))
    )

    def time(group: ColumnGroup) -> float:
        steps = sum(1 + len(carriers[row]) for row in (*group.reduced, *group.solved))
        full, rest = divmod(-(-len(group.columns) // LANES), VECTORS)
        return steps * (full * VECTORS + (max(rest, LATENCY) if rest else 0.0))

    def gained(one: ColumnGroup, other: ColumnGroup) -> float:
        return time(one) + time(other) - time(_union(one, other, places))

    gains = [gained(*pair) for pair in pairwise(found)]
    while gains and max(gains) > 0.0:
        k = gains.index(max(gains))
        found[k : k + 2] = [_union(found[k], found[k + 1], places)]
        first, last = max(k - 1, 0), min(k + 2, len(found))
        gains[first : k + 2] = [gained(*pair) for pair in pairwise(found[first:last])]
    return found


def _union(one: ColumnGroup, other: ColumnGroup, places: Mapping[int, int]) -> ColumnGroup:
    """Return the group of the columns of two groups; `places` are those of rows in the elimination."""
    return ColumnGroup(
        tuple(sorted((*one.columns, *other.columns))),
        tuple(sorted({*one.given, *other.given})),
        tuple(sorted({*one.reduced, *other.reduced}, key=places.__getitem__)),
        tuple(sorted({*one.solved, *other.solved}, key=places.__getitem__, reverse=True)),
    )
