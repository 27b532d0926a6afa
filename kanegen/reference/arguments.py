"""The arguments of the reference as arrays whose shapes fit the system and each other.

In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ArrayError
from kanegen.model.arguments import LoadInputs
from kanegen.model.arrays import SystemArrays
from kanegen.model.system import System
from kanegen.reference.freedoms import UNPRESCRIBED, coordinate_count, free_columns
from kanegen.reference.matrices import Numbers, apply, transposed


@dataclass(frozen=True)
class PointInputs:
    """Loads on the P points that take loads, and the time.

    Attributes:
        force: (P, 3) or (..., P, 3) forces, inertial components (N).
        moment: (P, 3) or (..., P, 3) moments, inertial components (N m).
        t: (...) time (s).
    """

    force: Numbers
    moment: Numbers
    t: Numbers


@dataclass(frozen=True)
class Arguments:
    """The arguments of {f}.

    Attributes:
        x: (..., m) coordinates (rad, m, 1).
        y: (..., n) generalized speeds.
        force: (N, 3) or (..., N, 3) forces on the bodies, in body components (N).
        torque: (N, 3) or (..., N, 3) torques on the bodies, in body components (N m).
        prescribed: (3, p) or (..., 3, p) values, rates and second derivatives of the prescribed freedoms.
        point_inputs: Loads on points, and the time.
    """

    x: Numbers
    y: Numbers
    force: Numbers
    torque: Numbers
    prescribed: Numbers
    point_inputs: PointInputs


def arguments(
    system: SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    force: ArrayLike | None,
    torque: ArrayLike | None,
    prescribed: ArrayLike | None,
    **loads: Unpack[LoadInputs],
) -> Arguments:
    """Return the checked arguments of `equations.forcing`.

    Raises:
        ArrayError: If an array has another shape.
    """
    x, y = coordinates(system, x), speeds(system, y, "y")
    if x.shape[:-1] != y.shape[:-1]:
        raise ArrayError(f"x has shape {x.shape} and y {y.shape}; they must have as many states.")
    return Arguments(
        x=x,
        y=y,
        force=_load(system, force, x, "force"),
        torque=_load(system, torque, x, "torque"),
        prescribed=prescribed_motion(system, prescribed, x),
        point_inputs=point_inputs(system, x, **loads),
    )


def arrays_of(system: System | SystemArrays) -> SystemArrays:
    """Return the numbers of a system, parameters at their defaults."""
    return system.values() if isinstance(system, System) else system


def coordinates(system: SystemArrays, x: ArrayLike) -> Numbers:
    """Return {x} as an (m,) or (B, m) array.

    Raises:
        ArrayError: If it has another shape.
    """
    return _states(x, "x", coordinate_count(system))


def speeds(system: SystemArrays, value: ArrayLike, label: str) -> Numbers:
    """Return {y} or {ydot} as an (n,) or (B, n) array; `label` names it in error messages.

    Raises:
        ArrayError: If it has another shape.
    """
    return _states(value, label, int(free_columns(system).sum()))


def prescribed_motion(system: SystemArrays, value: ArrayLike | None, x: Numbers) -> Numbers:
    """Return the motion of the prescribed freedoms as a (3, p) or (B, 3, p) array that fits `x`.

    Raises:
        ArrayError: If it has another shape, or is None although there are prescribed freedoms.
    """
    count = int(system.prescribed.sum())
    if value is None and count:
        raise ArrayError(f"prescribed: missing. Pass (3, {count}) values, rates and second derivatives.")
    array = UNPRESCRIBED if value is None else np.asarray(value)
    if array.shape not in {(3, count), (*x.shape[:-1], 3, count)}:
        raise ArrayError(f"prescribed has shape {array.shape}; expected (3, {count}), or one for each state.")
    return array


def point_inputs(system: SystemArrays, x: Numbers, **loads: Unpack[LoadInputs]) -> PointInputs:
    """Return the loads on points in the states `x`, and the time; zeros where the caller passes none."""
    none = np.zeros((len(system.forces.points), 3))
    force, moment, t = loads.get("point_force"), loads.get("point_moment"), loads.get("t")
    return PointInputs(
        force=none if force is None else np.asarray(force),
        moment=none if moment is None else np.asarray(moment),
        t=np.zeros(x.shape[:-1]) + (0.0 if t is None else np.asarray(t)),
    )


def _states(value: ArrayLike, label: str, count: int) -> Numbers:
    """Return `value` as a (count,) or (B, count) array; `label` names it in error messages."""
    array = np.asarray(value)
    if array.ndim not in (1, 2) or array.shape[-1] != count:
        raise ArrayError(f"{label} has shape {array.shape}; expected ({count},) or (B, {count}).")
    return array


def _load(system: SystemArrays, value: ArrayLike | None, x: Numbers, label: str) -> Numbers:
    """Return `value` as an (N, 3) or (B, N, 3) array in body components that fits `x`; zeros for None."""
    count = len(system.mass)
    if value is None:
        return np.zeros((count, 3))
    array = np.asarray(value)
    allowed = {(count, 3), (*x.shape[:-1], count, 3)}
    if array.shape not in allowed:
        shapes = " or ".join(str(shape) for shape in sorted(allowed, key=len))
        raise ArrayError(f"{label} has shape {array.shape}; expected {shapes}.")
    return apply(transposed(system.load_rotation), array)
