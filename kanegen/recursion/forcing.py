"""{f}, and the generalized forces that given accelerations need, by an inward recursion of forces.

Outward go the motions, inward the force and moment about each origin that they need, less the loads. Their
work on a freedom is the generalized force that it needs; with {ydot} = 0 this is minus its entry of {f} (Luh,
Walker and Paul 1980; Featherstone 2008, section 5.3).
"""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Expr, S

from kanegen.recursion.derived import Derived
from kanegen.recursion.joint_motion import NO_FREEDOM
from kanegen.recursion.loads import efforts
from kanegen.recursion.motion import Requirement, requirements
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import add, cross, dot


def forcing(tree: Tree) -> Derived:
    """The entries of {f}, Eq. (44)."""
    return Derived([-needed for needed in works(tree, requirements(tree, accelerated=False))])


def inverse_dynamics(tree: Tree) -> Derived:
    """The entries of [A]{ydot} - {f}: what the accelerations {ydot} need beside loads and gravity."""
    return Derived(works(tree, requirements(tree, accelerated=True)))


def works(tree: Tree, needs: Sequence[Requirement]) -> list[Expr]:
    """The generalized forces that do the work of what each body needs, less those of force elements."""
    definitions = tree.definitions
    carried = [Requirement() for _ in tree.motions]
    result: dict[int, Expr] = {}
    for motion in reversed(tree.motions):
        k, j, own = motion.body, motion.lower, needs[motion.body - 1]
        tree.about(k, "force and moment about its origin, Eq. (44)")
        force = definitions.vector(f"F_{k}", add(own.force, carried[k - 1].force))
        moment = definitions.vector(f"M_{k}", add(own.moment, carried[k - 1].moment))
        result |= {spin.freedom: moment[spin.axis] for spin in motion.spins}
        for step in reversed(motion.steps):
            if step.freedom != NO_FREEDOM:
                result[step.freedom] = moment[step.axis]
            force = definitions.vector(f"F_{step.frame}", step.turn.down(force))
            moment = definitions.vector(f"M_{step.frame}", step.turn.down(moment))
        for slide in motion.slides:
            result[slide.freedom] = definitions.define(f"f_{slide.freedom}", dot(slide.direction, force))
        if j:
            shifted = definitions.vector(f"M_{k}j", add(moment, cross(motion.offset, force)))
            carried[j - 1] = Requirement(
                definitions.vector(f"F_{k}s", add(carried[j - 1].force, force)),
                definitions.vector(f"M_{k}s", add(carried[j - 1].moment, shifted)),
            )
    acting = efforts(tree)
    freedoms = enumerate(tree.system.freedoms)
    return [result[i] - acting.get((freedom.body, freedom.index), S.Zero) for i, freedom in freedoms]
