"""The output {xdot}, and the map between the rates of a joint's angles and its relative angular velocity.

Eqs. (8), (9) hold for any sequence of axes. In the frame between the second turn and the third, the second
and third axes are basis vectors, and the first is a vector {v} without a component along the second. The
first rate is therefore the component of the angular velocity across both basis vectors over that of {v}.
Where the latter is zero, the three axes lie in a plane (gimbal lock) and no rates exist: for 1-2-3 it is the
cosine of theta2, for a sequence that ends with its first axis the sine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.joint_motion import JointMotion, Step
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.turns import rotation_rates, turnings_as_a_whole
from kanegen.recursion.vectors import unit
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.symbols import coordinate_rate


def coordinate_rates(tree: Tree) -> Derived:
    """Derive the entries of {xdot}: Eq. (9) where speeds are angular velocities, Eq. (45) elsewhere."""
    system = tree.system
    rates: list[Expr] = [coordinate_rate(one.body, one.index) for one in system.coordinates]
    positive: dict[int, Expr] = {}
    for joint in tree.joints:
        if joint.angular_speeds:
            tree.about(joint.body, "rates of the orientation, Eq. (9)")
            places = _orientation_places(joint, tree)
            names = [f"xdot_{place}" for place in places]
            if joint.composed_of:
                found = _rates_of_angles(joint, tree, names, positive)
            else:
                found = _rates_as_a_whole(joint, tree, names)
            for place, rate in zip(places, found, strict=True):
                rates[place] = rate
    if not positive:
        return Derived(rates)
    return Derived(rates, [positive.get(place, S.One) for place in range(len(system.freedoms))])


def _rates_of_angles(
    joint: JointMotion, tree: Tree, names: Sequence[str], positive: dict[int, Expr]
) -> Sequence[Expr]:
    """Return the rates of the angles of a joint; add to `positive` a square that is zero at gimbal lock."""
    one, two, three = names
    found = angle_rates(joint, tree.definitions)
    square = tree.definitions.define(f"Cq_{joint.body}", found.across * found.across)
    # Gimbal lock is a matter of the middle angle, which the status therefore names.
    positive[joint.angular_speeds[1].freedom] = square
    return found.rates(joint.relative_omega, (one, two, three))


def _rates_as_a_whole(joint: JointMotion, tree: Tree, names: Sequence[str]) -> Sequence[Expr]:
    """Return the rates of the coordinates of a rotation that is not made of turns about axes."""
    rotation = tree.system.bodies[joint.body - 1].joint.rotation
    rates = rotation_rates(joint.body, rotation, joint.relative_omega)
    return [tree.definitions.define(name, rate) for name, rate in zip(names, rates, strict=True)]


def turnings(joint: JointMotion, tree: Tree) -> dict[int, Vector]:
    """Return the rotation of K on J, in K, for a unit change of each coordinate of the orientation, Eq. (8).

    Args:
        joint: The joint of K; its speeds are components of the relative angular velocity.
        tree: The tree.

    Returns:
        Rotations by place in {x}.
    """
    places = _orientation_places(joint, tree)
    if not joint.composed_of:
        rotation = tree.system.bodies[joint.body - 1].joint.rotation
        return dict(zip(places, turnings_as_a_whole(joint.body, rotation, tree.definitions), strict=True))
    return dict(zip(places, axes_of_angles(joint.composed_of, tree.definitions), strict=True))


def axes_of_angles(steps: Sequence[Step], definitions: Definitions) -> list[Vector]:
    """Return the axes of angles in the frame above all turns, one for each."""
    axes: list[Vector] = []
    for step in steps:
        turned = [step.turn.up(axis) for axis in axes]
        axes = [definitions.vector(f"ba_{step.frame}_{i}", axis) for i, axis in enumerate(turned, start=1)]
        axes.append(unit(step.axis))
    return axes


def _orientation_places(joint: JointMotion, tree: Tree) -> list[int]:
    """Return the places in {x} of the coordinates that orient the body of a joint."""
    return [
        place
        for coordinate, place in tree.system.coordinate_places.items()
        if coordinate.body == joint.body and not coordinate.is_translation
    ]


@dataclass(frozen=True)
class AngleRates:
    """The map between rates and angular velocity of a joint whose three angles are free.

    Attributes:
        body: Number of body K.
        first: Turn of theta1.
        second: Turn of theta2.
        third: Turn of theta3.
        definitions: Definitions that the intermediates are added to.
    """

    body: int
    first: Step
    second: Step
    third: Step
    definitions: Definitions

    @property
    def across(self) -> Expr:
        """The component of {v} that vanishes where the axes lie in a plane."""
        return self._v[self._across_axis]

    def rates(self, omega: Vector, names: tuple[str, str, str]) -> tuple[Expr, Expr, Expr]:
        """Return the rates of the angles, Eq. (9).

        Args:
            omega: Relative angular velocity, in K (rad/s); or the part of the relative angular acceleration
                that is linear in second derivatives (rad/s^2), for which the same map gives second
                derivatives.
            names: Names of the rates.
        """
        define = self.definitions.define
        between = self.third.turn.down(omega)
        across = define(f"qq_{self.body}", between[self._across_axis])
        one = define(names[0], across * self._reciprocal)
        two = define(names[1], between[self.second.axis])
        three = define(names[2], between[self.third.axis] - self._v[self.third.axis] * one)
        return one, two, three

    def angular(self, rates: tuple[Expr, Expr, Expr]) -> Vector:
        """Return the relative angular velocity, in K, of rates of the angles, Eq. (8)."""
        one, two, three = rates
        between = {
            self._across_axis: self.definitions.define(f"omegar_{self.body}_q", self.across * one),
            self.second.axis: two,
            self.third.axis: self._v[self.third.axis] * one + three,
        }
        return self.third.turn.up(Vector(between[0], between[1], between[2]))

    def torque(self, efforts: tuple[Expr, Expr, Expr]) -> Vector:
        """Return the torque {T}, in K, of the generalized forces {tau} on the angles: [P]^T {T} = {tau}."""
        one, two, three = efforts
        name = f"T_{self.body}"
        surplus = one - self._v[self.third.axis] * three
        between = {
            self._across_axis: self.definitions.define(f"{name}_q", surplus * self._reciprocal),
            self.second.axis: two,
            self.third.axis: three,
        }
        torque = self.third.turn.up(Vector(between[0], between[1], between[2]))
        return self.definitions.vector(name, torque)

    @property
    def _v(self) -> Vector:
        """The first axis {v} in the frame between the second turn and the third."""
        return self.second.turn.up(unit(self.first.axis))

    @property
    def _across_axis(self) -> int:
        """The axis that is neither the second nor the third."""
        return 3 - self.second.axis - self.third.axis

    @property
    def _reciprocal(self) -> Expr:
        """The symbol of 1 over `across`, which gives the first rate."""
        return self.definitions.define(f"Ci_{self.second.frame}", 1 / self.across)


def angle_rates(joint: JointMotion, definitions: Definitions) -> AngleRates:
    """Return the map between rates and angular velocity of a joint whose three angles are free."""
    first, second, third = joint.composed_of if joint.angular_speeds else joint.angles
    return AngleRates(joint.body, first, second, third, definitions)
