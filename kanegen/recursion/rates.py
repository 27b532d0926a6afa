"""Between the rates of a joint's angles and its relative angular velocity: Eqs. (8), (9) for any sequence.

In the frame between the second turn and the third, the second and third axes are basis vectors, and the first
is {v}, which has no component along the second. So only one component of an angular velocity stands between
it and the first rate, that across both basis vectors; where {v} has none, the axes lie in a plane and no
rates exist. For 1-2-3 it is the middle cosine, for a sequence that begins and ends with one axis a sine.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr

from kanegen.recursion.joint_motion import JointMotion, Step
from kanegen.recursion.vectors import unit
from kanegen.symbolic.definitions import Definitions, Vector


@dataclass(frozen=True)
class AngleRates:
    """The map of a joint whose three angles are free.

    Attributes:
        body: K.
        first: The turn of theta1.
        second: That of theta2.
        third: That of theta3.
        definitions: Take the intermediates.
    """

    body: int
    first: Step
    second: Step
    third: Step
    definitions: Definitions

    @property
    def across(self) -> Expr:
        """The component of {v} that vanishes where the axes lie in a plane."""
        return self._v[self._free_axis]

    def rates(self, omega: Vector, names: tuple[str, str, str]) -> tuple[Expr, Expr, Expr]:
        """The rates behind a relative angular velocity, Eq. (9).

        Args:
            omega: In K (rad/s). Or what the second derivatives make of a relative angular acceleration.
            names: Of the rates.
        """
        define = self.definitions.define
        between = self.third.turn.down(omega)
        across = define(f"qq_{self.body}", between[self._free_axis])
        one = define(names[0], across * self._reciprocal)
        two = define(names[1], between[self.second.axis])
        three = define(names[2], between[self.third.axis] - self._v[self.third.axis] * one)
        return one, two, three

    def torque(self, efforts: tuple[Expr, Expr, Expr]) -> Vector:
        """The torque, in K, that works on the rates as their efforts do: [P]^T {T} = {tau}."""
        one, two, three = efforts
        name = f"T_{self.body}"
        surplus = one - self._v[self.third.axis] * three
        between = {
            self._free_axis: self.definitions.define(f"{name}_q", surplus * self._reciprocal),
            self.second.axis: two,
            self.third.axis: three,
        }
        torque = self.third.turn.up(Vector(between[0], between[1], between[2]))
        return self.definitions.vector(name, torque)

    @property
    def _v(self) -> Vector:
        """The first axis between the second turn and the third."""
        return self.second.turn.up(unit(self.first.axis))

    @property
    def _free_axis(self) -> int:
        """Neither the second axis nor the third."""
        return 3 - self.second.axis - self.third.axis

    @property
    def _reciprocal(self) -> Expr:
        return self.definitions.define(f"Ci_{self.second.frame}", 1 / self.across)


def angle_rates(motion: JointMotion, definitions: Definitions) -> AngleRates:
    """The map of a joint whose three angles are free."""
    first, second, third = motion.behind if motion.spins else motion.angles
    return AngleRates(motion.body, first, second, third, definitions)
