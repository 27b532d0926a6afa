"""Rotations and origins of the bodies, outward: Eqs. (3) and (22)."""

from __future__ import annotations

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


def body_poses(tree: Tree) -> Derived:
    """For every body the rows of [R_K], then {p_O_K}, inertial components."""
    seen: list[Columns] = [(unit(0), unit(1), unit(2))]
    origins = [ZERO]
    entries: list[Expr] = []
    for motion in tree.motions:
        k, lower = motion.body, seen[motion.lower]
        tree.about(k, "rotation and origin, Eqs. (3), (22)")
        arm = Vector(*(dot(direction, motion.arm) for direction in lower))
        origins.append(tree.definitions.vector(f"pO_{k}", add(origins[motion.lower], arm)))
        seen.append(_turned(lower, motion, tree.definitions))
        entries += [direction[row] for row in range(3) for direction in seen[k]]
        entries += origins[k]
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
