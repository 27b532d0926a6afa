"""The output of gravity alone: the weights of composite bodies along the freedoms that move them.

With every joint outward of a freedom locked, the bodies that the freedom carries weigh m {g} at their common
mass centre. The generalized force is therefore {b} . m {g} for a translation along {b}, and {a} . {h} x {g}
for a rotation about {a}, where {h} is their first moment about a point of the axis. No motion enters, and the
first moments are those of [A] and of the mass centre.

First moments are passed inward only as far as a torque needs them. Where the axis of a hinge is parallel to
that of the next hinge inward, the torque about it is a part of the torque about the next one as it is; and
gravity has no torque about an axis along it, such as the vertical first axis of an arm.
"""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Expr, S

from kanegen.recursion.constants import exact
from kanegen.recursion.inverse_dynamics import at_free
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import ZERO, add, cross, dot, scale, unit
from kanegen.symbolic.definitions import Vector

Fields = Sequence[tuple[Vector, ...]]
"""{g} by body in the frame below each turn of its joint, then in its own frame (m/s^2); 0 is the ground."""


def gravity_forces(tree: Tree) -> Derived:
    """Derive the part of {f} that gravity causes, the sum of [v_G,y]^T m {g} over all bodies, Eq. (44)."""
    weighing = _Weighing(tree)
    for joint in reversed(tree.joints):
        tree.about(joint.body, "weight of all that it carries, along its freedoms")
        weighing.weigh(joint)
    return Derived(at_free(tree, weighing.efforts))


class _Weighing:
    """The weights of composite bodies, joint by joint inward.

    Attributes:
        efforts: Generalized forces by number of the freedom.
    """

    def __init__(self, tree: Tree) -> None:
        self._tree = tree
        self._fields = _fields(tree)
        self._parallel = _only_as_torques(tree, self._fields)
        self._masses = [S.Zero, *(own.mass for own in tree.inertias)]
        self._moments = [ZERO, *(own.moment for own in tree.inertias)]
        self._torques: list[Expr] = [S.Zero for _ in self._masses]
        self.efforts: dict[int, Expr] = {}

    def weigh(self, joint: JointMotion) -> None:
        """Record the weight of what a body carries along the freedoms of its joint, and pass it inward."""
        k, j, definitions = joint.body, joint.lower, self._tree.definitions
        moments = [self._moments[k]]
        for step in reversed(joint.steps):
            moments.insert(0, definitions.vector(f"hc_{step.frame}", step.turn.down(moments[0])))
        torques = [cross(h, g) for h, g in zip(moments, self._fields[k], strict=True)]
        # The torque about a turn is the same in the frames below and above it. Below it a leaf needs no {g}
        # of its own; above it a first moment that is not passed inward need not be turned.
        above = 0 if j and k not in self._parallel else 1
        for i, step in enumerate(joint.steps):
            if step.moves:
                self.efforts[step.number] = torques[i + above][step.axis] + self._torques[k]
        for speed in joint.angular_speeds:
            self.efforts[speed.number] = torques[-1][speed.axis]
        for one in joint.moving_translations:
            self.efforts[one.number] = self._masses[k] * dot(one.direction, self._fields[k][0])
        if j:
            self._pass(joint, moments[0])

    def _pass(self, joint: JointMotion, moment: Vector) -> None:
        """Add a composite body to the lower one, with its first moment or with its torque."""
        k, j, definitions = joint.body, joint.lower, self._tree.definitions
        if k in self._parallel:
            (step,) = joint.angles
            torque = definitions.define(f"fg_{step.number}", self.efforts[step.number])
            self._torques[j] += self._parallel[k] * torque
            moment = ZERO
        shifted = definitions.vector(f"hc_{k}j", add(moment, scale(self._masses[k], joint.offset)))
        self._masses[j] = definitions.define(f"mc_{j}", self._masses[j] + self._masses[k])
        self._moments[j] = definitions.vector(f"hc_{j}", add(self._moments[j], shifted))


def _only_as_torques(tree: Tree, fields: Fields) -> dict[int, Expr]:
    """Return the bodies whose first moment no torque further inward needs, if their own torque is known.

    Returns:
        Factor of the torque about the hinge of a body in that about the hinge of its lower body, by body.
    """
    found: dict[int, Expr] = {}
    needing: set[int] = set()
    for joint in tree.joints:
        if not joint.lower:
            continue
        lower = tree.joints[joint.lower - 1]
        if factor := _parallel(joint, lower):
            found[joint.body] = factor
        if joint.lower in needing or (not factor and _has_torque(lower, fields)):
            needing.add(joint.body)
    return {k: factor for k, factor in found.items() if k not in needing}


def _parallel(joint: JointMotion, lower: JointMotion) -> Expr:
    """Return 1 or -1 where the axes of two successive hinges are parallel, else 0."""
    if not joint.hinge or not lower.hinge:
        return S.Zero
    factor = joint.down_from(joint.hinge, unit(joint.hinge.axis))[lower.hinge.axis]
    return factor if factor in (-1, 1) else S.Zero


def _has_torque(joint: JointMotion, fields: Fields) -> bool:
    """Return whether gravity may have a torque about an axis of a joint."""
    if joint.hinge:
        return cross(unit(joint.hinge.axis), fields[joint.body][-1]) != ZERO
    return joint.rotates


def _fields(tree: Tree) -> Fields:
    """Return {g} in the frames of all joints."""
    found: list[tuple[Vector, ...]] = [(Vector(*(exact(value) for value in tree.system.gravity)),)]
    for joint in tree.joints:
        tree.about(joint.body, "gravity")
        field = [found[joint.lower][-1]]
        for step in joint.steps:
            field.append(tree.definitions.vector(f"g_{joint.above(step)}", step.turn.up(field[-1])))
        found.append(tuple(field))
    return found
