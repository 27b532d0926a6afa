"""Coordinates over time as a page holds them, with the quantities of its plot and forces as arrows."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ArrayError, OptionError, counted, quoted
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.viewer.forces import Force, forces_of
from kanegen.viewer.numbers import checked, doubles, encoded

MOST_TIMES = 20_000
"""Times that a page holds; of a longer motion every k-th is kept, and a note says so."""

GROUPS = {"x": "Coordinates", "y": "Speeds", "tau": "Generalized forces"}
"""Names of groups of quantities by the beginning of the names of their columns."""

Quantity = tuple[str, str, str, Floats]
"""Group, name, unit and (T,) values of a quantity."""


@runtime_checkable
class HasStates(Protocol):
    """What a picture needs of a trajectory or a rollout: times, and coordinates and speeds at these."""

    @property
    def times(self) -> Any:
        """(T,) times that increase, in s."""

    @property
    def x(self) -> Any:
        """(T, m) coordinates, rad, m or 1."""


@dataclass(frozen=True)
class Series:
    """A quantity over time for the plot.

    Attributes:
        group: Quantities of one group stand in one plot, such as "Coordinates, rad".
        name: Name of the quantity.
        unit: Its unit.
        values: Base64 of (T,) doubles, little-endian.
    """

    group: str
    name: str
    unit: str
    values: str


@dataclass(frozen=True)
class Motion:
    """Coordinates over time; the numbers are base64, little-endian.

    Attributes:
        times: (T,) doubles: times that increase (s).
        x: (T, m) doubles: coordinates (rad, m, 1); single precision would be off after many turns.
        prescribed: (T, p) doubles: values of the prescribed freedoms (rad, m).
        series: Quantities of the plot.
        forces: Forces that are drawn.
        notes: Sentences about what is left out.
    """

    times: str
    x: str
    prescribed: str
    series: list[Series]
    forces: list[Force]
    notes: list[str]

    def as_table(self) -> dict[str, Any]:
        """Return the motion as nested dictionaries and lists that JSON can hold.

        Example:
            motion_of(system, trajectory).as_table()["series"][0]["name"]
        """
        return asdict(self)

    def decoded(self) -> tuple[Floats, Floats, Floats]:
        """Return (T,) times (s), (T, m) coordinates and (T, p) prescribed values.

        Example:
            times, x, prescribed = motion.decoded()
        """
        times = np.frombuffer(base64.b64decode(self.times), "<f8").astype(np.float64)
        x, prescribed = (
            np.frombuffer(base64.b64decode(text), "<f8").astype(np.float64).reshape(len(times), -1)
            for text in (self.x, self.prescribed)
        )
        return times, x, prescribed


def motion_of(
    system: System,
    trajectory: HasStates | Sequence[ArrayLike],
    forces: Mapping[str, ArrayLike] | None = None,
    plots: Mapping[str, ArrayLike] | None = None,
) -> Motion:
    """Return the motion of a trajectory for a page.

    Args:
        system: The tree that moves.
        trajectory: A `Trajectory`, a `Rollout`, or a pair: (T,) increasing times (s) and (T, m) coordinates.
        forces: (T, 3) inertial components of forces (N) by name of the point, frame or body on which each
            acts: at the point, the origin of the frame, or the mass centre of the body.
        plots: (T,) further quantities for the plot, by their names.

    Raises:
        OptionError: If `trajectory` is no trajectory, or it is one of another model, or of several motions.
        ArrayError: If an array has another shape, times do not increase, or a number is not finite.
        ModelError: If there is no point, frame or body of the name of a force.

    Example:
        motion_of(system, (times, x))
    """
    times, x, y, prescribed = _states(system, trajectory)
    kept = np.arange(0, len(times), -(-len(times) // MOST_TIMES))
    notes = []
    if len(kept) < len(times):
        notes.append(f"Of {len(times)} times 1 in {kept[1]} is kept.")
    series = _series(system, trajectory, x, y)
    for name, values in (plots or {}).items():
        series.append(
            ("Further quantities", str(name), "", checked(f"plot {quoted(name)}", values, (len(times),)))
        )
    return Motion(
        times=encoded("times", times[kept], "<f8"),
        x=encoded("x", x[kept], "<f8"),
        prescribed=encoded("prescribed", prescribed[kept], "<f8"),
        series=[
            Series(group, name, unit, encoded(name, one[kept], "<f8")) for group, name, unit, one in series
        ],
        forces=forces_of(system, trajectory, forces or {}, len(times), kept),
        notes=notes,
    )


def _states(system: System, trajectory: Any) -> tuple[Floats, Floats, Floats | None, Floats]:
    """Return (T,) times, (T, m) coordinates, (T, n) speeds or None, and (T, p) prescribed values."""
    m, p = len(system.coordinates), len(system.prescribed)
    pair = isinstance(trajectory, tuple | list) and len(trajectory) == 2
    if not pair and not isinstance(trajectory, HasStates):
        raise OptionError(
            f"trajectory: {quoted(trajectory)} is none. Pass what kg.simulate returns, or a pair of times "
            "and coordinates."
        )
    moments, states = trajectory if pair else (trajectory.times, trajectory.x)
    times, x = doubles("times", moments), doubles("x", states)
    if times.ndim != 1 or not len(times):
        raise ArrayError(f"times: expected at least one in one row, got shape {times.shape}.")
    if not (np.isfinite(times).all() and (np.diff(times) > 0).all()):
        raise ArrayError("times: they must be finite and increase from each to the next.")
    if x.ndim == 3:
        times_first = x.shape[0] == len(times)  # of a trajectory; in a rollout the motions are first
        raise OptionError(
            f"trajectory: it holds {counted(x.shape[int(times_first)], 'motion')}. Pass one of them, such as "
            f"(trajectory.times, trajectory.x[{':, 0' if times_first else '0'}])."
        )
    if x.shape != (len(times), m):
        raise OptionError(
            f"trajectory: its coordinates have shape {x.shape}, but {len(times)} times of system "
            f"{quoted(system.name)} need {(len(times), m)}. {_mend(x.shape, len(times), m)}"
        )
    _require_same_names(system, trajectory)
    _require_finite(system, times, x)
    y = None if pair else getattr(trajectory, "y", None)
    speeds = None if y is None else checked("y", y, (len(times), len(system.freedoms)))
    driven = None if pair else getattr(trajectory, "inputs", {}).get("prescribed")
    values = (
        np.zeros((len(times), p))
        if driven is None
        else checked("prescribed", driven, (len(times), 3, p))[:, 0]
    )
    return times, x, speeds, values


def _mend(shape: tuple[int, ...], count: int, m: int) -> str:
    """Return how to mend coordinates whose shape is not (`count`, `m`)."""
    if len(shape) != 2:
        return "Pass one row of coordinates for each time."
    if shape == (m, count):
        return "Transpose them: a row for each time."
    if shape[1] == m:
        return "Pass as many rows as times."
    return "It is one of another model."


def _require_same_names(system: System, trajectory: Any) -> None:
    """Make sure that the library of a trajectory has the coordinates of the system."""
    names = getattr(getattr(trajectory, "library", None), "coordinate_names", None)
    if names is not None and tuple(names) != tuple(system.coordinate_names):
        raise OptionError(
            f"trajectory: it is one of {quoted(trajectory.library.name)}, whose coordinates are not those of "
            f"system {quoted(system.name)}. Pass the system from which its library was built."
        )


def _require_finite(system: System, times: Floats, x: Floats) -> None:
    """Make sure that all coordinates are finite; the message has the first time at which one is not."""
    bad = np.argwhere(~np.isfinite(x))
    if len(bad):
        row, column = bad[0]
        raise ArrayError(
            f"trajectory: coordinate {quoted(system.coordinate_names[column])} is {x[row, column]} at t = "
            f"{times[row]:.9g} s. Pass the times before, trajectory.x[:{row}]."
        )


def _series(system: System, trajectory: Any, x: Floats, y: Floats | None) -> list[Quantity]:
    """Return what a trajectory holds over time: all its columns, where it has names for them."""
    if hasattr(trajectory, "columns") and hasattr(trajectory, "units"):
        found = [
            _quantity(name, trajectory.units[name], one)
            for name, one in trajectory.columns().items()
            if name != "t"
        ]
    else:
        units = [coordinate.unit for coordinate in system.coordinates]
        names = zip(system.coordinate_names, units, strict=True)
        found = [_quantity(f"x.{name}", unit, x[:, i]) for i, (name, unit) in enumerate(names)]
        for i, (name, freedom) in enumerate(zip(system.speed_names, system.freedoms, strict=True)):
            if y is not None:
                found.append(_quantity(f"y.{name}", "rad/s" if freedom.is_angle else "m/s", y[:, i]))
    return [*found, *_energies(trajectory, len(x))]


def _quantity(name: str, unit: str, values: Floats) -> Quantity:
    """Return a quantity from the name of its column, such as "x.pole" or "point_positions.tip.z"."""
    head, dot, tail = name.partition(".")
    words = GROUPS.get(head, head.replace("_", " ").capitalize())
    group = words if unit in ("", "1") else f"{words}, {unit}"
    return group, tail if dot else words, unit, checked(name, values, None)


def _energies(trajectory: Any, count: int) -> list[Quantity]:
    """Return the energies of a trajectory whose library computes them."""
    outputs = getattr(getattr(trajectory, "library", None), "outputs", ())
    if not {"kinetic_energy", "potential_energy"} <= set(outputs) or not hasattr(
        trajectory, "kinetic_energy"
    ):
        return []
    kinetic = checked("kinetic_energy", trajectory.kinetic_energy, (count,))
    potential = checked("potential_energy", trajectory.potential_energy, (count,))
    values = {"kinetic": kinetic, "potential": potential, "sum": kinetic + potential}
    return [("Energies, J", name, "J", one) for name, one in values.items()]
