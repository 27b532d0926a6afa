"""The part with the derivatives of {ydot} by articulated bodies, and where they exist and are accurate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.model.coordinates import Coordinate
from kanegen.recursion.articulated_bodies import ArticulatedBodies
from kanegen.recursion.articulated_derivatives import ArticulatedDerivatives
from kanegen.recursion.body_motion import BodyMotion
from kanegen.recursion.inverse_dynamics import Requirement
from kanegen.recursion.pivot_margins import PivotMargins
from kanegen.recursion.refinement import Refinement, unless_positive
from kanegen.recursion.tree import Derived


@dataclass(frozen=True)
class ArticulatedRows:
    """The rows, each with a number for every freedom, that make up the part "forward_dynamics_by_state".

    Attributes:
        freedoms: Number of freedoms n, which is that of the coordinates.
    """

    freedoms: int

    @property
    def slices(self) -> dict[str, slice]:
        """The rows by name.

        They are the derivatives of {ydot} by {x}, then by {y}, where efforts stay as they are; [A]^-1; and
        {tau} with the efforts of force elements, which depend on the state.
        """
        n = self.freedoms
        return {
            "by_coordinate": slice(0, n),
            "by_speed": slice(n, 2 * n),
            "inverse": slice(2 * n, 3 * n),
            "efforts": slice(3 * n, self.count),
        }

    @property
    def count(self) -> int:
        """Number of rows of the part."""
        return 3 * self.freedoms + 1


def articulated_rows(
    solver: ArticulatedBodies, motions: Mapping[int, BodyMotion], bias: Requirement, refinement: Refinement
) -> Derived:
    """Derive the rows of `ArticulatedRows`.

    Args:
        solver: The eliminations.
        motions: Motions where all free components are zero.
        bias: What these require.
        refinement: What the solver reports; no step of refinement.
    """
    system, places = solver.tree.system, range(len(solver.pivots))
    found = ArticulatedDerivatives(solver, motions, solver.passed(bias, "ydot"))
    at = {
        system.coordinate_places[Coordinate(freedom.body, freedom.index)]: i
        for freedom, i in system.places.items()
    }
    rows: list[Sequence[Expr]] = [
        [found.by_coordinate.get((i, at[j]), S.Zero) for j in places] for i in places
    ]
    rows += [[found.by_speed.get((i, j), S.Zero) for j in places] for i in places]
    rows += [[found.inverse.get((i, j), S.Zero) for j in places] for i in places]
    rows.append(solver.joint_efforts(bias))
    margins = PivotMargins(solver).margins(refinement.pivots)
    entries = [entry for row in rows for entry in row]
    return Derived(entries, solver.regular_if_positive, unless_positive([margins] if margins else []))
