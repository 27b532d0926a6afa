"""The inverse of [A], entry by entry; both halves hold the same values.

Entry (i, j) is the product of two unit generalized forces with [A]^-1: a sum over the freedoms that carry
both, see `reduced`. So an entry costs as much as the two have in common, however many freedoms there are, and
the diagonal is a sum of positive terms.

For a chain without branches `symmetric_factors.inverse_of_chain` gives the same entries at no greater cost.
"""

from __future__ import annotations

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
