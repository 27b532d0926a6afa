"""{f}, and the generalized forces that given accelerations need, by an inward recursion of forces.

Outward go the motions, inward the force and moment about each origin that they need, less the loads. Their
work on a freedom is the generalized force that it needs; with {ydot} = 0 this is minus its entry of {f} (Luh,
Walker and Paul 1980; Featherstone 2008, section 5.3). Freedoms that are prescribed need such a force as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.derived import Derived
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.loads import efforts
from kanegen.recursion.motion import Requirement, requirements
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import add, cross, dot
from kanegen.symbolic.definitions import Vector


def forcing(tree: Tree) -> Derived:
    """The entries of {f}, Eq. (44)."""
    return Derived([-needed for needed in works(tree, requirements(tree, accelerated=False))])


def inverse_dynamics(tree: Tree) -> Derived:
    """The entries of [A]{ydot} - {f}: what the accelerations {ydot} need beside loads and gravity."""
    return Derived(works(tree, requirements(tree, accelerated=True)))


@dataclass(frozen=True)
class Passage:
    """What a joint carries: the force and moment that its body needs, with all that hangs on it.

    Attributes:
        motion: The joint.
        above: Both, about the origin of K and in its frame.
        moments: The moment above each of the turns of the joint.
        force: The force in the frame of J.
    """

    motion: JointMotion
    above: Requirement
    moments: tuple[Vector, ...]
    force: Vector


def prescribed_efforts(tree: Tree) -> Derived:
    """The generalized forces that act at the prescribed freedoms, beside loads and gravity."""
    found = _works(tree, requirements(tree, accelerated=True))
    first = len(tree.system.freedoms)
    return Derived([found[first + i] for i in range(len(tree.system.prescribed))])


def works(tree: Tree, needs: Sequence[Requirement]) -> list[Expr]:
    """The generalized forces that do the work of what each body needs, less those of force elements."""
    found = _works(tree, needs)
    return [found[i] for i in range(len(tree.system.freedoms))]


def _works(tree: Tree, needs: Sequence[Requirement]) -> dict[int, Expr]:
    """The same by number of a freedom, prescribed ones behind the others."""
    result: dict[int, Expr] = {}
    for passage in passages(tree, needs):
        motion = passage.motion
        result |= {spin.freedom: passage.above.moment[spin.axis] for spin in motion.spins}
        for step, moment in zip(motion.steps, passage.moments, strict=True):
            if step.moves:
                result[step.number] = moment[step.axis]
        for slide in motion.sliding:
            work = dot(slide.direction, passage.force)
            result[slide.number] = tree.definitions.define(f"f_{slide.number}", work)
    acting = efforts(tree)
    moving = enumerate((*tree.system.freedoms, *tree.system.prescribed))
    return {i: result[i] - acting.get((freedom.body, freedom.index), S.Zero) for i, freedom in moving}


def passages(tree: Tree, needs: Sequence[Requirement]) -> Iterator[Passage]:
    """What each body needs on its way inward, joint by joint."""
    definitions = tree.definitions
    carried = [Requirement() for _ in tree.motions]
    for motion in reversed(tree.motions):
        k, j, own = motion.body, motion.lower, needs[motion.body - 1]
        tree.about(k, "force and moment about its origin, Eq. (44)")
        force = definitions.vector(f"F_{k}", add(own.force, carried[k - 1].force))
        moment = definitions.vector(f"M_{k}", add(own.moment, carried[k - 1].moment))
        above, moments = Requirement(force, moment), []
        for step in reversed(motion.steps):
            moments.append(moment)
            force = definitions.vector(f"F_{step.frame}", step.turn.down(force))
            moment = definitions.vector(f"M_{step.frame}", step.turn.down(moment))
        yield Passage(motion, above, tuple(reversed(moments)), force)
        if j:
            shifted = definitions.vector(f"M_{k}j", add(moment, cross(motion.offset, force)))
            carried[j - 1] = Requirement(
                definitions.vector(f"F_{k}s", add(carried[j - 1].force, force)),
                definitions.vector(f"M_{k}s", add(carried[j - 1].moment, shifted)),
            )
