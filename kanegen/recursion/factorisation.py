"""The solver of [A]{ydot} = {b} by factorising [A] = [L]^T [D] [L].

Freedoms are eliminated from the outermost inward. An entry of [A] is zero unless one of its freedoms carries
the other, and this order keeps it so: no fill (Featherstone 2008, section 6.5). Cheap for short trees; its
cost grows with the third power of the depth, that of articulated bodies with the first.

Where freedoms are coupled, an entry of {y} moves several of them, and is eliminated where the innermost one
stands. An entry of [A] is then zero unless a freedom that one entry of {y} moves carries one that the other
moves, and an elimination may fill entries: it couples all rows that it changes. A rotor in another branch
than the freedom that drives it does the same. The pattern follows from the tree, couplings and rotors alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from types import MappingProxyType

from sympy import Expr, S

from kanegen.model.coordinates import Freedom
from kanegen.model.system import System
from kanegen.recursion.attached import Attached, partial_velocities
from kanegen.recursion.body_motion import NOT_CARRIED, Carried
from kanegen.recursion.inverse_dynamics import Requirement, required_efforts
from kanegen.recursion.joint_path import joint_path, released
from kanegen.recursion.kinematics import poses
from kanegen.recursion.mass_matrix import mass_matrix
from kanegen.recursion.mass_matrix_inverse import products, products_cost_less
from kanegen.recursion.reduced import Reduced
from kanegen.recursion.solved_motion import Paths, generalized_loads
from kanegen.recursion.symmetric_factors import factorised, inverse_from_factors
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, Wrench
from kanegen.symbolic.symbols import generalized_force

ARTICULATED_COST = 350
"""Operations of articulated bodies per freedom, roughly; a costlier factorisation is not worth deriving."""

MOST_ANGLES = 2
"""Largest number of free angles with rates as speeds at a joint, for which factorisation is used. With three,
[A] is nearly singular close to gimbal lock, where articulated bodies stay accurate."""


def worth_trying(system: System) -> bool:
    """Return whether a factorisation may be the cheaper solver, and loses no accuracy.

    Where a body translates freely and rotates, the moments of loads at its mass centre would cancel only in
    the elimination.
    """
    if any(all(joint.free[3:]) and any(joint.moving[:3]) for joint in (body.joint for body in system.bodies)):
        return False
    cost = sum(len(carrying) ** 2 for carrying in carriers(system).values())
    angles = max(sum(body.joint.free[:3]) if body.joint.speeds_are_rates else 0 for body in system.bodies)
    return angles <= MOST_ANGLES and cost <= ARTICULATED_COST * len(system.freedoms)


class Factorisation:
    """The factors [L] and [D] of a tree, which solve [A]{ydot} = {b} for any right side.

    Attributes:
        tree: The tree.
        paths: Path through the joint of each body, by body; the free components are {ydot} itself.
        pivots: Entries of [D] by freedom; positive where [A] is regular.
        released: Freedoms of joints with three free translations, and angular velocities.
        diagonal: Diagonal entries of [A] by freedom.
        together: False.
    """

    together = False

    def __init__(self, tree: Tree) -> None:
        """Form [A], and factorise it from the outermost freedom inward."""
        n = len(tree.system.freedoms)
        self.tree = tree
        self.paths: Paths = {joint.body: joint_path(joint, together=False) for joint in tree.joints}
        self.released = released(tree, together=False)
        entries = mass_matrix(tree).entries
        a = {(i, j): entries[n * i + j] for i in range(n) for j in range(n)}
        self.diagonal = [a[i, i] for i in range(n)]
        self._carriers = carriers(tree.system)
        tree.definitions.about("[A] = [L]^T [D] [L], then {ydot}, Eq. (42)")
        self._factors, pivots = factorised(a, self._carriers, tree.definitions)
        self.pivots: Sequence[Expr] = [pivots[i] for i in range(n)]

    @property
    def regular_if_positive(self) -> Sequence[Expr]:
        """Expressions by freedom that are positive where [A] is regular."""
        return self.pivots

    def solve(self, bias: Requirement, name: str) -> list[Expr]:
        """Return {ydot}.

        Args:
            bias: What is required where all free components are zero.
            name: Prefix of the names of the entries.
        """
        b = self._remainders(self._surplus(bias))
        return self.components({k: value * self._inverse_pivot(k) for k, value in b.items()}, name)

    def components(self, over_pivots: Mapping[int, Expr], name: str) -> list[Expr]:
        """Return {ydot} from the innermost freedom outward.

        Args:
            over_pivots: The eliminated right side over the pivots, by place in {y}.
            name: Prefix of the names of the entries.
        """
        define, result = self.tree.definitions.define, dict[int, Expr]()
        for k in reversed(self._carriers):
            known = sum(self._factors.get((k, i), S.Zero) * result[i] for i in self._carriers[k])
            result[k] = define(f"{name}_{k}", define(f"bd_{k}", over_pivots[k]) - known)
        return [result[i] for i in range(len(result))]

    def reduced(self, bias: Requirement) -> Reduced:
        """Return the right side under {tau}, where `bias` is required at zero components, eliminated."""
        return self._reduced(self._surplus(bias))

    def reduced_effort(self, place: int) -> Reduced:
        """Return a unit generalized force at a place in {y}, eliminated."""
        efforts = [S.One if i == place else S.Zero for i in range(len(self.pivots))]
        with self.tree.definitions.marking(f"_u{place}"):
            return self._reduced(efforts)

    def reduced_loads(self, one: Attached) -> list[Reduced]:
        """Return unit moments, then unit forces, at a point along the inertial axes, eliminated."""
        found = partial_velocities(self.tree, one, poses(self.tree))
        self.tree.about(one.body, f"unit loads at {one.label}, eliminated")
        result: list[Reduced] = []
        for i, (velocities, axis) in enumerate(product((found.angular, found.linear), range(3)), start=1):
            with self.tree.definitions.marking(f"_l{one.number}_{i}"):
                result.append(self._reduced([velocities.get(k, ZERO)[axis] for k in range(len(self.pivots))]))
        return result

    def reduced_wrenches(self, loads: Mapping[int, Wrench], mark: str) -> Reduced:
        """Return loads on bodies, about their origins and in their frames by number of the body, eliminated.

        Args:
            loads: The loads.
            mark: End of the names of intermediates.
        """
        with self.tree.definitions.marking(mark):
            b = generalized_loads(self.tree, self.paths, loads)
            return self._reduced([b.get(k, S.Zero) for k in range(len(self.pivots))])

    def inverse(self) -> Mapping[tuple[int, int], Expr]:
        """Return the entries of [A]^-1 by row and column."""
        if products_cost_less(self._carriers):
            return products(self)
        order = list(reversed(self._carriers))
        inverses = {k: self._inverse_pivot(k) for k in order}
        self.tree.definitions.about("[A]^-1")
        return inverse_from_factors(self._factors, inverses, order, self.tree.definitions)

    def _surplus(self, bias: Requirement) -> list[Expr]:
        """Return {tau} less what is required where all free components are zero, by freedom."""
        efforts = [generalized_force(f.body, f.index) for f in self.tree.system.freedoms]
        b = [effort - work for effort, work in zip(efforts, required_efforts(self.tree, bias), strict=True)]
        self.tree.definitions.about("{ydot}, Eq. (42)")
        return b

    def _remainders(self, b: Sequence[Expr]) -> dict[int, Expr]:
        """Return what is left of a right side at the elimination of each freedom: [L]^-T {b}."""
        left = dict(enumerate(b))
        for k in self._carriers:
            left[k] = self.tree.definitions.define(f"b_{k}", left[k])
            for i in self._carriers[k]:
                left[i] -= self._factors.get((k, i), S.Zero) * left[k]
        return left

    def _reduced(self, b: Sequence[Expr]) -> Reduced:
        """Return a right side after the elimination of every freedom."""
        left = self._remainders(b)
        return Reduced(left, {k: self._over_pivot(k, value) for k, value in left.items()})

    def _over_pivot(self, k: int, remainder: Expr) -> Expr:
        """Return what is left of a right side at a freedom, over the pivot of the freedom."""
        return self.tree.definitions.define(f"bd_{k}", remainder * self._inverse_pivot(k))

    def _inverse_pivot(self, k: int) -> Expr:
        """Return 1 over the pivot of a freedom."""
        return self.tree.definitions.define(f"D_{k}i", 1 / self.pivots[k])

    def speed_rates(
        self, components: Sequence[Expr], name: str, carried: Mapping[int, Carried]
    ) -> list[Expr]:
        """Return {ydot}: the components less the accelerations that the bias left out, by body."""
        result, define = list(components), self.tree.definitions.define
        for joint in self.tree.joints:
            along = carried.get(joint.body, NOT_CARRIED)
            for one in joint.translations if joint.translates_freely else ():
                own = components[one.freedom] - along.acceleration[one.axis]
                result[one.freedom] = define(f"{name}_{one.freedom}", own)
            for speed in joint.angular_speeds:
                own = components[speed.freedom] - along.alpha[speed.axis]
                result[speed.freedom] = define(f"{name}_{speed.freedom}", own)
        return result


def carriers(
    system: System, outward: Mapping[int, Sequence[Freedom]] = MappingProxyType({})
) -> dict[int, list[int]]:
    """Return the rows of [A] that the elimination of each freedom changes, in the order of elimination.

    Freedoms are eliminated from the outermost inward. Without couplings the rows are those of the freedoms
    inward of it on its path.

    Args:
        system: The tree.
        outward: Order of the freedoms of a body, from the innermost, where it is not that of its joint.

    Returns:
        Places in {y} from the innermost, by place of the eliminated freedom.
    """
    linked, order = _pattern(system, outward)
    has_new_links = _link_rotors(system, linked)
    fills = bool(system.couplings) or has_new_links
    rank = {place: i for i, place in enumerate(order)}
    found: dict[int, list[int]] = {}
    for place in order:
        left = {other for other in linked[place] if rank[other] > rank[place]}
        found[place] = sorted(left, key=lambda other: -rank[other])
        if fills:
            for other in left:
                linked[other] |= left - {other}
    return found


def _pattern(
    system: System, orders: Mapping[int, Sequence[Freedom]]
) -> tuple[dict[int, set[int]], list[int]]:
    """Return the places in {y} that [A] links with each place, and all places in the order of elimination.

    Args:
        system: The tree.
        orders: Order of the freedoms of a body, from the innermost, where it is not that of its joint.
    """
    moved = _places_that_move(system)
    linked: dict[int, set[int]] = {place: set() for place in range(len(system.freedoms))}
    outward: dict[int, list[tuple[int, ...]]] = {0: []}
    for k, body in enumerate(system.bodies, start=1):
        own = [freedom for freedom in moved if freedom.body == k]
        own.sort(key=lambda f: (f.is_angle, f.axis))  # translations carry angles, the first angle the next
        own = list(orders.get(k, own))
        outward[k] = outward[body.lower] + [moved[freedom] for freedom in own]
    order: dict[int, None] = {}
    for k in range(system.number_of_bodies, 0, -1):
        inner = len(outward[system.connection[k - 1]])
        for i in range(len(outward[k]) - 1, inner - 1, -1):
            on_path = {place for places in outward[k][: i + 1] for place in places}
            for place in outward[k][i]:
                linked[place] |= on_path - {place}
                for other in on_path - {place}:
                    linked[other].add(place)
                order.pop(place, None)  # the innermost freedom that it moves decides
                order[place] = None
    return linked, list(order)


def _link_rotors(system: System, linked: dict[int, set[int]]) -> bool:
    """Link what drives a rotor with what turns its carrier, and return whether there are new links."""
    moved, before = _places_that_move(system), sum(map(len, linked.values()))
    for one in system.mounted_rotors:
        k = one.body
        while k and one.freedom in moved:
            turning = {place for freedom in moved if freedom.body == k for place in moved[freedom]}
            for place in moved[one.freedom]:
                linked[place] |= turning - {place}
                for other in turning - {place}:
                    linked[other].add(place)
            k = system.connection[k - 1]
    return sum(map(len, linked.values())) > before


def _places_that_move(system: System) -> dict[Freedom, tuple[int, ...]]:
    """Return the places in {y} that move each freedom, itself or through couplings."""
    found: dict[Freedom, tuple[int, ...]] = {one: (place,) for one, place in system.places.items()}
    for one in system.coupled:
        places = [place for other, _ in one.terms for place in found.get(other, ())]
        found[one.freedom] = tuple(dict.fromkeys(places))
    return {freedom: places for freedom, places in found.items() if places}
