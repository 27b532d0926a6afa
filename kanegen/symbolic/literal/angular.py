"""How a body turns: Eqs. (2)-(20), body by body. Columns are resolved in body K."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sympy import ImmutableMatrix

from kanegen.symbolic.literal.joint_frame import JointEquations
from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.literal.outward import outward


@dataclass(frozen=True, eq=False, repr=False)
class AngularEquations(JointEquations):
    """Orientation, angular velocity and its derivatives of body K."""

    @cached_property
    def relative_rotation(self) -> ImmutableMatrix:
        """[^J R_K] = [R_123] [C_K], from J to K components, Eqs. (2), (4)."""
        return self._named("relative_rotation", self._orientation.rotation * self.joint_orientation)

    @cached_property
    def relative_rotation_rate(self) -> ImmutableMatrix:
        """Time derivative of [^J R_K], Eq. (7)."""
        return skew(self.relative_angular_velocity).T * self.relative_rotation

    @outward
    def rotation(self) -> ImmutableMatrix:
        """[R_K], from inertial to K components, Eqs. (3), (5)."""
        if self.lower is None:
            return self.relative_rotation
        return self._named("rotation", self.relative_rotation * self.lower.rotation)

    @cached_property
    def rotation_rate(self) -> ImmutableMatrix:
        """Time derivative of [R_K], Eq. (6)."""
        return skew(self.angular_velocity).T * self.rotation

    @cached_property
    def angle_rate_matrix(self) -> ImmutableMatrix:
        """[P^AV_K], Eq. (17), all three columns: speeds of the angles to relative angular velocity.

        The identity where the speeds are the components of this velocity.
        """
        if self.body.joint.spins:
            return ImmutableMatrix.eye(3)
        return self._named("angle_rate_matrix", self._angles.rate_matrix)

    @cached_property
    def angle_rate_matrix_rate(self) -> ImmutableMatrix:
        """Time derivative of [P^AV_K], below Eq. (20)."""
        if self.body.joint.spins:
            return ImmutableMatrix.zeros(3, 3)
        return self._named("angle_rate_matrix_rate", self._angles.rate_matrix_rate(self._turning_speeds))

    @cached_property
    def angle_rate_inverse(self) -> ImmutableMatrix:
        """Inverse of Eq. (8), Eq. (9): relative angular velocity to angle rates, or those of a quaternion."""
        return self._orientation.rate_inverse

    @cached_property
    def relative_angular_velocity(self) -> ImmutableMatrix:
        """Angular velocity of K in J (rad/s), Eq. (8)."""
        return self._named("relative_angular_velocity", self.angle_rate_matrix * self._turning_speeds)

    @outward
    def angular_velocity(self) -> ImmutableMatrix:
        """Angular velocity of K in the inertial frame (rad/s), Eqs. (11), (19)."""
        if self.lower is None:
            return self.relative_angular_velocity
        carried = self.relative_rotation * self.lower.angular_velocity
        return self._named("angular_velocity", carried + self.relative_angular_velocity)

    @cached_property
    def relative_partial_angular_velocity(self) -> ImmutableMatrix:
        """(3, n) partial derivatives of the relative angular velocity by {y}, Eq. (16)."""
        return self._columns(self.angle_rate_matrix, 0)

    @outward
    def partial_angular_velocity(self) -> ImmutableMatrix:
        """(3, n) partial derivatives of the angular velocity by {y}, Eq. (15)."""
        own = self.relative_partial_angular_velocity
        if self.lower is not None:
            own += self.relative_rotation * self.lower.partial_angular_velocity
        return self._named("partial_angular_velocity", own)

    @outward
    def partial_angular_velocity_rate(self) -> ImmutableMatrix:
        """(3, n) time derivative of the partial angular velocities, Eq. (20)."""
        rate = self._columns(self.angle_rate_matrix_rate, 0)
        if self.lower is not None:
            rate += self.relative_rotation * self.lower.partial_angular_velocity_rate
            rate += self.relative_rotation_rate * self.lower.partial_angular_velocity
        return self._named("partial_angular_velocity_rate", rate)
