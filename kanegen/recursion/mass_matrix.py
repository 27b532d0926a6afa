"""[A] by composite bodies: Eq. (43) regrouped so that nothing is computed twice.

Hold every joint outward of a freedom still: all bodies that the freedom carries move as one composite body.
Its unit speed then needs a force {F} and a moment {M} about the origin, and the work of that pair on every
freedom further inward is an entry of [A] (Featherstone 2008, section 6.2). The joint's turns are passed one
at a time, so that an angle's entry is simply a component of {M}, a translation's a component of {F}.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.bodies import Inertia
from kanegen.recursion.columns import Column, Push, Wrench
from kanegen.recursion.derived import Derived
from kanegen.recursion.joints import NO_FREEDOM, JointMotion, Step
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import column, cross, dot, scale, unit
from kanegen.symbolic.definitions import Definitions


@dataclass(frozen=True)
class _Assembly:
    """[A] in the making: entries by pair of freedoms, the larger first, and the definitions behind them."""

    definitions: Definitions
    entries: dict[tuple[int, int], Expr]

    def record(self, a: int, b: int, value: Expr) -> None:
        """Store an entry; its mirror image is the same."""
        self.entries[max(a, b), min(a, b)] = value

    def turn_columns(self, carried: list[Column], composite: Inertia, step: Step) -> list[Column]:
        """Columns seen from below a turn, whose angle takes their entries and adds its own column."""
        turned: list[Column] = []
        for col in carried:
            if step.freedom != NO_FREEDOM:
                self.record(col.freedom, step.freedom, col.moment_about(step.axis, self.definitions))
            turned.append(col.down(step.turn, step.frame, self.definitions))
        if step.freedom != NO_FREEDOM:
            moment = column(composite.inertia, step.axis)
            self.record(step.freedom, step.freedom, moment[step.axis])
            force = cross(unit(step.axis), composite.moment)
            turned.append(Wrench(step.freedom, step.frame, force, moment))
        return turned

    def slide(self, carried: list[Column], composite: Inertia, motion: JointMotion) -> None:
        """The entries of the joint's translations."""
        for slide in motion.slides:
            for col in carried:
                name = f"A_{col.freedom}_{slide.freedom}"
                value = self.definitions.define(name, dot(slide.direction, col.force))
                self.record(col.freedom, slide.freedom, value)
            self.record(slide.freedom, slide.freedom, composite.mass)

    def shift_columns(self, carried: list[Column], composite: Inertia, motion: JointMotion) -> list[Column]:
        """Columns about O_J, and those of the joint's translations.

        A translation moves the whole composite body along a direction fixed in J, so its column begins there.
        """
        shifted = [col.shifted(motion.offset, str(motion.lower), self.definitions) for col in carried]
        if not motion.slides or composite.mass == 0:
            return shifted
        center = scale(1 / composite.mass, composite.moment)
        center = self.definitions.vector(f"c_{motion.body}", center)
        for slide in motion.slides:
            label = f"{motion.body}s{slide.freedom}"
            force = self.definitions.vector(f"F_{label}", scale(composite.mass, slide.direction))
            shifted.append(Push(slide.freedom, label, motion.body, force, center))
        return shifted


def mass_matrix(tree: Tree) -> Derived:
    """The entries of [A], row-major; both halves hold the same symbols."""
    bodies = list(tree.inertias)
    columns: list[list[Column]] = [[] for _ in bodies]
    assembly = _Assembly(tree.definitions, {})
    for motion in reversed(tree.motions):
        k, j = motion.body, motion.lower
        tree.about(k, "composite body and its columns of [A], Eq. (43)")
        composite, carried = bodies[k - 1], columns[k - 1]
        for step in reversed(motion.steps):
            composite = composite.down(step.turn, step.frame, tree.definitions)
            carried = assembly.turn_columns(carried, composite, step)
        assembly.slide(carried, composite, motion)
        if j:
            composite = composite.shifted(motion.offset, f"{k}j", tree.definitions)
            columns[j - 1] += assembly.shift_columns(carried, composite, motion)
            bodies[j - 1] = bodies[j - 1].plus(composite, str(j), tree.definitions)
    n = len(tree.system.freedoms)
    pairs = ((max(r, c), min(r, c)) for r in range(n) for c in range(n))
    return Derived([assembly.entries.get(pair, S.Zero) for pair in pairs])
