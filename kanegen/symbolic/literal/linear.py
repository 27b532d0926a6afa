"""How a body's origin and mass centre move, and how it accelerates: Eqs. (21)-(35), body by body.

Columns of O_K are resolved in the lower body J, columns of G_K in body K.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sympy import ImmutableMatrix

from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.literal.outward import outward
from kanegen.symbolic.literal.remainder import RemainderEquations
from kanegen.symbolic.symbols import column


@dataclass(frozen=True, eq=False, repr=False)
class LinearEquations(RemainderEquations):
    """Position, velocity and its derivatives of O_K and G_K."""

    @outward
    def position_of_origin(self) -> ImmutableMatrix:
        """O_K from the inertial origin (m), Eq. (22)."""
        lower = ImmutableMatrix.zeros(3, 1) if self.lower is None else self.lower.position_of_origin
        return ImmutableMatrix(self.relative_rotation * (lower + self.offset))

    @cached_property
    def position_of_center(self) -> ImmutableMatrix:
        """G_K from the inertial origin (m), Eq. (23)."""
        return self.position_of_origin + self._mass_center

    @outward
    def velocity_of_origin(self) -> ImmutableMatrix:
        """Velocity of O_K (m/s) in **J** components, Eq. (25)."""
        if self.lower is None:
            return self.offset_rate
        lower = self.lower
        carried = lower.relative_rotation * lower.velocity_of_origin
        turned = skew(lower.angular_velocity) * self.offset
        return self._named("velocity_of_origin", carried + self.offset_rate + turned)

    @cached_property
    def velocity_of_center(self) -> ImmutableMatrix:
        """Velocity of G_K (m/s), Eq. (27)."""
        carried = self.relative_rotation * self.velocity_of_origin
        turned = skew(self.angular_velocity) * self._mass_center
        return self._named("velocity_of_center", carried + turned)

    @cached_property
    def relative_partial_velocity(self) -> ImmutableMatrix:
        """(3, n) partial derivatives of O_K's velocity in J by {y}, in J components, Eqs. (29), (30)."""
        return self._columns(self.joint_orientation.T, 3)

    @outward
    def partial_velocity_of_origin(self) -> ImmutableMatrix:
        """(3, n) partial velocities of O_K in **J** components, Eq. (28)."""
        own = self.relative_partial_velocity
        if self.lower is not None:
            lower = self.lower
            own += lower.relative_rotation * lower.partial_velocity_of_origin
            own -= skew(self.offset) * lower.partial_angular_velocity
        return self._named("partial_velocity_of_origin", own)

    @cached_property
    def partial_velocity_of_center(self) -> ImmutableMatrix:
        """(3, n) partial velocities of G_K, Eq. (32)."""
        carried = self.relative_rotation * self.partial_velocity_of_origin
        turned = skew(self._mass_center) * self.partial_angular_velocity
        return self._named("partial_velocity_of_center", carried - turned)

    @outward
    def partial_velocity_of_origin_rate(self) -> ImmutableMatrix:
        """(3, n) time derivative of the partial velocities of O_K in **J** components, Eq. (35)."""
        rate = ImmutableMatrix.zeros(3, len(self.system.freedoms))
        if self.lower is not None:
            lower = self.lower
            rate += lower.relative_rotation * lower.partial_velocity_of_origin_rate
            rate += lower.relative_rotation_rate * lower.partial_velocity_of_origin
            rate -= skew(self.offset_rate) * lower.partial_angular_velocity
            rate -= skew(self.offset) * lower.partial_angular_velocity_rate
        return self._named("partial_velocity_of_origin_rate", rate)

    @cached_property
    def partial_velocity_of_center_rate(self) -> ImmutableMatrix:
        """(3, n) time derivative of the partial velocities of G_K, Eq. (34)."""
        rate = self.relative_rotation * self.partial_velocity_of_origin_rate
        rate += self.relative_rotation_rate * self.partial_velocity_of_origin
        rate -= skew(self._mass_center) * self.partial_angular_velocity_rate
        return self._named("partial_velocity_of_center_rate", rate)

    @cached_property
    def angular_acceleration_bias(self) -> ImmutableMatrix:
        """Angular acceleration where {ydot} is zero (rad/s^2), the expansion above Eq. (20)."""
        return self.partial_angular_velocity_rate * self._y + self.remaining_angular_velocity_rate

    @cached_property
    def angular_acceleration(self) -> ImmutableMatrix:
        """Angular acceleration (rad/s^2), the expansion above Eq. (20)."""
        return self.partial_angular_velocity * self._ydot + self.angular_acceleration_bias

    @cached_property
    def acceleration_bias(self) -> ImmutableMatrix:
        """Acceleration of G_K where {ydot} is zero (m/s^2), the last two terms of Eq. (33)."""
        turned = skew(self.angular_velocity) * self.velocity_of_center
        told = self.remaining_velocity_of_center_rate
        return self.partial_velocity_of_center_rate * self._y + told + turned

    @cached_property
    def acceleration_of_center(self) -> ImmutableMatrix:
        """Acceleration of G_K (m/s^2), Eq. (33)."""
        return self.partial_velocity_of_center * self._ydot + self.acceleration_bias

    @property
    def _mass_center(self) -> ImmutableMatrix:
        return column(self.body.mass_center)
