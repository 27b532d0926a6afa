"""The tree as the recursions see it: joints, and inertias regrouped so that many numbers vanish.

What a joint cannot move apart from the lower body may as well belong to the lower body: the mass of a body
whose joint does not slide, as a point at its origin; the first moment along a hinge, and the inertia of a rod
on its axis; the whole inertia of a body that does not turn; everything of a welded body. [A] and {f} do not
change (base inertial parameters: Gautier and Khalil 1990).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from sympy import S

from kanegen.model.system import System
from kanegen.program.constants import DOUBLE_CONSTANTS, Constants
from kanegen.recursion.bodies import NOTHING, Inertia, body_inertia
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.joints import joint_motion
from kanegen.recursion.vectors import ZERO, entry, scale, unit
from kanegen.symbolic.definitions import Definitions, Symmetric, Vector


@dataclass(frozen=True)
class Tree:
    """A system, ready for recursions.

    Attributes:
        system: What it was made from.
        motions: The joint of each body.
        inertias: What each body keeps, about its origin.
        ground: What they pass to the ground, about the inertial origin; it never moves.
        definitions: Take the intermediates.
    """

    system: System
    motions: tuple[JointMotion, ...]
    inertias: tuple[Inertia, ...]
    ground: Inertia
    definitions: Definitions

    def inward(self, motion: JointMotion) -> Iterator[JointMotion]:
        """The joint, and those between it and the ground."""
        yield motion
        while motion.lower:
            motion = self.motions[motion.lower - 1]
            yield motion

    def about(self, k: int, what: str) -> None:
        """Say what the following definitions are: something of body `k`."""
        self.definitions.about(f"Body {k} ({self.system.bodies[k - 1].name}): {what}")


def tree(system: System, constants: Constants = DOUBLE_CONSTANTS) -> Tree:
    """The tree of `system`, with new definitions."""
    definitions = Definitions([parameter.name for parameter in system.parameters], constants)
    motions: list[JointMotion] = []
    for k, body in enumerate(system.bodies, start=1):
        below = motions[body.lower - 1].origin if body.lower else ZERO
        motions.append(joint_motion(system, k, below, definitions))
    return _grouped(system, motions, definitions, lambda motion: True)


def apart(tree: Tree) -> Tree:
    """The same tree, where every body that turns on its lower body keeps its inertia.

    A sum of two inertias is rounded as the larger is, which may be all there is of the smaller one. What the
    tree needs for given accelerations, body by body, is then still accurate.
    """
    return _grouped(tree.system, tree.motions, tree.definitions, lambda motion: not motion.turns)


def ungrouped(tree: Tree) -> Tree:
    """The same tree, where every body keeps its inertia: what joints carry depends on which side has it."""
    return _grouped(tree.system, tree.motions, tree.definitions, lambda motion: False)


def _grouped(
    system: System,
    motions: Sequence[JointMotion],
    definitions: Definitions,
    passes: Callable[[JointMotion], bool],
) -> Tree:
    """The tree in which the bodies whose joints `passes` names give the lower body what they can."""
    own = [Inertia(), *(body_inertia(system, m.body, m.origin, definitions) for m in motions)]
    for motion in reversed(motions):
        k, j = motion.body, motion.lower
        if passes(motion):
            own[k], passed = _regrouped(own[k], motion, definitions)
            own[j] = own[j].plus(passed, f"{j}r{k}", definitions)
    ground, *kept = own
    return Tree(system, tuple(motions), tuple(kept), ground, definitions)


def _regrouped(own: Inertia, motion: JointMotion, definitions: Definitions) -> tuple[Inertia, Inertia]:
    """What a body keeps, and what its lower body gets, about the lower body's origin and in its frame."""
    if motion.sliding and motion.turns:
        return own, Inertia()
    if motion.sliding:
        spinning = _seen_below(Inertia(inertia=own.inertia), motion, ZERO, definitions)
        return replace(own, inertia=NOTHING), spinning
    if not motion.turns:
        return Inertia(), _seen_below(own, motion, motion.offset, definitions)
    fixed = _on_axis(own, motion.hinge.axis) if motion.hinge else Inertia(mass=own.mass)
    return _difference(own, fixed), _seen_below(fixed, motion, motion.offset, definitions)


def _on_axis(own: Inertia, axis: int) -> Inertia:
    """Mass on the axis that a hinge does not move: its first moment along the axis, and a rod's inertia."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rod = getattr(own.inertia, entry(k, k))
    inertia = {name: S.Zero for name in Symmetric._fields} | {entry(j, j): rod, entry(k, k): rod}
    return Inertia(own.mass, scale(own.moment[axis], unit(axis)), Symmetric(**inertia))


def _difference(own: Inertia, fixed: Inertia) -> Inertia:
    return Inertia(
        own.mass - fixed.mass,
        Vector(*(a - b for a, b in zip(own.moment, fixed.moment, strict=True))),
        Symmetric(*(a - b for a, b in zip(own.inertia, fixed.inertia, strict=True))),
    )


def _seen_below(part: Inertia, motion: JointMotion, offset: Vector, definitions: Definitions) -> Inertia:
    """Through the turns that stand still, which leave a rod on a turning axis as it is, and by the offset."""
    name = f"{motion.body}r"
    for step in reversed(motion.steps):
        if not step.moves:
            part = part.down(step.turn, f"{name}{step.frame}", definitions)
    return part.shifted(offset, name, definitions)
