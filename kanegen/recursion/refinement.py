"""The solution {ydot} of [A]{ydot} = {b} with rows of constraints: found by a solver, refined step by step.

The residual of a solution is {tau} less the generalized forces that inverse dynamics gives for it; the solver
maps the residual to a correction (Higham 2002, chapter 12). Nothing is computed in a higher precision:
eliminations lose digits of a solution, but a residual only loses digits in sums of forces. So one step
repairs any solution with a few correct digits, and the correction tells how many there were.

A step does not form the residual explicitly. The wrenches that the bodies require for the solution are added
to the bias wrenches, and the solver runs again from there. For this every body keeps its own inertia, because
the inertia of a light body would be lost to rounding in the sum with a heavy one; see
`tree.with_own_inertias`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from sympy import Add, Expr, S

from kanegen.recursion.constraints import Constraints
from kanegen.recursion.correction_size import CorrectionSize
from kanegen.recursion.inertia import Inertia
from kanegen.recursion.inverse_dynamics import Requirement
from kanegen.recursion.pivot_margins import NO_LIMITS, PivotLimits, PivotMargins
from kanegen.recursion.rotors import rotor_efforts, spinning_rotors
from kanegen.recursion.solved_motion import SolvedMotion, solved_motions
from kanegen.recursion.solver import Solver
from kanegen.recursion.vectors import ZERO, Wrench, add, column, cross, dot, scale
from kanegen.symbolic.definitions import Vector


@dataclass(frozen=True)
class Refinement:
    """Iterative refinement of {ydot}, and the limit beyond which its result is reported as inaccurate.

    Attributes:
        steps: Number of steps.
        limit: Largest first correction over the solution, freedom by freedom.
        floor: Acceleration by freedom below which a solution counts as zero (rad/s^2, m/s^2).
        pivots: Losses of pivots beyond which {ydot} is reported as inaccurate.
        unrefined: The same for results that no step refines, such as [A]^-1.
        amplification: Largest factor by which an operational inertia may multiply the roundoffs of its
            inverse without being reported as inaccurate; see `operational.Operational`.
        independent_rows: Share of the acceleration of a row of constraints alone, for unit load, that its
            pivot must keep for the row not to count as dependent on others.
        accurate_rows: The same for the loads to be accurate.
    """

    steps: int = 0
    limit: float = 0.0
    floor: tuple[float, ...] = ()
    pivots: PivotLimits = NO_LIMITS
    unrefined: PivotLimits = NO_LIMITS
    amplification: float = 1.0
    independent_rows: float = 2.0**-43
    accurate_rows: float = 2.0**-13

    @property
    def accurate_damped_rows(self) -> float:
        """The same for loads of rows with damping to be accurate.

        Damping means to bear small pivots, so that only those count that rounding errors of the row change
        noticeably: by about one part in 10^6 in double precision.
        """
        return min(self.accurate_rows, 2.0**10 * self.independent_rows)


UNREFINED = Refinement()


@dataclass(frozen=True)
class Unknowns:
    """A solution, or the correction of one.

    Attributes:
        components: Free components of the accelerations, by freedom.
        loads: Loads of the constraints, by row.
    """

    components: list[Expr]
    loads: list[Expr]


@dataclass(frozen=True, eq=False)
class RefinedSolution:
    """The refined solution of [A]{ydot} = {b} with rows of constraints, of which there may be none.

    Attributes:
        solver: The solver.
        constraints: The rows of constraints.
        bias: What is required where all free components are zero.
        refinement: The refinement.
    """

    solver: Solver
    constraints: Constraints
    bias: Requirement
    refinement: Refinement

    @cached_property
    def refined(self) -> Unknowns:
        """The solution after all steps of refinement."""
        found = self._first
        for step in range(self.refinement.steps):
            correction = self._corrected(found) if step else self.correction
            found = Unknowns(
                self._sums("ydot", 0, found.components, correction.components),
                self._sums("cf", 1, found.loads, correction.loads),
            )
        return found

    @cached_property
    def correction(self) -> Unknowns:
        """The first correction of the solution."""
        return self._corrected(self._first)

    def margins(self) -> list[Sequence[Expr]]:
        """Return expressions by freedom that are positive where {ydot} is accurate, test by test."""
        refinement, margins = self.refinement, list[Sequence[Expr]]()
        if refinement.steps:
            margins.append(self._size.margins(refinement.limit, refinement.floor))
        margins.append(PivotMargins(self.solver).margins(refinement.pivots))
        return [test for test in margins if test]

    @cached_property
    def _first(self) -> Unknowns:
        """The solution before any refinement."""
        return self._solved(self.bias, [row.gap for row in self.constraints.rows], ("ydot", "cf"))

    @cached_property
    def _size(self) -> CorrectionSize:
        """Size of the unrefined solution and of its first correction."""
        found = self._first.components, self.correction.components
        return CorrectionSize(self.solver.tree, self.solver.pivots, *found)

    def _solved(self, bias: Requirement, gaps: Sequence[Expr], names: tuple[str, str]) -> Unknowns:
        """Return the solution for what is required, and missing along rows, at zero components.

        Args:
            bias: What is required.
            gaps: Accelerations along the rows.
            names: Prefixes of the names of the components and of the loads.
        """
        of_components, of_loads = names
        if not self.constraints.rows:
            return Unknowns(self.solver.solve(bias, of_components), [])
        right_side = self.solver.reduced(bias)
        loads = self.constraints.loads(right_side, gaps, of_loads)
        components = self.solver.components(self.constraints.added(right_side, loads), of_components)
        return Unknowns(components, loads)

    def _corrected(self, found: Unknowns) -> Unknowns:
        """Return the correction of a solution: the solution for what it leaves over."""
        solved = solved_motions(self.solver.tree, self.solver.paths, found.components)
        bias = _with_free_components(self.solver, self.bias, found.components, solved)
        accelerations = {k: motion.acceleration for k, motion in solved.items()}
        gaps = self.constraints.gaps(accelerations, found.loads)
        return self._solved(self.constraints.without_loads(bias, found.loads), gaps, ("dy", "dc"))

    def _sums(self, name: str, first: int, old: Sequence[Expr], new: Sequence[Expr]) -> list[Expr]:
        """Return the sums of two lists, with a symbol for every entry, numbered from `first`."""
        define, pairs = self.solver.tree.definitions.define, zip(old, new, strict=True)
        return [define(f"{name}_{i}", one + other) for i, (one, other) in enumerate(pairs, start=first)]


def unless_positive(margins: Sequence[Sequence[Expr]]) -> Sequence[Expr]:
    """Return the margins of several tests, one after the other, none if all are positive numbers."""
    every = [margin for test in margins for margin in test]
    return () if all(margin.is_positive and margin.is_number for margin in every) else every


def _with_free_components(
    solver: Solver, bias: Requirement, components: Sequence[Expr], solved: Mapping[int, SolvedMotion]
) -> Requirement:
    """Return `bias` plus what is required for the free components, with which the bodies move as `solved`."""
    tree, total, efforts = solver.tree, [], dict(bias.efforts)
    rotors, spinning = spinning_rotors(tree), dict[int, Vector]()
    for rotor in rotors:
        rate = Add(*(share * components[i] for i, share in rotor.motion.shares.items()))
        moment = scale(rate, rotor.momentum)
        spinning[rotor.carrier] = add(spinning.get(rotor.carrier, ZERO), moment)
    for joint in tree.joints:
        k, a = joint.body, solved[joint.body].acceleration
        tree.about(k, "what the solution needs, Eq. (44)")
        own = _accelerated(tree.inertias[k - 1], Vector(*a[:3]), Vector(*a[3:]))
        own = replace(own, moment=add(own.moment, spinning.get(k, ZERO)))
        total.append(bias.wrenches[k - 1].plus(own, f"{k}own", tree.definitions))
        for one in joint.freedoms:
            if one.armature != 0:
                rate = Add(*(share * components[i] for i, share in one.shares.items()))
                needed = efforts.get(one.number, S.Zero) + one.armature * rate
                efforts[one.number] = tree.definitions.define(f"fm_{one.number}", needed)
    alpha = {k: Vector(*motion.acceleration[:3]) for k, motion in solved.items()}
    for freedom, effort in rotor_efforts(rotors, alpha).items():
        efforts[freedom] = tree.definitions.define(f"fr_{freedom}", efforts.get(freedom, S.Zero) + effort)
    return Requirement(total, efforts)


def _accelerated(inertia: Inertia, alpha: Vector, a: Vector) -> Wrench:
    """Return the wrench that a body requires for an angular acceleration and that of its origin."""
    force = add(scale(inertia.mass, a), cross(alpha, inertia.moment))
    angular = Vector(*(dot(column(inertia.inertia, axis), alpha) for axis in range(3)))
    return Wrench(force, add(angular, cross(inertia.moment, a)))
