"""The parts of {f} that gravity and motion cause, and the Coriolis matrix [C], by partial velocities.

A system is a set of particles with the partial velocities [v_P,y]. Its mass matrix is the sum of
m [v_P,y]^T [v_P,y], and [C] is the sum of m [v_P,y]^T [dv_P,y/dt], with time derivatives in inertial space.
So -[C]{y} are the generalized inertia forces that {y} causes, and [dA/dt] - 2 [C] is skew: it is the sum of
m [dv_P,y/dt]^T [v_P,y] less its transpose. For a rigid body with the partial angular velocities [W] and the
partial velocities [V] of its mass centre, in body components, the sum is

    m [V]^T ([dV/dt] + [omega~][V]) + [W]^T ([I][dW/dt] + [u~][W]),  {u} = tr(I)/2 {omega} - [I]{omega},

where time derivatives are those of the components. In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.arrays import SystemArrays
from kanegen.model.system import System
from kanegen.reference.arguments import arrays_of, coordinates, prescribed_motion, speeds
from kanegen.reference.equations import forcing_terms
from kanegen.reference.freedoms import free_columns, full_order, gathered
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.reference.matrices import Numbers, apply, skew, transposed
from kanegen.reference.motors import spin_of


def gravity_forces(
    system: System | SystemArrays, x: ArrayLike, prescribed: ArrayLike | None = None
) -> Numbers:
    """Return the (n,) or (B, n) part of {f} that gravity causes; the arguments are those of `mass_matrix`.

    Example:
        >>> gravity_forces(kg.load("models/double_pendulum.toml"), [0.3, 0.4])
    """
    arrays = arrays_of(system)
    x = coordinates(arrays, x)
    still = np.zeros((*x.shape[:-1], int(free_columns(arrays).sum())), x.dtype)
    return forcing_terms(arrays, x, still, prescribed=prescribed).gravity


def velocity_forces(
    system: System | SystemArrays, x: ArrayLike, y: ArrayLike, prescribed: ArrayLike | None = None
) -> Numbers:
    """Return the (n,) or (B, n) part of {f} that {y} and prescribed motion cause.

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        y: (n,) or (B, n) generalized speeds.
        prescribed: (3, p) or (B, 3, p) values, rates and second derivatives of the prescribed freedoms.

    Example:
        >>> velocity_forces(kg.load("models/double_pendulum.toml"), [0.3, 0.4], [1.0, 2.0])
    """
    terms = forcing_terms(system, x, y, prescribed=prescribed)
    return terms.acceleration + terms.transport + terms.angular + terms.gyroscopic + terms.motors


def coriolis_matrix(
    system: System | SystemArrays, x: ArrayLike, y: ArrayLike, prescribed: ArrayLike | None = None
) -> Numbers:
    """Return the (n, n) or (B, n, n) Coriolis matrix [C]; the arguments are those of `velocity_forces`.

    Raises:
        ArrayError: If an array has another shape.

    Example:
        >>> coriolis_matrix(kg.load("models/double_pendulum.toml"), [0.3, 0.4], [1.0, 2.0])
    """
    system = arrays_of(system)
    x, y = coordinates(system, x), speeds(system, y, "y")
    motion = prescribed_motion(system, prescribed, x)
    bodies = kinematics(system, x, y, motion)
    total = _of_rotors(system, bodies, full_order(system, y, motion[..., 1, :]))
    for k, body in enumerate(bodies):
        inertia = system.inertia[k]
        turning = np.trace(inertia) / 2 * body.omega - apply(inertia, body.omega)
        linear = body.center_y_dot + skew(body.omega) @ body.center_y
        angular = inertia @ body.omega_y_dot + skew(turning) @ body.omega_y
        total = total + system.mass[k] * transposed(body.center_y) @ linear
        total = total + transposed(body.omega_y) @ angular
    rates = gathered(system, np.eye(system.free.size), free_columns(system))
    return rates.T @ total @ rates


def _of_rotors(system: SystemArrays, bodies: Sequence[BodyKinematics], rates: Numbers) -> Numbers:
    """Return the (6N, 6N) part of [C] that the spin of rotors adds; reflected inertia adds none.

    A rotor with the angular momentum {h} y in carrier C, y being the speed at place r, has the terms
    [W]^T {h} {e_r}^T and its transpose in [A]. Their time derivative leaves to [C] the row {h}^T [dW/dt] and,
    in body components, the part {u} = {omega} x {h} / 2 of the column and of the row, with opposite signs,
    as Christoffel symbols would; and -y [W]^T [h~] [W] / 2.
    """
    total = np.zeros((*rates.shape, rates.shape[-1]), rates.dtype)
    for rotor in system.rotors:
        if rotor.body:
            place, momentum, _ = spin_of(system, rotor)
            carrier = bodies[rotor.body - 1]
            w, spin = carrier.omega_y, rates[..., place, None, None]
            half = (np.cross(carrier.omega, momentum) / 2)[..., None, :]
            total = total - spin / 2 * transposed(w) @ skew(momentum) @ w
            total[..., place, :] += momentum @ carrier.omega_y_dot - (half @ w)[..., 0, :]
            total[..., :, place] += (half @ w)[..., 0, :]
    return total
