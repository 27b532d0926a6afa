"""Joints as CasADi expressions, and what every recursion does at a joint.

Vectors of three, in the frame of each body. CasADi itself removes what is multiplied by zero.
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
    """A joint with one freedom at its coordinate, and the body beyond it.

    Attributes:
        parent: Number of the joint before, from 1; 0 is the ground.
        column: Place in {x}.
        angle: Whether it turns rather than slides.
        axis: (3, 1), the same on both sides.
        rotation: R, components of its frame into those of the frame before.
        position: Its origin in the frame before (m).
        mass: kg.
        moment: kg m, in its frame.
        inertia: kg m^2, about its origin.
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

    def own(self, moment: SX, force: SX) -> SX:
        """What a moment and a force do along the freedom."""
        return casadi.dot(self.axis, moment if self.angle else force)

    def inward(self, moment: SX, force: SX) -> tuple[SX, SX]:
        """A moment and a force in the frame before."""
        force = self.rotation @ force
        return self.rotation @ moment + casadi.cross(self.position, force), force

    def outward(self, lower: Motion, speed: SX) -> Motion:
        """The motion beyond the joint, whose speed is constant."""
        arm, velocity, rate = self.position, lower.velocity, lower.rate
        acceleration = lower.acceleration + casadi.cross(rate, arm)
        acceleration += casadi.cross(velocity, casadi.cross(velocity, arm))
        velocity, rate, acceleration = (self.rotation.T @ v for v in (velocity, rate, acceleration))
        own = self.axis * speed
        if self.angle:
            return Motion(velocity + own, rate + casadi.cross(velocity, own), acceleration)
        return Motion(velocity, rate, acceleration + 2 * casadi.cross(velocity, own))


@dataclass(frozen=True)
class Motion:
    """Angular velocity, its rate, and the acceleration of the origin, in the body's frame."""

    velocity: SX
    rate: SX
    acceleration: SX


Tree = Sequence[Moved]


def moved(joints: Sequence[Joint], x: SX) -> Tree:
    """Every joint of `joints` (single freedoms) at {x}."""
    return [_moved(joint, x[joint.columns[0]]) for joint in joints]


def below(tree: Tree, at: Moved) -> Iterator[Moved]:
    """The joints between `at` and the ground."""
    while at.parent:
        at = tree[at.parent - 1]
        yield at


def _moved(joint: Joint, value: SX) -> Moved:
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
    )


def _sparse(values: Floats | SX) -> SX:
    return casadi.sparsify(SX(values))


def _turn(axis: int, angle: SX) -> SX:
    sine, cosine = casadi.sin(angle), casadi.cos(angle)
    one, two = (axis + 1) % 3, (axis + 2) % 3
    turn = SX(3, 3)
    turn[axis, axis] = 1
    turn[one, one] = turn[two, two] = cosine
    turn[two, one], turn[one, two] = sine, -sine
    return turn
