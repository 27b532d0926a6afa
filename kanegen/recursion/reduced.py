"""Right sides {b} of [A]{ydot} = {b} after the inward half of a solution, and products with [A]^-1.

With [A] = [L]^T [D] [L], the elimination of every freedom from the outermost inward makes {e} = [L]^-T {b} of
a right side, and

    {a}^T [A]^-1 {b} = sum over freedoms k of e_k(a) e_k(b) / D_k.

So a product with [A]^-1 needs no outward half. At a freedom on which a right side does not act, and that
carries nothing on which it acts, its entry of {e} is zero: two right sides share only the freedoms that carry
both. For {a} = {b} the terms are not negative, and nothing cancels. Both solvers eliminate in this way,
articulated bodies in components of accelerations instead of {ydot}: their elimination is the same
factorisation of a congruent matrix.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sympy import Add, Expr


@dataclass(frozen=True)
class Reduced:
    """A right side after the elimination of every freedom.

    Attributes:
        remainders: The entries of {e} by place of the eliminated freedom in {y}.
        over_pivots: The same over the pivots of the freedoms.
    """

    remainders: Mapping[int, Expr]
    over_pivots: Mapping[int, Expr]

    @property
    def extent(self) -> int:
        """Number of freedoms at which something of the right side is left."""
        return sum(value != 0 for value in self.remainders.values())

    def product(self, other: Reduced) -> Expr:
        """Return {a}^T [A]^-1 {b} of this right side {a} and another one {b}."""
        return Add(*(value * other.over_pivots[place] for place, value in self.remainders.items()))
