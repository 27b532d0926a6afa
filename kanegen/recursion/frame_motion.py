"""Outputs about frames, in inertial components: Jacobians, velocities, accelerations.

Six rows belong to each frame: those of the angular velocity of its body, then those of the velocity of its
origin. The axes of the frame do not matter, because all components are inertial.
"""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Expr, S

from kanegen.recursion.attached import (
    Attached,
    BodyVector,
    acceleration,
    inertial,
    partial_velocities,
    velocity,
)
from kanegen.recursion.body_motion import body_motions
from kanegen.recursion.frames import fixed_frame
from kanegen.recursion.kinematics import angular_velocities, poses, velocities
from kanegen.recursion.tree import Derived, Tree


def frame_jacobians(tree: Tree) -> Derived:
    """Derive the partial velocities of every frame by {y}, Eqs. (15), (32): (6, n), frame after frame."""
    n, seen = len(tree.system.freedoms), poses(tree)
    entries: list[Expr] = []
    for one in frame_origins(tree):
        found = partial_velocities(tree, one, seen)
        for columns in (found.angular, found.linear):
            for i in range(3):
                entries += [columns[freedom][i] if freedom in columns else S.Zero for freedom in range(n)]
    return Derived(entries)


def frame_velocities(tree: Tree) -> Derived:
    """Derive {omega_K} and the velocity of the origin, Eqs. (11), (27), of every frame."""
    omega = angular_velocities(tree)
    of_origins, origins = velocities(tree, omega), frame_origins(tree)
    angular = [
        BodyVector(one.body, f"wf_{one.number}", f"angular velocity of frame {one.number}", omega[one.body])
        for one in origins
    ]
    return _six_rows(tree, angular, [velocity(tree, one, omega, of_origins) for one in origins])


def frame_accelerations(tree: Tree) -> Derived:
    """Derive the angular acceleration and the acceleration of the origin, Eqs. (20), (33), of every frame."""
    return _accelerations(tree, accelerated=True)


def frame_bias_accelerations(tree: Tree) -> Derived:
    """Derive the accelerations of every frame for {ydot} = 0: the derivative of its Jacobian times {y}."""
    return _accelerations(tree, accelerated=False)


def _accelerations(tree: Tree, accelerated: bool) -> Derived:
    """Derive the accelerations of every frame, without gravity."""
    moved = body_motions(tree, accelerated=accelerated, weightless=True)
    origins = frame_origins(tree)
    angular = [
        BodyVector(
            one.body,
            f"ef_{one.number}",
            f"angular acceleration of frame {one.number}",
            moved[one.body].alpha,
        )
        for one in origins
    ]
    return _six_rows(tree, angular, [acceleration(tree, one, moved[one.body]) for one in origins])


def _six_rows(tree: Tree, angular: Sequence[BodyVector], linear: Sequence[BodyVector]) -> Derived:
    """Derive an angular and a linear vector for each frame, in inertial components."""
    found = inertial(tree, [*angular, *linear])
    pairs = zip(found[: len(angular)], found[len(angular) :], strict=True)
    return Derived([entry for pair in pairs for v in pair for entry in v])


def frame_origins(tree: Tree) -> list[Attached]:
    """Return the origins of the frames that the system selects."""
    return [
        Attached("frame", number, frame.body, fixed_frame(tree, frame.name, frame.body).origin)
        for number, frame in enumerate(tree.system.pose_frames, start=1)
    ]
