"""The inverse of [A], entry by entry; both halves hold the same values.

Entry (i, j) is the product of two unit generalized forces with [A]^-1: a sum over the freedoms that carry
both, see `reduced`. So an entry costs as much as the two have in common, however many freedoms there are, and
the diagonal is a sum of positive terms.

Entries can also follow from the factors of [A], each from entries further inward; see
`symmetric_factors.inverse_from_factors`. That costs the same for chains, and less for those with parallel
axes, where entries of [L] are equal; trees with long branches on a short trunk cost more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kanegen.recursion.solver import Solver
from kanegen.recursion.symmetric_factors import Entries


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


def products_cost_less(carriers: Mapping[int, Sequence[int]]) -> bool:
    """Return whether `products` takes fewer operations than `symmetric_factors.inverse_from_factors`.

    Args:
        carriers: For each freedom, in the order of elimination, the freedoms that its elimination changes.
    """
    paths = {k: {k, *inward} for k, inward in carriers.items()}
    order = list(carriers)[::-1]
    by_products = by_factors = 0
    for number, k in enumerate(order):
        inward = len(carriers[k])
        by_products += inward**2  # the unit force, eliminated, and over the pivots
        for j in (*order[:number], k):
            common = len(paths[k] & paths[j])
            by_products += max(2 * common - 1 - (j in paths[k]), 0)
            by_factors += max(2 * inward - (j != k), 0) if common else 0
    return by_products < by_factors
