"""Which derivation of the derivatives of {ydot} can cost less, estimated from the tree alone.

Both ways make about a hundred operations for each pair of freedoms of which one carries the other. By
articulated bodies (`articulated_derivatives`) that is all, but for a large share of each freedom. Otherwise
each column is solved for by the factors of [A] (`solution_derivatives`), which costs a third power of the
length of chains, and the share of a freedom is small. The estimates are within some 10 % of the counts of
chains of hinges about different axes, and only say where it is worth counting.
"""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.model.coordinates import ANGLES
from kanegen.model.force_elements.elements import PointLoad, Spring
from kanegen.model.system import System
from kanegen.recursion.factorisation import carriers

LOOPED = 120_000
"""Operations of derivatives by articulated bodies, which are straight-line code, from which loops over
columns stay shorter and are compiled in less time."""


@dataclass(frozen=True)
class _Costs:
    """Operations of derivatives.

    Attributes:
        pair: Those for each pair of freedoms of which one carries the other.
        freedom: Those for each freedom.
        tree: Those for each tree on the ground, whose first and last joints cost less: a negative number.
    """

    pair: int
    freedom: int
    tree: int

    def of(self, pairs: int, freedoms: int, trees: int) -> int:
        """Return the sum for these numbers of pairs, freedoms, and trees on the ground."""
        return self.pair * pairs + self.freedom * freedoms + self.tree * trees


ARTICULATED, PARALLEL_ARTICULATED = _Costs(112, 919, -1857), _Costs(38, 191, -333)
"""Operations by articulated bodies for hinges about different axes, and about parallel ones."""

COLUMNS, PARALLEL_COLUMNS = _Costs(98, 461, -1200), _Costs(20, 110, -150)
"""The same where columns are solved for, without these solutions."""

FEWEST = 5
"""Fewest freedoms with which a chain costs less by articulated bodies."""

BRANCHES = 115
"""Operations by articulated bodies for two freedoms in branches of a tree."""

SOLVED = 9 / 8
"""What solutions of all columns, with [A]^-1, cost more than those by coordinates and by speeds."""

WITHIN = 1.1
"""Largest ratio of the two estimates with which the way by articulated bodies is counted, too."""


def may_cost_less(system: System) -> bool:
    """Return whether derivatives by articulated bodies are worth deriving, to be counted beside the others.

    They win on chains of hinges about different axes from 12 on and about parallel axes from 5 on, and lose
    on arms with six or seven and on trees with short branches, for which nothing more is derived. Where even
    this code would be longer than `LOOPED`, loops over columns stay short.
    """
    if len(system.freedoms) < FEWEST or not _is_taken(system):
        return False
    inward = {k: frozenset(row) for k, row in carriers(system).items()}
    pairs, freedoms = sum(map(len, inward.values())), len(inward)
    trees = sum(not row for row in inward.values())
    parallel = _has_parallel_axes(system)
    least = (PARALLEL_ARTICULATED if parallel else ARTICULATED).of(pairs, freedoms, trees)
    if least >= LOOPED:
        return False
    by_columns = (PARALLEL_COLUMNS if parallel else COLUMNS).of(pairs, freedoms, trees)
    branches, solved = 0, 0
    for j, carrying in inward.items():
        for k, row in inward.items():
            is_related = k == j or j in row or k in carrying
            common = len(row & carrying)
            if is_related:
                solved += 4 * len(row)
            elif common:
                branches += 1
                solved += 2 * common
    articulated = least + BRANCHES / 2 * branches
    return articulated < min(LOOPED, WITHIN * (by_columns + 2 * SOLVED * solved))


def _is_taken(system: System) -> bool:
    """Return whether there are derivatives by articulated bodies.

    The joints are hinges and slides, several at a joint but not three of a kind, which are solved for
    together: next to gimbal lock nothing else is accurate. Couplings, rotors, springs between points and
    loads on points make terms that this way lacks, and so do columns by run-time parameters.
    """
    joints = [body.joint for body in system.bodies]
    simple = all(one.speeds_are_rates and not all(one.free[:3]) and not all(one.free[3:]) for one in joints)
    loaded = any(point.loads for _, point in system.points)
    loaded |= any(isinstance(element, Spring | PointLoad) for element in system.force_elements)
    return simple and not (loaded or system.couplings or system.mounted_rotors or system.parameters)


def _has_parallel_axes(system: System) -> bool:
    """Return whether nothing moves but hinges with one common axis, such as those of a multiple pendulum."""
    axes = set()
    for joint in (body.joint for body in system.bodies):
        turning = [i for i in ANGLES if joint.moving[i]]
        if any(joint.moving[3:]) or len(turning) != 1 or any(joint.locked[i] != 0 for i in ANGLES):
            return False
        (index,) = turning
        axis, orientation = joint.axes[index], joint.orientation
        axes.add(axis)
        if not isinstance(orientation[0], tuple) or orientation[axis][axis] != 1.0:
            return False
    return len(axes) == 1
