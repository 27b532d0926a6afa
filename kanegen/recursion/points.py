"""Outputs about points, in inertial components: positions, velocities, accelerations, Jacobians.

A vector of a point can be turned inward joint by joint, or by the rotation of its body as a whole, which
costs more for one point and less where it serves several. The operation count decides.
"""

from __future__ import annotations

from collections.abc import Iterator

from sympy import Expr, S

from kanegen.recursion.frames import position_of
from kanegen.recursion.inverse_dynamics import body_motions
from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion
from kanegen.recursion.kinematics import Pose, angular_velocities, poses, velocities
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import add, cross, multiply, subtract, unit
from kanegen.symbolic.definitions import Vector

MATRIX_COST = 15
"""Operations of a rotation matrix times a vector."""


def point_positions(tree: Tree) -> Derived:
    """Derive {p_P} of every point, Eq. (22) with the point in place of an origin."""
    entries: list[Expr] = []
    seen = _poses_that_save(tree)
    for number, k, position in _points(tree):
        tree.about(k, f"position of point {number}")
        if seen:
            p = add(seen[k].origin, seen[k].inertial(position))
        else:
            p = position
            for joint in tree.inward(tree.joints[k - 1]):
                p = add(joint.arm, _below(tree, joint, p, f"pp_{number}"))
                p = tree.definitions.vector(f"pp_{number}_{joint.body}j", p)
        entries += tree.definitions.vector(f"pP_{number}", p)
    return Derived(entries)


def point_velocities(tree: Tree) -> Derived:
    """Derive {v_P} = {v_O} + {omega} x {r} of every point at {r} from the origin, Eq. (27)."""
    omega = angular_velocities(tree)
    velocity = velocities(tree, omega)
    found = {number: add(velocity[k], cross(omega[k], arm)) for number, k, arm in _arms(tree)}
    return _inertial(tree, found, "vP", "velocity")


def point_accelerations(tree: Tree) -> Derived:
    """Derive {a_P} of every point, without gravity, Eq. (33)."""
    moved = body_motions(tree, accelerated=True, weightless=True)
    found = {
        number: add(moved[k].acceleration, multiply(moved[k].field, arm)) for number, k, arm in _arms(tree)
    }
    return _inertial(tree, found, "aP", "acceleration")


def point_jacobians(tree: Tree) -> Derived:
    """Derive the partial velocities of every point by {y}, Eq. (32): (3, n), one point after the other."""
    n, seen = len(tree.system.freedoms), poses(tree)
    entries: list[Expr] = []
    for number, k, position in _points(tree):
        tree.about(k, f"partial velocities of point {number}")
        p = tree.definitions.vector(f"pP_{number}", add(seen[k].origin, seen[k].inertial(position)))
        columns: dict[int, Vector] = {}
        for joint in tree.inward(tree.joints[k - 1]):
            arm = subtract(p, seen[joint.body].origin)
            arm = tree.definitions.vector(f"rP_{number}_{joint.body}", arm)
            columns |= {freedom: cross(axis, arm) for freedom, axis in _axes(tree, joint, seen)}
            lower = seen[joint.lower]
            columns |= {one.freedom: lower.inertial(one.direction) for one in joint.translations}
        for i in range(3):
            entries += [columns[freedom][i] if freedom in columns else S.Zero for freedom in range(n)]
    return Derived(entries)


def _axes(tree: Tree, joint: JointMotion, seen: list[Pose]) -> Iterator[tuple[int, Vector]]:
    """Yield the freedoms that rotate body K, with their axes in inertial components."""
    pose = seen[joint.body]
    for speed in joint.angular_speeds:
        yield speed.freedom, pose.inertial(unit(speed.axis))
    for place, step in enumerate(joint.angles):
        if step.freedom != NO_FREEDOM:
            axis = unit(step.axis)
            for outer in joint.angles[place + 1 :]:
                axis = outer.turn.up(axis)
            axis = tree.definitions.vector(f"n_{step.frame}", pose.inertial(axis))
            yield step.freedom, axis


def _points(tree: Tree) -> Iterator[tuple[int, int, Vector]]:
    """Yield number, from 1, body, and position from O_K in K (m) of every point."""
    for number, (k, point) in enumerate(tree.system.points, start=1):
        yield number, k, position_of(tree, k, point)


def _arms(tree: Tree) -> Iterator[tuple[int, int, Vector]]:
    """Yield number, body, and position from the origin of the body in K (m) of every point."""
    for number, k, position in _points(tree):
        arm = subtract(position, tree.joints[k - 1].origin)
        yield number, k, tree.definitions.vector(f"r_{k}p{number}", arm)


def _inertial(tree: Tree, vectors: dict[int, Vector], name: str, quantity: str) -> Derived:
    """Derive the inertial components of one vector for each point, given in the frame of its body."""
    entries: list[Expr] = []
    seen = _poses_that_save(tree)
    for number, k, _ in _points(tree):
        tree.about(k, f"{quantity} of point {number}")
        v = tree.definitions.vector(f"{name}_{number}", vectors[number])
        if seen:
            v = seen[k].inertial(v)
        else:
            for joint in tree.inward(tree.joints[k - 1]):
                v = _below(tree, joint, v, f"{name}_{number}")
        entries += v
    return Derived(entries)


def _below(tree: Tree, joint: JointMotion, v: Vector, name: str) -> Vector:
    """Return a vector of body K in components of the lower body."""
    for step in reversed(joint.steps):
        v = tree.definitions.vector(f"{name}_{step.frame}", step.turn.down(v))
    return v


def _poses_that_save(tree: Tree) -> list[Pose]:
    """Return the poses of the bodies if vectors cost less by [R_K] than joint by joint; else none."""
    paths = [list(tree.inward(tree.joints[k - 1])) for _, k, _ in _points(tree)]
    by_joints = sum(joint.turn_cost for path in paths for joint in path)
    columns = {joint.body: 3 * joint.turn_cost for path in paths for joint in path}
    by_poses = sum(columns.values()) + MATRIX_COST * len(paths)
    return poses(tree) if by_poses < by_joints else []
