"""Bounds of the pivots of a solver that hold in every state, from the constants and translations of a model.

The pivot of a freedom is twice the least kinetic energy of the bodies that it carries, at unit speed of the
freedom, over all speeds of the freedoms outward of it. The sums that make up a pivot consist of inertias of
carried bodies about the axis of the freedom. None of them is larger than that of a body as far away as its
path allows: `PivotBounds.carried`. Rounding changes a pivot by a few unit roundoffs of the latter.

A pivot is never less than the energy of some of the bodies alone: `PivotBounds.least`. For the first angle
that moves inward of a body, the inertia of the body about its axis is known exactly: translations between
the two cannot reduce what its motion across them costs. Elsewhere the body of the joint alone counts. For a
freedom that couplings name, there is no lower bound.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from sympy import Expr, Rational, S

from kanegen.model.body import Body
from kanegen.recursion.constants import exact
from kanegen.recursion.frames import fixed_frame
from kanegen.recursion.joint_motion import NO_FREEDOM, FreedomMotion, JointMotion, Step
from kanegen.recursion.principal_inertia import largest_inertia, least_inertia
from kanegen.recursion.reach import NO_DISTANCE, Reach, Square
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import dot
from kanegen.symbolic.definitions import Vector


@dataclass(frozen=True)
class Bound:
    """A bound of an inertia about an axis, or of a mass.

    Attributes:
        constant: Constant part (kg m^2, kg).
        masses: Factors (kg) of the squares of numbers that translations change, by number.
    """

    constant: Expr = S.Zero
    masses: Mapping[Expr, Expr] = field(default_factory=dict)

    def plus(self, inertia: Expr, mass: Expr = S.Zero, square: Square = NO_DISTANCE) -> Bound:
        """Return the bound with an inertia more, and a mass at a distance."""
        masses = dict(self.masses)
        if mass != 0:
            masses |= {one: masses.get(one, S.Zero) + mass * factor for one, factor in square.moving}
        return Bound(self.constant + inertia + mass * square.constant, masses)


class PivotBounds:
    """Bounds of the pivots of a solver and of the inertias that freedoms carry, by freedom (kg m^2, kg).

    Args:
        tree: The tree.
        together: Whether three free angles or translations are eliminated as components in the body's frame;
            the mass of a body that translates freely then does not load the lower body.
    """

    def __init__(self, tree: Tree, *, together: bool) -> None:
        self._tree, self._together = tree, together
        self._carried = [Bound() for _ in tree.system.freedoms]
        self._least = list(self._carried)
        self._widened: set[int] = set()
        self._moved = Counter(i for joint in tree.joints for one in joint.freedoms for i in one.shares)
        for joint in tree.joints:
            body = tree.system.bodies[joint.body - 1]
            tree.about(joint.body, "bounds of the pivots that it is part of")
            carries = any(one.body == joint.body for one in tree.system.mounted_rotors)
            own = S.Zero if carries else least_inertia(body)
            for freedom, least in _least_of_joint(body, own, joint, together).items():
                self._least[freedom] = Bound(least)
            self._carry(joint)
            self._add_motors(joint)

    def carried(self, freedom: int, share: Rational = S.One) -> Expr:
        """Return a share of the bound of the inertias that a freedom carries."""
        define, masses = self._tree.definitions.define, self._carried[freedom].masses
        if not masses:
            return self.constant(freedom, share)
        moments = [define(f"hs_{freedom}", mass * number) for number, mass in masses.items()]
        terms = [define(f"Us_{freedom}", n * moment) for n, moment in zip(masses, moments, strict=True)]
        moving = define(f"Us_{freedom}", sum(terms, S.Zero))
        if freedom not in self._widened:  # the solver forms the same inertia
            return share * define(f"Ut_{freedom}", self.constant(freedom) + moving)
        return define(
            f"Ut_{freedom}", self.constant(freedom, share) + define(f"Us_{freedom}", share * moving)
        )

    def constant(self, freedom: int, share: Rational = S.One) -> Expr:
        """Return a share of the part of the same bound that depends on no translation."""
        return self._tree.definitions.define(f"U_{freedom}", share * self._carried[freedom].constant)

    def least(self, freedom: int) -> Expr:
        """Return a lower bound of the pivot of a freedom where all translations are zero, or zero."""
        return self._tree.definitions.define(f"Dl_{freedom}", self._least[freedom].constant)

    def loses_nothing(self, freedom: int) -> bool:
        """Return whether the two bounds are the same in every state."""
        return self._least[freedom] == self._carried[freedom]

    def has_largest_loss(self, freedom: int) -> bool:
        """Return whether no translation increases the ratio of the two bounds."""
        least = self._least[freedom]
        return least.constant != 0 and least.masses == self._carried[freedom].masses

    def _carry(self, joint: JointMotion) -> None:
        """Add the inertia of the body of a joint to the bounds of all freedoms that carry it."""
        body = self._tree.system.bodies[joint.body - 1]
        mass, largest = exact(body.mass), largest_inertia(body)
        reach = Reach(self._tree.definitions, Vector(*(exact(value) for value in body.mass_center)))
        for below in self._tree.inward(joint):
            freely = self._together and below.translates_freely
            if below.angular_speeds:
                for speed in below.angular_speeds:
                    self._add(speed, largest, mass, *reach.distance())
                reach = reach.below_any_rotation()
            else:
                reach = self._add_to_angles(below, body, mass, largest, reach)
            for one in below.translations:
                self._add(one, mass, S.Zero)
            if freely and (below.turns_freely or below.rotates_freely):
                return
            if freely:
                # Whatever the distance, the moment of the mass about the axes of inward turns vanishes.
                mass = S.Zero
            reach = reach.below_joint(self._tree, below)

    def _add_motors(self, joint: JointMotion) -> None:
        """Add armature and rotors to the bounds of the freedoms of a joint.

        The energy of a body and its rotor is not less than that of the body without the inertia J about the
        rotor's axis, if the freedom may move the body. The coupling of both is bounded by 2 J n omega y <=
        J omega^2 + J n^2 y^2.
        """
        system, inward = self._tree.system, {inner.lower for inner in self._tree.inward(joint)}
        armature = system.bodies[joint.body - 1].joint.armature
        freedoms = {number: freedom for freedom, number in system.moving_places.items()}
        for one in joint.freedoms:
            freedom, carried = freedoms[one.number], one.armature
            certain = exact(armature[freedom.index])
            for mounted in system.mounted_rotors:
                if mounted.freedom == freedom:
                    inertia, ratio = exact(mounted.rotor.inertia), exact(mounted.rotor.ratio)
                    if mounted.body in inward and not system.couplings:
                        certain += inertia * ratio**2
                    else:
                        carried += inertia + inertia * ratio**2
            for place, factor in one.shares.items():
                self._carried[place] = self._carried[place].plus(factor**2 * carried)
            if one.freedom != NO_FREEDOM:
                self._least[one.freedom] = self._least[one.freedom].plus(certain)

    def _add_to_angles(
        self, joint: JointMotion, body: Body, mass: Expr, largest: Expr, reach: Reach
    ) -> Reach:
        """Add the inertia of a body to the bounds of the angles of a joint that carries it.

        Args:
            joint: The joint.
            body: The body.
            mass: Its mass (kg), zero if the joint does not feel it.
            largest: Bound of its inertia about any axis through its mass centre (kg m^2).
            reach: Where its mass centre is above the joint.

        Returns:
            Where its mass centre is below the angles.
        """
        components = self._together and joint.rotates_freely
        for step in reversed(joint.angles):
            if step.shares:
                known = _comes_first(joint, self._together) and not step.is_coupled
                axis = reach.upward(step.axis) if known else None
                if axis:
                    self._raise_least(step, self._inertia_without_rotors(body, axis), mass, reach)
                if axis and _is_basis_vector(axis):
                    self._add_exactly(step, _inertia_about(body, axis), mass, reach)
                else:
                    distance = reach.distance(None if components else step.axis)
                    self._add(step, largest, mass, *distance)
            reach = reach.below(step)
        return reach

    def _add(
        self,
        one: FreedomMotion,
        inertia: Expr,
        mass: Expr,
        distance: Expr = S.Zero,
        excursions: tuple[Square, ...] = (),
    ) -> None:
        """Add the inertia of a body about an axis at a distance, to which excursions add, to bounds.

        The square of a sum is at most the number of its terms times the sum of their squares. So it is for
        the motions that one entry of {y} gives to a body through several coupled freedoms.
        """
        terms = [Square(distance * distance)] if distance != 0 else []
        for place, share in one.shares.items():
            weight = self._moved[place] * share**2
            bound = self._carried[place].plus(weight * inertia)
            for square in (*terms, *excursions):
                bound = bound.plus(S.Zero, (len(terms) + len(excursions)) * weight * mass, square)
            if len(terms) + len(excursions) > 1 or one.is_coupled:
                self._widened.add(place)
            self._carried[place] = bound

    def _add_exactly(self, step: Step, inertia: Expr, mass: Expr, reach: Reach) -> None:
        """Add a body with its inertia about the axis of a turn, and through its mass centre, to a bound.

        No turn mixes its components on the way, so that the pivot is not a sum of larger numbers.
        """
        bound = self._carried[step.freedom].plus(inertia, mass, reach.square(step.axis))
        self._carried[step.freedom] = bound

    def _inertia_without_rotors(self, body: Body, direction: Vector) -> Expr:
        """Return the inertia of a body about an axis through its mass centre, without that of its rotors."""
        found, system = _inertia_about(body, direction), self._tree.system
        for one in system.mounted_rotors:
            if one.body and system.bodies[one.body - 1] is body:
                frame = fixed_frame(self._tree, one.frame, one.body)
                along = dot(frame.inward(Vector(*map(exact, one.direction))), direction)
                found -= exact(one.rotor.inertia) * along**2
        return found

    def _raise_least(self, step: Step, inertia: Expr, mass: Expr, reach: Reach) -> None:
        """Add a body to the lower bound of the first angle that moves inward of it.

        A translation across the axis may follow the motion of the mass centre that is along its direction,
        and that is caused by the distance across the direction. The arguments are those of `_add_exactly`.
        """
        square, followed = reach.square(step.axis), len(reach.across(step.axis))
        if followed == 1:
            square = Square(moving=square.moving)
        self._least[step.freedom] = self._least[step.freedom].plus(
            inertia, mass, square if followed < 2 else NO_DISTANCE
        )


def _comes_first(joint: JointMotion, together: bool) -> bool:
    """Return whether the last angle of a joint is eliminated before all else that moves its body."""
    return not (together and (joint.rotates_freely or joint.translates_freely))


def _least_of_joint(body: Body, least: Expr, joint: JointMotion, together: bool) -> dict[int, Expr]:
    """Return lower bounds of the pivots of a joint by freedom, from its own body.

    The last angle of a joint is left out where `PivotBounds` knows it exactly.

    Args:
        body: The body.
        least: Lower bound of its smallest principal inertia (kg m^2).
        joint: Its joint.
        together: As for `PivotBounds`.
    """
    if any(one.is_coupled for one in joint.freedoms):
        return {}
    mass, center = exact(body.mass), [exact(value) for value in body.mass_center]
    angles = [step for step in joint.angles if step.freedom != NO_FREEDOM]
    rotations = [step.freedom for step in angles] + [speed.freedom for speed in joint.angular_speeds]
    found = dict.fromkeys(
        rotations, least if _are_orthogonal(angles, together and joint.rotates_freely) else S.Zero
    )
    moving = [step for step in joint.angles if step.moves]
    if moving and _comes_first(joint, together):
        found.pop(moving[-1].freedom, None)
    carried = mass
    if rotations and not (together and joint.translates_freely):
        # The body may turn instead of following with its mass centre.
        offset = mass * sum((one**2 for one in center), S.Zero)
        carried = mass if offset == 0 else S.Zero
        if least != 0 and not offset.free_symbols:
            carried = mass * least / (least + offset)
    return found | {one.freedom: carried for one in joint.translations}


def _are_orthogonal(angles: list[Step], together: bool) -> bool:
    """Return whether the free angles of a joint turn about orthogonal axes in every state."""
    if len(angles) == 3:
        return together
    return len(angles) < 2 or angles[1].angle - angles[0].angle == 1


def _is_basis_vector(direction: Vector) -> bool:
    """Return whether a unit vector is a basis vector up to its sign."""
    return all(component in (-1, 0, 1) for component in direction)


def _inertia_about(body: Body, direction: Vector) -> Expr:
    """Return the inertia of a body about an axis through its mass centre."""
    terms = [direction[i] * direction[j] * exact(body.inertia[i][j]) for i in range(3) for j in range(3)]
    return sum(terms, S.Zero)
