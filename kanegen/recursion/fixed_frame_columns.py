"""Columns of [A] on long paths, kept in one fixed frame near the ground so that no joint has to turn them.

A column that passes many joints can keep its components in a fixed frame; its entries of [A] are then
products with the axes of the joints in that frame. The axes of a joint in the fixed frame follow from those
of its lower body, so the bodies where columns change to the fixed frame form a tree with the same root.

A moment is taken about the point O_K of a body K, or it stays about that of a body further outward that the
column has passed. The entry of an axis {u} through a point at {p} from there is then
{u}.{M} + ({p} x {u}).{F}, where {p} x {u} is the same for all columns about one point. `fixed_frame_choice`
chooses bodies and points so that operations are saved. Where rotations are about the mass centre of a body,
it takes the place of O_K; see `tree.about_mass_centers`.

All these points are on the path of their columns, which leads from O_K to O_K: no lever arm is longer than
the path, so that no digits are lost to a distant point. The point that `JointMotion` has as origin may be far
from O_K on the axis of a hinge. Where columns turn with their joints, the component about the axis has no
share of that distance, but in the fixed frame it would.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from sympy import Expr

from kanegen.recursion.columns import RotationColumn
from kanegen.recursion.fixed_frame_choice import FixedFrameChoice, choose
from kanegen.recursion.joint_motion import JointMotion, Step
from kanegen.recursion.tree import Tree
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, add, cross, dot, negate, subtract, unit
from kanegen.symbolic.definitions import Definitions, Vector


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
        arm: Vector from O_J of the lower body J to O_K in the fixed frame (m).
        origin: Vector from O_K to the origin of columns that have not changed to the fixed frame, in K (m).
        points: Vectors from O_K to the points O about which columns arrive, by body, in the fixed frame (m).
        kept: Number of the body about whose point O columns stay that arrive about it; 0 if there is none.
        lever_arms: Moments of the axes of the rotations about that point, by number of the freedom (m).
    """

    body: int
    basis: Basis
    axes: dict[int, Vector]
    directions: dict[int, Vector]
    arm: Vector
    origin: Vector
    points: Mapping[int, Vector] = field(default_factory=dict)
    kept: int = 0
    lever_arms: Mapping[int, Vector] = field(default_factory=dict)

    def to_fixed(self, column: RotationColumn, definitions: Definitions) -> RotationColumn:
        """Return a column about O_K in the fixed frame, from the column about the origin of K, in K."""
        column = column.shifted(self.origin, f"{self.body}o", definitions)
        force = definitions.vector(f"F_{column.label}_{self.body}h", self.basis.to_fixed(column.force))
        moment = definitions.vector(f"M_{column.label}_{self.body}h", self.basis.to_fixed(column.moment))
        return replace(column, force=force, moment=moment, shares={})

    def entries(self, column: RotationColumn, definitions: Definitions) -> dict[int, Expr]:
        """Return the entries of [A] of the joint's freedoms, by freedom, in a column about O_K."""
        values = {freedom: dot(axis, column.moment) for freedom, axis in self.axes.items()}
        return self._defined(values, column, definitions)

    def entries_of_kept(self, column: RotationColumn, definitions: Definitions) -> dict[int, Expr]:
        """Return the entries of [A] of the joint's freedoms, by freedom, in a column about the point kept."""
        values = {
            freedom: dot(axis, column.moment) + dot(self.lever_arms[freedom], column.force)
            for freedom, axis in self.axes.items()
        }
        return self._defined(values, column, definitions)

    def _defined(
        self, values: Mapping[int, Expr], column: RotationColumn, definitions: Definitions
    ) -> dict[int, Expr]:
        """Return entries of rotations with those of the translations, by freedom, each with a symbol."""
        forces = {freedom: dot(direction, column.force) for freedom, direction in self.directions.items()}
        every = {**values, **forces}
        return {b: definitions.define(f"A_{column.freedom}_{b}", value) for b, value in every.items()}


def fixed_frame_joints(tree: Tree) -> dict[int, FixedFrameJoint]:
    """Return the joints where columns change to the fixed frame, by body."""
    found: dict[int, FixedFrameJoint] = {}
    choice = choose(tree)
    for joint in tree.joints:
        if joint.body in choice.bodies:
            tree.about(joint.body, "the joint seen from the frame of long columns of [A]")
            if joint.lower:
                found[joint.body] = _next(joint, found[joint.lower].basis, tree)
            else:
                found[joint.body] = _first(joint, tree)
    _add_points(found, choice, tree)
    return found


def _add_points(found: dict[int, FixedFrameJoint], choice: FixedFrameChoice, tree: Tree) -> None:
    """Add to joints the points about which columns arrive, and the one of those that stay about it."""
    definitions = tree.definitions
    for joint in reversed(tree.joints):
        k, j = joint.body, joint.lower
        if (seen := found.get(k)) is None:
            continue
        arriving = {k: seen.arm}
        if kept := choice.kept.get(k, 0):
            tree.about(k, f"the joint seen from body {kept}, for columns of [A] about its point O")
            seen = found[k] = _keeping(seen, kept, definitions)
            arriving[kept] = definitions.vector(f"d_{j}_{kept}h", add(seen.points[kept], seen.arm))
        if j:
            found[j] = replace(found[j], points={**found[j].points, **arriving})


def _keeping(seen: FixedFrameJoint, kept: int, definitions: Definitions) -> FixedFrameJoint:
    """Return a joint at which columns stay about the point O of body `kept`."""
    away = negate(seen.points[kept])
    lever_arms = {
        number: definitions.vector(f"l_{number}_{kept}h", cross(away, axis))
        for number, axis in seen.axes.items()
    }
    return replace(seen, kept=kept, lever_arms=lever_arms)


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
    seen = FixedFrameJoint(
        joint.body, Basis((unit(0), unit(1), unit(2))), axes, directions, ZERO, joint.origin
    )
    return _outward(seen, joint, joint.steps[len(below) :], tree.definitions)


def _next(joint: JointMotion, basis: Basis, tree: Tree) -> FixedFrameJoint:
    """Return a joint in components of the fixed frame, from the basis in the frame of the lower body."""
    k, definitions = joint.body, tree.definitions
    directions = {
        translation.number: definitions.vector(
            f"u_{translation.number}h", basis.to_fixed(translation.direction)
        )
        for translation in joint.translations
    }
    arm = basis.to_fixed(subtract(joint.arm, tree.joints[joint.lower - 1].to_center))
    arm = definitions.vector(f"q_{k}h", arm)
    seen = FixedFrameJoint(k, basis, {}, directions, arm, _origin(joint))
    return _outward(seen, joint, joint.steps, definitions)


def _origin(joint: JointMotion) -> Vector:
    """Return the origin of columns in the frame of a body from the point for those in the fixed frame."""
    return subtract(joint.origin, joint.to_center)


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
