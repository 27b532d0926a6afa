"""Rotations and origins of the bodies, outward: Eqs. (3) and (22)."""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr

from kanegen.recursion.derived import Derived
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, dot, present, unit
from kanegen.symbolic.definitions import AXES, Definitions, Vector

CROSS = 9
"""Operations of a vector product."""

Columns = tuple[Vector, Vector, Vector]
"""Of [R_K]: the inertial basis vectors in components of K."""


@dataclass(frozen=True)
class Pose:
    """Where a body is.

    Attributes:
        columns: Of [R_K].
        origin: {p_O_K}, inertial components (m).
    """

    columns: Columns
    origin: Vector

    def inertial(self, v: Vector) -> Vector:
        """A vector of K in inertial components."""
        return Vector(*(dot(direction, v) for direction in self.columns))


def poses(tree: Tree) -> list[Pose]:
    """Of the ground, 0, and of every body."""
    found = [Pose((unit(0), unit(1), unit(2)), ZERO)]
    for motion in tree.motions:
        lower = found[motion.lower]
        tree.about(motion.body, "rotation and origin, Eqs. (3), (22)")
        away = add(lower.origin, lower.inertial(motion.arm))
        origin = tree.definitions.vector(f"pO_{motion.body}", away)
        found.append(Pose(_turned(lower.columns, motion, tree.definitions), origin))
    return found


def body_poses(tree: Tree) -> Derived:
    """For every body that the system reports the rows of [R_K], then {p_O_K}, inertial components."""
    entries: list[Expr] = []
    seen = poses(tree)
    for pose in (seen[k] for k in tree.system.pose_numbers):
        entries += [direction[row] for row in range(3) for direction in pose.columns]
        entries += pose.origin
    return Derived(entries)


def _turned(lower: Columns, motion: JointMotion, definitions: Definitions) -> Columns:
    """The basis vectors through a joint; the third from the others where that costs less."""
    spared = motion.turning > CROSS and all(present(direction) == len(AXES) for direction in lower)
    x, y, *others = (
        _up(direction, f"N{axis.upper()}", motion, definitions)
        for axis, direction in zip(AXES, lower[: 2 if spared else 3], strict=False)
    )
    z = others[0] if others else definitions.vector(f"NZ_{motion.body}", cross(x, y))
    return x, y, z


def _up(v: Vector, name: str, motion: JointMotion, definitions: Definitions) -> Vector:
    """A basis vector through the turns of a joint."""
    for step in motion.steps:
        v = definitions.vector(f"{name}_{motion.above(step)}", step.turn.up(v))
    return v
