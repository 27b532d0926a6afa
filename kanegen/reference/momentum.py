"""The centroidal momentum matrix and its bias, from the partial velocities of the notes.

The momentum of all bodies is the sum of m {v_G}, and the sum of [I_G] {omega} + ({p_G} - {p_C}) x m {v_G}
about the mass centre C of all bodies (Orin, Goswami and Lee 2013). Its rate is the sum of the same terms with
accelerations, because the moment of the total momentum by the velocity of C vanishes. A rotor adds its spin.
In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.arrays import SystemArrays
from kanegen.model.system import System
from kanegen.reference.arguments import arrays_of, coordinates, prescribed_motion, speeds
from kanegen.reference.freedoms import free_columns, full_order, gathered
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.reference.matrices import Numbers, apply, skew, transposed
from kanegen.reference.motors import spin_of


@dataclass(frozen=True)
class CentroidalMomentum:
    """The momentum of all bodies in some states, inertial components, linear rows first.

    Attributes:
        matrix: (..., 6, n) [A_G], the momentum by {y}.
        momentum: (..., 6) momentum, that of prescribed motion included (kg m/s, kg m^2/s).
        bias: (..., 6) rate of the momentum for {ydot} = 0 (N, N m).
    """

    matrix: Numbers
    momentum: Numbers
    bias: Numbers


def centroidal_momentum(
    system: System | SystemArrays, x: ArrayLike, y: ArrayLike, prescribed: ArrayLike | None = None
) -> CentroidalMomentum:
    """Return the centroidal momentum matrix, the momentum and the bias of its rate.

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        y: (n,) or (B, n) generalized speeds.
        prescribed: (3, p) or (B, 3, p) values, rates and second derivatives of the prescribed freedoms.

    Raises:
        ArrayError: If an array has another shape.

    Example:
        >>> system = kg.load("models/double_pendulum.toml")
        >>> centroidal_momentum(system, [0.3, 0.4], [1.0, 2.0]).matrix
    """
    system = arrays_of(system)
    x, y = coordinates(system, x), speeds(system, y, "y")
    motion = prescribed_motion(system, prescribed, x)
    bodies = kinematics(system, x, y, motion)
    rates = full_order(system, y, motion[..., 1, :])
    accelerations = full_order(system, 0 * y, motion[..., 2, :])
    center = _mass_center(system, bodies)
    matrix, bias = _of_rotors(system, bodies, rates, accelerations)
    for k, body in enumerate(bodies):
        mass, inertia, up = system.mass[k], system.inertia[k], transposed(body.rotation)
        arm = skew(apply(up, body.center_position) - center)
        linear, angular = mass * up @ body.center_y, up @ inertia @ body.omega_y
        matrix = matrix + np.concatenate([linear, angular + arm @ linear], axis=-2)
        alpha = apply(body.omega_y_dot, rates) + apply(body.omega_y, accelerations)
        acceleration = apply(body.center_y_dot, rates) + apply(body.center_y, accelerations)
        force = mass * apply(up, acceleration + np.cross(body.omega, body.center_velocity))
        moment = apply(inertia, alpha) + np.cross(body.omega, apply(inertia, body.omega))
        bias = bias + np.concatenate([force, apply(up, moment) + apply(arm, force)], axis=-1)
    return CentroidalMomentum(
        matrix=gathered(system, matrix, free_columns(system)), momentum=apply(matrix, rates), bias=bias
    )


def _mass_center(system: SystemArrays, bodies: Sequence[BodyKinematics]) -> Numbers:
    """Return the (..., 3) position of the mass centre of all bodies, inertial; zeros without mass."""
    centers = [apply(transposed(body.rotation), body.center_position) for body in bodies]
    moments = [mass * center for mass, center in zip(system.mass, centers, strict=True)]
    moment: Numbers = sum(moments, start=np.zeros_like(centers[0]))
    return moment / (system.mass.sum() or 1.0)


def _of_rotors(
    system: SystemArrays, bodies: Sequence[BodyKinematics], rates: Numbers, accelerations: Numbers
) -> tuple[Numbers, Numbers]:
    """Return the (..., 6, 6N) momentum by speeds, and its (..., 6) rate, of the spin of rotors."""
    matrix = np.zeros((*rates.shape[:-1], 6, rates.shape[-1]), rates.dtype)
    rate = np.zeros((*rates.shape[:-1], 6), rates.dtype)
    for rotor in system.rotors:
        place, momentum, _ = spin_of(system, rotor)
        turning = momentum * accelerations[..., place, None]
        up = np.eye(3)
        if rotor.body:
            carrier = bodies[rotor.body - 1]
            up = transposed(carrier.rotation)
            turning = turning + rates[..., place, None] * np.cross(carrier.omega, momentum)
        matrix[..., 3:, place] += up @ momentum
        rate[..., 3:] += apply(up, turning)
    return matrix, rate
