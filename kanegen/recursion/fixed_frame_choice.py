"""Where columns of [A] had better change to the view from home, by counting operations; see `distant`.

Costs are those of generic vectors, for one column and one joint. A body's view needs that of its lower body,
so the bodies that are chosen form a tree with the same root.
"""

from __future__ import annotations

from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import present

MATRIX = 15
"""Operations that it takes to multiply a vector by a matrix."""

SHIFT = 12
"""Operations that it takes to see a moment about another origin."""

DOT = 5
"""Operations of a scalar product."""


def chosen(tree: Tree) -> set[int]:
    """The bodies whose views together save most; none if they save nothing.

    Inward, every body is weighed: with a view, it takes all columns from outward, or those that have none of
    their own yet. Outward, those that pay and can be reached are taken.
    """
    own = [_angles(motion) for motion in tree.motions]
    outward = list(own)
    gains = [-_view(motion) for motion in tree.motions]
    paying: set[int] = set()
    for motion in reversed(tree.motions):
        k, j = motion.body, motion.lower
        each = _saved(tree, tree.motions[j - 1]) if j else 0
        without, with_view = each * outward[k - 1], each * own[k - 1] + gains[k - 1]
        if with_view > without:
            paying.add(k)
        if j:
            gains[j - 1] += max(without, with_view)
            outward[j - 1] += outward[k - 1]
    reached: set[int] = set()
    for motion in tree.motions:
        if motion.body in paying and motion.lower in reached | {0}:
            reached.add(motion.body)
    return reached


def _saved(tree: Tree, motion: JointMotion) -> int:
    """What a column from outward saves that changes to the view from home in the body of `motion`."""
    here, *inward = tree.inward(motion)
    if not inward:
        return 0
    *between, first = inward
    saved = _walk(here) - _reading(here) - SHIFT - 2 * MATRIX
    saved += sum(_walk(joint) - DOT * (_angles(joint) + len(joint.slides)) - SHIFT for joint in between)
    reading_at_home = 3 * (max(_angles(first) - 2, 0) + max(len(first.slides) - 1, 0))
    return max(saved + _reading(first) - reading_at_home, 0)


def _walk(motion: JointMotion) -> int:
    """What a column costs that passes a joint turn by turn."""
    force = min(motion.turning, MATRIX) if motion.slides else motion.turning
    return motion.turning + force + 4 * present(motion.offset)


def _reading(motion: JointMotion) -> int:
    """What a column costs of which no more than the entries is wanted."""
    turns = len(motion.angles)
    return 3 * (turns * (turns - 1) // 2) + (motion.turning if motion.slides else 0)


def _view(motion: JointMotion) -> int:
    """What a view costs; the first ones hold many zeros."""
    if motion.lower:
        return 3 * motion.turning + MATRIX
    return 3 * max(motion.turning - SHIFT, 0)


def _angles(motion: JointMotion) -> int:
    return len(motion.spins) + sum(step.freedom != NO_FREEDOM for step in motion.steps)
