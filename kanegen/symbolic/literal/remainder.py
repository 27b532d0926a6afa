"""What prescribed freedoms make of the motion of a body: velocities that no generalized speed has a part in.

Where some freedoms move as they are told, the angular velocity is [omega_y]{y} + {omega_t}, and velocities of
points are [v_y]{y} + {v_t}. The remainders pass outward as the columns of the partial velocities do, Eqs.
(15), (20), (28), (34), (35); without prescribed freedoms they are zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sympy import ImmutableMatrix

from kanegen.symbolic.literal.angular import AngularEquations
from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.literal.outward import outward
from kanegen.symbolic.symbols import acceleration, column, speed


@dataclass(frozen=True, eq=False, repr=False)
class RemainderEquations(AngularEquations):
    """Velocities that prescribed freedoms make, and their time derivatives; all (3, 1)."""

    @outward
    def remaining_angular_velocity(self) -> ImmutableMatrix:
        """{omega_t}, in K (rad/s)."""
        own = self.angle_rate_matrix * self._told(speed, 0)
        if self.lower is not None:
            own += self.relative_rotation * self.lower.remaining_angular_velocity
        return self._named("remaining_angular_velocity", own)

    @outward
    def remaining_angular_velocity_rate(self) -> ImmutableMatrix:
        """Time derivative of its components in K (rad/s^2)."""
        rate = self.angle_rate_matrix * self._told(acceleration, 0)
        rate += self.angle_rate_matrix_rate * self._told(speed, 0)
        if self.lower is not None:
            rate += self.relative_rotation * self.lower.remaining_angular_velocity_rate
            rate += self.relative_rotation_rate * self.lower.remaining_angular_velocity
        return self._named("remaining_angular_velocity_rate", rate)

    @outward
    def remaining_velocity_of_origin(self) -> ImmutableMatrix:
        """{v_t} of O_K in **J** components (m/s)."""
        own = self.joint_orientation.T * self._told(speed, 3)
        if self.lower is not None:
            lower = self.lower
            own += lower.relative_rotation * lower.remaining_velocity_of_origin
            own -= skew(self.offset) * lower.remaining_angular_velocity
        return self._named("remaining_velocity_of_origin", own)

    @outward
    def remaining_velocity_of_origin_rate(self) -> ImmutableMatrix:
        """Time derivative of its **J** components (m/s^2)."""
        rate = self.joint_orientation.T * self._told(acceleration, 3)
        if self.lower is not None:
            lower = self.lower
            rate += lower.relative_rotation * lower.remaining_velocity_of_origin_rate
            rate += lower.relative_rotation_rate * lower.remaining_velocity_of_origin
            rate -= skew(self.offset_rate) * lower.remaining_angular_velocity
            rate -= skew(self.offset) * lower.remaining_angular_velocity_rate
        return self._named("remaining_velocity_of_origin_rate", rate)

    @cached_property
    def remaining_velocity_of_center_rate(self) -> ImmutableMatrix:
        """Time derivative of the components in K of {v_t} of G_K (m/s^2)."""
        rate = self.relative_rotation * self.remaining_velocity_of_origin_rate
        rate += self.relative_rotation_rate * self.remaining_velocity_of_origin
        rate -= skew(column(self.body.mass_center)) * self.remaining_angular_velocity_rate
        return self._named("remaining_velocity_of_center_rate", rate)
