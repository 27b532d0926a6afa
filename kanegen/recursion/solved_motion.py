"""The accelerations of the bodies for a solution: outward along the joints, from its free components."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.body_motion import Carried
from kanegen.recursion.joint_path import (
    GROUND_ACCELERATION,
    ROTATIONS,
    TRANSLATIONS,
    FreeComponent,
    FreeTranslations,
    PathElement,
)
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO
from kanegen.symbolic.definitions import Vector

Paths = Mapping[int, tuple[PathElement, ...]]
"""Path through the joint of each body, inward, by number of the body."""


@dataclass(frozen=True)
class SolvedMotion:
    """Accelerations of a body that the free components of a solution cause.

    Attributes:
        acceleration: Angular acceleration, then acceleration of the origin, in K (rad/s^2, m/s^2).
        carried: The part that components further inward cause, where the joint's components are absolute.
    """

    acceleration: tuple[Expr, ...]
    carried: Carried


def solved_motions(tree: Tree, paths: Paths, components: Sequence[Expr]) -> dict[int, SolvedMotion]:
    """Return the accelerations of every body for the free components of a solution, by number of the body.

    Args:
        tree: The tree.
        paths: Path through the joint of each body.
        components: Free components of the accelerations, by freedom.
    """
    found = {0: SolvedMotion(GROUND_ACCELERATION, Carried())}
    for joint in tree.joints:
        tree.about(joint.body, "accelerations of the solution, Eqs. (20), (33)")
        a, linear = found[joint.lower].acceleration, ZERO
        replaced: dict[int, Expr] = {}
        for element in reversed(paths[joint.body]):
            if isinstance(element, FreeComponent):
                i, freedom = element.index, element.freedom
                if element.is_absolute:
                    replaced[i], moved = a[i], components[freedom]
                else:
                    moved = tree.definitions.define(f"r_{freedom}", a[i] + element.acceleration(components))
                a = (*a[:i], moved, *a[i + 1 :])
                continue
            if isinstance(element, FreeTranslations):
                linear = Vector(*a[3:])
            a = element.outward(a, tree.definitions)
        alpha, to_center = (
            Vector(*(replaced.get(i, S.Zero) for i in indices)) for indices in (ROTATIONS, TRANSLATIONS)
        )
        found[joint.body] = SolvedMotion(a, Carried(alpha, linear, to_center))
    return found
