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

from kanegen.arrays import SystemArrays
from kanegen.check.force_elements import Acting, contributions
from kanegen.check.kinematics import (
    UNPRESCRIBED,
    BodyKinematics,
    coordinate_count,
    free_columns,
    full_order,
    kinematics,
    prescribed_columns,
)
from kanegen.check.matrices import Numbers, apply, transposed
from kanegen.errors import ArrayError
from kanegen.given import GivenLoads
from kanegen.system import System


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
    **given: Unpack[GivenLoads],
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
    **given: Unpack[GivenLoads],
) -> Numbers:
    """(p,) or (B, p) generalized forces that act at the prescribed freedoms, beside loads and gravity.

    They are the rows of Eq. (44), less loads and gravity, that the prescribed freedoms have where they are
    free like the others; `ydot` is (n,) or (B, n), everything else as in `forcing`.
    """
    system = arrays_of(system)
    x = coordinates(system, x)
    ydot = state(system, ydot, "ydot", int(free_columns(system).sum()))
    columns = prescribed_columns(system)
    return -_terms(system, x, y, ydot, force, torque, prescribed, columns, **given).total


def forcing_terms(
    system: System | SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    prescribed: ArrayLike | None = None,
    **given: Unpack[GivenLoads],
) -> ForcingTerms:
    """The separate sums of Eq. (44); arguments as `forcing`."""
    system = arrays_of(system)
    columns = free_columns(system)
    still = np.zeros(int(columns.sum()))
    return _terms(system, x, y, still, force, torque, prescribed, columns, **given)


def _terms(
    system: SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    ydot: Numbers,
    force: ArrayLike | None,
    torque: ArrayLike | None,
    prescribed: ArrayLike | None,
    columns: NDArray[np.bool_],
    **given: Unpack[GivenLoads],
) -> ForcingTerms:
    """The sums, {ydot} among the accelerations, of some columns."""
    x, y = coordinates(system, x), state(system, y, "y", int(free_columns(system).sum()))
    if x.shape[:-1] != y.shape[:-1]:
        raise ArrayError(f"x has shape {x.shape} and y {y.shape}; they must have as many states.")
    forces, torques = load(system, force, x, "force"), load(system, torque, x, "torque")
    told = motion(system, prescribed, x)
    speeds = full_order(system, y, told[..., 1, :])
    accelerations = full_order(system, np.broadcast_to(ydot, y.shape), told[..., 2, :])
    moving = kinematics(system, x, y, told)
    bodies = [
        _body_terms(system, k, body, (speeds, accelerations), (forces[..., k, :], torques[..., k, :]))
        for k, body in enumerate(moving)
    ]
    zero = np.zeros_like(speeds[..., columns])
    elements = contributions(system, moving, (x, told[..., 0, :]), speeds, acting(system, x, **given))
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
    prescribed: ArrayLike | None = None,
    **given: Unpack[GivenLoads],
) -> Numbers:
    """(..., n) what the generalized forces of force elements and loads on points are rounded by.

    Args:
        system: The numbers of the tree.
        bodies: Their kinematics.
        x: (..., m) coordinates.
        y: (..., n) generalized speeds.
        prescribed: As in `mass_matrix`.
        given: As in `forcing`.
    """
    told = motion(system, prescribed, x)
    speeds, free = full_order(system, y, told[..., 1, :]), free_columns(system)
    parts = contributions(system, bodies, (x, told[..., 0, :]), speeds, acting(system, x, **given))
    return sum((part.size[..., free] for part in parts), start=np.zeros(y.shape))


def acting(system: SystemArrays, x: Numbers, **given: Unpack[GivenLoads]) -> Acting:
    """What acts on points in the states `x`, and the time."""
    none = np.zeros((len(system.forces.points), 3))
    force, moment, t = given.get("point_force"), given.get("point_moment"), given.get("t")
    return Acting(
        force=none if force is None else np.asarray(force),
        moment=none if moment is None else np.asarray(moment),
        t=np.zeros(x.shape[:-1]) + (0.0 if t is None else np.asarray(t)),
    )


def motion(system: SystemArrays, value: ArrayLike | None, x: Numbers) -> Numbers:
    """The motion of the prescribed freedoms as a (3, p) or (B, 3, p) array that fits `x`.

    Raises:
        ArrayError: If it has another shape; None is for systems without them.
    """
    count = int(system.prescribed.sum())
    if value is None and count:
        raise ArrayError(
            f"prescribed: it is missing. Pass (3, {count}) values, rates and second derivatives."
        )
    array = UNPRESCRIBED if value is None else np.asarray(value)
    if array.shape not in {(3, count), (*x.shape[:-1], 3, count)}:
        raise ArrayError(f"prescribed has shape {array.shape}; expected (3, {count}), or one for each state.")
    return array


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
