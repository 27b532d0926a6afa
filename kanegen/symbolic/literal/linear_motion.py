"""Position, velocity and acceleration of the origin and the mass centre of a body, Eqs. (21)-(35).

Columns of the origin O_K are resolved in the lower body J, columns of the mass centre G_K in body K. Where
some freedoms are prescribed, velocities are [v_y]{y} + {v_t}; the remainders {v_t} pass outward as the
columns of the partial velocities do. Without prescribed freedoms they are zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sympy import ImmutableMatrix

from kanegen.symbolic.literal.angular_motion import AngularEquations
from kanegen.symbolic.literal.joint import NOTHING
from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.literal.outward_property import outward_property
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.symbols import column


@dataclass(frozen=True, eq=False, repr=False)
class LinearEquations(AngularEquations):
    """Position, velocity and acceleration of O_K and G_K."""

    @outward_property
    def position_of_origin(self) -> ImmutableMatrix:
        """O_K from the inertial origin in K components, (3, 1) (m), Eq. (22)."""
        lower = FiniteMatrix.zeros(3, 1) if self.lower is None else self.lower.position_of_origin
        return FiniteMatrix(self.relative_rotation * (lower + self.offset))

    @cached_property
    def position_of_center(self) -> ImmutableMatrix:
        """G_K from the inertial origin in K components, (3, 1) (m), Eq. (23)."""
        return self.position_of_origin + self._mass_center

    @outward_property
    def velocity_of_origin(self) -> ImmutableMatrix:
        """Velocity of O_K in **J** components, (3, 1) (m/s), Eq. (25)."""
        if self.lower is None:
            return self.offset_rate
        lower = self.lower
        carried = lower.relative_rotation * lower.velocity_of_origin
        turned = skew(lower.angular_velocity) * self.offset
        return self._named("velocity_of_origin", carried + self.offset_rate + turned)

    @cached_property
    def velocity_of_center(self) -> ImmutableMatrix:
        """Velocity of G_K in K components, (3, 1) (m/s), Eq. (27)."""
        carried = self.relative_rotation * self.velocity_of_origin
        turned = skew(self.angular_velocity) * self._mass_center
        return self._named("velocity_of_center", carried + turned)

    @cached_property
    def relative_partial_velocity(self) -> ImmutableMatrix:
        """Partial derivatives of O_K's velocity in J with respect to {y}, (3, n), Eqs. (29), (30)."""
        return self._columns(self.joint_orientation.T, 3)

    @outward_property
    def partial_velocity_of_origin(self) -> ImmutableMatrix:
        """Partial velocities of O_K in **J** components, (3, n), Eq. (28)."""
        own = self.relative_partial_velocity
        if self.lower is not None:
            lower = self.lower
            own += lower.relative_rotation * lower.partial_velocity_of_origin
            own -= skew(self.offset) * lower.partial_angular_velocity
        return self._named("partial_velocity_of_origin", own)

    @cached_property
    def partial_velocity_of_center(self) -> ImmutableMatrix:
        """Partial velocities of G_K in K components, (3, n), Eq. (32)."""
        carried = self.relative_rotation * self.partial_velocity_of_origin
        turned = skew(self._mass_center) * self.partial_angular_velocity
        return self._named("partial_velocity_of_center", carried - turned)

    @outward_property
    def partial_velocity_of_origin_rate(self) -> ImmutableMatrix:
        """Time derivative of the partial velocities of O_K in **J** components, (3, n), Eq. (35)."""
        rate = FiniteMatrix.zeros(3, len(self.system.freedoms))
        if self.lower is not None:
            lower = self.lower
            rate += lower.relative_rotation * lower.partial_velocity_of_origin_rate
            rate += lower.relative_rotation_rate * lower.partial_velocity_of_origin
            rate -= skew(self.offset_rate) * lower.partial_angular_velocity
            rate -= skew(self.offset) * lower.partial_angular_velocity_rate
        return self._named("partial_velocity_of_origin_rate", rate)

    @cached_property
    def partial_velocity_of_center_rate(self) -> ImmutableMatrix:
        """Time derivative of the partial velocities of G_K in K components, (3, n), Eq. (34)."""
        rate = self.relative_rotation * self.partial_velocity_of_origin_rate
        rate += self.relative_rotation_rate * self.partial_velocity_of_origin
        rate -= skew(self._mass_center) * self.partial_angular_velocity_rate
        return self._named("partial_velocity_of_center_rate", rate)

    @outward_property
    def remaining_velocity_of_origin(self) -> ImmutableMatrix:
        """{v_t} of O_K in **J** components, (3, 1): its velocity that prescribed freedoms cause (m/s)."""
        if not self.system.prescribed:
            return NOTHING
        own = self.joint_orientation.T * self._prescribed(self.symbols.speed, 3)
        if self.lower is not None:
            lower = self.lower
            own += lower.relative_rotation * lower.remaining_velocity_of_origin
            own -= skew(self.offset) * lower.remaining_angular_velocity
        return self._named("remaining_velocity_of_origin", own)

    @outward_property
    def remaining_velocity_of_origin_rate(self) -> ImmutableMatrix:
        """Time derivative of the **J** components of {v_t} of O_K, (3, 1) (m/s^2)."""
        if not self.system.prescribed:
            return NOTHING
        rate = self.joint_orientation.T * self._prescribed(self.symbols.acceleration, 3)
        if self.lower is not None:
            lower = self.lower
            rate += lower.relative_rotation * lower.remaining_velocity_of_origin_rate
            rate += lower.relative_rotation_rate * lower.remaining_velocity_of_origin
            rate -= skew(self.offset_rate) * lower.remaining_angular_velocity
            rate -= skew(self.offset) * lower.remaining_angular_velocity_rate
        return self._named("remaining_velocity_of_origin_rate", rate)

    @cached_property
    def remaining_velocity_of_center_rate(self) -> ImmutableMatrix:
        """Time derivative of the K components of {v_t} of G_K, (3, 1) (m/s^2)."""
        if not self.system.prescribed:
            return NOTHING
        rate = self.relative_rotation * self.remaining_velocity_of_origin_rate
        rate += self.relative_rotation_rate * self.remaining_velocity_of_origin
        rate -= skew(column(self.body.mass_center)) * self.remaining_angular_velocity_rate
        return self._named("remaining_velocity_of_center_rate", rate)

    @cached_property
    def acceleration_bias(self) -> ImmutableMatrix:
        """Acceleration of G_K where {ydot} is zero, (3, 1) (m/s^2), the last two terms of Eq. (33)."""
        turned = skew(self.angular_velocity) * self.velocity_of_center
        prescribed = self.remaining_velocity_of_center_rate
        return self.partial_velocity_of_center_rate * self._y + prescribed + turned

    @cached_property
    def acceleration_of_center(self) -> ImmutableMatrix:
        """Acceleration of G_K in K components, (3, 1) (m/s^2), Eq. (33)."""
        return self.partial_velocity_of_center * self._ydot + self.acceleration_bias

    @property
    def _mass_center(self) -> ImmutableMatrix:
        """{r'_K}, (3, 1): from O_K to G_K in K components (m)."""
        return column(self.body.mass_center)
