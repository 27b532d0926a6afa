"""Velocities of the bodies, outward: Eqs. (11) and (25), one turn at a time."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, scale, unit
from kanegen.symbolic.definitions import Vector


def angular_velocities(tree: Tree) -> list[Vector]:
    """{omega'_K} of the ground, 0, and of every body, each in its frame (rad/s)."""
    found = [ZERO]
    for motion in tree.motions:
        tree.about(motion.body, "angular velocity, Eq. (11)")
        omega = found[motion.lower]
        for step in motion.steps:
            turned = add(step.turn.up(omega), scale(step.rate, unit(step.axis)))
            omega = tree.definitions.vector(f"omega_{motion.above(step)}", turned)
        if motion.spins:
            omega = tree.definitions.vector(f"omega_{motion.body}", add(omega, motion.spinning))
        found.append(omega)
    return found


def velocities(tree: Tree, omega: Sequence[Vector]) -> list[Vector]:
    """Velocities of the origins of the ground, 0, and of every body, each in its frame (m/s)."""
    found = [ZERO]
    for motion in tree.motions:
        passing = relative_velocity(tree, motion, omega[motion.lower])
        tree.about(motion.body, "velocity of the origin, Eq. (25)")
        velocity = tree.definitions.vector(f"vo_{motion.body}j", add(found[motion.lower], passing))
        for step in motion.steps:
            velocity = tree.definitions.vector(f"vo_{motion.above(step)}", step.turn.up(velocity))
        found.append(velocity)
    return found


def relative_velocity(tree: Tree, motion: JointMotion, omega: Vector) -> Vector:
    """Velocity of the origin of K less that of J, in J (m/s).

    Args:
        tree: Its definitions take the intermediates.
        motion: The joint of K.
        omega: Angular velocity of J.
    """
    tree.about(motion.body, "velocity of the origin on the lower body, Eq. (25)")
    turning = cross(omega, motion.offset)
    return tree.definitions.vector(f"vr_{motion.body}", add(turning, sliding_velocity(tree, motion)))


def sliding_velocity(tree: Tree, motion: JointMotion) -> Vector:
    """What the translations of a joint make of it (m/s)."""
    total = ZERO
    for slide in motion.sliding:
        total = add(total, scale(slide.rate, slide.direction))
    return tree.definitions.vector(f"v_{motion.body}", total)
