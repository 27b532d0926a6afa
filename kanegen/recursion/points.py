"""Points of the bodies, inertial components: positions, velocities, accelerations, partial velocities.

What belongs to a point can be turned inward joint by joint, or by the rotation of its body as a whole, which
costs more alone and less where it serves several points. Operations decide.
"""

from __future__ import annotations

from collections.abc import Iterator

from sympy import Expr, S

from kanegen.recursion.derived import Derived
from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion
from kanegen.recursion.joints import exact
from kanegen.recursion.motion import outward
from kanegen.recursion.poses import Pose, poses
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import add, cross, multiply, subtract, unit
from kanegen.recursion.velocities import angular_velocities, velocities
from kanegen.symbolic.definitions import Vector

MATRIX = 15
"""Operations that it takes to turn a vector by a rotation."""


def point_positions(tree: Tree) -> Derived:
    """{p_P} of every point, Eq. (22) one arm further."""
    entries: list[Expr] = []
    seen = _poses_that_pay(tree)
    for number, k, position in _points(tree):
        tree.about(k, f"position of point {number}")
        if seen:
            p = add(seen[k].origin, seen[k].inertial(position))
        else:
            p = position
            for motion in tree.inward(tree.motions[k - 1]):
                p = add(motion.arm, _below(tree, motion, p, f"pp_{number}"))
                p = tree.definitions.vector(f"pp_{number}_{motion.body}j", p)
        entries += tree.definitions.vector(f"pP_{number}", p)
    return Derived(entries)


def point_velocities(tree: Tree) -> Derived:
    """{v_P} = {v_O} + {omega} x {arm} of every point, Eq. (27)."""
    omega = angular_velocities(tree)
    velocity = velocities(tree, omega)
    found = {number: add(velocity[k], cross(omega[k], arm)) for number, k, arm in _arms(tree)}
    return _turned(tree, found, "vP", "velocity")


def point_accelerations(tree: Tree) -> Derived:
    """{a_P} of every point, without gravity, Eq. (33)."""
    moved = outward(tree, accelerated=True, weightless=True)
    found = {
        number: add(moved[k].acceleration, multiply(moved[k].field, arm)) for number, k, arm in _arms(tree)
    }
    return _turned(tree, found, "aP", "acceleration")


def point_jacobians(tree: Tree) -> Derived:
    """The partial velocities of every point by {y}, Eq. (32): (3, n), one point after the other."""
    n, seen = len(tree.system.freedoms), poses(tree)
    entries: list[Expr] = []
    for number, k, position in _points(tree):
        tree.about(k, f"partial velocities of point {number}")
        p = tree.definitions.vector(f"pP_{number}", add(seen[k].origin, seen[k].inertial(position)))
        columns: dict[int, Vector] = {}
        for motion in tree.inward(tree.motions[k - 1]):
            arm = subtract(p, seen[motion.body].origin)
            arm = tree.definitions.vector(f"rP_{number}_{motion.body}", arm)
            columns |= {freedom: cross(axis, arm) for freedom, axis in _axes(tree, motion, seen)}
            lower = seen[motion.lower]
            columns |= {slide.freedom: lower.inertial(slide.direction) for slide in motion.slides}
        for i in range(3):
            entries += [columns[freedom][i] if freedom in columns else S.Zero for freedom in range(n)]
    return Derived(entries)


def _axes(tree: Tree, motion: JointMotion, seen: list[Pose]) -> Iterator[tuple[int, Vector]]:
    """The freedoms that turn body K, and their axes in inertial components."""
    turned = seen[motion.body]
    for spin in motion.spins:
        yield spin.freedom, turned.inertial(unit(spin.axis))
    for place, step in enumerate(motion.angles):
        if step.freedom != NO_FREEDOM:
            axis = unit(step.axis)
            for outer in motion.angles[place + 1 :]:
                axis = outer.turn.up(axis)
            axis = tree.definitions.vector(f"n_{step.frame}", turned.inertial(axis))
            yield step.freedom, axis


def _points(tree: Tree) -> Iterator[tuple[int, int, Vector]]:
    """Of every point its number from 1, its body, and its position from O_K in K."""
    for number, (k, point) in enumerate(tree.system.points, start=1):
        yield number, k, Vector(*(exact(value) for value in point.position))


def _arms(tree: Tree) -> Iterator[tuple[int, int, Vector]]:
    """The same from the point that serves as the origin of K."""
    for number, k, position in _points(tree):
        arm = subtract(position, tree.motions[k - 1].origin)
        yield number, k, tree.definitions.vector(f"r_{k}p{number}", arm)


def _turned(tree: Tree, vectors: dict[int, Vector], name: str, what: str) -> Derived:
    """A vector of each point, seen from its body, in inertial components."""
    entries: list[Expr] = []
    seen = _poses_that_pay(tree)
    for number, k, _ in _points(tree):
        tree.about(k, f"{what} of point {number}")
        v = tree.definitions.vector(f"{name}_{number}", vectors[number])
        if seen:
            v = seen[k].inertial(v)
        else:
            for motion in tree.inward(tree.motions[k - 1]):
                v = _below(tree, motion, v, f"{name}_{number}")
        entries += v
    return Derived(entries)


def _below(tree: Tree, motion: JointMotion, v: Vector, name: str) -> Vector:
    """A vector through the turns of a joint."""
    for step in reversed(motion.steps):
        v = tree.definitions.vector(f"{name}_{step.frame}", step.turn.down(v))
    return v


def _poses_that_pay(tree: Tree) -> list[Pose]:
    """The poses of the bodies, where turning by them costs less than joint by joint; else none."""
    joints = [list(tree.inward(tree.motions[k - 1])) for _, k, _ in _points(tree)]
    inward = sum(motion.turning for path in joints for motion in path)
    turning = {motion.body: 3 * motion.turning for path in joints for motion in path}
    by_poses = sum(turning.values()) + MATRIX * len(joints)
    return poses(tree) if by_poses < inward else []
