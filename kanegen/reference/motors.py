"""What motors add to the equations of the notes: the reflected inertia of each freedom.

A motor with the reflected inertia a has the kinetic energy a y^2 / 2 in the speed y of its freedom. By Kane's
method its generalized inertia force is -a {ydot}, at its own freedom alone, or at those that this one
follows. In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

import numpy as np

from kanegen.model.arrays import Floats, SystemArrays
from kanegen.reference.freedoms import free_columns, gathered
from kanegen.reference.matrices import Numbers


def armature_in_order(system: SystemArrays) -> Floats:
    """Return the (6N,) reflected inertias in the order of Eq. (1) (kg m^2, kg)."""
    armature: Floats = np.concatenate([system.armature[:, :3].ravel(), system.armature[:, 3:].ravel()])
    return armature


def motor_mass_matrix(system: SystemArrays) -> Floats:
    """Return the (n, n) part of [A] that belongs to motors."""
    rates = gathered(system, np.eye(system.free.size), free_columns(system))
    matrix: Floats = rates.T @ (armature_in_order(system)[:, None] * rates)
    return matrix


def motor_forces(system: SystemArrays, accelerations: Numbers) -> Numbers:
    """Return the (..., 6N) generalized inertia forces of motors.

    Args:
        system: The numbers of the tree.
        accelerations: (..., 6N) accelerations in the order of Eq. (1), zero for locked freedoms.
    """
    forces: Numbers = -armature_in_order(system) * accelerations
    return forces
