"""The inverse of [A], entry by entry; both halves hold the same values.

Entry (i, j) is the product of two unit generalized forces with [A]^-1: a sum over the freedoms that carry
both, see `reduced`. So an entry costs as much as the two have in common, however many freedoms there are, and
the diagonal is a sum of positive terms.

In a chain without branches, entries can also follow from entries further inward: [L] [A]^-1 = [D]^-1 [L]^-T
holds with [A] = [L]^T [D] [L], and its right side is zero where the row is outward of the column. That costs
the same where all entries of [L] differ, and less where some are equal, as for parallel axes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sympy import Add, Expr

from kanegen.recursion.solver import Solver
from kanegen.symbolic.definitions import Definitions

Entries = dict[tuple[int, int], Expr]
"""Entries of a symmetric matrix by row and column."""


def products(solver: Solver) -> Entries:
    """Return the entries of [A]^-1 as products of unit generalized forces.

    Args:
        solver: The factorised [A].
    """
    definitions, places = solver.tree.definitions, range(len(solver.pivots))
    sides = []
    for place in places:
        definitions.about("one unit generalized force, eliminated")
        sides.append(solver.reduced_effort(place))
    definitions.about("[A]^-1")
    found: Entries = {}
    for i in places:
        for j in range(i + 1):
            inner, outer = sorted((sides[i], sides[j]), key=lambda side: side.extent)
            found[i, j] = found[j, i] = definitions.define(f"Ai_{i}_{j}", inner.product(outer))
    return found


def outward(
    factors: Mapping[tuple[int, int], Expr],
    inverses: Mapping[int, Expr],
    order: Sequence[int],
    definitions: Definitions,
) -> Entries:
    """Return the entries of [A]^-1 for a chain, each from entries further inward.

    Args:
        factors: Entries of [L] left of its diagonal.
        inverses: Entries of [D]^-1, by freedom.
        order: The freedoms from the innermost outward.
        definitions: Definitions that the intermediates are added to.
    """
    definitions.about("[A]^-1")
    found: Entries = {}
    for number, k in enumerate(order):
        row = {i: factors[k, i] for i in order[:number] if (k, i) in factors}
        for j in (*order[:number], k):
            carried = -Add(*(factor * found[i, j] for i, factor in row.items()))
            value = inverses[k] + carried if j == k else carried
            found[k, j] = found[j, k] = definitions.define(f"Ai_{max(k, j)}_{min(k, j)}", value)
    return found
