"""The outputs that a solver of [A]{ydot} = {b} gives: {ydot}, loads of contacts, products with [A]^-1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import sympy
from sympy import Expr, Rational, S

from kanegen.recursion.articulated_bodies import ArticulatedBodies
from kanegen.recursion.articulated_rows import articulated_rows
from kanegen.recursion.body_motion import BodyMotion, body_motions
from kanegen.recursion.constraints import Constraints
from kanegen.recursion.contact import HeldContacts
from kanegen.recursion.inverse_dynamics import Requirement, required
from kanegen.recursion.operational import Operational
from kanegen.recursion.pivot_margins import PivotMargins
from kanegen.recursion.refinement import UNREFINED, RefinedSolution, Refinement, unless_positive
from kanegen.recursion.solution_derivatives import solution_parts
from kanegen.recursion.solver import Solver
from kanegen.recursion.tree import Derived, by_place


class Solution:
    """What outputs are derived from: solutions {ydot}, free or with contacts held, and products with [A]^-1.

    Each is derived when it is first needed, and all share what they have in common.
    """

    def __init__(self, solver: Solver, refinement: Refinement = UNREFINED) -> None:
        self._solver = solver
        self._tree = solver.tree
        self._refinement = refinement

    def forward_dynamics(self) -> Derived:
        """Derive the entries of {ydot}, refined."""
        entries = self._speed_rates(self._free.refined.components)
        return Derived(entries, self._solver.regular_if_positive, unless_positive(self._free.margins()))

    def contact_dynamics(self) -> Derived:
        """Derive the entries of {ydot} where all contacts hold, refined."""
        return self._derived_held(self._speed_rates(self._held.refined.components))

    def contact_forces(self) -> Derived:
        """Derive the loads by which all contacts hold, row by row, refined."""
        return self._derived_held(self._contacts.named_loads(self._held.refined.loads))

    def mass_matrix_inverse(self) -> Derived:
        """Derive the entries of [A]^-1, row-major; both halves hold the same symbols."""
        found, places = self._solver.inverse(), range(len(self._solver.pivots))
        entries = [found[i, j] for i in places for j in places]
        return Derived(entries, self._solver.regular_if_positive, self._unrefined_margins())

    def operational_inertia_inverse(self) -> Derived:
        """Derive J [A]^-1 J^T of every frame, row-major."""
        entries = [entry for inverse in self._operational.inverses for row in inverse for entry in row]
        return Derived(entries, self._solver.regular_if_positive, self._unrefined_margins())

    def operational_inertia(self) -> Derived:
        """Derive [Lambda], the inverse of J [A]^-1 J^T, of every frame, row-major."""
        entries = [entry for one in self._operational.inertias for row in one.entries for entry in row]
        return self._of_inertias(entries)

    def operational_bias(self) -> Derived:
        """Derive -[Lambda] {a_0} of every frame, with its acceleration {a_0} without a load on it."""
        biases = self._operational.biases(self._solver.reduced(self._bias), self._motions)
        return self._of_inertias([entry for bias in biases for entry in bias])

    def _of_inertias(self, entries: Sequence[Expr]) -> Derived:
        """Return entries that exist, and are accurate, where the operational inertia of every frame is."""
        inertias, freedoms = self._operational.inertias, self._solver.regular_if_positive
        independent = [left for one in inertias for left in one.independent]
        margins = [margin for one in inertias for margin in one.accurate]
        accurate = self._unrefined_margins() or [S.One] * len(freedoms)
        return Derived(entries, by_place(freedoms, independent), by_place(accurate, margins))

    def error_estimate(self) -> Derived:
        """Derive the absolute change of each entry of {ydot} by the first step of refinement."""
        entries = self._solver.speed_rates(self._free.correction.components, "dy", {})
        squares = [self._define(f"de_{i}", entry * entry) for i, entry in enumerate(entries)]
        return Derived([sympy.sqrt(square) for square in squares], self._solver.regular_if_positive)

    def regularity(self) -> Derived:
        """Derive by freedom the ratio of its pivot to its inertia with every other freedom locked."""
        pairs = zip(self._solver.regular_if_positive, self._solver.diagonal, strict=True)
        return Derived([left / whole for left, whole in pairs])

    def parts_of_derivatives(self) -> Derived:
        """Derive the rows of `SolutionRows`, from which derivatives of unrefined {ydot} are made."""
        return solution_parts(self._tree, self._refinement, together=self._solver.together)

    def derivatives_by_state(self) -> Derived:
        """Derive the rows of `ArticulatedRows`, which hold the derivatives of unrefined {ydot}.

        Raises:
            TypeError: If the solver does not eliminate by articulated bodies.
        """
        if not isinstance(self._solver, ArticulatedBodies):
            raise TypeError(self._solver)
        return articulated_rows(self._solver, self._motions, self._bias, self._refinement)

    def _unrefined_margins(self) -> Sequence[Expr]:
        """Return expressions by freedom that are positive where a result that is not refined is accurate."""
        return unless_positive([PivotMargins(self._solver).margins(self._refinement.unrefined)])

    def _derived_held(self, entries: list[Expr]) -> Derived:
        """Return the entries of an output that exists where the rows of contacts are independent, too."""
        refinement, rows = self._refinement, self._held.constraints
        regular, first = self._solver.regular_if_positive, len(self._tree.system.rows_of_frames)
        shares = refinement.accurate_rows, refinement.accurate_damped_rows
        accurate = rows.accurate_if_positive(*map(Rational, shares))
        margins = [by_place(test, [S.One] * len(accurate), first) for test in self._held.margins()]
        margins.append(by_place([S.One] * len(regular), accurate, first))
        independent = rows.independent_if_positive(Rational(refinement.independent_rows))
        return Derived(entries, by_place(regular, independent, first), unless_positive(margins))

    def _speed_rates(self, components: Sequence[Expr]) -> list[Expr]:
        """Return {ydot} from the free components."""
        carried = {k: motion.carried for k, motion in self._motions.items()}
        return self._solver.speed_rates(components, "ydot", carried)

    @cached_property
    def _motions(self) -> Mapping[int, BodyMotion]:
        """Motion of the bodies where all free components are zero."""
        return body_motions(self._tree, accelerated=False, released=self._solver.released)

    @cached_property
    def _operational(self) -> Operational:
        """Operational inertias of the frames that the system selects."""
        refinement = self._refinement
        return Operational(self._solver, refinement.independent_rows, refinement.amplification)

    @cached_property
    def _bias(self) -> Requirement:
        """What is required where all free components are zero."""
        return required(self._tree, self._motions, accelerated=False)

    @cached_property
    def _free(self) -> RefinedSolution:
        """The solution without constraints."""
        return RefinedSolution(self._solver, Constraints(self._solver, ()), self._bias, self._refinement)

    @cached_property
    def _contacts(self) -> HeldContacts:
        """The contacts of the system."""
        return HeldContacts(self._solver)

    @cached_property
    def _held(self) -> RefinedSolution:
        """The solution where all contacts hold."""
        constraints = Constraints(self._solver, self._contacts.rows)
        return RefinedSolution(self._solver, constraints, self._bias, self._refinement)

    def _define(self, name: str, value: Expr) -> Expr:
        """Return a symbol for a value."""
        return self._tree.definitions.define(name, value)
