"""Margins of unrefined solutions: by freedom, positive where its pivot keeps enough of its digits.

A pivot is what remains of sums that cancel, and has the rounding errors of their terms. An error of a pivot
is an error of the solution. The loss of a pivot measures it in roundoffs: the bound of the inertias that the
freedom carries, over the pivot. The generator looks for the largest losses that a model can have and decides
whether the solver is accurate there; the generated code says where a loss is larger still. Where constants of
the model exclude this, nothing is left to test. See `pivot_bounds`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from sympy import Expr, Rational, S

from kanegen.recursion.pivot_bounds import PivotBounds
from kanegen.recursion.tree import Tree


@dataclass(frozen=True)
class PivotLimits:
    """The losses of pivots beyond which results are reported as inaccurate.

    Attributes:
        losses: Largest loss by freedom; empty if losses are not tested.
        bounded: By freedom whether no state has a larger loss while parameters stay near their defaults.
    """

    losses: tuple[float, ...] = ()
    bounded: tuple[bool, ...] = ()


NO_LIMITS = PivotLimits()


class Pivots(Protocol):
    """What margins need of a solver of [A]{ydot} = {b}."""

    @property
    def tree(self) -> Tree:
        """The tree whose [A] is eliminated."""

    @property
    def pivots(self) -> Sequence[Expr]:
        """The divisor of the elimination of each freedom."""

    @property
    def together(self) -> bool:
        """Whether three free angles or translations of a joint are eliminated as components."""


class PivotMargins:
    """Losses and margins of the pivots of a solver.

    Args:
        solver: The solver.
    """

    def __init__(self, solver: Pivots) -> None:
        self._solver = solver
        self._bounds = PivotBounds(solver.tree, together=solver.together)

    def losses(self) -> list[Expr]:
        """Return the losses by freedom, each the bound of its carried inertias over its pivot."""
        return [self._bounds.carried(i) / pivot for i, pivot in enumerate(self._solver.pivots)]

    def largest_losses(self) -> list[Expr]:
        """Return bounds of the losses by freedom that hold in every state; zero where there is none."""
        return [self._largest_loss(i) for i in range(len(self._solver.pivots))]

    def _largest_loss(self, freedom: int) -> Expr:
        """Return a bound of the loss of a freedom that holds in every state, or zero."""
        bounds = self._bounds
        if bounds.loses_nothing(freedom):
            return S.One
        return (
            bounds.constant(freedom) / bounds.least(freedom) if bounds.has_largest_loss(freedom) else S.Zero
        )

    def margins(self, limits: PivotLimits) -> list[Expr]:
        """Return the margins by freedom; none if losses are not tested.

        The margin of a freedom whose loss is bounded is that of the lower bound of its pivot, which depends
        on parameters at most; else it is that of the pivot.
        """
        self._solver.tree.definitions.about("margins of the pivots")
        pairs = zip(limits.losses, limits.bounded, strict=True)
        return [
            self._margin(i, Rational(1) / Rational(limit), is_bounded)
            for i, (limit, is_bounded) in enumerate(pairs)
        ]

    def _margin(self, freedom: int, share: Rational, is_bounded: bool) -> Expr:
        """Return the margin of a freedom: what its pivot exceeds a share of its carried inertias by."""
        bounds = self._bounds
        if bounds.loses_nothing(freedom):
            return S.One
        margin = self._solver.pivots[freedom] - bounds.carried(freedom, share)
        if is_bounded:
            margin = bounds.least(freedom) - bounds.constant(freedom, share)
        return self._solver.tree.definitions.define(f"Dm_{freedom}", margin)
