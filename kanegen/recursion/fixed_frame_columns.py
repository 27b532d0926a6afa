"""Columns of [A] on long paths, kept in one fixed frame near the ground so that no joint has to turn them.

A column that passes many joints can keep its components in a fixed frame; its entries of [A] are then
products with the axes of the joints in that frame. Moments are still taken about one origin after the other,
so that no digits are lost to a distant origin. `bodies_that_save` counts beforehand, body by body, where this
saves operations. Costs are those of vectors without zeros, for one column and one joint. The axes of a joint
in the fixed frame follow from those of its lower body, so the selected bodies form a tree with the same root.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from sympy import Expr

from kanegen.recursion.columns import RotationColumn
from kanegen.recursion.joint_motion import JointMotion, Step
from kanegen.recursion.tree import Tree
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, count_nonzero, dot, unit
from kanegen.symbolic.definitions import Definitions, Vector

MATRIX_COST = 15
"""Operations of a matrix times a vector."""

SHIFT_COST = 12
"""Operations that shift a moment to another origin."""

DOT_COST = 5
"""Operations of a scalar product."""


@dataclass(frozen=True)
class Basis:
    """The basis vectors of the fixed frame in components of another frame."""

    vectors: tuple[Vector, Vector, Vector]

    def to_fixed(self, v: Vector) -> Vector:
        """Return the components of a vector in the fixed frame."""
        return Vector(*(dot(direction, v) for direction in self.vectors))

    def up(self, turn: Turn, frame: str, definitions: Definitions) -> Basis:
        """Return the basis in components of the frame above a turn."""
        x, y, z = (
            definitions.vector(f"E_{frame}_{i + 1}", turn.up(direction))
            for i, direction in enumerate(self.vectors)
        )
        return Basis((x, y, z))


@dataclass(frozen=True)
class FixedFrameJoint:
    """A joint and its body K, with vectors in components of the fixed frame.

    Attributes:
        body: Number of body K.
        basis: The fixed frame in components of K.
        axes: Axes of the rotations in the fixed frame, by number of the freedom.
        directions: Directions of the translations in the fixed frame, by number of the freedom.
        offset: Vector from the origin of the lower body to that of K in the fixed frame (m).
    """

    body: int
    basis: Basis
    axes: dict[int, Vector]
    directions: dict[int, Vector]
    offset: Vector

    def to_fixed(self, column: RotationColumn, definitions: Definitions) -> RotationColumn:
        """Return a column in components of the fixed frame, from its components in the frame of K."""
        force = definitions.vector(f"F_{column.label}_{self.body}h", self.basis.to_fixed(column.force))
        moment = definitions.vector(f"M_{column.label}_{self.body}h", self.basis.to_fixed(column.moment))
        return replace(column, force=force, moment=moment, shares={})

    def entries(self, column: RotationColumn, definitions: Definitions) -> dict[int, Expr]:
        """Return the entries of [A] in the rows of the joint's freedoms and in the column, by freedom."""
        values = {freedom: dot(axis, column.moment) for freedom, axis in self.axes.items()}
        values |= {freedom: dot(direction, column.force) for freedom, direction in self.directions.items()}
        return {b: definitions.define(f"A_{column.freedom}_{b}", value) for b, value in values.items()}


def fixed_frame_joints(tree: Tree) -> dict[int, FixedFrameJoint]:
    """Return the joints where columns change to the fixed frame, by body."""
    found: dict[int, FixedFrameJoint] = {}
    chosen = bodies_that_save(tree)
    for joint in tree.joints:
        if joint.body in chosen:
            tree.about(joint.body, "the joint seen from the frame of long columns of [A]")
            if joint.lower:
                found[joint.body] = _next(joint, found[joint.lower].basis, tree.definitions)
            else:
                found[joint.body] = _first(joint, tree)
    return found


def _first(joint: JointMotion, tree: Tree) -> FixedFrameJoint:
    """Return a joint on the ground in components of the fixed frame.

    The fixed frame is the one above the innermost angle, where the axes of two angles are basis vectors;
    where the speeds are an angular velocity, it is the frame of the body.
    """
    free = [i for i, step in enumerate(joint.steps) if step.shares]
    below = joint.steps if joint.angular_speeds else joint.steps[: free[0] + 1] if free else ()
    directions = {translation.number: translation.direction for translation in joint.translations}
    for step in below:
        for freedom, direction in directions.items():
            name = f"u_{freedom}_{step.frame}"
            directions[freedom] = tree.definitions.vector(name, step.turn.up(direction))
    axes = {step.number: unit(step.axis) for step in below if step.shares}
    seen = FixedFrameJoint(joint.body, Basis((unit(0), unit(1), unit(2))), axes, directions, ZERO)
    return _outward(seen, joint, joint.steps[len(below) :], tree.definitions)


def _next(joint: JointMotion, basis: Basis, definitions: Definitions) -> FixedFrameJoint:
    """Return a joint in components of the fixed frame, from the basis in the frame of the lower body."""
    k = joint.body
    directions = {
        translation.number: definitions.vector(
            f"u_{translation.number}h", basis.to_fixed(translation.direction)
        )
        for translation in joint.translations
    }
    offset = definitions.vector(f"d_{k}h", basis.to_fixed(joint.offset))
    return _outward(FixedFrameJoint(k, basis, {}, directions, offset), joint, joint.steps, definitions)


def _outward(
    seen: FixedFrameJoint, joint: JointMotion, steps: Iterable[Step], definitions: Definitions
) -> FixedFrameJoint:
    """Return the joint with the axes of its turns `steps` and with the basis above them."""
    axes, basis = dict(seen.axes), seen.basis
    for step in steps:
        if step.shares:
            axes[step.number] = basis.to_fixed(unit(step.axis))
        basis = basis.up(step.turn, f"{step.frame}u", definitions)
    axes |= {speed.number: basis.to_fixed(unit(speed.axis)) for speed in joint.angular_speeds}
    return replace(seen, axes=axes, basis=basis)


def bodies_that_save(tree: Tree) -> set[int]:
    """Return the bodies at which columns change to the fixed frame, chosen to save most operations.

    An inward pass computes the saving at every body, with all columns from outward or with those that have
    not changed further out. An outward pass selects bodies with a saving whose lower body is selected.
    """
    own = [_rotations(joint) for joint in tree.joints]
    outward = list(own)
    gains = [-_basis_cost(joint) for joint in tree.joints]
    saving: set[int] = set()
    for joint in reversed(tree.joints):
        k, j = joint.body, joint.lower
        each = _saved(tree, tree.joints[j - 1]) if j else 0
        without, with_basis = each * outward[k - 1], each * own[k - 1] + gains[k - 1]
        if with_basis > without:
            saving.add(k)
        if j:
            gains[j - 1] += max(without, with_basis)
            outward[j - 1] += outward[k - 1]
    reached: set[int] = set()
    for joint in tree.joints:
        if joint.body in saving and joint.lower in reached | {0}:
            reached.add(joint.body)
    return reached


def _saved(tree: Tree, joint: JointMotion) -> int:
    """Return the operations saved when one column from outward changes to the fixed frame at a joint."""
    here, *inward = tree.inward(joint)
    if not inward:
        return 0
    *between, first = inward
    saved = _pass_cost(here) - _entry_cost(here) - SHIFT_COST - 2 * MATRIX_COST
    for other in between:
        saved += _pass_cost(other) - DOT_COST * (_rotations(other) + len(other.translations)) - SHIFT_COST
    first_entries = 3 * (max(_rotations(first) - 2, 0) + max(len(first.translations) - 1, 0))
    return max(saved + _entry_cost(first) - first_entries, 0)


def _pass_cost(joint: JointMotion) -> int:
    """Return the operations that pass one column through a joint turn by turn."""
    force = min(joint.turn_cost, MATRIX_COST) if joint.translations else joint.turn_cost
    return joint.turn_cost + force + 4 * count_nonzero(joint.offset)


def _entry_cost(joint: JointMotion) -> int:
    """Return the operations for the entries of one fixed-frame column with a joint."""
    turns = len(joint.angles)
    return 3 * (turns * (turns - 1) // 2) + (joint.turn_cost if joint.translations else 0)


def _basis_cost(joint: JointMotion) -> int:
    """Return the operations that carry the basis of the fixed frame past a joint; few on the ground."""
    if joint.lower:
        return 3 * joint.turn_cost + MATRIX_COST
    return 3 * max(joint.turn_cost - SHIFT_COST, 0)


def _rotations(joint: JointMotion) -> int:
    """Return the number of rotations of a joint that {y} moves."""
    return len(joint.angular_speeds) + sum(bool(step.shares) for step in joint.steps)
