"""Reaction loads: what joints carry along the directions that they lock.

They are what `inverse_dynamics` would give for these directions if they were free and stood still: the force
that a joint carries, along a translation of its joint frame, and the moment about O_K, about the axis of an
angle. The recursion is that of `forcing`, but no body passes inertia to its lower body. That would leave [A]
and {f} as they are, and not what the joint between the two carries.
"""

from __future__ import annotations

from collections.abc import Iterator

from sympy import Expr, S

from kanegen.model.joint import Joint
from kanegen.recursion.derived import Derived
from kanegen.recursion.forcing import Passage, passages
from kanegen.recursion.loads import efforts
from kanegen.recursion.motion import requirements
from kanegen.recursion.tree import Tree, ungrouped
from kanegen.recursion.vectors import add, cross, dot
from kanegen.symbolic.definitions import Definitions


def reaction_loads(tree: Tree) -> Derived:
    """The generalized force of every locked direction that the system reports, in its order."""
    whole = ungrouped(tree)
    carried = list(passages(whole, requirements(whole, accelerated=True)))
    found: dict[tuple[int, int], Expr] = {}
    for passage in carried:
        k = passage.motion.body
        tree.about(k, "what its joint carries along locked directions")
        joint = tree.system.bodies[k - 1].joint
        found |= {(k, angle): load for angle, load in _moments(passage, joint, tree.definitions)}
        found |= {(k, 3 + axis): load for axis, load in _forces(passage, joint, tree.definitions)}
    acting = efforts(tree)
    places = [(freedom.body, freedom.index) for freedom in tree.system.reaction_freedoms]
    return Derived([found[place] - acting.get(place, S.Zero) for place in places])


def _moments(passage: Passage, joint: Joint, definitions: Definitions) -> Iterator[tuple[int, Expr]]:
    """Of every locked angle the moment about O_K, about its axis.

    Above and below the turn of an angle its axis is the same basis vector. A locked angle that turns nothing
    has no step, but still an axis.
    """
    motion, need = passage.motion, passage.above
    steps = {step.angle: step for step in motion.angles}
    moment = definitions.vector(f"M_{motion.body}o", add(need.moment, cross(motion.origin, need.force)))
    for angle in (2, 1, 0):
        if not joint.moving[angle]:
            yield angle, moment[joint.axes[angle]]
        if angle in steps:
            step = steps[angle]
            moment = definitions.vector(f"M_{step.frame}o", step.turn.down(moment))


def _forces(passage: Passage, joint: Joint, definitions: Definitions) -> Iterator[tuple[int, Expr]]:
    """Of every locked translation the force along it."""
    for axis, direction in enumerate(passage.motion.directions):
        if not joint.moving[3 + axis]:
            name = f"F_{passage.motion.body}l{axis + 1}"
            yield axis, definitions.define(name, dot(direction, passage.force))
