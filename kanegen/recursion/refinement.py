"""{ydot} by a solver, improved step by step, and what is known of its error.

A solution leaves a residual, {tau} less what it needs by inverse dynamics, and the eliminations that found it
turn that into a correction (Higham 2002, chapter 12). Nothing is computed in a higher precision: a solution
loses digits by eliminating, a residual only by adding up forces. So one step repairs whatever has a few
correct digits, and the correction tells how many those were.

A step does not form the residual. What the bodies need for the solution is added to what they need without
it, and the solver starts again from there: what is then missing is the residual. It must know the inertia of
every body by itself, since next to a heavy body that hangs on it a light one's would be rounded away; see
`tree.apart`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import sympy
from sympy import Expr

from kanegen.recursion.bodies import Inertia
from kanegen.recursion.correction_size import Sizes
from kanegen.recursion.derived import Derived
from kanegen.recursion.joint_path import STILL, Free, Stop
from kanegen.recursion.motion import Requirement, requirements
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import add, column, cross, dot, scale
from kanegen.symbolic.definitions import Vector


class Solver(Protocol):
    """A way to solve [A]{ydot} = {b} for several {b}.

    Attributes:
        tree: Of which system.
        ways: By body the stops of its joint, with the free components that are solved for.
        pivots: By freedom, what is divided by.
    """

    tree: Tree
    ways: Mapping[int, tuple[Stop, ...]]
    pivots: Sequence[Expr]

    @property
    def positive(self) -> Sequence[Expr]:
        """By freedom what is positive where [A] is regular; pivots, weakened where coordinates fail."""

    @property
    def diagonal(self) -> Sequence[Expr]:
        """What the pivots would be if all other components stood still."""

    def solve(self, needs: Sequence[Requirement], name: str) -> list[Expr]:
        """The free components that the efforts cause where the bodies need `needs` for anything else."""

    def coordinates(self, found: Sequence[Expr], name: str) -> list[Expr]:
        """{ydot} behind free components."""


@dataclass(frozen=True)
class Refinement:
    """How {ydot} is improved, and when the result is called inaccurate.

    Attributes:
        steps: How many.
        limit: Largest first correction over the solution, freedom by freedom.
        floor: Per freedom an acceleration that counts as part of the whole solution, so that nothing is
            called inaccurate where forces cancel (rad/s^2, m/s^2).
    """

    steps: int = 0
    limit: float = 0.0
    floor: tuple[float, ...] = ()


UNREFINED = Refinement()


class Solution:
    """{ydot}, and what goes with it; nothing is derived before it is asked for."""

    def __init__(self, solver: Solver, refinement: Refinement = UNREFINED) -> None:
        self._solver = solver
        self._tree = solver.tree
        self._refinement = refinement

    def forward_dynamics(self) -> Derived:
        """The entries of {ydot}."""
        found, refinement = self._found, self._refinement
        for step in range(refinement.steps):
            correction = self._corrected(found) if step else self._correction
            pairs = zip(found, correction, strict=True)
            found = [self._define(f"ydot_{i}", old + new) for i, (old, new) in enumerate(pairs)]
        entries = self._solver.coordinates(found, "ydot")
        margins = self._sizes.margins(refinement.limit, refinement.floor) if refinement.steps else ()
        return Derived(entries, self._solver.positive, margins)

    def error_estimate(self) -> Derived:
        """How much the first step changes each entry of {ydot}."""
        entries = self._solver.coordinates(self._correction, "dy")
        squares = [self._define(f"de_{i}", entry * entry) for i, entry in enumerate(entries)]
        return Derived([sympy.sqrt(square) for square in squares], self._solver.positive)

    def regularity(self) -> Derived:
        """By freedom, what the other freedoms leave of its inertia."""
        pairs = zip(self._solver.positive, self._solver.diagonal, strict=True)
        return Derived([left / whole for left, whole in pairs])

    def sizes(self) -> Derived:
        """The square of the solution, then those of the first correction by freedom; without units."""
        return Derived([self._sizes.whole, *self._sizes.errors])

    @cached_property
    def _needs(self) -> list[Requirement]:
        return requirements(self._tree, accelerated=False)

    @cached_property
    def _found(self) -> list[Expr]:
        return self._solver.solve(self._needs, "ydot")

    @cached_property
    def _correction(self) -> list[Expr]:
        return self._corrected(self._found)

    @cached_property
    def _sizes(self) -> Sizes:
        return Sizes(self._tree, self._solver.pivots, self._found, self._correction)

    def _corrected(self, found: Sequence[Expr]) -> list[Expr]:
        return self._solver.solve(_needed(self._solver, self._needs, found), "dy")

    def _define(self, name: str, value: Expr) -> Expr:
        return self._tree.definitions.define(name, value)


def _needed(solver: Solver, needs: Sequence[Requirement], found: Sequence[Expr]) -> list[Requirement]:
    """What each body needs for accelerations with the free components `found`, beside `needs`."""
    tree, definitions = solver.tree, solver.tree.definitions
    accelerations = {0: STILL}
    total = []
    for motion in tree.motions:
        k = motion.body
        tree.about(k, "what the solution needs, Eq. (44)")
        a = accelerations[motion.lower]
        for stop in reversed(solver.ways[k]):
            if isinstance(stop, Free):
                i, freedom = stop.index, stop.freedom
                a = (*a[:i], definitions.define(f"r_{freedom}", a[i] + found[freedom]), *a[i + 1 :])
            else:
                a = stop.outward(a, definitions)
        accelerations[k] = a
        own = _moved(tree.inertias[k - 1], Vector(*a[:3]), Vector(*a[3:]))
        total.append(needs[k - 1].plus(own, f"{k}own", definitions))
    return total


def _moved(inertia: Inertia, alpha: Vector, a: Vector) -> Requirement:
    """What a body needs for an angular acceleration and the acceleration of its origin."""
    force = add(scale(inertia.mass, a), cross(alpha, inertia.moment))
    turning = Vector(*(dot(column(inertia.inertia, axis), alpha) for axis in range(3)))
    return Requirement(force, add(turning, cross(inertia.moment, a)))
