"""What forward dynamics and products with [A]^-1 need of a solver of [A]{ydot} = {b}."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from sympy import Expr

from kanegen.recursion.attached import Attached
from kanegen.recursion.body_motion import Carried
from kanegen.recursion.inverse_dynamics import Requirement
from kanegen.recursion.reduced import Reduced
from kanegen.recursion.solved_motion import Paths
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import Wrench


class Solver(Protocol):
    """A factorised [A] that solves [A]{ydot} = {b} for several {b}.

    Attributes:
        tree: The tree.
        paths: Path through the joint of each body, with the free components that are solved for, by body.
        pivots: Divisor of the elimination of each freedom.
        together: Whether three free angles, or three free translations, of a joint are eliminated as
            components in the frame of the body.
        released: Freedoms behind which the bias starts from zero accelerations, as for `body_motions`.
    """

    tree: Tree
    paths: Paths
    pivots: Sequence[Expr]
    together: bool
    released: frozenset[int]

    @property
    def regular_if_positive(self) -> Sequence[Expr]:
        """Expressions by freedom, positive where [A] is regular: pivots, smaller near gimbal lock."""

    @property
    def diagonal(self) -> Sequence[Expr]:
        """Inertia of the composite body by freedom: the pivot with every other freedom locked."""

    def solve(self, bias: Requirement, name: str) -> list[Expr]:
        """Return the free components under {tau}, where `bias` is required at zero components."""

    def reduced(self, bias: Requirement) -> Reduced:
        """Return the right side under {tau}, where `bias` is required at zero components, eliminated."""

    def reduced_effort(self, place: int) -> Reduced:
        """Return a unit generalized force at a place in {y}, eliminated."""

    def reduced_loads(self, one: Attached) -> Sequence[Reduced]:
        """Return unit moments, then unit forces, at a point along the inertial axes, eliminated."""

    def reduced_wrenches(self, loads: Mapping[int, Wrench], mark: str) -> Reduced:
        """Return loads on bodies, about their origins and in their frames by number of the body, eliminated.

        Args:
            loads: The loads.
            mark: End of the names of intermediates.
        """

    def components(self, over_pivots: Mapping[int, Expr], name: str) -> list[Expr]:
        """Return the free components from an eliminated right side over the pivots, outward.

        Args:
            over_pivots: The right side by place in {y}: what each component is if all others are zero.
            name: Prefix of the names of the components.
        """

    def inverse(self) -> Mapping[tuple[int, int], Expr]:
        """Return the entries of [A]^-1 by row and column."""

    def speed_rates(
        self, components: Sequence[Expr], name: str, carried: Mapping[int, Carried]
    ) -> list[Expr]:
        """Return {ydot} from the free components, less the accelerations that the bias left out, by body."""
