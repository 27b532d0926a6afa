"""Joints as CasADi expressions, and the transformations of every recursion at a joint.

Vectors have three components in the frame of their body. CasADi itself removes products with zero.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import casadi
import numpy as np
from casadi import SX

from kanegen.model.arrays import Floats
from kanegen.studies.bench.peers.joints import KINDS, Joint


@dataclass(frozen=True)
class Moved:
    """A joint with one freedom at the value of its coordinate, and the body beyond it.

    Attributes:
        parent: Number of the joint before this one, from 1; 0 is the ground.
        column: Index of the coordinate in {x}.
        angle: Whether the joint turns rather than slides.
        axis: (3, 1) axis, with the same components in both frames.
        rotation: (3, 3) matrix from components in the frame of the joint to those in the frame before it.
        position: (3, 1) origin of the joint in the frame before it (m).
        mass: Mass of the body (kg).
        moment: (3, 1) first moment of the body in the frame of the joint (kg m).
        inertia: (3, 3) inertia of the body about the origin of the joint (kg m^2).
        armature: Reflected inertia of the motor of the joint (kg m^2, kg).
    """

    parent: int
    column: int
    angle: bool
    axis: SX
    rotation: SX
    position: SX
    mass: SX
    moment: SX
    inertia: SX
    armature: SX

    def own(self, moment: SX, force: SX) -> SX:
        """Return the generalized force of a moment and a force in the direction of the freedom."""
        return casadi.dot(self.axis, moment if self.angle else force)

    def inward(self, moment: SX, force: SX) -> tuple[SX, SX]:
        """Transform a moment and a force to the frame before the joint."""
        force = self.rotation @ force
        return self.rotation @ moment + casadi.cross(self.position, force), force

    def outward(self, lower: Motion, speed: SX) -> Motion:
        """Return the motion beyond the joint at a constant speed of its freedom."""
        arm, velocity, rate = self.position, lower.velocity, lower.rate
        acceleration = lower.acceleration + casadi.cross(rate, arm)
        acceleration += casadi.cross(velocity, casadi.cross(velocity, arm))
        velocity, rate, acceleration = (self.rotation.T @ v for v in (velocity, rate, acceleration))
        own = self.axis * speed
        if self.angle:
            return Motion(velocity + own, rate + casadi.cross(velocity, own), acceleration)
        return Motion(velocity, rate, acceleration + 2 * casadi.cross(velocity, own))

    def accelerated(self, motion: Motion, value: SX) -> Motion:
        """Return a motion beyond the joint to which an acceleration of its freedom is added."""
        own = self.axis * value
        if self.angle:
            return Motion(motion.velocity, motion.rate + own, motion.acceleration)
        return Motion(motion.velocity, motion.rate, motion.acceleration + own)


@dataclass(frozen=True)
class Motion:
    """The motion of a frame: angular velocity, its rate, and the acceleration of the origin, (3, 1) each."""

    velocity: SX
    rate: SX
    acceleration: SX


Tree = Sequence[Moved]


def moved(joints: Sequence[Joint], x: SX) -> Tree:
    """Return all joints, with one freedom each, at the coordinates {x}."""
    return [_moved(joint, x[joint.columns[0]]) for joint in joints]


def below(tree: Tree, at: Moved) -> Iterator[Moved]:
    """Yield the joints between `at` and the ground."""
    while at.parent:
        at = tree[at.parent - 1]
        yield at


def _moved(joint: Joint, value: SX) -> Moved:
    """Return a joint with one freedom at a value of its coordinate."""
    index = KINDS.index(joint.kind)
    axis, placement, body = np.eye(3)[index % 3], joint.placement, joint.body
    angle = index < 3
    rotation = placement.rotation @ _turn(index, value) if angle else placement.rotation
    position = placement.position if angle else placement.position + placement.rotation @ SX(axis) * value
    return Moved(
        joint.parent,
        joint.columns[0],
        angle,
        _sparse(axis),
        _sparse(rotation),
        _sparse(position),
        SX(body.mass),
        _sparse(body.moment),
        _sparse(body.inertia),
        _sparse(np.array(joint.armature)),
    )


def _sparse(values: Floats | SX) -> SX:
    """Return values as an expression in which zeros are structural."""
    return casadi.sparsify(SX(values))


def _turn(axis: int, angle: SX) -> SX:
    """Return the rotation by an angle about basis vector `axis`."""
    sine, cosine = casadi.sin(angle), casadi.cos(angle)
    one, two = (axis + 1) % 3, (axis + 2) % 3
    turn = SX(3, 3)
    turn[axis, axis] = 1
    turn[one, one] = turn[two, two] = cosine
    turn[two, one], turn[one, two] = sine, -sine
    return turn
