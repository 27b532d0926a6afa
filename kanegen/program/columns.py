"""The plan of a solution in loops: [A]{z} + {b} = {0} for many columns {b} with one elimination of [A].

As straight-line code such a solution has a statement for every pair of related rows and every column, which
for forty freedoms is a megabyte of code. The plan is what loops need instead: for columns whose elements are
zero in the same rows, the rows that are visited. So zeros that are known when the code is generated are not
computed, and code has a statement for every pair of related rows of a group of columns.

The factors are those of [A] = [L]^T [D] [L], from the outermost row inward. Where the columns of a group are
zero in all rows of a branch, the solution there is a linear function of that in rows further inward, whose
coefficients, the gains, serve all such columns. Columns of the solution with {b} = -{e}, where {e} is a
column of the unit matrix, are columns of [A]^-1. These are found row by row, outward: a row of [A]^-1 is a
sum of products of factors with rows further inward, and half of it is known by symmetry.

Some rows of the result may be mapped: each is its own element of {b} less products of its factors with
components, rows of [A] that are no rows of the result.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

WIDEST = 16
"""Lanes of the widest vectors of columns, those of floats: so many numbers may be read from an element of {b}
on."""

USUAL = 4
"""Lanes of a vector of columns, for the decision which groups to join."""

JOINED_ROWS = 2
"""Most rows in which a column is zero and is joined to columns that are not."""


@dataclass(frozen=True, slots=True)
class Gain:
    """How the solution in a row follows from that in rows further inward, where {b} is zero from there on.

    Attributes:
        row: The row.
        known: Rows inward of it in which {b} may differ from zero.
        carriers: Rows whose products with coefficients are subtracted.
    """

    row: int
    known: tuple[int, ...]
    carriers: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class ColumnGroup:
    """Columns that are solved together, because their elements are zero in the same rows.

    Attributes:
        columns: The columns, in increasing order.
        given: Rows of {b}, or of what is added to mapped rows, that are computed.
        reduced: Rows that may differ from zero on the way inward, in the order of elimination.
        solved: Rows of {z} that are computed, in the order outward.
        sums: For each of them the number of the sum, `ColumnSolution.sums`, that is subtracted from its row.
    """

    columns: tuple[int, ...]
    given: tuple[int, ...]
    reduced: tuple[int, ...]
    solved: tuple[int, ...]
    sums: tuple[int, ...]


@dataclass(frozen=True)
class ColumnSolution:
    """The plan of the solution of [A]{z} + {b} = {0} for many columns.

    The values that it needs are, in this order: the factors of each sum; -1 over the pivot of each row; the
    elements of {b}, group by group, of each group row by row; and zeros, that vectors may reach beyond.

    Attributes:
        order: The rows in the order of elimination; a mapped row comes before its components.
        carriers: For each row the rows that its elimination changes, in the order in which it changes them;
            for a mapped row the components that it maps.
        gains: Further sums.
        groups: Groups of columns.
        inverses: Rows of [A]^-1 and mapped rows, outward, of each tree of related rows; () for no columns of
            [A]^-1.
        mapped: The mapped rows.
        first_unit: Column of the solution for minus the unit column of row 0, if there are such columns.
    """

    order: tuple[int, ...]
    carriers: tuple[tuple[int, ...], ...]
    gains: tuple[Gain, ...]
    groups: tuple[ColumnGroup, ...]
    inverses: tuple[tuple[int, ...], ...] = ()
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

    @cached_property
    def sums(self) -> tuple[tuple[int, ...], ...]:
        """The rows of each sum of products: those of a row of [L], by row, then those of a gain."""
        return (*self.carriers, *(gain.carriers for gain in self.gains))

    @cached_property
    def first_factors(self) -> tuple[int, ...]:
        """The place of the first factor of each sum among all factors, and the number of factors."""
        places = [0]
        for carriers in self.sums:
            places.append(places[-1] + len(carriers))
        return tuple(places)

    @property
    def number_of_factors(self) -> int:
        """Number of factors of all sums."""
        return self.first_factors[-1]

    @property
    def number_of_values(self) -> int:
        """Number of values that the solution needs."""
        given = sum(len(group.given) * len(group.columns) for group in self.groups)
        return self.number_of_factors + self.rows + given + WIDEST - 1

    @property
    def terms(self) -> int:
        """Number of values that the text of the loops reads: factors, pivots and elements of {b}."""
        groups = sum(
            len(group.given)
            + sum(1 + len(self.carriers[row]) for row in group.reduced)
            + sum(len(self.sums[number]) for number in group.sums)
            for group in self.groups
        )
        return groups + sum(1 + 2 * len(self.carriers[row]) for tree in self.inverses for row in tree)

    def elements(self) -> set[tuple[int, int]]:
        """Return row and column of every element of the result that is computed."""
        found = {(row, column) for group in self.groups for column in group.columns for row in group.solved}
        for tree in self.inverses:
            found.update((i, self.first_unit + j) for i in tree for j in tree if j < self.stored)
        return {(row, column) for row, column in found if row < self.stored}

    @property
    def operations(self) -> dict[str, int]:
        """Operations of one evaluation by kind, as `count` has them."""
        add = multiply = 0
        for group in self.groups:
            width, products = len(group.columns), len(group.reduced)
            known = set(group.given)
            for k in group.reduced:
                add += width * sum(i in known for i in self.carriers[k])
                products += len(self.carriers[k])
                known.update(self.carriers[k])
            for row, one in zip(group.solved, group.sums, strict=True):
                terms = sum(i in known for i in self.sums[one])
                products += terms
                add += width * (terms - (row not in known))
                known.add(row)
            multiply += width * products
        for tree in self.inverses:
            for place, row in enumerate(tree):
                terms = len(self.carriers[row])
                multiply += terms * (place + 1)
                add += max(terms - 1, 0) * place + (terms if row not in self.mapped else max(terms - 1, 0))
        return {"add": add, "multiply": multiply}


def column_solution(
    carriers: Mapping[int, Sequence[int]],
    given: Mapping[int, Iterable[int]],
    first_unit: int | None = None,
    mapped: frozenset[int] = frozenset(),
) -> ColumnSolution:
    """Return the plan of a solution.

    Args:
        carriers: Rows that the elimination of each row changes, by row, in the order of elimination.
        given: Rows of {b} that differ from zero, by column; a column without any is left out.
        first_unit: Column of the solution for minus the unit column of row 0; None for no columns of [A]^-1.
        mapped: The mapped rows; the last rows, as many, are components.
    """
    order = tuple(carriers)
    lists = tuple(tuple(carriers[row]) for row in range(len(order)))
    rows_of = {column: frozenset(rows) for column, rows in given.items() if rows}
    inverses: list[tuple[int, ...]] = []
    for tree in _trees(order, lists) if first_unit is not None else ():
        if _is_dense(tree, lists):
            inverses.append(tree)
        else:
            of_result = [row for row in tree if row < len(order) - len(mapped)]
            rows_of |= {(first_unit or 0) + row: _unit_rows(row, lists, mapped) for row in of_result}
    by_rows: dict[_Support, list[int]] = {}
    for column in sorted(rows_of):
        reduced = _reduced(order, lists, rows_of[column] - mapped)
        by_rows.setdefault(_Support(reduced, rows_of[column] & mapped), []).append(column)
    sums = _Sums(order, lists)
    groups = []
    for support, columns in _joined(by_rows):
        rows = sorted(set().union(*(rows_of[column] for column in columns)))
        solved = sums.solved(support)
        groups.append(
            ColumnGroup(tuple(columns), tuple(rows), support.reduced, tuple(solved), tuple(solved.values()))
        )
    return ColumnSolution(
        order, lists, tuple(sums.gains), tuple(groups), tuple(inverses), mapped, first_unit or 0
    )


def _unit_rows(row: int, carriers: Sequence[Sequence[int]], mapped: frozenset[int]) -> frozenset[int]:
    """Return where {b} differs from zero for the column of [A]^-1, or of mapped rows, of a row of the result.

    For a mapped row, {b} holds its factors in the rows of the components, since what maps components to a row
    also maps a load on it to loads on the components.
    """
    return frozenset(carriers[row]) if row in mapped else frozenset({row})


@dataclass(frozen=True)
class _Support:
    """Where a column may differ from zero.

    Attributes:
        reduced: Rows that may on the way inward, in the order of elimination.
        added: Mapped rows to which something is added.
    """

    reduced: tuple[int, ...]
    added: frozenset[int]

    @property
    def rows(self) -> frozenset[int]:
        """The rows in which the column may differ from zero."""
        return self.added.union(self.reduced)


class _Sums:
    """The sums of products by which rows of a solution follow from rows further inward.

    Args:
        order: The rows in the order of elimination.
        carriers: For each row the rows that its elimination changes.
    """

    def __init__(self, order: Sequence[int], carriers: Sequence[Sequence[int]]) -> None:
        self._order, self._carriers = order, carriers
        self._inward: dict[int, frozenset[int]] = {}
        for row in reversed(order):
            self._inward[row] = frozenset(carriers[row]).union(*(self._inward[i] for i in carriers[row]))
        self._numbers: dict[tuple[int, tuple[int, ...]], int] = {}
        self.gains: list[Gain] = []

    def solved(self, support: _Support) -> dict[int, int]:
        """Return the rows of the solution that may differ from zero, outward, and the number of their sum."""
        found: dict[int, int] = {}
        for row in reversed(self._order):
            if row in support.rows:
                found[row] = row
            elif known := self._inward[row] & support.rows:
                found[row] = self._gain(row, tuple(sorted(known)))
        return found

    def _gain(self, row: int, known: tuple[int, ...]) -> int:
        """Return the number of the sum of a row that is zero by itself, as all others inward but `known`."""
        carriers = self._carriers[row]
        if all(i in known for i in carriers):
            return row
        if (row, known) not in self._numbers:
            self._numbers[row, known] = len(self._order) + len(self.gains)
            self.gains.append(Gain(row, known, tuple(self._gain_rows(row, known))))
        return self._numbers[row, known]

    def _gain_rows(self, row: int, known: Iterable[int]) -> dict[int, None]:
        """Return the rows whose products a gain sums, in the order in which they enter it."""
        inward = self._inward[row].intersection(known)
        found = dict.fromkeys(i for i in self._carriers[row] if i in inward)
        for between in self._carriers[row]:
            if between not in inward:
                found |= self._gain_rows(between, inward)
        return found


def _reduced(
    order: Sequence[int], carriers: Sequence[Sequence[int]], given: Iterable[int]
) -> tuple[int, ...]:
    """Return the rows that differ from zero on the way inward, in the order of elimination."""
    found = set(given)
    for row in order:
        if row in found:
            found.update(carriers[row])
    return tuple(row for row in order if row in found)


def _joined(by_rows: Mapping[_Support, Sequence[int]]) -> list[tuple[_Support, list[int]]]:
    """Return the groups of columns, small ones joined to others that differ from zero in little more.

    A column is joined where it finds room in a vector that would not be full without it.
    """
    found = [(support, list(columns)) for support, columns in by_rows.items()]
    for support, columns in sorted(found, key=lambda one: (len(one[1]), one[0].reduced)):
        for other, taken in found:
            further = other.rows - support.rows
            has_room = -len(taken) % USUAL >= len(columns)
            if taken and further and support.rows < other.rows and len(further) <= JOINED_ROWS and has_room:
                taken.extend(columns)
                columns.clear()
                break
    return [(support, sorted(columns)) for support, columns in found if columns]


def _trees(order: Sequence[int], carriers: Sequence[Sequence[int]]) -> list[tuple[int, ...]]:
    """Return the trees of rows that are related, each outward."""
    trees: list[list[int]] = []
    for row in reversed(order):
        related = [tree for tree in trees if not set(tree).isdisjoint(carriers[row])]
        trees = [tree for tree in trees if tree not in related]
        trees.append([*(one for tree in related for one in tree), row])
    places = {row: place for place, row in enumerate(reversed(order))}
    return [tuple(sorted(tree, key=places.__getitem__)) for tree in trees]


def _is_dense(tree: Sequence[int], carriers: Sequence[Sequence[int]]) -> bool:
    """Return whether no element of [A]^-1 in the rows of a tree, outward, is zero by structure."""
    known: dict[int, set[int]] = {}
    for place, row in enumerate(tree):
        known[row] = {row}.union(*(known[i] for i in carriers[row]))
        if len(known[row]) <= place:
            return False
        for other in tree[:place]:
            known[other].add(row)
    return True
