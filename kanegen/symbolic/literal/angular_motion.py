"""Orientation, angular velocity and angular acceleration of a body, Eqs. (2)-(20).

Columns are resolved in body K. Where some freedoms are prescribed, the angular velocity is
[omega_y]{y} + {omega_t}; the remainder {omega_t}, which does not depend on {y}, passes outward as the columns
of the partial angular velocity do. Without prescribed freedoms the remainder is zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sympy import ImmutableMatrix

from kanegen.symbolic.literal.joint import NOTHING, JointEquations
from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.literal.outward_property import outward_property
from kanegen.symbolic.matrices import FiniteMatrix


@dataclass(frozen=True, eq=False, repr=False)
class AngularEquations(JointEquations):
    """Orientation, angular velocity and angular acceleration of body K."""

    @cached_property
    def relative_rotation(self) -> ImmutableMatrix:
        """[^J R_K] = [R_123] [C_K], (3, 3): J to K components, Eqs. (2), (4)."""
        return self._named("relative_rotation", self._orientation.rotation * self.joint_orientation)

    @cached_property
    def relative_rotation_rate(self) -> ImmutableMatrix:
        """Time derivative of [^J R_K], (3, 3), Eq. (7)."""
        return skew(self.relative_angular_velocity).T * self.relative_rotation

    @outward_property
    def rotation(self) -> ImmutableMatrix:
        """[R_K], (3, 3): inertial to K components, Eqs. (3), (5)."""
        if self.lower is None:
            return self.relative_rotation
        return self._named("rotation", self.relative_rotation * self.lower.rotation)

    @cached_property
    def rotation_rate(self) -> ImmutableMatrix:
        """Time derivative of [R_K], (3, 3), Eq. (6)."""
        return skew(self.angular_velocity).T * self.rotation

    @cached_property
    def angle_rate_matrix(self) -> ImmutableMatrix:
        """[P^AV_K], (3, 3): speeds of the three angles to relative angular velocity, Eq. (17).

        It is the identity where the speeds are the components of the relative angular velocity.
        """
        if not self.body.joint.speeds_are_rates:
            return FiniteMatrix.eye(3)
        return self._named("angle_rate_matrix", self._orientation.rate_matrix)

    @cached_property
    def angle_rate_matrix_rate(self) -> ImmutableMatrix:
        """Time derivative of [P^AV_K], (3, 3), below Eq. (20)."""
        if not self.body.joint.speeds_are_rates:
            return FiniteMatrix.zeros(3, 3)
        return self._named("angle_rate_matrix_rate", self._orientation.rate_matrix_rate(self._turning_speeds))

    @cached_property
    def angle_rate_inverse(self) -> ImmutableMatrix:
        """Relative angular velocity to rates of the angles, (3, 3), Eq. (9), or of a quaternion, (4, 3)."""
        return self._orientation.rate_inverse

    @cached_property
    def relative_angular_velocity(self) -> ImmutableMatrix:
        """Angular velocity of K in J, (3, 1) (rad/s), Eq. (8)."""
        return self._named("relative_angular_velocity", self.angle_rate_matrix * self._turning_speeds)

    @outward_property
    def angular_velocity(self) -> ImmutableMatrix:
        """Angular velocity of K in the inertial frame, (3, 1) (rad/s), Eqs. (11), (19)."""
        if self.lower is None:
            return self.relative_angular_velocity
        carried = self.relative_rotation * self.lower.angular_velocity
        return self._named("angular_velocity", carried + self.relative_angular_velocity)

    @cached_property
    def relative_partial_angular_velocity(self) -> ImmutableMatrix:
        """Partial derivatives of the relative angular velocity with respect to {y}, (3, n), Eq. (16)."""
        return self._columns(self.angle_rate_matrix, 0)

    @outward_property
    def partial_angular_velocity(self) -> ImmutableMatrix:
        """Partial derivatives of the angular velocity with respect to {y}, (3, n), Eq. (15)."""
        own = self.relative_partial_angular_velocity
        if self.lower is not None:
            own += self.relative_rotation * self.lower.partial_angular_velocity
        return self._named("partial_angular_velocity", own)

    @outward_property
    def partial_angular_velocity_rate(self) -> ImmutableMatrix:
        """Time derivative of the partial angular velocities, (3, n), Eq. (20)."""
        rate = self._columns(self.angle_rate_matrix_rate, 0)
        if self.lower is not None:
            rate += self.relative_rotation * self.lower.partial_angular_velocity_rate
            rate += self.relative_rotation_rate * self.lower.partial_angular_velocity
        return self._named("partial_angular_velocity_rate", rate)

    @outward_property
    def remaining_angular_velocity(self) -> ImmutableMatrix:
        """{omega_t}, (3, 1): angular velocity that prescribed freedoms cause (rad/s)."""
        if not self.system.prescribed:
            return NOTHING
        own = self.angle_rate_matrix * self._prescribed(self.symbols.speed, 0)
        if self.lower is not None:
            own += self.relative_rotation * self.lower.remaining_angular_velocity
        return self._named("remaining_angular_velocity", own)

    @outward_property
    def remaining_angular_velocity_rate(self) -> ImmutableMatrix:
        """Time derivative of the K components of {omega_t}, (3, 1) (rad/s^2)."""
        if not self.system.prescribed:
            return NOTHING
        rate = self.angle_rate_matrix * self._prescribed(self.symbols.acceleration, 0)
        rate += self.angle_rate_matrix_rate * self._prescribed(self.symbols.speed, 0)
        if self.lower is not None:
            rate += self.relative_rotation * self.lower.remaining_angular_velocity_rate
            rate += self.relative_rotation_rate * self.lower.remaining_angular_velocity
        return self._named("remaining_angular_velocity_rate", rate)

    @cached_property
    def angular_acceleration_bias(self) -> ImmutableMatrix:
        """Angular acceleration where {ydot} is zero, (3, 1) (rad/s^2), the expansion above Eq. (20)."""
        return self.partial_angular_velocity_rate * self._y + self.remaining_angular_velocity_rate

    @cached_property
    def angular_acceleration(self) -> ImmutableMatrix:
        """Angular acceleration, (3, 1) (rad/s^2), the expansion above Eq. (20)."""
        return self.partial_angular_velocity * self._ydot + self.angular_acceleration_bias
