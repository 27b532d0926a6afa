"""The choice of what the columns of [A] do: where they change to the fixed frame, and about which points.

Both are counted beforehand, with the costs of vectors without zeros. A column that changes to the fixed frame
saves its turns and costs two products with the basis, which has to be carried outward. A moment that moves to
the point O_K of a joint costs a shift, and then a scalar product for every axis there; one that stays about a
point further outward costs two scalar products. So most columns of a long chain of hinges stay about the
point of one joint, a station, while they pass several joints, then about that of the next station. The closer
the stations, the more often all columns are shifted; the further apart, the more joints there are whose
columns have yet to arrive at a station.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, count_nonzero

MATRIX_COST = 15
"""Operations of a matrix times a vector."""

SHIFT_COST = 12
"""Operations that shift a moment to another point."""

DOT_COST = 5
"""Operations of a scalar product."""

LEVER_ARM_COST = 9
"""Operations of the moment of an axis about a point."""

SUM_COST = 3
"""Operations of the sum of two vectors."""


@dataclass(frozen=True)
class FixedFrameChoice:
    """The choice of what columns of [A] do in the fixed frame.

    Attributes:
        bodies: Numbers of the bodies where columns change to it; with a body its lower body.
        kept: By number of such a body, that of the body about whose point O columns stay.
    """

    bodies: frozenset[int] = frozenset()
    kept: Mapping[int, int] = field(default_factory=dict)


def choose(tree: Tree) -> FixedFrameChoice:
    """Return the choice for a tree.

    Columns change to the fixed frame only where this saves operations without stations, too. With stations it
    saves some on shorter chains, but not enough to make up for the numbers that wait in memory: [A] and {f}
    of a chain of 20 hinges took 3 % fewer operations and 9 % more time.
    """
    bodies = bodies_that_save(tree)
    return FixedFrameChoice(bodies, kept_points(tree, bodies)[0])


def bodies_that_save(tree: Tree) -> frozenset[int]:
    """Return the bodies at which columns change to the fixed frame, chosen to save most operations.

    An inward pass computes the saving at every body, with all columns from outward or with those that have
    not changed further out. An outward pass selects bodies with a saving whose lower body is selected.
    """
    own = [_rotations(joint) for joint in tree.joints]
    outward = list(own)
    gains = [-_basis_cost(joint) for joint in tree.joints]
    saving: set[int] = set()
    for joint in reversed(tree.joints):
        k, j = joint.body, joint.lower
        each = _saved_by_column(tree, tree.joints[j - 1]) if j else 0
        without, with_basis = each * outward[k - 1], each * own[k - 1] + gains[k - 1]
        if with_basis > without:
            saving.add(k)
        if j:
            gains[j - 1] += max(without, with_basis)
            outward[j - 1] += outward[k - 1]
    reached: set[int] = set()
    for joint in tree.joints:
        if joint.body in saving and joint.lower in reached | {0}:
            reached.add(joint.body)
    return frozenset(reached)


def kept_points(tree: Tree, bodies: Collection[int]) -> tuple[dict[int, int], int]:
    """Return the body about whose point columns stay, by body that they pass, and the operations saved.

    Columns of coupled freedoms are added where they meet, which needs one point.

    Args:
        tree: The tree.
        bodies: The bodies at which columns change to the fixed frame.
    """
    kept: dict[int, int] = {}
    saved = 0
    if tree.system.in_couplings:
        return kept, saved
    columns = _columns_outward(tree)
    for run in _runs(tree, bodies):
        counts = [columns[joint.body - 1] for joint in run]
        stations, more = _stations(run, counts)
        saved += more
        for start, end in pairwise(stations):
            kept.update((joint.body, run[start].body) for joint in run[start + 1 : end])
    return kept, saved


def _stations(run: Sequence[JointMotion], columns: Sequence[int]) -> tuple[list[int], int]:
    """Return the places of the stations in a run of joints, and the operations that they save.

    At a station all columns are about the point of the joint; before the next one, those from its body and
    further outward stay about it. Stations are the first joint and the last, or the end of a run on the
    ground, where the last station is behind its last joint.

    Args:
        run: Joints inward, each the only one from outward of the next.
        columns: Number of columns from outward of each joint.
    """
    ends = len(run) + (run[-1].lower == 0)
    best, before = [0] * ends, [0] * ends
    shifts = [0, *(_shift_cost(joint) for joint in run)]
    for end in range(1, ends):
        found: list[tuple[int, int]] = []
        each = spent = longest = 0
        for start in range(end - 1, -1, -1):
            arriving = 0 if end == len(run) else max(longest, shifts[end]) - shifts[end]
            found.append((best[start] + columns[start] * (each - arriving) - spent, start))
            rotations = _rotations(run[start])
            each += shifts[start] - (DOT_COST + 1) * rotations
            spent += LEVER_ARM_COST * rotations + SUM_COST
            longest = max(longest, shifts[start])
        best[end], before[end] = max(found)
    stations = [ends - 1]
    while stations[-1]:
        stations.append(before[stations[-1]])
    return stations[::-1], best[-1]


def _runs(tree: Tree, bodies: Collection[int]) -> Iterator[list[JointMotion]]:
    """Yield the joints of `bodies` in runs inward, from the end of a branch or from where branches meet.

    Where branches meet one run ends and another begins.
    """
    outward = Counter(tree.joints[k - 1].lower for k in bodies)
    for k in sorted(bodies):
        if outward[k] == 1:
            continue
        run = [tree.joints[k - 1]]
        while run[-1].lower and (len(run) == 1 or outward[run[-1].body] == 1):
            run.append(tree.joints[run[-1].lower - 1])
        yield run


def _columns_outward(tree: Tree) -> list[int]:
    """Return the number of columns of rotations from outward of each body."""
    columns = [0 for _ in tree.joints]
    for joint in reversed(tree.joints):
        if joint.lower:
            columns[joint.lower - 1] += columns[joint.body - 1] + _rotations(joint)
    return columns


def _saved_by_column(tree: Tree, joint: JointMotion) -> int:
    """Return the operations saved when one column from outward changes to the fixed frame at a joint."""
    here, *inward = tree.inward(joint)
    if not inward:
        return 0
    *between, first = inward
    saved = _pass_cost(here) - _entry_cost(here) - _shift_cost(here) - 2 * MATRIX_COST
    for other in between:
        entries = DOT_COST * (_rotations(other) + len(other.translations))
        saved += _pass_cost(other) - entries - _shift_cost(other)
    first_entries = 3 * (max(_rotations(first) - 2, 0) + max(len(first.translations) - 1, 0))
    return max(saved + _entry_cost(first) - first_entries, 0)


def _pass_cost(joint: JointMotion) -> int:
    """Return the operations that pass one column through a joint turn by turn."""
    force = min(joint.turn_cost, MATRIX_COST) if joint.translations else joint.turn_cost
    return joint.turn_cost + force + 4 * count_nonzero(joint.offset)


def _shift_cost(joint: JointMotion) -> int:
    """Return the operations that shift the moment of one fixed-frame column to the lower body's point."""
    return SHIFT_COST if joint.arm != ZERO else 0


def _entry_cost(joint: JointMotion) -> int:
    """Return the operations for the entries of one fixed-frame column with a joint."""
    turns = len(joint.angles)
    return 3 * (turns * (turns - 1) // 2) + (joint.turn_cost if joint.translations else 0)


def _basis_cost(joint: JointMotion) -> int:
    """Return the operations that carry the basis of the fixed frame past a joint; few on the ground."""
    if joint.lower:
        return 3 * joint.turn_cost + 3 * max(2 * count_nonzero(joint.arm) - 1, 0)
    return 3 * max(joint.turn_cost - SHIFT_COST, 0)


def _rotations(joint: JointMotion) -> int:
    """Return the number of rotations of a joint that {y} moves."""
    return len(joint.angular_speeds) + sum(bool(step.shares) for step in joint.steps)
