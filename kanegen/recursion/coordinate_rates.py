"""{xdot} from the speeds: Eq. (9) where they are components of an angular velocity, Eq. (45) elsewhere."""

from __future__ import annotations

from sympy import Expr, S

from kanegen.recursion.derived import Derived
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.rates import angle_rates
from kanegen.recursion.tree import Tree
from kanegen.symbolic.symbols import speeds


def coordinate_rates(tree: Tree) -> Derived:
    """The entries of {xdot}; what must be positive for the rates of three angles to exist."""
    rates = dict(enumerate(speeds(tree.system)))
    positive: dict[int, Expr] = {}
    for motion in tree.motions:
        if motion.spins:
            tree.about(motion.body, "rates of the angles, Eq. (9)")
            _turn(motion, tree, rates, positive)
    if not positive:
        return Derived(list(rates.values()))
    return Derived(list(rates.values()), [positive.get(place, S.One) for place in rates])


def _turn(motion: JointMotion, tree: Tree, rates: dict[int, Expr], positive: dict[int, Expr]) -> None:
    """Of the angles of one joint; where two of their axes coincide there are none."""
    places = [spin.freedom for spin in motion.spins]
    one, two, three = (f"xdot_{place}" for place in places)
    found = angle_rates(motion, tree.definitions)
    rates |= dict(zip(places, found.rates(motion.spinning, (one, two, three)), strict=True))
    square = tree.definitions.define(f"Cq_{motion.body}", found.across * found.across)
    # The middle angle decides, and the status names it.
    positive[places[1]] = square
