"""The output `reaction_loads`: the loads that joints transmit, along locked directions or in frames.

The load along a locked direction is the generalized force that `inverse_dynamics` would give for it if it
were free and at rest: the component of the transmitted force along a translation of the joint frame, or of
the moment about O_K along the axis of an angle. In a frame, the load is all that the joint transmits, about
the origin of the frame: what the lower body exerts on the body, efforts on freedoms included.

The recursion is that of {f}, but inertias are not regrouped: regrouping does not change [A] and {f}, but
changes the load that the joint between the two bodies transmits.
"""

from __future__ import annotations

from collections.abc import Iterator

from sympy import Expr, S

from kanegen.model.joint import Joint
from kanegen.model.reaction import Reaction
from kanegen.recursion.body_motion import body_motions
from kanegen.recursion.force_elements import element_efforts
from kanegen.recursion.frames import fixed_frame
from kanegen.recursion.inverse_dynamics import CarriedWrench, carried_wrenches, required
from kanegen.recursion.tree import Derived, Tree, ungrouped
from kanegen.recursion.vectors import add, cross, dot, subtract
from kanegen.symbolic.definitions import Definitions


def reaction_loads(tree: Tree) -> Derived:
    """Derive every load that the system selects, in its order."""
    whole = ungrouped(tree)
    needed = required(whole, body_motions(whole, accelerated=True), accelerated=True)
    every = list(carried_wrenches(whole, needed.wrenches))
    found: dict[tuple[int, int], Expr] = {}
    in_frames: dict[tuple[str, int], Expr] = {}
    for carried in every:
        k = carried.joint.body
        tree.about(k, "what its joint carries along locked directions")
        joint = tree.system.bodies[k - 1].joint
        found |= {(k, angle): load for angle, load in _moments(carried, joint, tree.definitions)}
        found |= {(k, 3 + axis): load for axis, load in _forces(carried, joint, tree.definitions)}
        rows = [row for row in tree.system.reaction_rows if row.frame and row.body == k]
        for name in dict.fromkeys(row.frame for row in rows):
            in_frames |= {(name, i): load for i, load in enumerate(_in_frame(tree, carried, name))}
    acting = element_efforts(tree)

    def load(row: Reaction) -> Expr:
        if row.frame:
            return in_frames[row.frame, row.index]
        return found[row.body, row.index] - acting.get((row.body, row.index), S.Zero)

    return Derived([load(row) for row in tree.system.reaction_rows])


def _in_frame(tree: Tree, carried: CarriedWrench, name: str) -> tuple[Expr, ...]:
    """Return the moment about the origin of a frame and the force, in components of the frame."""
    k, above = carried.joint.body, carried.above
    frame = fixed_frame(tree, name, k)
    tree.about(k, "what its joint carries, in a frame")
    arm = subtract(carried.joint.origin, frame.origin)
    moment = tree.definitions.vector(f"M_{k}f", add(above.moment, cross(arm, above.force)))
    return (*frame.outward(moment), *frame.outward(above.force))


def _moments(carried: CarriedWrench, joint: Joint, definitions: Definitions) -> Iterator[tuple[int, Expr]]:
    """Yield every locked angle with the moment about O_K, about its axis.

    Above and below the turn of an angle its axis is the same basis vector. A locked angle that turns nothing
    has no step, but still an axis.
    """
    k, above = carried.joint.body, carried.above
    steps = {step.angle: step for step in carried.joint.angles}
    moment = definitions.vector(f"M_{k}o", add(above.moment, cross(carried.joint.origin, above.force)))
    for angle in (2, 1, 0):
        if not joint.moving[angle]:
            yield angle, moment[joint.axes[angle]]
        if angle in steps:
            step = steps[angle]
            moment = definitions.vector(f"M_{step.frame}o", step.turn.down(moment))


def _forces(carried: CarriedWrench, joint: Joint, definitions: Definitions) -> Iterator[tuple[int, Expr]]:
    """Yield every locked translation with the force along it."""
    for axis, direction in enumerate(carried.joint.directions):
        if not joint.moving[3 + axis]:
            name = f"F_{carried.joint.body}l{axis + 1}"
            yield axis, definitions.define(name, dot(direction, carried.below.force))
