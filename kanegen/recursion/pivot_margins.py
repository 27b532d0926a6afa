"""Margins of unrefined solutions: by freedom, positive where its pivot keeps enough of its digits.

A pivot is what remains of sums that cancel, and has the rounding errors of their terms. An error of a pivot
is an error of the solution. The loss of a pivot measures it in roundoffs: the bound of the inertias that the
freedom carries, `CompositeInertias`, over the pivot. The generator looks for the largest losses that a model
can have and decides whether the solver is accurate there; the generated code says where a loss is larger
still. Where constants of the model exclude this, nothing is left to test.
"""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Expr, Rational, S

from kanegen.recursion.pivot_bounds import CompositeInertias, least_pivots
from kanegen.recursion.solver import Solver


class PivotMargins:
    """Losses and margins of the pivots of a solver.

    Args:
        solver: The solver.
    """

    def __init__(self, solver: Solver) -> None:
        self._solver = solver
        self._carried = CompositeInertias(solver.tree, together=solver.together)
        self._least = least_pivots(solver.tree, together=solver.together)

    def losses(self) -> list[Expr]:
        """Return the losses by freedom, each the bound of its carried inertias over its pivot."""
        return [self._carried.bound(i) / pivot for i, pivot in enumerate(self._solver.pivots)]

    def largest_losses(self) -> list[Expr]:
        """Return bounds of the losses by freedom that hold in every state; zero where there is none."""
        return [
            self._carried.bound(i) / least if least != 0 and not self._carried.depends_on_state(i) else S.Zero
            for i, least in enumerate(self._least)
        ]

    def margins(self, limits: Sequence[float], bounded: Sequence[bool]) -> list[Expr]:
        """Return the margins by freedom.

        Args:
            limits: Largest loss by freedom.
            bounded: By freedom whether the margin is that of the lower bound of its pivot, which depends on
                parameters at most, or that of the pivot.
        """
        define = self._solver.tree.definitions.define
        self._solver.tree.definitions.about("margins of the pivots")
        pairs = zip(limits, bounded, strict=True)
        return [
            define(
                f"Dm_{i}",
                (self._least[i] if is_bounded else self._solver.pivots[i])
                - self._carried.bound(i, Rational(1) / Rational(limit)),
            )
            for i, (limit, is_bounded) in enumerate(pairs)
        ]
