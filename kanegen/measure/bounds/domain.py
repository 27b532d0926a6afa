"""The box of inputs over which bounds hold, read from a table of plain data.

The table has the form of a TOML file, that of `domain_tables` with all inputs that functions read:

    [x]                             # coordinates, rad and m
    angles = [-3.0, 3.0]            # all angles; there are also "translations" and "quaternions"
    elbow = [0.1, 2.5]              # one coordinate, by its name; a single number fixes it
    [y]                             # generalized speeds, rad/s and m/s
    [ydot]                          # generalized accelerations, rad/s^2 and m/s^2
    [tau]                           # generalized forces, N m and N
    [force]                         # loads of a body, or of "all": one range, or one for each component
    hand = [-10.0, 10.0]
    [torque]
    [point_force]                   # loads of a point, or of "all"
    [point_moment]
    [parameters]                    # run-time parameters
    load = [0.0, 12.5]
    [prescribed]                    # "values", "rates" and "accelerations" of the prescribed freedoms
    values.angles = [-1.0, 1.0]
    [time]
    t = [0.0, 10.0]
    [exclude]
    clearance = 0.05                # states where |cos(theta2)| of a joint with three free angles is smaller
    quaternions = 0.5               # states where every element of a quaternion is smaller in magnitude

A key that is left out keeps the range of the limits of the model or, where it has none, that of
`reference.states.ranges`; {tau} is 0 without limits, weights and directions of products with derivatives are
from -1 to 1, and a parameter has its default, or the value that a library has. If no range of a quaternion is
given, `exclude.quaternions` is 0.5, so that the box holds all unit quaternions and none of length 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.c.formats import Formats
from kanegen.errors import OptionError, quoted
from kanegen.measure.bounds.excluded_states import (
    away_from_gimbal_lock,
    without_short_homogeneous_coordinates,
)
from kanegen.measure.bounds.intervals import Intervals
from kanegen.measure.domain_tables import (
    non_negative,
    read_range,
    require_known_keys,
    require_table,
    set_load_ranges,
    set_ranges,
)
from kanegen.model.arguments import OF_PRODUCTS
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.program.ir import PARAMETERS
from kanegen.readers.reader import read_text
from kanegen.readers.toml import parse_toml
from kanegen.recursion.outputs import argument_arrays
from kanegen.reference.states import ranges

PRESCRIBED = ("values", "rates", "accelerations")
"""Rows of the array of prescribed freedoms."""

TIME = "t"
"""Name of the array of the time."""

DOMAIN = "domain"
"""Beginning of error messages about a domain that is no file."""

_ABSENT = {
    **dict.fromkeys(("force", "torque"), "no body takes loads (loads = true)"),
    **dict.fromkeys(("point_force", "point_moment"), "no point takes loads (loads = true)"),
    PARAMETERS: "there are no run-time parameters",
    "prescribed": "no freedom is prescribed",
    "time": "nothing depends on the time",
}
"""Why a system may lack a table."""

SHORTEST = 0.5
"""Default of `exclude.quaternions`. The largest of the four elements of a unit quaternion is no smaller."""

MOST_HOMOGENEOUS = 2
"""Most quaternions of a system for which there is this default; each multiplies the boxes by eight."""


@dataclass(frozen=True)
class InputBox:
    """Ranges of all inputs of a system.

    Attributes:
        system: The system.
        low: Smallest number of every element, row-major, by name of the input array.
        high: Largest number of every element.
        clearance: Least |cos(theta2)| of joints with three free angles, or |sin(theta2)| where the first and
            the last angle turn about the same axis.
        shortest: Least magnitude of the largest element of every quaternion.
    """

    system: System
    low: Mapping[str, Floats]
    high: Mapping[str, Floats]
    clearance: float = 0.0
    shortest: float = 0.0

    def intervals(self, formats: Formats) -> dict[str, Intervals]:
        """Return intervals (size, B) by name of the array; B boxes together are this one.

        Ends of a range are moved outward to numbers of the precision of the array, so that inputs that are
        rounded to this precision stay inside. An input with one value keeps it; the error of rounding this
        value to the precision of the array is part of its bounds.

        Args:
            formats: Precisions of arrays.

        Raises:
            OptionError: If a range holds no number of the precision of the array.
        """
        self._require_numbers(formats)
        columns = {
            name: Intervals(
                _moved(self.low[name], self.high[name], formats.of(name).dtype, -np.inf)[:, None],
                _moved(self.high[name], self.low[name], formats.of(name).dtype, np.inf)[:, None],
            )
            for name in self.low
        }
        for place, lock in self._gimbal_lock_angles():
            columns = away_from_gimbal_lock(columns, self.system, place, lock, self.clearance)
        for places in homogeneous_places(self.system) if self.shortest else ():
            columns = without_short_homogeneous_coordinates(columns, self.system, places, self.shortest)
        return columns

    def _require_numbers(self, formats: Formats) -> None:
        """Raise an `OptionError` if a range, not one value, holds no number of the precision of its array."""
        for name, low in self.low.items():
            high, precision = self.high[name], formats.of(name)
            first = _moved(low, high, precision.dtype, np.inf)
            for place in np.flatnonzero((low < high) & (first > high) & np.isfinite(first)):
                raise OptionError(
                    f"{DOMAIN}: {name}[{place}]: the range [{float(low[place])!r}, {float(high[place])!r}] "
                    f"holds no number of {precision.label} precision. Give one number, or a longer range."
                )

    def _gimbal_lock_angles(self) -> list[tuple[int, float]]:
        """Return places in x of middle angles, with an angle at which the joint is in gimbal lock (rad)."""
        if self.clearance == 0:
            return []
        joints = [body.joint for body in self.system.bodies]
        return [
            (place, 0.0 if joints[coordinate.body - 1].gimbal_lock == "sin" else np.pi / 2)
            for place, coordinate in enumerate(self.system.coordinates)
            if coordinate.index == 1 and joints[coordinate.body - 1].gimbal_lock
        ]


def read_domain(domain: InputBox | Mapping[str, Any] | str | Path | None, system: System) -> InputBox:
    """Return a box from itself, from a table, from the path of a .toml file, or from the content of one.

    Args:
        domain: The box, or what describes it; in text, ";" may stand for the end of a line. None is the
            default box.
        system: The system whose inputs the box has. A parameter without a range has the value of `system`;
            a box that is given keeps its own ranges.

    Raises:
        OptionError: If it describes no box of this system; the message names the file and the key.
        ReadError: If the file does not exist, or the text is not valid TOML.
    """
    if isinstance(domain, InputBox):
        return _of_system(domain, system)
    if domain is None:
        return box_from_table(system, {})
    if isinstance(domain, Mapping):
        return box_from_table(system, domain)
    if isinstance(domain, Path) or (isinstance(domain, str) and domain.lower().endswith(".toml")):
        return box_from_table(system, parse_toml(read_text(Path(domain)), domain), str(domain))
    if not isinstance(domain, str) or (domain.strip() and not set(domain) & set("=[#")):
        raise OptionError(
            f"{DOMAIN}: {quoted(domain)} has no ranges. Give a table such as x.angles = [-1.0, 1.0], in "
            'Python {"x": {"angles": [-1.0, 1.0]}}, or the path of a .toml file.'
        )
    return box_from_table(system, parse_toml(domain.replace(";", "\n"), DOMAIN))


def _of_system(box: InputBox, system: System) -> InputBox:
    """Return a box if it has the inputs of a system.

    Raises:
        OptionError: If it is the box of a system with other inputs.
    """
    sizes = {name: size.shape for name, size in _default_sizes(system).items()}
    if {name: low.shape for name, low in box.low.items()} != sizes:
        raise OptionError(
            f"{DOMAIN}: the box is one of system {box.system.name!r}, whose inputs differ from those of "
            f"{system.name!r}."
        )
    return box


def box_from_table(system: System, table: Mapping[str, Any], where: str = DOMAIN) -> InputBox:
    """Return the box that a table describes.

    Raises:
        OptionError: If a name is unknown or a value is no range; the message names the key.
    """
    largest = _default_sizes(system)
    rows, tables = load_rows(system), _tables(system)
    for name, reason in _ABSENT.items():
        if name in table and name not in tables:
            raise OptionError(f"{where}: {name}: {reason} in system {system.name!r}. Leave it out.")
    require_known_keys(where, table, (*tables, "exclude"))
    low = {name: -size for name, size in largest.items()}
    high = {name: size.copy() for name, size in largest.items()}
    low["x"], high["x"] = system.limits.positions(low["x"], high["x"])
    for parameter, place in zip(system.parameters, range(len(system.parameters)), strict=True):
        low[PARAMETERS][place] = high[PARAMETERS][place] = parameter.value
    for name, units in tables.items():
        own, at = require_table(where, name, table.get(name, {})), f"{where}: {name}"
        if name in rows:
            set_load_ranges(at, rows[name], own, low[name], high[name])
        elif name == "prescribed":
            _set_prescribed(at, system, units, own, low[name], high[name])
        elif name in (PARAMETERS, "time"):
            array = TIME if name == "time" else name
            require_known_keys(at, own, tuple(units))
            for place, key in enumerate(units):
                if key in own:
                    low[array][place], high[array][place] = read_range(f"{at}.{key}", own[key])
        else:
            set_ranges(at, system.name, units, own, low[name], high[name])
    excluded = require_table(where, "exclude", table.get("exclude", {}))
    elements = [place for places in homogeneous_places(system) for place in places]
    require_known_keys(
        f"{where}: exclude", excluded, ("clearance", "quaternions") if elements else ("clearance",)
    )
    clearance = non_negative(f"{where}: exclude.clearance", excluded.get("clearance", 0.0))
    if clearance >= 1:
        raise OptionError(f"{where}: exclude.clearance: {clearance!r} is not below 1.")
    given = {"quaternions", *(system.coordinate_names[place] for place in elements)} & {*table.get("x", {})}
    is_default = not given and 0 < len(elements) <= 4 * MOST_HOMOGENEOUS
    shortest = excluded.get("quaternions", SHORTEST if is_default else 0.0)
    return InputBox(system, low, high, clearance, non_negative(f"{where}: exclude.quaternions", shortest))


def homogeneous_places(system: System) -> tuple[tuple[int, ...], ...]:
    """Return the places in {x} of the four elements of each quaternion."""
    found: dict[int, list[int]] = {}
    for coordinate, place in system.coordinate_places.items():
        if coordinate.unit == "1":
            found.setdefault(coordinate.body, []).append(place)
    return tuple(map(tuple, found.values()))


def _tables(system: System) -> dict[str, dict[str, str]]:
    """Return the tables of a system, each with its keys and their units."""
    freedoms: dict[str, str] = {
        name: freedom.unit for name, freedom in zip(system.freedom_names, system.freedoms, strict=True)
    }
    units = [coordinate.unit for coordinate in system.coordinates]
    coordinates: dict[str, str] = dict(zip(system.coordinate_names, units, strict=True))
    found: dict[str, dict[str, str]] = {"x": coordinates}
    found |= {name: freedoms for name in ("y", "ydot", "tau")}
    found |= {name: {} for name in load_rows(system)}
    if system.parameters:
        found[PARAMETERS] = {parameter.name: "" for parameter in system.parameters}
    if system.prescribed:
        pairs = zip(system.prescribed_names, system.prescribed, strict=True)
        found["prescribed"] = {name: freedom.unit for name, freedom in pairs}
    if system.depends_on_time:
        found["time"] = {TIME: "s"}
    return found


def load_rows(system: System) -> dict[str, dict[str, int]]:
    """Return the rows of bodies or points that take loads, by name of the array."""
    bodies = {body.name: row for row, body in enumerate(system.bodies) if body.loads}
    points = {point.name: row for row, (_, point) in enumerate(system.points) if point.loads}
    found = {name: bodies for name in ("force", "torque") if bodies}
    return found | {name: points for name in ("point_force", "point_moment") if points}


def _default_sizes(system: System) -> dict[str, Floats]:
    """Return the largest magnitudes of the elements of all input arrays, by name."""
    found = ranges(system)
    rate = found.y / found.size
    n = len(system.freedoms)
    limits = system.limits
    sizes = {
        "x": found.x,
        "y": limits.speeds(found.y),
        "ydot": found.y * rate,
        "tau": limits.efforts(np.zeros(n)),
    }
    sizes |= {one.name: np.ones(one.size) for one in argument_arrays(system) if one.name in OF_PRODUCTS}
    if any(body.loads for body in system.bodies):
        sizes |= {"force": found.force.ravel(), "torque": found.torque.ravel()}
    sizes |= {
        name: np.atleast_1d(np.asarray(value, dtype=float)).ravel() for name, value in found.inputs.items()
    }
    if system.parameters:
        sizes[PARAMETERS] = np.zeros(len(system.parameters))
    return sizes


def _set_prescribed(
    where: str, system: System, units: Mapping[str, str], table: Mapping[str, Any], low: Floats, high: Floats
) -> None:
    """Write the ranges of the three rows of prescribed freedoms into the ends of a box; see `set_ranges`."""
    require_known_keys(where, table, PRESCRIBED)
    for row, name in enumerate(PRESCRIBED):
        own = require_table(where, name, table.get(name, {}))
        part = slice(row * len(units), (row + 1) * len(units))
        set_ranges(f"{where}.{name}", system.name, units, own, low[part], high[part])


def _moved(ends: Floats, others: Floats, dtype: np.dtype[Any], outward: float) -> Floats:
    """Return ends, moved outward to numbers of a precision with fewer digits than double.

    An end that is also the other end of its range stays, unless it is beyond the largest number.
    """
    if np.finfo(dtype).nmant >= np.finfo(np.float64).nmant:
        return ends.astype(np.float64)
    with np.errstate(over="ignore"):
        nearest = ends.astype(dtype)
    inside = nearest.astype(np.float64) > ends if outward < 0 else nearest.astype(np.float64) < ends
    moved = np.where(inside, np.nextafter(nearest, dtype.type(outward)), nearest).astype(np.float64)
    return np.where((ends == others) & np.isfinite(nearest), ends, moved)
