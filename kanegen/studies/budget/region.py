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
from typing import Any

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import KanegenError, OptionError
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.studies.budget.values import ends, ends_of_three, number, positive
from kanegen.studies.tradeoff.domain import Domain, default_domain

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
