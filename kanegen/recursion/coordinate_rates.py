"""{xdot} from the speeds: Eq. (9) where they are components of an angular velocity, Eq. (45) elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Expr, S

from kanegen.recursion.derived import Derived
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.orientations import rotation_rates
from kanegen.recursion.rates import angle_rates
from kanegen.recursion.tree import Tree
from kanegen.symbolic.symbols import coordinate_rate


def coordinate_rates(tree: Tree) -> Derived:
    """The entries of {xdot}; what must be positive for the rates of three angles to exist."""
    system = tree.system
    rates: list[Expr] = [coordinate_rate(one.body, one.index) for one in system.coordinates]
    positive: dict[int, Expr] = {}
    for motion in tree.motions:
        if motion.spins:
            tree.about(motion.body, "rates of the orientation, Eq. (9)")
            places = [
                place
                for coordinate, place in system.coordinate_places.items()
                if coordinate.body == motion.body and not coordinate.is_translation
            ]
            names = [f"xdot_{place}" for place in places]
            found = (
                _angles(motion, tree, names, positive) if motion.behind else _as_a_whole(motion, tree, names)
            )
            for place, rate in zip(places, found, strict=True):
                rates[place] = rate
    if not positive:
        return Derived(rates)
    return Derived(rates, [positive.get(place, S.One) for place in range(len(system.freedoms))])


def _angles(
    motion: JointMotion, tree: Tree, names: Sequence[str], positive: dict[int, Expr]
) -> Sequence[Expr]:
    """Of the angles of one joint; where two of their axes coincide there are none."""
    one, two, three = names
    found = angle_rates(motion, tree.definitions)
    square = tree.definitions.define(f"Cq_{motion.body}", found.across * found.across)
    # The middle angle decides, and the status names it.
    positive[motion.spins[1].freedom] = square
    return found.rates(motion.spinning, (one, two, three))


def _as_a_whole(motion: JointMotion, tree: Tree, names: Sequence[str]) -> Sequence[Expr]:
    """Return the rates of the coordinates of a rotation that is not made of turns about axes."""
    rotation = tree.system.bodies[motion.body - 1].joint.rotation
    rates = rotation_rates(motion.body, rotation, motion.spinning)
    return [tree.definitions.define(name, rate) for name, rate in zip(names, rates, strict=True)]
