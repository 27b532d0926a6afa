"""The tree that the recursions traverse: joints, and inertias regrouped so that many numbers vanish.

The part of an inertia that a joint cannot move relative to the lower body is added to the lower body: the
mass of a body whose joint has no moving translation, as a point at its origin; the first moment along a
hinge, and the inertia of a rod on its axis; the whole inertia of a body that does not rotate; everything of a
welded body. [A] and {f} do not change (base inertial parameters: Gautier and Khalil 1990).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from sympy import Expr, S

from kanegen.model.system import System
from kanegen.program.constants import DOUBLE_CONSTANTS, Constants
from kanegen.recursion.constants import exact
from kanegen.recursion.inertia import NO_INERTIA, Inertia, body_inertia
from kanegen.recursion.joint_builder import joint_motion
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.model_numbers import with_expressions_defined
from kanegen.recursion.vectors import ZERO, entry, scale, subtract, unit
from kanegen.symbolic.definitions import Definitions, Symmetric, Vector


@dataclass(frozen=True)
class Derived:
    """The result of a recursion: the entries of an output, in terms of definitions.

    Attributes:
        entries: Entries, row-major.
        exists_if_positive: Expressions by freedom, all positive where the entries exist; empty if they exist
            in every state.
        accurate_if_positive: Expressions by freedom, all positive where the entries are accurate; empty if
            accuracy is not checked.
    """

    entries: Sequence[Expr]
    exists_if_positive: Sequence[Expr] = ()
    accurate_if_positive: Sequence[Expr] = ()


def by_place(freedoms: Sequence[Expr], rows: Sequence[Expr], first: int = 0) -> list[Expr]:
    """Return expressions for freedoms and for rows of outputs in the order of the places of statuses.

    Between the two is the status of results that are not finite.

    Args:
        freedoms: Expressions by freedom.
        rows: Expressions by row.
        first: Number of rows of other outputs before these.
    """
    return [*freedoms, S.One, *[S.One] * first, *rows]


@dataclass(frozen=True)
class Tree:
    """A system, prepared for recursions.

    Attributes:
        described: The system as it is described.
        system: The same, with parameters in place of numbers that are expressions of parameters.
        joints: Joint of each body.
        inertias: Inertia that each body keeps, about its origin.
        ground: Inertia that bodies pass to the ground, about the inertial origin; it never moves.
        definitions: Definitions that recursions add their intermediates to.
        is_regrouped: Function that selects the joints at which inertia was passed to the lower body.
    """

    described: System
    system: System
    joints: tuple[JointMotion, ...]
    inertias: tuple[Inertia, ...]
    ground: Inertia
    definitions: Definitions
    is_regrouped: Callable[[JointMotion], bool]

    def inward(self, joint: JointMotion) -> Iterator[JointMotion]:
        """Yield a joint, then those between it and the ground."""
        yield joint
        while joint.lower:
            joint = self.joints[joint.lower - 1]
            yield joint

    def about(self, k: int, quantity: str) -> None:
        """Set the comment of the definitions that follow: a quantity of body `k`, 0 for the ground."""
        body = f"Body {k} ({self.system.bodies[k - 1].name})" if k else "Ground"
        self.definitions.about(f"{body}: {quantity}")


def tree(system: System, constants: Constants = DOUBLE_CONSTANTS) -> Tree:
    """Return the tree of a system, with new definitions."""
    definitions = Definitions([parameter.name for parameter in system.parameters], constants)
    described, system = system, with_expressions_defined(system, definitions)
    joints: list[JointMotion] = []
    for k, body in enumerate(system.bodies, start=1):
        below = joints[body.lower - 1].origin if body.lower else ZERO
        joints.append(joint_motion(system, k, below, definitions))
    return _regrouped((described, system), joints, definitions, lambda joint: True)


def with_own_inertias(tree: Tree) -> Tree:
    """Return the same tree, where every body that rotates on its lower body keeps its inertia.

    The sum of two inertias has the rounding error of the larger, in which the smaller one may be lost. With
    its own inertia, the wrench that each body requires for its accelerations stays accurate.
    """
    return _regrouped(
        (tree.described, tree.system), tree.joints, tree.definitions, lambda joint: not joint.rotates
    )


def about_mass_centers(tree: Tree) -> Tree:
    """Return the same tree, where bodies that translate freely and rotate have their mass centre as origin.

    Their translations are solved for first, as accelerations of the mass centre. Loads at the mass centre
    then cause exactly no moment, and a body that carries no inertia has no coupling of rotation and
    translation. The origin of other bodies, without loads, stays O_K, which costs less.
    """
    carrying = {joint.lower for joint in tree.joints if not joint.translates_freely}
    joints: list[JointMotion] = []
    for joint in tree.joints:
        k, below = joint.body, joints[joint.lower - 1].to_center if joint.lower else ZERO
        body, offset = tree.system.bodies[k - 1], subtract(joint.offset, below)
        origin, to_center = joint.origin, joint.to_center
        if joint.translates_freely and joint.rotates and (body.loads or k not in carrying):
            origin = to_center = Vector(*(exact(value) for value in body.mass_center))
        offset = tree.definitions.vector(f"d_{k}", offset)
        joints.append(replace(joint, origin=origin, offset=offset, to_center=to_center))
    return _regrouped((tree.described, tree.system), joints, tree.definitions, tree.is_regrouped)


def ungrouped(tree: Tree) -> Tree:
    """Return the same tree, where every body keeps its inertia, for the loads that joints transmit."""
    return _regrouped((tree.described, tree.system), tree.joints, tree.definitions, lambda joint: False)


def _regrouped(
    systems: tuple[System, System],
    joints: Sequence[JointMotion],
    definitions: Definitions,
    is_regrouped: Callable[[JointMotion], bool],
) -> Tree:
    """Return the tree in which bodies pass to the lower body the inertia that their joints do not move.

    Args:
        systems: The system as described, and with parameters in place of expressions.
        joints: Joint of each body.
        definitions: Definitions that the intermediates are added to.
        is_regrouped: Function that selects the joints at which inertia is passed.
    """
    described, system = systems
    own = [Inertia(), *(body_inertia(system, joint.body, joint.origin, definitions) for joint in joints)]
    for joint in reversed(joints):
        k, j = joint.body, joint.lower
        if is_regrouped(joint):
            own[k], passed = _split(own[k], joint, definitions)
            own[j] = own[j].plus(passed, f"{j}r{k}", definitions)
    ground, *kept = own
    return Tree(described, system, tuple(joints), tuple(kept), ground, definitions, is_regrouped)


def _split(own: Inertia, joint: JointMotion, definitions: Definitions) -> tuple[Inertia, Inertia]:
    """Return the inertia that a body keeps, and the part for its lower body, about that body's origin."""
    if joint.moving_translations and joint.rotates:
        return own, Inertia()
    if joint.moving_translations:
        rotational = _seen_below(Inertia(inertia=own.inertia), joint, ZERO, definitions)
        return replace(own, inertia=NO_INERTIA), rotational
    if not joint.rotates:
        return Inertia(), _seen_below(own, joint, joint.offset, definitions)
    fixed = _on_axis(own, joint.hinge.axis) if joint.hinge else Inertia(mass=own.mass)
    return _difference(own, fixed, joint.body, definitions), _seen_below(
        fixed, joint, joint.offset, definitions
    )


def _on_axis(own: Inertia, axis: int) -> Inertia:
    """Return the part of an inertia that a hinge about `axis` does not move.

    It is the mass, its first moment along the axis, and the inertia of a rod on the axis.
    """
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rod = getattr(own.inertia, entry(k, k))
    inertia = {name: S.Zero for name in Symmetric._fields} | {entry(j, j): rod, entry(k, k): rod}
    return Inertia(own.mass, scale(own.moment[axis], unit(axis)), Symmetric(**inertia))


def _difference(own: Inertia, part: Inertia, k: int, definitions: Definitions) -> Inertia:
    """Return the inertia of body `k` less a part of it."""
    inertia = Symmetric(*(a - b for a, b in zip(own.inertia, part.inertia, strict=True)))
    return Inertia(
        own.mass - part.mass,
        Vector(*(a - b for a, b in zip(own.moment, part.moment, strict=True))),
        definitions.symmetric(f"Im_{k}", inertia),
    )


def _seen_below(part: Inertia, joint: JointMotion, offset: Vector, definitions: Definitions) -> Inertia:
    """Return an inertia below the constant turns of a joint and about an origin `offset` before it.

    Moving turns leave a rod on the turning axis as it is.
    """
    name = f"{joint.body}r"
    for step in reversed(joint.steps):
        if not step.moves:
            part = part.down(step.turn, f"{name}{step.frame}", definitions)
    return part.shifted(offset, name, definitions)
