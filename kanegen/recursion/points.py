"""Outputs about points, in inertial components: positions, velocities, accelerations, Jacobians."""

from __future__ import annotations

from sympy import Expr, S

from kanegen.recursion.attached import (
    Attached,
    acceleration,
    below,
    inertial,
    partial_velocities,
    path,
    poses_save,
    velocity,
)
from kanegen.recursion.body_motion import body_motions
from kanegen.recursion.frames import position_of
from kanegen.recursion.kinematics import angular_velocities, poses, velocities
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import add


def point_positions(tree: Tree) -> Derived:
    """Derive {p_P} of every point, Eq. (22) with the point in place of an origin."""
    entries: list[Expr] = []
    points = _points(tree)
    seen = poses(tree) if poses_save(tree, [one.body for one in points]) else []
    for one in points:
        tree.about(one.body, f"position of {one.label}")
        if seen:
            p = add(seen[one.body].origin, seen[one.body].inertial(one.position))
        else:
            p = one.position
            for joint in path(tree, one.body):
                p = add(joint.arm, below(tree, joint, p, f"pp_{one.number}"))
                p = tree.definitions.vector(f"pp_{one.number}_{joint.body}j", p)
        entries += tree.definitions.vector(f"pP_{one.number}", p)
    return Derived(entries)


def point_velocities(tree: Tree) -> Derived:
    """Derive {v_P} of every point, Eq. (27)."""
    omega = angular_velocities(tree)
    of_origins = velocities(tree, omega)
    vectors = [velocity(tree, one, omega, of_origins) for one in _points(tree)]
    return Derived([entry for v in inertial(tree, vectors) for entry in v])


def point_accelerations(tree: Tree) -> Derived:
    """Derive {a_P} of every point, without gravity, Eq. (33)."""
    moved = body_motions(tree, accelerated=True, weightless=True)
    vectors = [acceleration(tree, one, moved[one.body]) for one in _points(tree)]
    return Derived([entry for v in inertial(tree, vectors) for entry in v])


def point_jacobians(tree: Tree) -> Derived:
    """Derive the partial velocities of every point by {y}, Eq. (32): (3, n), one point after the other."""
    n, seen = len(tree.system.freedoms), poses(tree)
    entries: list[Expr] = []
    for one in _points(tree):
        columns = partial_velocities(tree, one, seen).linear
        for i in range(3):
            entries += [columns[freedom][i] if freedom in columns else S.Zero for freedom in range(n)]
    return Derived(entries)


def _points(tree: Tree) -> list[Attached]:
    """Return the points of the system."""
    return [
        Attached("point", number, k, position_of(tree, k, point))
        for number, (k, point) in enumerate(tree.system.points, start=1)
    ]
