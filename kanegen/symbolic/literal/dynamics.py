"""The contribution of a body to the equations of motion, Eqs. (36)-(44)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from sympy import Add, Expr, ImmutableMatrix, S

from kanegen.symbolic.definitions import Definition
from kanegen.symbolic.literal.frames import frame_equations
from kanegen.symbolic.literal.intermediates import QUANTITIES
from kanegen.symbolic.literal.linear_motion import LinearEquations
from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.symbols import column, expression, force, matrix, torque


@dataclass(frozen=True, eq=False, repr=False)
class BodyEquations(LinearEquations):
    """All equations of the notes for body K; each matrix is computed on first use and kept.

    Columns are resolved in body K; those of the origin O_K in the lower body J. A (3, n) matrix is the notes'
    3 x 6N matrix without the columns of locked freedoms, in the order of {y}.
    """

    def __repr__(self) -> str:
        """The number and name of the body, and the name of its system."""
        return f"<BodyEquations of body {self.number} ({self.body.name}) of {self.system.name}>"

    @property
    def definitions(self) -> tuple[Definition, ...]:
        """The definitions of this body's intermediates in order of evaluation."""
        found: list[Definition] = []
        for name in QUANTITIES:
            getattr(self, name)
            found += self.intermediates.definitions(name)
        return tuple(found)

    @cached_property
    def mass(self) -> Expr:
        """Mass m_K (kg), as in Eq. (39)."""
        return expression(self.body.mass)

    @cached_property
    def inertia(self) -> ImmutableMatrix:
        """[I'_GK], (3, 3): inertia about the mass centre in K components (kg m^2), as in Eq. (40)."""
        return matrix(self.body.inertia)

    @cached_property
    def force(self) -> ImmutableMatrix:
        """{F'_K} of Eq. (37), (3, 1): weight m_K [R_K] {g} and the load on the body at G_K (N)."""
        weight = self.mass * self.rotation * column(self.system.gravity)
        if self.body.loads:
            weight += self._in_body(FiniteMatrix([force(self.number, axis) for axis in range(3)]))
        return weight

    @cached_property
    def torque(self) -> ImmutableMatrix:
        """{M'_K} of Eq. (37), (3, 1): the symbols of the load on the body, or zeros (N m)."""
        if not self.body.loads:
            return FiniteMatrix.zeros(3, 1)
        return self._in_body(FiniteMatrix([torque(self.number, axis) for axis in range(3)]))

    def _in_body(self, load: ImmutableMatrix) -> ImmutableMatrix:
        """Return a load, (3, 1), in body components, from those of the frame that users of the body see."""
        return frame_equations(self.system, self.body.name).rotation.T * load

    @cached_property
    def generalized_forces(self) -> ImmutableMatrix:
        """The contribution of this body to {F_y}, (n, 1), Eq. (37)."""
        by_force = self.partial_velocity_of_center.T * self.force
        return by_force + self.partial_angular_velocity.T * self.torque

    @cached_property
    def partial_angular_momentum(self) -> ImmutableMatrix:
        """[I'_GK] times the partial angular velocities, (3, n), as in Eq. (40)."""
        return self._named("partial_angular_momentum", self.inertia * self.partial_angular_velocity)

    @cached_property
    def mass_matrix(self) -> ImmutableMatrix:
        """The contribution of this body to [A], (n, n), Eq. (43)."""
        velocity = self.partial_velocity_of_center
        by_mass = _symmetric_product(velocity, self.mass * velocity)
        return by_mass + _symmetric_product(self.partial_angular_velocity, self.partial_angular_momentum)

    @cached_property
    def net_force(self) -> ImmutableMatrix:
        """{F'_K} less m_K times the acceleration where {ydot} is zero, (3, 1) (N), Eqs. (33), (39)."""
        return self._named("net_force", self.force - self.mass * self.acceleration_bias)

    @cached_property
    def net_torque(self) -> ImmutableMatrix:
        """{M'_K} less the inertia torque where {ydot} is zero, (3, 1) (N m), Eqs. (40), (41)."""
        accelerating = self.inertia * self.angular_acceleration_bias
        gyroscopic = skew(self.angular_velocity) * (self.inertia * self.angular_velocity)
        return self._named("net_torque", self.torque - accelerating - gyroscopic)

    @cached_property
    def forcing(self) -> ImmutableMatrix:
        """The contribution of this body to {f}, (n, 1), Eq. (44)."""
        by_force = self.partial_velocity_of_center.T * self.net_force
        return by_force + self.partial_angular_velocity.T * self.net_torque


def total(parts: Iterable[ImmutableMatrix]) -> ImmutableMatrix:
    """Add matrices of one shape, each entry at once: adding one matrix after another takes quadratic time."""
    matrices = list(parts)
    rows, columns = matrices[0].shape
    entries = zip(*(matrix.flat() for matrix in matrices), strict=True)
    return FiniteMatrix(rows, columns, [Add(*terms) for terms in entries])


def _symmetric_product(a: ImmutableMatrix, b: ImmutableMatrix) -> ImmutableMatrix:
    """Return [a]^T [b], which is known to be symmetric; only one half is computed."""
    columns_a, columns_b = a.T.tolist(), b.T.tolist()
    n = len(columns_a)
    result = [[S.Zero] * n for _ in range(n)]
    for i in range(n):
        for j in range(i, n):
            products = [u * v for u, v in zip(columns_a[i], columns_b[j], strict=True) if u and v]
            result[i][j] = result[j][i] = Add(*products)
    return FiniteMatrix(result)
