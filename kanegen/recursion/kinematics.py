"""Rotations, origins and velocities of the bodies, outward: Eqs. (3), (11), (22) and (25)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sympy import Expr

from kanegen.recursion.frames import FixedFrame, fixed_frame
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import ZERO, Rows, add, count_nonzero, cross, dot, scale, unit
from kanegen.symbolic.definitions import AXES, Definitions, Vector

CROSS_COST = 9
"""Operations of a vector product."""


@dataclass(frozen=True)
class Pose:
    """Rotation and origin of a body K, or of a frame that is fixed in a body.

    Attributes:
        columns: Columns of [R_K]: the inertial basis vectors in components of K.
        origin: Position {p_O_K}, inertial components (m).
    """

    columns: Rows
    origin: Vector

    def inertial(self, v: Vector) -> Vector:
        """Return a vector of K in inertial components."""
        return Vector(*(dot(direction, v) for direction in self.columns))


def poses(tree: Tree) -> list[Pose]:
    """Return the pose of the ground, then that of every body."""
    found = [Pose((unit(0), unit(1), unit(2)), ZERO)]
    for joint in tree.joints:
        lower = found[joint.lower]
        tree.about(joint.body, "rotation and origin, Eqs. (3), (22)")
        away = add(lower.origin, lower.inertial(joint.arm))
        origin = tree.definitions.vector(f"pO_{joint.body}", away)
        found.append(Pose(_columns(lower.columns, joint, tree.definitions), origin))
    return found


def body_poses(tree: Tree) -> Derived:
    """Derive the rows of [R], then the origin, of every frame that is selected; inertial components."""
    entries: list[Expr] = []
    seen = poses(tree)
    for frame in tree.system.pose_frames:
        pose = in_frame(seen[frame.body], fixed_frame(tree, frame.name, frame.body))
        entries += [direction[row] for row in range(3) for direction in pose.columns]
        entries += pose.origin
    return Derived(entries)


def in_frame(pose: Pose, frame: FixedFrame) -> Pose:
    """Return the pose of a frame that is fixed in the body of a pose."""
    x, y, z = (frame.outward(direction) for direction in pose.columns)
    return Pose((x, y, z), add(pose.origin, pose.inertial(frame.origin)))


def _columns(lower: Rows, joint: JointMotion, definitions: Definitions) -> Rows:
    """Return the inertial basis vectors above a joint; the third from the others where that costs less."""
    is_full = all(count_nonzero(direction) == len(AXES) for direction in lower)
    by_product = joint.turn_cost > CROSS_COST and is_full
    x, y, *others = (
        _up(direction, f"N{axis.upper()}", joint, definitions)
        for axis, direction in zip(AXES, lower[: 2 if by_product else 3], strict=False)
    )
    z = others[0] if others else definitions.vector(f"NZ_{joint.body}", cross(x, y))
    return x, y, z


def _up(v: Vector, name: str, joint: JointMotion, definitions: Definitions) -> Vector:
    """Return a vector in components of the body above a joint, from its components in the lower body."""
    for step in joint.steps:
        v = definitions.vector(f"{name}_{joint.above(step)}", step.turn.up(v))
    return v


def angular_velocities(tree: Tree) -> list[Vector]:
    """Return {omega'_K} of the ground, then of every body, each in its frame (rad/s)."""
    found = [ZERO]
    for joint in tree.joints:
        tree.about(joint.body, "angular velocity, Eq. (11)")
        omega = found[joint.lower]
        for step in joint.steps:
            turned = add(step.turn.up(omega), scale(step.rate, unit(step.axis)))
            omega = tree.definitions.vector(f"omega_{joint.above(step)}", turned)
        if joint.angular_speeds:
            omega = tree.definitions.vector(f"omega_{joint.body}", add(omega, joint.relative_omega))
        found.append(omega)
    return found


def velocities(tree: Tree, omega: Sequence[Vector]) -> list[Vector]:
    """Return the velocity of the origin of the ground, then of every body, each in its frame (m/s)."""
    found = [ZERO]
    for joint in tree.joints:
        passing = relative_velocity(tree, joint, omega[joint.lower])
        tree.about(joint.body, "velocity of the origin, Eq. (25)")
        velocity = tree.definitions.vector(f"vo_{joint.body}j", add(found[joint.lower], passing))
        for step in joint.steps:
            velocity = tree.definitions.vector(f"vo_{joint.above(step)}", step.turn.up(velocity))
        found.append(velocity)
    return found


def relative_velocity(tree: Tree, joint: JointMotion, omega: Vector) -> Vector:
    """Return the velocity of the origin of K less that of J, in J (m/s).

    Args:
        tree: The tree.
        joint: The joint of K.
        omega: Angular velocity of J, in J (rad/s).
    """
    tree.about(joint.body, "velocity of the origin on the lower body, Eq. (25)")
    turning = cross(omega, joint.offset)
    return tree.definitions.vector(f"vr_{joint.body}", add(turning, translation_velocity(tree, joint)))


def translation_velocity(tree: Tree, joint: JointMotion) -> Vector:
    """Return the velocity that the translations of a joint cause, in J (m/s)."""
    total = ZERO
    for translation in joint.moving_translations:
        total = add(total, scale(translation.rate, translation.direction))
    return tree.definitions.vector(f"v_{joint.body}", total)
