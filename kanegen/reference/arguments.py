"""What callers pass to the reference, as arrays that fit the system and each other.

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
from kanegen.reference.matrices import Numbers


@dataclass(frozen=True)
class Acting:
    """What acts on the points, and the time.

    Attributes:
        force: (P, 3) or (..., P, 3) inertial components (N).
        moment: (P, 3) or (..., P, 3) inertial components (N m).
        t: (...) s.
    """

    force: Numbers
    moment: Numbers
    t: Numbers


@dataclass(frozen=True)
class Arguments:
    """What {f} depends on.

    Attributes:
        x: (..., m) coordinates (rad, m, 1).
        y: (..., n) generalized speeds.
        force: (N, 3) or (..., N, 3) on the bodies, in their components (N).
        torque: (N, 3) or (..., N, 3) likewise (N m).
        prescribed: (3, p) or (..., 3, p) values, rates and second derivatives of the prescribed freedoms.
        acting: The rest.
    """

    x: Numbers
    y: Numbers
    force: Numbers
    torque: Numbers
    prescribed: Numbers
    acting: Acting


def arguments(
    system: SystemArrays,
    x: ArrayLike,
    y: ArrayLike,
    force: ArrayLike | None,
    torque: ArrayLike | None,
    prescribed: ArrayLike | None,
    **given: Unpack[LoadInputs],
) -> Arguments:
    """All of them; see `reference.forcing`.

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
        prescribed=motion(system, prescribed, x),
        acting=acting(system, x, **given),
    )


def arrays_of(system: System | SystemArrays) -> SystemArrays:
    """The numbers of a system, parameters at their defaults."""
    return system.values() if isinstance(system, System) else system


def coordinates(system: SystemArrays, x: ArrayLike) -> Numbers:
    """{x} as a (m,) or (B, m) array.

    Raises:
        ArrayError: If it has another shape.
    """
    return _states(x, "x", coordinate_count(system))


def speeds(system: SystemArrays, value: ArrayLike, what: str) -> Numbers:
    """{y}, or {ydot}, as a (n,) or (B, n) array.

    Raises:
        ArrayError: If it has another shape.
    """
    return _states(value, what, int(free_columns(system).sum()))


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


def acting(system: SystemArrays, x: Numbers, **given: Unpack[LoadInputs]) -> Acting:
    """What acts on points in the states `x`, and the time; nothing, and 0, where they are not given."""
    none = np.zeros((len(system.forces.points), 3))
    force, moment, t = given.get("point_force"), given.get("point_moment"), given.get("t")
    return Acting(
        force=none if force is None else np.asarray(force),
        moment=none if moment is None else np.asarray(moment),
        t=np.zeros(x.shape[:-1]) + (0.0 if t is None else np.asarray(t)),
    )


def _states(value: ArrayLike, what: str, count: int) -> Numbers:
    """`value` as a (count,) or (B, count) array."""
    array = np.asarray(value)
    if array.ndim not in (1, 2) or array.shape[-1] != count:
        raise ArrayError(f"{what} has shape {array.shape}; expected ({count},) or (B, {count}).")
    return array


def _load(system: SystemArrays, value: ArrayLike | None, x: Numbers, what: str) -> Numbers:
    """`value` as a (N, 3) or (B, N, 3) array that fits `x`; zeros for None."""
    count = len(system.mass)
    if value is None:
        return np.zeros((count, 3))
    array = np.asarray(value)
    allowed = {(count, 3), (*x.shape[:-1], count, 3)}
    if array.shape not in allowed:
        shapes = " or ".join(str(shape) for shape in sorted(allowed, key=len))
        raise ArrayError(f"{what} has shape {array.shape}; expected {shapes}.")
    return array
