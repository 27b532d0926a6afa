"""The states for which a budget is kept, read from a table of plain data and written as one.

A region is a box of states without the states that the user excludes. Its table has the form of a TOML file:

    [x]                             # coordinates, rad and m
    angles = [-3.0, 3.0]            # all angles; there are also "translations" and "quaternions"
    elbow = [0.1, 2.5]              # one freedom, by its name; a single number fixes it
    [y]                             # generalized speeds, rad/s and m/s
    [tau]                           # generalized forces, N m and N
    [force]                         # loads of a body, or of "all": one range, or one for each component
    hand = [-10.0, 10.0]
    [torque]
    [parameters]                    # values of run-time parameters
    load = 12.5
    [exclude]
    clearance = 0.05                # states where |cos(theta2)| of a joint with three free angles is smaller
    cancellation = 1e6              # states where the cancellation chi of the accelerations is larger

A key that is left out keeps the range of `tradeoff.domain.default_domain`: the limits of the model where it
has some, else the scale of each body.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.errors import KanegenError, OptionError
from kanegen.measure.domain_tables import (
    finite_number,
    non_negative,
    require_known_keys,
    require_table,
    set_load_ranges,
    set_ranges,
)
from kanegen.model.system import System
from kanegen.readers.reader import read_text
from kanegen.readers.toml import parse_toml
from kanegen.studies.tradeoff.domain import GRID, Domain, default_domain

OPTION = "--domain"
"""The command-line option that describes a region, named in error messages."""

STATE_TABLES = ("x", "y", "tau")
LOAD_TABLES = ("force", "torque")
EXCLUSIONS = ("clearance", "cancellation")
TABLES = (*STATE_TABLES, *LOAD_TABLES, "parameters", "exclude")

_LARGEST = (float(np.finfo(GRID.dtype).max), "single precision")
"""Largest number of a state."""


@dataclass(frozen=True)
class Region:
    """A box of states without the excluded ones.

    Attributes:
        domain: The box and its distance from gimbal lock. The parameters of its system have the values of
            this region.
        cancellation: Largest cancellation chi of the accelerations (`measure.truth.conditioning`) of a state
            that belongs to the region; infinite if no state is excluded by it.
        parameters: Values of run-time parameters that the table sets, by name.
    """

    domain: Domain
    cancellation: float
    parameters: Mapping[str, float]

    @property
    def system(self) -> System:
        """The system whose parameters have the values of this region."""
        return self.domain.system

    def as_table(self) -> dict[str, Any]:
        """Return the table from which `region_from_table` makes an equal region."""
        ranges = self.domain.as_dict()
        loaded = [body.name for body in self.system.bodies if body.loads]
        table: dict[str, Any] = {name: ranges[name] for name in STATE_TABLES}
        table |= {name: {body: ranges[name][body] for body in loaded} for name in LOAD_TABLES if loaded}
        table["parameters"] = dict(self.parameters)
        table["exclude"] = {"clearance": self.domain.clearance}
        if self.cancellation < math.inf:
            table["exclude"]["cancellation"] = self.cancellation
        return table


def read_region(text: str | None, system: System) -> Region:
    """Return the region that the option `--domain` describes.

    Args:
        text: Path of a file that ends in .toml, or the content of such a file with ";" for the ends of
            lines; None for the default region.
        system: The system whose states the region holds.

    Raises:
        OptionError: If the text describes no region of this system; the message names the file and the key.
        ReadError: If the file does not exist, or the text is not valid TOML.
    """
    if text is None:
        return region_from_table(system, {})
    if text.lower().endswith(".toml"):
        return region_from_table(system, parse_toml(read_text(Path(text)), text), text)
    return region_from_table(system, parse_toml(text.replace(";", "\n"), OPTION), OPTION)


def region_from_table(system: System, table: Mapping[str, Any], where: str = "domain") -> Region:
    """Return the region that a table describes.

    Args:
        system: The system whose states the region holds.
        table: Ranges, parameters and exclusions in the form of the module docstring.
        where: Beginning of error messages, such as the name of a file.

    Raises:
        OptionError: If a name is unknown or a value is no range; the message names the key.
    """
    require_known_keys(where, table, TABLES)
    tables = {name: require_table(where, name, table.get(name, {})) for name in TABLES}
    parameters = {
        name: finite_number(f"{where}: parameters.{name}", value)
        for name, value in tables["parameters"].items()
    }
    try:
        system = system.with_parameters(parameters)
    except KanegenError as error:
        raise OptionError(f"{where}: parameters: {error}") from None
    exclusions = _exclusions(f"{where}: exclude", tables["exclude"])
    box = default_domain(system, clearance=exclusions.get("clearance", 0.0))
    low, high = box.low.copy(), box.high.copy()
    rows = {body.name: row for row, body in enumerate(system.bodies) if body.loads}
    for name, first in box.first.items():
        place = f"{where}: {name}"
        if name in LOAD_TABLES:
            set_load_ranges(place, rows, tables[name], low[first:], high[first:], _LARGEST)
        else:
            elements = box.elements[name]
            set_ranges(place, system.name, elements, tables[name], low[first:], high[first:], _LARGEST)
    try:
        domain = replace(box, low=low, high=high)
        domain.uniform(1, np.random.default_rng(0))
    except OptionError as error:
        raise OptionError(f"{where}: {error}") from None
    return Region(domain, exclusions.get("cancellation", math.inf), parameters)


def require_no_gimbal_lock(region: Region) -> None:
    """Require that [A] is regular in the whole region as far as gimbal lock is concerned.

    Joints whose speeds are the relative angular velocity are regular at gimbal lock; joints whose speeds are
    rates of angles are singular there.

    Raises:
        OptionError: If the region holds states at gimbal lock where [A] is singular; the message names the
            range to exclude.
    """
    domain, system = region.domain, region.system
    if domain.clearance > 0:
        return
    for place, lock in domain.gimbal_lock_angles.items():
        body = system.bodies[system.coordinates[place].body - 1]
        if body.joint.speeds_are_rates and _range_meets(lock, domain.low[place], domain.high[place]):
            name = system.coordinate_names[place]
            raise OptionError(
                f"domain: [A] is singular where {'cos' if lock else 'sin'}({name}) = 0, which x.{name} from "
                f"{domain.low[place]:.4g} to {domain.high[place]:.4g} meets. Exclude that, such as by "
                f"exclude.clearance = 0.05, or give the joint of {body.name!r} the speeds angular_velocity, "
                "which are regular there."
            )


def _range_meets(lock: float, low: float, high: float) -> bool:
    """Return whether the range from `low` to `high` holds `lock` plus a whole number of half turns (rad)."""
    return math.floor((high - lock) / math.pi) >= math.ceil((low - lock) / math.pi)


def _exclusions(where: str, table: Mapping[str, Any]) -> dict[str, float]:
    """Return the numbers of the table [exclude] by name.

    Raises:
        OptionError: If a key is unknown or a value out of range.
    """
    require_known_keys(where, table, EXCLUSIONS)
    found = {name: non_negative(f"{where}.{name}", value) for name, value in table.items()}
    if found.get("clearance", 0.0) >= 1:
        raise OptionError(f"{where}.clearance: {found['clearance']!r} is not below 1.")
    return found
