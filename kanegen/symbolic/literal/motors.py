"""What motors add to [A]: the reflected inertia of each freedom, on its diagonal."""

from __future__ import annotations

from sympy import ImmutableMatrix

from kanegen.model.system import System
from kanegen.symbolic.symbols import expression


def motor_mass_matrix(system: System) -> ImmutableMatrix:
    """Return the (n, n) diagonal matrix of the reflected inertias of the free freedoms (kg m^2, kg)."""
    armature = [system.bodies[f.body - 1].joint.armature[f.index] for f in system.freedoms]
    return ImmutableMatrix.diag(*map(expression, armature))
