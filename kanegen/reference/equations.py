"""Equations (36)-(44) of the notes in NumPy: [A] and {f}, against which generated code is checked.

They are sums over the bodies of products of the matrices in `kinematics`, written as in the notes; the
columns of locked freedoms are dropped before the sums. Those of prescribed ones multiply the rates and
accelerations that are given, and lead to the efforts that these need. Nothing is done for speed but the
batch.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kanegen.model.arguments import LoadInputs
from kanegen.model.arrays import SystemArrays
from kanegen.model.system import System
from kanegen.reference.arguments import Arguments, arguments, arrays_of, coordinates, motion, speeds
from kanegen.reference.force_elements import contributions
from kanegen.reference.freedoms import free_columns, full_order, prescribed_columns
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.reference.matrices import Numbers, apply, transposed


@dataclass(frozen=True)
class ForcingTerms:
    """The separate sums of Eq. (44), each (..., n), signed as they enter {f}.

    Attributes:
        loads: Applied forces and torques.
        gravity: A force `m_K g` at every mass centre.
        acceleration: `- m [v_G,y]^T ([dv_G,y/dt] {y} + [v_G,y] {ydot})`, {ydot} being what is prescribed.
        transport: `- m [v_G,y]^T (omega x v_G)`.
        angular: `- [omega_y]^T [I] ([domega_y/dt] {y} + [omega_y] {ydot})`, likewise.
        gyroscopic: `- [omega_y]^T (omega x [I] omega)`.
        elements: Force elements, and loads on points.
    """

    loads: Numbers
    gravity: Numbers
    acceleration: Numbers
    transport: Numbers
    angular: Numbers
    gyroscopic: Numbers
    elements: Numbers

    @property
    def total(self) -> Numbers:
        """(..., n) {f}."""
        return sum((getattr(self, field.name) for field in fields(self)), start=np.zeros_like(self.loads))


def mass_matrix(system: System | SystemArrays, x: ArrayLike, prescribed: ArrayLike | None = None) -> Numbers:
    """[A] of Eq. (43).

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        prescribed: (3, p) or (B, 3, p) values, rates and second derivatives of the prescribed freedoms.

    Returns:
        (n, n) or (B, n, n).

    Raises:
        ArrayError: If an array has another shape.
    """
    system = arrays_of(system)
    x = coordinates(system, x)
    free, told = free_columns(system), motion(system, prescribed, x)
    bodies = kinematics(system, x, np.zeros((*x.shape[:-1], int(free.sum())), x.dtype), told)
    center_y = [body.center_y[..., free] for body in bodies]
    omega_y = [body.omega_y[..., free] for body in bodies]
    momentum_y = [m * v for m, v in zip(system.mass, center_y, strict=True)]
    spin_y = [inertia @ w for inertia, w in zip(system.inertia, omega_y, strict=True)]
    # One product of the bodies' matrices on top of each other is their sum over K, and much faster.
    linear: Numbers = transposed(_stacked(center_y)) @ _stacked(momentum_y)
    angular: Numbers = transposed(_stacked(omega_y)) @ _stacked(spin_y)
    return linear + angular


def forcing(
    system: System | SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    prescribed: ArrayLike | None = None,
    **given: Unpack[LoadInputs],
) -> Numbers:
    """{f} of Eq. (44).

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        y: (n,) or (B, n) generalized speeds.
        force: (N, 3) or (B, N, 3) forces F'_K at G_K, in K (N); default none. Every row counts, also of
            bodies for which generated code takes no loads.
        torque: Like `force`: torques M'_K, in K (N m).
        prescribed: As in `mass_matrix`.
        given: Loads on points and the time.

    Returns:
        (n,) or (B, n).

    Raises:
        ArrayError: If an array has another shape.
    """
    return forcing_terms(system, x, y, force, torque, prescribed, **given).total


def prescribed_efforts(
    system: System | SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    ydot: ArrayLike,
    prescribed: ArrayLike,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    **given: Unpack[LoadInputs],
) -> Numbers:
    """(p,) or (B, p) generalized forces that act at the prescribed freedoms, beside loads and gravity.

    They are the rows of Eq. (44), less loads and gravity, that the prescribed freedoms have where they are
    free like the others; `ydot` is (n,) or (B, n), everything else as in `forcing`.
    """
    system = arrays_of(system)
    passed = arguments(system, x, y, force, torque, prescribed, **given)
    return -_terms(system, passed, speeds(system, ydot, "ydot"), prescribed_columns(system)).total


def forcing_terms(
    system: System | SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    prescribed: ArrayLike | None = None,
    **given: Unpack[LoadInputs],
) -> ForcingTerms:
    """The separate sums of Eq. (44); arguments as `forcing`."""
    system = arrays_of(system)
    passed = arguments(system, x, y, force, torque, prescribed, **given)
    return _terms(system, passed, np.zeros(passed.y.shape), free_columns(system))


def _terms(
    system: SystemArrays, passed: Arguments, ydot: Numbers, columns: NDArray[np.bool_]
) -> ForcingTerms:
    """The sums, {ydot} among the accelerations, of some columns."""
    told = passed.prescribed
    rates = full_order(system, passed.y, told[..., 1, :])
    accelerations = full_order(system, np.broadcast_to(ydot, passed.y.shape), told[..., 2, :])
    moving = kinematics(system, passed.x, passed.y, told)
    bodies = [
        _body_terms(
            system, k, body, (rates, accelerations), (passed.force[..., k, :], passed.torque[..., k, :])
        )
        for k, body in enumerate(moving)
    ]
    elements = contributions(system, moving, (passed.x, told[..., 0, :]), rates, passed.acting)
    zero = np.zeros_like(rates[..., columns])
    return ForcingTerms(
        **{name: sum((terms[name][..., columns] for terms in bodies), start=zero) for name in bodies[0]},
        elements=sum((part.value[..., columns] for part in elements), start=zero),
    )


def _body_terms(
    system: SystemArrays,
    k: int,
    body: BodyKinematics,
    motion: tuple[Numbers, Numbers],
    load: tuple[Numbers, Numbers],
) -> dict[str, Numbers]:
    """Body K's part of Eq. (44), each (..., 6N)."""
    (speeds, accelerations), (force, torque) = motion, load
    mass, inertia = system.mass[k], system.inertia[k]
    center, spin = transposed(body.center_y), transposed(body.omega_y)
    return dict(
        loads=apply(center, force) + apply(spin, torque),  # (37)
        gravity=apply(center, mass * apply(body.rotation, system.gravity)),
        acceleration=-apply(  # (39)
            center, mass * (apply(body.center_y_dot, speeds) + apply(body.center_y, accelerations))
        ),
        transport=-apply(center, mass * np.cross(body.omega, body.center_velocity)),
        angular=-apply(  # (40)
            spin,
            apply(inertia, apply(body.omega_y_dot, speeds) + apply(body.omega_y, accelerations)),
        ),
        gyroscopic=-apply(spin, np.cross(body.omega, apply(inertia, body.omega))),  # (41)
    )


def _stacked(matrices: list[Numbers]) -> Numbers:
    """(..., 3N, n) from N times (..., 3, n)."""
    return np.concatenate(matrices, axis=-2)
