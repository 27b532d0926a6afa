"""Limits of a model that a motion leaves: the equations do not contain them, so that the user must know."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kanegen.errors import warn
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.simulation.trajectory import Trajectory


def warn_outside_limits(motion: Trajectory) -> None:
    """Warn of the first limits of coordinates, speeds and efforts that a motion leaves, each in one line."""
    limits = motion.library.source.model.limits
    if not limits:
        return
    lower, upper, speed, effort = (np.array(values) for values in limits)
    library = motion.library
    kinds = [
        ("coordinate", library.coordinate_names, motion.x, lower, upper),
        ("speed", library.speed_names, motion.y, -speed, speed),
    ]
    if "tau" in motion.inputs:
        kinds.append(("effort", library.freedom_names, motion.inputs["tau"], -effort, effort))
    for kind, names, values, low, high in kinds:
        _warn(motion, kind, names, values, low, high)


def _warn(
    motion: Trajectory, kind: str, names: Sequence[str], values: Floats, low: Doubles, high: Doubles
) -> None:
    """Warn if values over the time leave their range, with the first time and all names."""
    outside = (values < low) | (values > high)
    if not outside.any():
        return
    row = int(np.argmax(outside.reshape(len(motion.times), -1).any(axis=1)))
    place = np.argwhere(outside[row])[0]
    k = int(place[-1])
    leaving = np.flatnonzero(outside.reshape(-1, len(names)).any(axis=0)).tolist()
    others = [names[j] for j in leaving if j != k]
    also = f" So do {', '.join(others[:6])}{', ...' * (len(others) > 6)}." if others else ""
    warn(
        f"at t = {motion.times[row]:.6g} s {kind} {names[k]!r} is {values[row][tuple(place)]:.6g}, outside "
        f"its limits {low[k]:g} to {high[k]:g}, which are no part of the equations.{also}"
    )
