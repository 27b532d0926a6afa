"""Which derivation of the derivatives of {ydot} can cost less, estimated from the tree alone.

Both ways make about a hundred operations for each pair of freedoms of which one carries the other. By
articulated bodies (`articulated_derivatives`) that is all, but for a large share of each freedom. Otherwise
each column is solved for by the factors of [A] (`solution_derivatives`), which costs a third power of the
length of chains, and the share of a freedom is small. The estimates are within some 10 % of the counts of
chains of hinges about different axes, and only say where it is worth counting.
"""

from __future__ import annotations

from kanegen.model.force_elements.elements import PointLoad, Spring
from kanegen.model.system import System
from kanegen.recursion.factorisation import carriers

LOOPED = 120_000
"""Operations of a solution for all columns from which loops take the place of straight-line code. Below,
straight-line code has fewer operations, SIMD in batches, and is compiled in less than a minute."""

PAIR, BRANCHES, FREEDOM, ENDS = 112, 115, 919, -1857
"""Operations by articulated bodies for each pair of freedoms on a path, and of two in branches of a tree, for
each freedom, and for each tree on the ground, whose first and last joints cost less."""

PAIR_OF_COLUMNS, FREEDOM_OF_COLUMNS, ENDS_OF_COLUMNS = 98, 461, -1200
"""The same where columns are solved for, without these solutions."""

SOLVED = 9 / 8
"""What solutions of all columns, with [A]^-1, cost more than those by coordinates and by speeds."""

WITHIN = 1.1
"""Largest ratio of the two estimates with which the way by articulated bodies is counted, too."""


def may_cost_less(system: System) -> bool:
    """Return whether derivatives by articulated bodies are worth deriving, to be counted beside the others.

    They win on chains of hinges about different axes from 11 or 12 on, and lose on arms with six or seven and
    on trees with short branches, for which nothing more is derived. Where even this code would be longer than
    `LOOPED`, loops over columns stay short.

    The joints are hinges and slides, several at a joint but not three of a kind, which are solved for
    together: next to gimbal lock nothing else is accurate. Couplings, rotors, springs between points and
    loads on points make terms that this way lacks, and so do columns by run-time parameters.
    """
    joints = [body.joint for body in system.bodies]
    simple = all(one.speeds_are_rates and not all(one.free[:3]) and not all(one.free[3:]) for one in joints)
    loaded = any(point.loads for _, point in system.points)
    loaded |= any(isinstance(element, Spring | PointLoad) for element in system.force_elements)
    if not simple or loaded or system.couplings or system.mounted_rotors or system.parameters:
        return False
    inward = {k: frozenset(row) for k, row in carriers(system).items()}
    pairs, freedoms = sum(map(len, inward.values())), len(inward)
    trees = sum(not row for row in inward.values())
    least = PAIR * pairs + FREEDOM * freedoms + ENDS * trees
    if least >= LOOPED:
        return False
    by_columns = PAIR_OF_COLUMNS * pairs + FREEDOM_OF_COLUMNS * freedoms + ENDS_OF_COLUMNS * trees
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
