"""What motors add to the equations of the notes: reflected inertias, and rotors that spin in their carriers.

A motor with the reflected inertia a has the kinetic energy a y^2 / 2 in the speed y of its freedom. By Kane's
method its generalized inertia force is -a {ydot}, at its own freedom alone, or at those that this one
follows.

A rotor of inertia J about the unit vector {e}, fixed in carrier C, has the angular velocity
{omega_C} + n y {e}, with the partial angular velocities [omega_C,y] and n {e} more at its own freedom. With
the rest of its inertia counted in C, its angular momentum is {h} y more than that of C, with {h} = J n {e};
the time derivative of {h} y is {h} {ydot} + {omega_C} x {h} y (Eqs. (40), (41)). About {e} the rotor needs
the torque J {e}^T {domega_C/dt} + J n {ydot}. In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kanegen.model.arrays import Floats, RotorArrays, SystemArrays
from kanegen.reference.freedoms import column, free_columns, gathered
from kanegen.reference.kinematics import BodyKinematics
from kanegen.reference.matrices import Numbers, apply, transposed


def armature_in_order(system: SystemArrays) -> Floats:
    """Return the (6N,) reflected inertias in the order of Eq. (1), without rotors (kg m^2, kg)."""
    armature: Floats = np.concatenate([system.armature[:, :3].ravel(), system.armature[:, 3:].ravel()])
    return armature


def motor_mass_matrix(system: SystemArrays, bodies: Sequence[BodyKinematics]) -> Numbers:
    """Return the (n, n) or (..., n, n) part of [A] that belongs to motors, Eq. (43).

    Args:
        system: The numbers of the tree.
        bodies: Kinematics of the bodies.
    """
    matrix: Numbers = np.diag(armature_in_order(system))
    for rotor in system.rotors:
        place, momentum, spin = spin_of(system, rotor)
        own = np.zeros((matrix.shape[-1], matrix.shape[-1]))
        own[place, place] = spin
        if rotor.body:
            row = momentum @ bodies[rotor.body - 1].omega_y
            coupled = np.zeros((*row.shape[:-1], *own.shape), row.dtype)
            coupled[..., place, :] = row
            own = own + coupled + transposed(coupled)
        matrix = matrix + own
    rates = gathered(system, np.eye(system.free.size), free_columns(system))
    return rates.T @ matrix @ rates


def motor_forces(
    system: SystemArrays, bodies: Sequence[BodyKinematics], speeds: Numbers, accelerations: Numbers
) -> Numbers:
    """Return the (..., 6N) generalized inertia forces of motors, Eq. (44).

    Args:
        system: The numbers of the tree.
        bodies: Kinematics of the bodies.
        speeds: (..., 6N) speeds in the order of Eq. (1).
        accelerations: (..., 6N) accelerations beside those at constant speeds, zero for locked freedoms.
    """
    forces: Numbers = -armature_in_order(system) * accelerations
    for rotor in system.rotors:
        place, momentum, spin = spin_of(system, rotor)
        own = np.zeros_like(forces)
        own[..., place] = -spin * accelerations[..., place]
        if rotor.body:
            carrier = bodies[rotor.body - 1]
            rate = speeds[..., place, None] * np.cross(carrier.omega, momentum)
            moment = momentum * accelerations[..., place, None] + rate
            turning = apply(carrier.omega_y_dot, speeds) + apply(carrier.omega_y, accelerations)
            own = own - apply(transposed(carrier.omega_y), moment)
            own[..., place] -= turning @ momentum
        forces = forces + own
    return forces


def spin_of(system: SystemArrays, rotor: RotorArrays) -> tuple[int, Floats, float]:
    """Return the column of a rotor's freedom, its angular momentum J n {e} and its J n^2, at unit speed."""
    place = column(system, rotor.freedom.body, rotor.freedom.index)
    momentum = rotor.inertia * rotor.ratio * rotor.axis
    return place, momentum, rotor.inertia * rotor.ratio**2
