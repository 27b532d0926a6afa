"""The factors [L]^T [D] [L] of a symmetric matrix [A], with unit diagonal of [L], and its inverse from them.

The rows of [L]^T [D] [L] are eliminated in an order that the caller chooses, so that few entries are filled.
The inverse follows in the opposite order: [L] [A]^-1 = [D]^-1 [L]^-T, whose right side is zero where the row
was eliminated before the column. Both halves of an inverse hold the same values.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sympy import Add, Expr

from kanegen.symbolic.definitions import Definitions

Entries = dict[tuple[int, int], Expr]
"""Entries of a matrix by row and column."""


def factorised(
    a: Entries, carriers: Mapping[int, Sequence[int]], definitions: Definitions
) -> tuple[Entries, dict[int, Expr]]:
    """Return the entries of [L] left of its diagonal and those of [D], by row.

    Args:
        a: Entries of [A], which are replaced by what each elimination leaves.
        carriers: For each row, in the order of elimination, the rows that its elimination changes.
        definitions: Definitions that the intermediates are added to.
    """
    factors: Entries = {}
    pivots: dict[int, Expr] = {}
    for k, carrying in carriers.items():
        pivots[k] = definitions.define(f"D_{k}", a[k, k])
        inverse = definitions.define(f"D_{k}i", 1 / pivots[k])
        coupled = [i for i in carrying if a[k, i] != 0]
        row = {i: definitions.define(f"A_{k}_{i}_", a[k, i]) for i in coupled}
        for i in coupled:
            factors[k, i] = definitions.define(f"L_{k}_{i}", row[i] * inverse)
        for i in coupled:
            for j in coupled:
                a[i, j] = definitions.define(
                    f"A_{i}_{j}_{k}", a[i, j] - factors[k, max(i, j)] * row[min(i, j)]
                )
    return factors, pivots


def inverse_from_factors(
    factors: Mapping[tuple[int, int], Expr],
    inverses: Mapping[int, Expr],
    order: Sequence[int],
    definitions: Definitions,
) -> Entries:
    """Return the entries of [A]^-1, each from entries of rows that were eliminated later.

    Args:
        factors: Entries of [L] left of its diagonal.
        inverses: Entries of [D]^-1 by row.
        order: The rows from the last that was eliminated to the first.
        definitions: Definitions that the intermediates are added to.
    """
    found: Entries = {}
    for number, k in enumerate(order):
        row = {i: factors[k, i] for i in order[:number] if (k, i) in factors}
        for j in (*order[:number], k):
            carried = -Add(*(factor * found[i, j] for i, factor in row.items()))
            value = inverses[k] + carried if j == k else carried
            found[k, j] = found[j, k] = definitions.define(f"Ai_{max(k, j)}_{min(k, j)}", value)
    return found
