"""Equations (36)-(44) of the notes in NumPy: [A] and {f}, against which generated code is checked.

They are sums over the bodies of products of the matrices in `kinematics`, written as in the notes; the
columns of locked freedoms are dropped before the sums. Nothing is done for speed but the batch.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from kanegen.arrays import SystemArrays
from kanegen.check.force_elements import Acting, contributions
from kanegen.check.kinematics import BodyKinematics, coordinate_count, free_columns, full_order, kinematics
from kanegen.check.matrices import Numbers, apply, transposed
from kanegen.errors import ArrayError
from kanegen.given import Given
from kanegen.system import System


@dataclass(frozen=True)
class ForcingTerms:
    """The separate sums of Eq. (44), each (..., n), signed as they enter {f}.

    Attributes:
        loads: Applied forces and torques.
        gravity: A force `m_K g` at every mass centre.
        acceleration: `- m [v_G,y]^T [dv_G,y/dt] {y}`.
        transport: `- m [v_G,y]^T (omega x v_G)`.
        angular: `- [omega_y]^T [I] [domega_y/dt] {y}`.
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


def mass_matrix(system: System | SystemArrays, x: ArrayLike) -> Numbers:
    """[A] of Eq. (43).

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).

    Returns:
        (n, n) or (B, n, n).

    Raises:
        ArrayError: If `x` has another shape.
    """
    system = arrays_of(system)
    x = coordinates(system, x)
    free = free_columns(system)
    bodies = kinematics(system, x, np.zeros((*x.shape[:-1], int(free.sum())), x.dtype))
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
    **given: Unpack[Given],
) -> Numbers:
    """{f} of Eq. (44).

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) or (B, m) coordinates (rad, m, 1).
        y: (n,) or (B, n) generalized speeds.
        force: (N, 3) or (B, N, 3) forces F'_K at G_K, in K (N); default none. Every row counts, also of
            bodies for which generated code takes no loads.
        torque: Like `force`: torques M'_K, in K (N m).
        given: Loads on points and the time.

    Returns:
        (n,) or (B, n).

    Raises:
        ArrayError: If an array has another shape.
    """
    return forcing_terms(system, x, y, force, torque, **given).total


def forcing_terms(
    system: System | SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    **given: Unpack[Given],
) -> ForcingTerms:
    """The separate sums of Eq. (44); arguments as `forcing`."""
    system = arrays_of(system)
    x, y = coordinates(system, x), state(system, y, "y", int(free_columns(system).sum()))
    if x.shape[:-1] != y.shape[:-1]:
        raise ArrayError(f"x has shape {x.shape} and y {y.shape}; they must have as many states.")
    forces, torques = load(system, force, x, "force"), load(system, torque, x, "torque")
    speeds = full_order(system, y, np.zeros((len(system.mass), 6)))
    free = free_columns(system)
    moving = kinematics(system, x, y)
    bodies = [
        _body_terms(system, k, body, speeds, forces[..., k, :], torques[..., k, :])
        for k, body in enumerate(moving)
    ]
    zero = np.zeros_like(speeds[..., free])
    elements = contributions(system, moving, x, speeds, acting(system, x, **given))
    return ForcingTerms(
        **{name: sum((terms[name][..., free] for terms in bodies), start=zero) for name in bodies[0]},
        elements=sum((part.value[..., free] for part in elements), start=zero),
    )


def _body_terms(
    system: SystemArrays, k: int, body: BodyKinematics, speeds: Numbers, force: Numbers, torque: Numbers
) -> dict[str, Numbers]:
    """Body K's part of Eq. (44), each (..., 6N)."""
    mass, inertia = system.mass[k], system.inertia[k]
    center, spin = transposed(body.center_y), transposed(body.omega_y)
    return dict(
        loads=apply(center, force) + apply(spin, torque),  # (37)
        gravity=apply(center, mass * apply(body.rotation, system.gravity)),
        acceleration=-apply(center, mass * apply(body.center_y_dot, speeds)),  # (39)
        transport=-apply(center, mass * np.cross(body.omega, body.center_velocity)),
        angular=-apply(spin, apply(inertia, apply(body.omega_y_dot, speeds))),  # (40)
        gyroscopic=-apply(spin, np.cross(body.omega, apply(inertia, body.omega))),  # (41)
    )


def arrays_of(system: System | SystemArrays) -> SystemArrays:
    """The numbers of a system, parameters at their defaults."""
    return system.values() if isinstance(system, System) else system


def coordinates(system: SystemArrays, x: ArrayLike) -> Numbers:
    """{x} as a (m,) or (B, m) array.

    Raises:
        ArrayError: If it has another shape.
    """
    return state(system, x, "x", coordinate_count(system))


def state(system: SystemArrays, value: ArrayLike, what: str, count: int) -> Numbers:
    """`value` as a (count,) or (B, count) array.

    Raises:
        ArrayError: If it has another shape.
    """
    array = np.asarray(value)
    if array.ndim not in (1, 2) or array.shape[-1] != count:
        raise ArrayError(f"{what} has shape {array.shape}; expected ({count},) or (B, {count}).")
    return array


def element_magnitude(
    system: SystemArrays,
    bodies: tuple[BodyKinematics, ...],
    x: Numbers,
    y: Numbers,
    **given: Unpack[Given],
) -> Numbers:
    """(..., n) what the generalized forces of force elements and loads on points are rounded by.

    Args:
        system: The numbers of the tree.
        bodies: Their kinematics.
        x: (..., m) coordinates.
        y: (..., n) generalized speeds.
        given: As in `forcing`.
    """
    speeds, free = full_order(system, y, np.zeros((len(system.mass), 6))), free_columns(system)
    parts = contributions(system, bodies, x, speeds, acting(system, x, **given))
    return sum((part.size[..., free] for part in parts), start=np.zeros(y.shape))


def acting(system: SystemArrays, x: Numbers, **given: Unpack[Given]) -> Acting:
    """What acts on points in the states `x`, and the time."""
    none = np.zeros((len(system.forces.points), 3))
    force, moment, t = given.get("point_force"), given.get("point_moment"), given.get("t")
    return Acting(
        force=none if force is None else np.asarray(force),
        moment=none if moment is None else np.asarray(moment),
        t=np.zeros(x.shape[:-1]) + (0.0 if t is None else np.asarray(t)),
    )


def load(system: SystemArrays, value: ArrayLike | None, x: Numbers, what: str) -> Numbers:
    """`value` as a (N, 3) or (B, N, 3) array that fits `x`; zeros for None.

    Raises:
        ArrayError: If it has another shape.
    """
    count = len(system.mass)
    if value is None:
        return np.zeros((count, 3))
    array = np.asarray(value)
    allowed = {(count, 3), (*x.shape[:-1], count, 3)}
    if array.shape not in allowed:
        shapes = " or ".join(str(shape) for shape in sorted(allowed, key=len))
        raise ArrayError(f"{what} has shape {array.shape}; expected {shapes}.")
    return array


def _stacked(matrices: list[Numbers]) -> Numbers:
    """(..., 3N, n) from N times (..., 3, n)."""
    return np.concatenate(matrices, axis=-2)
