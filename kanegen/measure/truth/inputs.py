"""What a user passes to `truth`, as one state."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ArrayError, OptionError
from kanegen.measure.truth.tree import State
from kanegen.model.arrays import Floats
from kanegen.model.prescribed import require_unprescribed
from kanegen.model.system import System


def checked_state(
    system: System,
    x: ArrayLike,
    y: ArrayLike,
    tau: ArrayLike | None,
    force: ArrayLike | None,
    torque: ArrayLike | None,
    ydot: ArrayLike | None,
) -> State:
    """One state of `system`; what is None is zero.

    Raises:
        ArrayError: If an array has another shape than it must, or is not finite.
        OptionError: If the system has force elements or loads on points, or a freedom is prescribed.
    """
    require_unprescribed(system, "truth")
    loaded = [point.name for _, point in system.points if point.loads]
    if system.force_elements or loaded:
        what = "force elements" if system.force_elements else f"loads on points ({', '.join(loaded)})"
        raise OptionError(
            f"system {system.name!r} has {what}, of which no exact results are known. Leave them out of the "
            "model that is measured."
        )
    n, loads = (len(system.freedoms),), (system.number_of_bodies, 3)
    coordinates = (len(system.coordinates),)
    return State(
        x=_floats(x, coordinates, "x"),
        y=_floats(y, n, "y"),
        force=_floats(force, loads, "force"),
        torque=_floats(torque, loads, "torque"),
        tau=_floats(tau, n, "tau"),
        ydot=_floats(ydot, n, "ydot"),
    )


def _floats(value: ArrayLike | None, shape: tuple[int, ...], what: str) -> Floats:
    if value is None:
        return np.zeros(shape)
    array = np.asarray(value)
    if array.dtype.kind not in "iuf" or array.shape != shape:
        found = f"{array.dtype} of shape {array.shape}"
        raise ArrayError(f"{what}: expected real numbers of shape {shape}, got {found}.")
    if not np.isfinite(array).all():
        raise ArrayError(f"{what}: every number must be finite.")
    return array.astype(np.float64)
