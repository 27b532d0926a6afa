"""What motors add to [A] and {f}: inertia forces of the reflected inertia of each freedom."""

from __future__ import annotations

from collections.abc import Iterator

from sympy import Add, Expr, ImmutableMatrix, zeros

from kanegen.model.system import System
from kanegen.symbolic.freedom_motion import FreedomMotions, Shares
from kanegen.symbolic.symbols import acceleration, expression


def motor_mass_matrix(system: System) -> ImmutableMatrix:
    """Return the (n, n) matrix of the reflected inertias (kg m^2, kg), diagonal where nothing is coupled.

    A coupled freedom with the factor a_i on freedom i adds its reflected inertia times a_i a_j.
    """
    found, places = zeros(len(system.freedoms), len(system.freedoms)), system.places
    for armature, shares in _motors(system):
        free = [(places[freedom], share) for freedom, share in shares.items() if freedom in places]
        for i, share in free:
            for j, other in free:
                found[i, j] += share * other * armature
    return ImmutableMatrix(found)


def motor_forces(system: System) -> ImmutableMatrix:
    """Return the (n, 1) part of {f} from motors of coupled freedoms that prescribed motion accelerates."""
    found, places = zeros(len(system.freedoms), 1), system.places
    for armature, shares in _motors(system):
        driven = Add(
            *(share * acceleration(f.body, f.index) for f, share in shares.items() if f not in places)
        )
        for freedom, share in shares.items():
            if freedom in places:
                found[places[freedom], 0] -= share * armature * driven
    return ImmutableMatrix(found)


def _motors(system: System) -> Iterator[tuple[Expr, Shares]]:
    """Yield each reflected inertia with the free and prescribed freedoms that move it, and their factors."""
    motions = FreedomMotions(system, expression)
    for freedom in system.moving_places:
        armature = expression(system.bodies[freedom.body - 1].joint.armature[freedom.index])
        if armature != 0:
            yield armature, motions.shares(freedom)
