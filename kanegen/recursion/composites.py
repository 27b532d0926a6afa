"""Composite bodies: a body with everything that it carries, as one rigid body in every frame of its joint."""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.recursion.inertia import Inertia
from kanegen.recursion.tree import Tree


@dataclass(frozen=True)
class CompositeBodies:
    """The composite bodies of a tree; inertias are regrouped as in `Tree`, and have the names that [A] gives.

    Attributes:
        in_frames: By body, the composite body about its origin in the frame below each turn of its joint,
            from the innermost, then in its own frame; entry 0 is empty.
        on_lower: By body, the composite body about the origin of the lower body, in its frame; entry 0 is
            that of all bodies and of the part of them that does not move.
    """

    in_frames: list[tuple[Inertia, ...]]
    on_lower: list[Inertia]


def composite_bodies(tree: Tree) -> CompositeBodies:
    """Return the composite bodies, added up from the outermost inward (Featherstone 2008, section 6.2)."""
    definitions, carried = tree.definitions, [tree.ground, *tree.inertias]
    in_frames: list[tuple[Inertia, ...]] = [() for _ in carried]
    on_lower = list(carried)
    for joint in reversed(tree.joints):
        k, j = joint.body, joint.lower
        tree.about(k, "composite body")
        seen = [carried[k]]
        for step in reversed(joint.steps):
            seen.append(seen[-1].down(step.turn, step.frame, definitions))
        in_frames[k] = tuple(reversed(seen))
        on_lower[k] = seen[-1].shifted(joint.offset, f"{k}j", definitions)
        carried[j] = carried[j].plus(on_lower[k], f"{j}", definitions)
    on_lower[0] = carried[0]
    return CompositeBodies(in_frames, on_lower)
