"""The motion in a file of columns over time, such as one that `Trajectory.save` has written."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from kanegen.errors import OptionError, quoted
from kanegen.files import path_of
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.simulation.input_tables import read_columns

TIME = "t"
"""Name of the column of times."""


@dataclass(frozen=True)
class StoredMotion:
    """Times and coordinates from a file, with the other columns of the file.

    Attributes:
        times: (T,) times, s.
        x: (T, m) coordinates, rad, m or 1.
        names: Names of all columns but the times.
        values: (T,) values of these columns.
        units: Unit of each column by its name, where it is that of a coordinate or a speed; else "".
    """

    times: Floats
    x: Floats
    names: tuple[str, ...]
    values: tuple[Floats, ...]
    units: dict[str, str]

    def columns(self) -> dict[str, Floats]:
        """Return all columns by name but the times: (T,) each.

        Example:
            motion.columns()["x.pole"]
        """
        return dict(zip(self.names, self.values, strict=True))


def stored_motion(system: System, path: str | os.PathLike[str]) -> StoredMotion:
    """Return the motion of a system in a file.

    Args:
        system: The system that moves.
        path: A .csv, .parquet or .npz file with a column "t" (s) and a column `x.<coordinate>` for every
            coordinate of the system, as `Trajectory.save` and `kanegen simulate --write` make it. Other
            columns are for the plot.

    Raises:
        ReadError: If the file cannot be read.
        OptionError: If it is of another kind, or a column is missing.
        MissingError: If a package for the format is not installed.

    Example:
        kg.view(system, stored_motion(system, "motion.csv"))
    """
    file = path_of(path)
    columns = read_columns(file)
    needed = [TIME, *(f"x.{name}" for name in system.coordinate_names)]
    missing = [name for name in needed if name not in columns]
    if missing:
        raise OptionError(
            f"{file}: there is no column {quoted(missing[0])}. A motion of {quoted(system.name)} has the "
            f"columns {', '.join(needed[:6])}{' and so on' if len(needed) > 6 else ''}."
        )
    times = columns.pop(TIME)
    x = np.stack([columns[name] for name in needed[1:]], axis=1)
    names = tuple(name for name, values in columns.items() if values.shape == times.shape)
    return StoredMotion(times, x, names, tuple(columns[name] for name in names), _units(system, names))


def _units(system: System, names: tuple[str, ...]) -> dict[str, str]:
    """Return the units of columns."""
    coordinates = zip(system.coordinate_names, system.coordinates, strict=True)
    known: dict[str, str] = {f"x.{name}": one.unit for name, one in coordinates}
    for name, freedom in zip(system.speed_names, system.freedoms, strict=True):
        known[f"y.{name}"] = "rad/s" if freedom.is_angle else "m/s"
    return {name: known.get(name, "") for name in names}
