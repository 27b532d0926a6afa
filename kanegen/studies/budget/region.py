"""The part of a domain that a request is about, as a table of plain data and back.

    [x]                             # coordinates, rad and m
    angles = [-3.0, 3.0]            # all angles; "translations" and "quaternions" likewise
    elbow = [0.1, 2.5]              # one freedom, by its name; a single number fixes it
    [y]                             # generalized speeds, rad/s and m/s
    [tau]                           # generalized forces, N m and N
    [force]                         # loads by body, or of "all": one range, or one for each component
    hand = [-10.0, 10.0]
    [torque]
    [parameters]                    # values of run-time parameters
    load = 12.5
    [exclude]
    clearance = 0.05                # states in which |cos(theta2)| of a joint with three free angles is less
    cancellation = 1e6              # states whose accelerations cancel more than this

What is left out keeps the range of `study.domain.default_domain`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import KanegenError, OptionError
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.readers.text import read_text
from kanegen.readers.toml import parsed
from kanegen.studies.tradeoff.domain import GRID, Domain, default_domain

KINDS = {"angles": "rad", "translations": "m", "quaternions": "1"}
"""Names for all coordinates of a kind, and their unit."""

STATE = ("x", "y", "tau")
LOADS = ("force", "torque")
EXCLUDED = ("clearance", "cancellation")
TABLES = (*STATE, *LOADS, "parameters", "exclude")

ALL = "all"
"""Name for all bodies that take loads."""


@dataclass(frozen=True)
class Region:
    """A box of states, and what is excluded from it.

    Attributes:
        domain: The box, clear of gimbal lock; its system has the values of the parameters.
        cancellation: States with a larger chi (`check.truth.conditioning`) are not part of it.
        parameters: The values that were given.
    """

    domain: Domain
    cancellation: float
    parameters: Mapping[str, float]

    @property
    def system(self) -> System:
        """The tree, parameters at their values here."""
        return self.domain.system

    def as_table(self) -> dict[str, Any]:
        """What `region` makes an equal one of."""
        ranges = self.domain.as_dict()
        loaded = [body.name for body in self.system.bodies if body.loads]
        table: dict[str, Any] = {name: ranges[name] for name in STATE}
        table |= {name: {body: ranges[name][body] for body in loaded} for name in LOADS if loaded}
        table["parameters"] = dict(self.parameters)
        table["exclude"] = {"clearance": self.domain.clearance}
        if self.cancellation < math.inf:
            table["exclude"]["cancellation"] = self.cancellation
        return table


def region(system: System, table: Mapping[str, Any], where: str = "domain") -> Region:
    """The region that a table describes.

    Args:
        system: The tree.
        table: As above.
        where: What error messages begin with, such as the name of a file.

    Raises:
        OptionError: If a name is unknown or a value is no range; names the key.
    """
    _known(where, table, TABLES)
    tables = {name: _table(where, name, table.get(name, {})) for name in TABLES}
    parameters = {name: number(f"{where}: parameters.{name}", v) for name, v in tables["parameters"].items()}
    try:
        system = system.with_parameters(parameters)
    except KanegenError as error:
        raise OptionError(f"{where}: parameters: {error}") from None
    excluded = _excluded(f"{where}: exclude", tables["exclude"])
    box = default_domain(system, clearance=excluded.get("clearance", 0.0))
    low, high = box.low.copy(), box.high.copy()
    for name, first in box.first.items():
        place = f"{where}: {name}"
        if name in LOADS:
            _bodies(place, system, tables[name], low[first:], high[first:])
        else:
            _elements(place, system, box.elements[name], tables[name], low[first:], high[first:])
    try:
        domain = replace(box, low=low, high=high)
        domain.uniform(1, np.random.default_rng(0))
    except OptionError as error:
        raise OptionError(f"{where}: {error}") from None
    return Region(domain, excluded.get("cancellation", math.inf), parameters)


def _excluded(where: str, table: Mapping[str, Any]) -> dict[str, float]:
    _known(where, table, EXCLUDED)
    excluded = {name: positive(f"{where}.{name}", value) for name, value in table.items()}
    if excluded.get("clearance", 0.0) >= 1:
        raise OptionError(f"{where}.clearance: {excluded['clearance']!r} is not below 1.")
    return excluded


def _elements(
    where: str, system: System, units: Mapping[str, str], table: Mapping[str, Any], low: Floats, high: Floats
) -> None:
    """Put the ranges of elements, whose units are given by name, into the ends of a box; kinds first."""
    _known(where, table, (*units, *KINDS))
    for kind, unit in KINDS.items():
        if kind in table and kind not in units:
            lowest, highest = ends(f"{where}.{kind}", table[kind])
            places = [place for place, own in enumerate(units.values()) if own == unit]
            if not places:
                raise OptionError(f"{where}.{kind}: system {system.name!r} has no {kind}.")
            low[places], high[places] = lowest, highest
    for place, name in enumerate(units):
        if name in table:
            low[place], high[place] = ends(f"{where}.{name}", table[name])


def _bodies(where: str, system: System, table: Mapping[str, Any], low: Floats, high: Floats) -> None:
    """Put the ranges of loads into the ends of a box; those of all bodies first."""
    loaded = [body.name for body in system.bodies if body.loads]
    _known(where, table, (*loaded, *((ALL,) if loaded else ())))
    for name in sorted(table, key=lambda name: name != ALL):
        for k, body in enumerate(system.bodies):
            if body.loads and (name == body.name or (name == ALL and ALL not in loaded)):
                own = slice(3 * k, 3 * k + 3)
                low[own], high[own] = ends_of_three(f"{where}.{name}", table[name]).T


def _table(where: str, name: str, value: Any) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise OptionError(f"{where}: {name}: write a table [{name}], or keys such as {name}.angles.")
    return value


def _known(where: str, table: Mapping[str, Any], known: tuple[str, ...]) -> None:
    for key in table:
        if key not in known:
            raise OptionError(f"{where}: unknown key {key!r}. {did_you_mean(key, known)}")


_LARGEST = float(np.finfo(GRID.dtype).max)


def number(where: str, value: Any) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise OptionError(f"{where}: {value!r} is not a number.")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise OptionError(f"{where}: {found!r} is not a finite number.")
    return found


def positive(where: str, value: Any) -> float:
    """A finite number that is not negative."""
    found = number(where, value)
    if found < 0:
        raise OptionError(f"{where}: {found!r} is negative.")
    return found


def ends(where: str, value: Any) -> tuple[float, float]:
    """The ends of a range, which for a single number are the same."""
    if not isinstance(value, list):
        fixed = _held(where, value)
        return fixed, fixed
    if len(value) != 2:
        raise OptionError(f"{where}: a range is [low, high], or one number that stays fixed; got {value!r}.")
    low, high = (_held(where, end) for end in value)
    if low > high:
        raise OptionError(f"{where}: the range [{low!r}, {high!r}] is inverted. Write [{high!r}, {low!r}].")
    return low, high


def ends_of_three(where: str, value: Any) -> Floats:
    """(3, 2) those of the ranges of components, from one range or three."""
    if isinstance(value, list) and any(isinstance(item, list) for item in value):
        if len(value) != 3:
            raise OptionError(f"{where}: expected one range or three, got {len(value)}.")
        return np.array([ends(f"{where}[{k}]", item) for k, item in enumerate(value)])
    return np.array([ends(where, value)] * 3)


def _held(where: str, value: Any) -> float:
    """A number that a state can hold."""
    found = number(where, value)
    if abs(found) > _LARGEST:
        raise OptionError(f"{where}: {found!r} is beyond single precision, which all states have.")
    return found


OPTION = "--domain"


def read_domain(given: str | None, system: System) -> Region:
    """The region that an option `--domain` names.

    Args:
        given: A file that ends in .toml, or TOML as it would stand in one, with ";" instead of the ends of
            lines; None for the default.
        system: The tree.

    Raises:
        OptionError: If it describes no region of this system; names the file and the key.
        ReadError: If there is no such file, or it is no TOML.
    """
    if given is None:
        return region(system, {})
    if given.lower().endswith(".toml"):
        return region(system, parsed(read_text(Path(given)), given), given)
    return region(system, parsed(given.replace(";", "\n"), OPTION), OPTION)


def require_clear(region: Region) -> None:
    """Make sure that no state of a region stands at gimbal lock where that matters.

    Raises:
        OptionError: If one does; names what to exclude.
    """
    domain, system = region.domain, region.system
    if domain.clearance > 0:
        return
    for place, lock in domain.locking.items():
        body = system.bodies[system.coordinates[place].body - 1]
        if not body.joint.spins and _meets(lock, domain.low[place], domain.high[place]):
            name = system.coordinate_names[place]
            raise OptionError(
                f"domain: [A] is singular where {'cos' if lock else 'sin'}({name}) = 0, which x.{name} from "
                f"{domain.low[place]:.4g} to {domain.high[place]:.4g} meets. Exclude that, such as by "
                f"exclude.clearance = 0.05, or give the joint of {body.name!r} the speeds angular_velocity, "
                "which are regular there."
            )


def _meets(lock: float, low: float, high: float) -> bool:
    """Whether an angle between these ends can be `lock`, or half turns away from it."""
    return math.floor((high - lock) / math.pi) >= math.ceil((low - lock) / math.pi)
