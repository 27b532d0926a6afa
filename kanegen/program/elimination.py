"""[A]{z} = {b} for many right sides, as instructions: [A] = [L]^T [D] [L] without fill.

The same elimination as `recursion.factorisation`, on values of a program; what is the constant 0 stays out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kanegen.program.builder import Builder

Column = dict[int, int]
"""By row the number of a value; none where it is zero."""


class Elimination:
    """[L] and [D] of a symmetric positive definite matrix.

    Args:
        builder: Takes the instructions.
        matrix: By pair of rows, the larger first, its entries that are not zero.
        carriers: Row by row in the order of elimination, the rows that its elimination may change.
        one: The number 1.
    """

    def __init__(
        self,
        builder: Builder,
        matrix: Mapping[tuple[int, int], int],
        carriers: Mapping[int, Sequence[int]],
        one: int,
    ) -> None:
        self._builder = builder
        self._carriers = carriers
        self._factors: dict[int, Column] = {}
        self._inverses: Column = {}
        a = dict(matrix)
        for k, carrying in carriers.items():
            row = {i: a[_pair(k, i)] for i in carrying if _pair(k, i) in a}
            self._inverses[k] = inverse = builder.divide(one, a[k, k])
            self._factors[k] = {i: builder.multiply(value, inverse) for i, value in row.items()}
            for i, factor in self._factors[k].items():
                for j, entry in row.items():
                    if j <= i:
                        a[i, j] = self._less(a.get((i, j)), builder.multiply(factor, entry))

    def solve(self, right: Column) -> Column:
        """{z}, none where it is zero."""
        make, b = self._builder, dict(right)
        for k in self._carriers:
            if k in b:
                for i, factor in self._factors[k].items():
                    b[i] = self._less(b.get(i), make.multiply(factor, b[k]))
        found: Column = {}
        for k in reversed(list(self._carriers)):
            value = make.multiply(b[k], self._inverses[k]) if k in b else None
            for i, factor in self._factors[k].items():
                if i in found:
                    value = self._less(value, make.multiply(factor, found[i]))
            if value is not None:
                found[k] = value
        return found

    def _less(self, value: int | None, change: int) -> int:
        return self._builder.negate(change) if value is None else self._builder.subtract(value, change)


def _pair(i: int, j: int) -> tuple[int, int]:
    return max(i, j), min(i, j)
