"""Passes along the joints of a solver: accelerations of a solution outward, loads on bodies inward."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.body_motion import Carried
from kanegen.recursion.joint_path import (
    GROUND_ACCELERATION,
    ROTATIONS,
    TRANSLATIONS,
    FrameChange,
    FreeComponent,
    FreeTranslations,
    OriginChange,
    PathElement,
)
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, Wrench
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


def generalized_loads(tree: Tree, paths: Paths, loads: Mapping[int, Wrench]) -> dict[int, Expr]:
    """Return the generalized forces of loads on bodies, by place in {y}, where they are not zero.

    Args:
        tree: The tree.
        paths: Path through the joint of each body, with the free components of the joint one by one.
        loads: Force, and moment about its origin, on each body, by number of the body, in its frame.
    """
    carried = [loads.get(k, Wrench()) for k in range(len(tree.joints) + 1)]
    found: dict[int, Expr] = {}
    for joint in reversed(tree.joints):
        tree.about(joint.body, "loads, passed inward")
        wrench = carried[joint.body]
        for element in paths[joint.body]:
            if isinstance(element, FreeComponent):
                along = [*wrench.moment, *wrench.force][element.index]
                for place, share in element.shares.items() if along != 0 else ():
                    found[place] = found.get(place, S.Zero) + share * along
            elif isinstance(element, FrameChange | OriginChange):
                wrench = element.inward(wrench, tree.definitions)
        carried[joint.lower] = wrench.plus(carried[joint.lower], f"{joint.lower}", tree.definitions)
    return found
