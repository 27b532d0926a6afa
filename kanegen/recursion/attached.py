"""Points that are fixed in a body: how they move, and vectors of bodies in inertial components.

A vector can be turned inward joint by joint, or by the rotation of its body as a whole, which costs more for
one vector and less where it serves several. The operation count decides.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from kanegen.recursion.body_motion import BodyMotion
from kanegen.recursion.joint_motion import FreedomMotion, JointMotion
from kanegen.recursion.kinematics import Pose, poses
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, multiply, scale, subtract, unit
from kanegen.symbolic.definitions import Vector

MATRIX_COST = 15
"""Operations of a rotation matrix times a vector."""


class _Kind(NamedTuple):
    """How comments and names call a kind of point."""

    label: str
    letter: str


_KINDS = {
    "point": _Kind("point", "P"),
    "frame": _Kind("the origin of frame", "f"),
    "contact": _Kind("contact", "c"),
}


@dataclass(frozen=True)
class Attached:
    """A point that is fixed in body K, or in the ground.

    Attributes:
        kind: "point" for a point of the model, "frame" for the origin of a frame, "contact" for what a
            contact holds.
        number: Its row in outputs, or the place of the contact, from 1.
        body: Number K, 0 for the ground.
        position: Position from O_K, in K (m).
    """

    kind: str
    number: int
    body: int
    position: Vector

    @property
    def label(self) -> str:
        """What it is, for comments."""
        return f"{_KINDS[self.kind].label} {self.number}"

    @property
    def letter(self) -> str:
        """The letter after that of the quantity in the names of its quantities."""
        return _KINDS[self.kind].letter

    def arm(self, tree: Tree) -> Vector:
        """Return its position from the origin that the recursions use, in K (m)."""
        origin = tree.joints[self.body - 1].origin if self.body else ZERO
        arm = subtract(self.position, origin)
        return tree.definitions.vector(f"r_{self.body}{self.letter.lower()}{self.number}", arm)


@dataclass(frozen=True)
class BodyVector:
    """A vector of a body that an output needs in inertial components.

    Attributes:
        body: Number of the body, 0 for the ground.
        name: Prefix of the names of its components.
        quantity: What it is, for comments.
        value: The vector, in components of the body.
    """

    body: int
    name: str
    quantity: str
    value: Vector


def velocity(tree: Tree, one: Attached, omega: Sequence[Vector], velocities: Sequence[Vector]) -> BodyVector:
    """Return the velocity of a point, {v_O} + {omega} x {r} with {r} from the origin, Eq. (27)."""
    value = add(velocities[one.body], cross(omega[one.body], one.arm(tree)))
    return BodyVector(one.body, f"v{one.letter}_{one.number}", f"velocity of {one.label}", value)


def acceleration(tree: Tree, one: Attached, motion: BodyMotion) -> BodyVector:
    """Return the acceleration of a point from the motion of its body, Eq. (33)."""
    value = add(motion.acceleration, multiply(motion.field, one.arm(tree)))
    return BodyVector(one.body, f"a{one.letter}_{one.number}", f"acceleration of {one.label}", value)


@dataclass(frozen=True)
class PartialVelocities:
    """Partial velocities by place in {y}, in inertial components; those of other freedoms are zero.

    Attributes:
        angular: Of the angular velocity of the body, Eq. (15).
        linear: Of the velocity of the point, Eq. (32).
    """

    angular: dict[int, Vector]
    linear: dict[int, Vector]

    def add(self, motion: FreedomMotion, angular: Vector, linear: Vector) -> None:
        """Add what a freedom moves to the partial velocities of the entries of {y} that move it."""
        for place, share in motion.shares.items():
            for found, velocity in ((self.angular, angular), (self.linear, linear)):
                found[place] = add(found.get(place, ZERO), scale(share, velocity))


def partial_velocities(tree: Tree, one: Attached, seen: Sequence[Pose]) -> PartialVelocities:
    """Return the partial velocities of a point and its body.

    Args:
        tree: The tree.
        one: The point.
        seen: Poses of the ground and of all bodies.
    """
    tree.about(one.body, f"partial velocities of {one.label}")
    pose, name = seen[one.body], f"{one.letter}_{one.number}"
    p = tree.definitions.vector(f"p{name}", add(pose.origin, pose.inertial(one.position)))
    found = PartialVelocities({}, {})
    for joint in path(tree, one.body):
        arm = tree.definitions.vector(f"r{name}_{joint.body}", subtract(p, seen[joint.body].origin))
        for turning, axis in _axes(tree, joint, seen):
            found.add(turning, axis, cross(axis, arm))
        for sliding in joint.translations:
            found.add(sliding, ZERO, seen[joint.lower].inertial(sliding.direction))
    return found


def _axes(tree: Tree, joint: JointMotion, seen: Sequence[Pose]) -> Iterator[tuple[FreedomMotion, Vector]]:
    """Yield the freedoms that rotate body K, with their axes in inertial components."""
    pose = seen[joint.body]
    for speed in joint.angular_speeds:
        yield speed, pose.inertial(unit(speed.axis))
    for place, step in enumerate(joint.angles):
        if step.shares:
            axis = unit(step.axis)
            for outer in joint.angles[place + 1 :]:
                axis = outer.turn.up(axis)
            axis = tree.definitions.vector(f"n_{step.frame}", pose.inertial(axis))
            yield step, axis


def inertial(tree: Tree, vectors: Sequence[BodyVector]) -> list[Vector]:
    """Return vectors of bodies in inertial components; one that occurs twice is turned once."""
    distinct = {(one.body, one.value): one for one in reversed(vectors)}
    seen = poses(tree) if poses_save(tree, [body for body, _ in distinct]) else []
    found: dict[tuple[int, Vector], Vector] = {}
    for one in (one for one in vectors if distinct[one.body, one.value] is one):
        tree.about(one.body, one.quantity)
        v = tree.definitions.vector(one.name, one.value)
        if seen:
            v = seen[one.body].inertial(v)
        else:
            for joint in path(tree, one.body):
                v = below(tree, joint, v, one.name)
        found[one.body, one.value] = v
    return [found[one.body, one.value] for one in vectors]


def below(tree: Tree, joint: JointMotion, v: Vector, name: str) -> Vector:
    """Return a vector of body K in components of the lower body."""
    for step in reversed(joint.steps):
        v = tree.definitions.vector(f"{name}_{step.frame}", step.turn.down(v))
    return v


def path(tree: Tree, k: int) -> list[JointMotion]:
    """Return the joints from body `k` inward to the ground."""
    return list(tree.inward(tree.joints[k - 1])) if k else []


def poses_save(tree: Tree, bodies: Sequence[int]) -> bool:
    """Return whether vectors of bodies cost less by [R_K] than joint by joint, one vector for each number."""
    paths = [path(tree, k) for k in bodies]
    by_joints = sum(joint.turn_cost for joints in paths for joint in joints)
    columns = {joint.body: 3 * joint.turn_cost for joints in paths for joint in joints}
    return sum(columns.values()) + MATRIX_COST * len(paths) < by_joints
