"""Equations (36)-(44) of the notes: [A] and {f}, against which generated code is checked.

They are sums over the bodies of products of the matrices in `kinematics`, written as in the notes. The
columns of locked freedoms are dropped before the sums, and those of coupled freedoms are added to the columns
of the freedoms that they follow, times their factors. The columns of prescribed freedoms multiply
prescribed rates and accelerations, and they also give the generalized forces that the prescribed motion
requires.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.model.arguments import LoadInputs
from kanegen.model.arrays import SystemArrays
from kanegen.model.system import System
from kanegen.reference.arguments import (
    Arguments,
    arguments,
    arrays_of,
    coordinates,
    prescribed_motion,
    speeds,
)
from kanegen.reference.force_elements import contributions
from kanegen.reference.freedoms import free_columns, full_order, gathered, prescribed_columns
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.reference.matrices import Numbers, apply, transposed
from kanegen.reference.motors import motor_forces, motor_mass_matrix


@dataclass(frozen=True)
class ForcingTerms:
    """The separate sums of Eq. (44), each (..., n), with their signs in {f}.

    Attributes:
        loads: Forces and torques on the bodies, Eq. (37).
        gravity: Weights `m_K g` at the mass centres.
        acceleration: `- m [v_G,y]^T ([dv_G,y/dt] {y} + [v_G,y] {ydot})` with the prescribed {ydot}, Eq. (39).
        transport: `- m [v_G,y]^T (omega x v_G)`.
        angular: `- [omega_y]^T [I] ([domega_y/dt] {y} + [omega_y] {ydot})` with the prescribed {ydot}, Eq.
            (40).
        gyroscopic: `- [omega_y]^T (omega x [I] omega)`, Eq. (41).
        elements: Force elements, and loads on points.
        motors: Generalized inertia forces of motors, with those of rotors that spin.
    """

    loads: Numbers
    gravity: Numbers
    acceleration: Numbers
    transport: Numbers
    angular: Numbers
    gyroscopic: Numbers
    elements: Numbers
    motors: Numbers

    @property
    def total(self) -> Numbers:
        """(..., n) forcing {f}, the sum of all terms."""
        return sum((getattr(self, field.name) for field in fields(self)), start=np.zeros_like(self.loads))


def mass_matrix(system: System | SystemArrays, x: ArrayLike, prescribed: ArrayLike | None = None) -> Numbers:
    """Return [A] of Eq. (43).

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        prescribed: (3, p) or (B, 3, p) values, rates and second derivatives of the prescribed freedoms.

    Returns:
        (n, n) or (B, n, n).

    Raises:
        ArrayError: If an array has another shape.

    Example:
        >>> system = kg.load("models/double_pendulum.toml")
        >>> equations.mass_matrix(system, [0.3, 0.4])
    """
    system = arrays_of(system)
    x = coordinates(system, x)
    free, motion = free_columns(system), prescribed_motion(system, prescribed, x)
    bodies = kinematics(system, x, np.zeros((*x.shape[:-1], int(free.sum())), x.dtype), motion)
    center_y = [gathered(system, body.center_y, free) for body in bodies]
    omega_y = [gathered(system, body.omega_y, free) for body in bodies]
    linear_momentum_y = [m * v for m, v in zip(system.mass, center_y, strict=True)]
    angular_momentum_y = [inertia @ w for inertia, w in zip(system.inertia, omega_y, strict=True)]
    # One product of the bodies' matrices on top of each other is their sum over K, and much faster.
    linear: Numbers = transposed(_stacked(center_y)) @ _stacked(linear_momentum_y)
    angular: Numbers = transposed(_stacked(omega_y)) @ _stacked(angular_momentum_y)
    return linear + angular + motor_mass_matrix(system, bodies)


def forcing(
    system: System | SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    prescribed: ArrayLike | None = None,
    **loads: Unpack[LoadInputs],
) -> Numbers:
    """Return {f} of Eq. (44).

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        y: (n,) or (B, n) generalized speeds.
        force: (N, 3) or (B, N, 3) forces F'_K at G_K, in K (N); default none. Every row counts, also of
            bodies for which generated code takes no loads.
        torque: (N, 3) or (B, N, 3) torques M'_K, in K (N m); default none.
        prescribed: As in `mass_matrix`.
        loads: Loads on points, and the time, by name.

    Returns:
        (n,) or (B, n).

    Raises:
        ArrayError: If an array has another shape.

    Example:
        >>> system = kg.load("models/double_pendulum.toml")
        >>> equations.forcing(system, x=[0.3, 0.4], y=[1.0, 2.0])
    """
    return forcing_terms(system, x, y, force, torque, prescribed, **loads).total


def prescribed_efforts(
    system: System | SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    ydot: ArrayLike,
    prescribed: ArrayLike,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    **loads: Unpack[LoadInputs],
) -> Numbers:
    """Return the (p,) or (B, p) generalized forces that the prescribed motion requires.

    They are the negative rows of Eq. (44) that the prescribed freedoms would have if they were free, {ydot}
    among the accelerations. `ydot` is (n,) or (B, n) generalized accelerations; the other arguments are those
    of `forcing`.
    """
    system = arrays_of(system)
    passed = arguments(system, x, y, force, torque, prescribed, **loads)
    return -_terms(system, passed, speeds(system, ydot, "ydot"), prescribed_columns(system)).total


def forcing_terms(
    system: System | SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    prescribed: ArrayLike | None = None,
    **loads: Unpack[LoadInputs],
) -> ForcingTerms:
    """Return the separate sums of Eq. (44); the arguments are those of `forcing`."""
    system = arrays_of(system)
    passed = arguments(system, x, y, force, torque, prescribed, **loads)
    return _terms(system, passed, np.zeros(passed.y.shape), free_columns(system))


def _terms(
    system: SystemArrays, passed: Arguments, ydot: Numbers, columns: NDArray[np.bool_]
) -> ForcingTerms:
    """Return the sums of Eq. (44) for some of the 6N freedoms.

    Args:
        system: The numbers of the tree.
        passed: Arguments of {f}.
        ydot: (..., n) accelerations that enter beside the prescribed ones.
        columns: (6N,) flags of the freedoms.
    """
    motion = passed.prescribed
    rates = full_order(system, passed.y, motion[..., 1, :])
    accelerations = full_order(system, np.broadcast_to(ydot, passed.y.shape), motion[..., 2, :])
    moving = kinematics(system, passed.x, passed.y, motion)
    bodies = [
        _body_terms(
            system, k, body, (rates, accelerations), (passed.force[..., k, :], passed.torque[..., k, :])
        )
        for k, body in enumerate(moving)
    ]
    elements = contributions(system, moving, (passed.x, motion[..., 0, :]), rates, passed.point_inputs)
    zero = np.zeros_like(rates[..., columns])
    return ForcingTerms(
        **{
            name: sum((gathered(system, terms[name], columns) for terms in bodies), start=zero)
            for name in bodies[0]
        },
        elements=sum((gathered(system, part.value, columns) for part in elements), start=zero),
        motors=zero + gathered(system, motor_forces(system, moving, rates, accelerations), columns),
    )


def _body_terms(
    system: SystemArrays,
    k: int,
    body: BodyKinematics,
    motion: tuple[Numbers, Numbers],
    load: tuple[Numbers, Numbers],
) -> dict[str, Numbers]:
    """Return body K's part of every sum of Eq. (44), each (..., 6N).

    Args:
        system: The numbers of the tree.
        k: Index of body K, from 0.
        body: Kinematics of body K.
        motion: (..., 6N) speeds, and (..., 6N) accelerations beside those at constant speeds.
        load: (..., 3) force and (..., 3) torque on the body, in body components.
    """
    (speeds, accelerations), (force, torque) = motion, load
    mass, inertia = system.mass[k], system.inertia[k]
    center, angular = transposed(body.center_y), transposed(body.omega_y)
    return dict(
        loads=apply(center, force) + apply(angular, torque),  # (37)
        gravity=apply(center, mass * apply(body.rotation, system.gravity)),
        acceleration=-apply(  # (39)
            center, mass * (apply(body.center_y_dot, speeds) + apply(body.center_y, accelerations))
        ),
        transport=-apply(center, mass * np.cross(body.omega, body.center_velocity)),
        angular=-apply(  # (40)
            angular,
            apply(inertia, apply(body.omega_y_dot, speeds) + apply(body.omega_y, accelerations)),
        ),
        gyroscopic=-apply(angular, np.cross(body.omega, apply(inertia, body.omega))),  # (41)
    )


def _stacked(matrices: list[Numbers]) -> Numbers:
    """Return N matrices (..., 3, n) on top of each other, (..., 3N, n)."""
    return np.concatenate(matrices, axis=-2)
