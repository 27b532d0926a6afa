"""The symbols of coordinates and speeds in the equations of one system: the names that its author gave.

A freedom that the model names, by its joint or in `freedom_names`, has its name as the symbol of its
coordinate: `q1`, with the rate `q1_dot` and the second derivative `q1_ddot`. All other freedoms have the
symbols of the notes, such as `theta_1_3`; so has a freedom whose name is no identifier, or means something
else in the same equations. The recursive derivation has the symbols of the notes alone: `NOTES`.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sympy import Symbol

from kanegen.model.coordinates import FREEDOMS, Freedom
from kanegen.model.validation import is_symbol_of_notes
from kanegen.symbolic import symbols
from kanegen.symbolic.symbols import real

if TYPE_CHECKING:
    from kanegen.model.system import System

RATE, SECOND_RATE = "_dot", "_ddot"
"""Ends of the names of the first and second time derivative of a coordinate."""

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

_OF_EXPRESSIONS = {"t", "pi"}
"""Names that have a meaning in every equation: the time, and a number."""


@dataclass(frozen=True)
class StateSymbols:
    """The symbols of coordinates, speeds and their derivatives; bodies count from 1.

    Example:
        of_system(kg.load("models/double_pendulum.toml")).coordinate(1, 2)  # q1

    Attributes:
        names: Names of freedoms in place of the symbols of the notes.
    """

    names: Mapping[Freedom, str] = field(default_factory=dict)

    def coordinate(self, body: int, kind: int) -> Symbol:
        """Return a coordinate; `kind` counts `COORDINATE_KINDS` (rad, m, 1)."""
        name = self.names.get(Freedom(body, kind))
        return real(name) if name else symbols.coordinate(body, kind)

    def coordinate_rate(self, body: int, kind: int) -> Symbol:
        """Return the time derivative of `coordinate(body, kind)` (rad/s, m/s, 1/s)."""
        name = self.names.get(Freedom(body, kind))
        return real(name + RATE) if name else symbols.coordinate_rate(body, kind)

    def speed(self, body: int, kind: int) -> Symbol:
        """Return a generalized speed; `kind` counts `SPEED_KINDS` (rad/s, m/s)."""
        name = self.names.get(Freedom(body, kind))
        return real(name + RATE) if name else symbols.speed(body, kind)

    def acceleration(self, body: int, kind: int) -> Symbol:
        """Return the time derivative of `speed(body, kind)` (rad/s^2, m/s^2)."""
        name = self.names.get(Freedom(body, kind))
        return real(name + SECOND_RATE) if name else symbols.acceleration(body, kind)

    def coordinates(self, system: System) -> tuple[Symbol, ...]:
        """Return the symbols of {x}, in order."""
        return tuple(self.coordinate(each.body, each.index) for each in system.coordinates)

    def coordinate_rates(self, system: System) -> tuple[Symbol, ...]:
        """Return the symbols of {xdot}, in order."""
        return tuple(self.coordinate_rate(each.body, each.index) for each in system.coordinates)

    def speeds(self, system: System) -> tuple[Symbol, ...]:
        """Return the symbols of {y}, in order."""
        return tuple(self.speed(each.body, each.index) for each in system.speeds)

    def accelerations(self, system: System) -> tuple[Symbol, ...]:
        """Return the symbols of {ydot}, in order."""
        return tuple(self.acceleration(each.body, each.index) for each in system.speeds)

    def prescribed(self, system: System) -> tuple[Symbol, ...]:
        """Return the symbols of prescribed freedoms: all values, all rates, all second derivatives."""
        places = [(freedom.body, freedom.index) for freedom in system.prescribed]
        kinds = self.coordinate, self.speed, self.acceleration
        return tuple(symbol(*place) for symbol in kinds for place in places)

    @property
    def reserved(self) -> frozenset[str]:
        """The names that no other quantity of the equations may have."""
        return frozenset(f"{name}{end}" for name in self.names.values() for end in ("", RATE, SECOND_RATE))


NOTES = StateSymbols()
"""The symbols of the notes for all freedoms."""


def of_system(system: System) -> StateSymbols:
    """Return the symbols in the equations of a system: the names that its author gave where they can be.

    The name of a freedom is its symbol if it is an identifier, if neither it nor that of a derivative names a
    parameter or another freedom, and if it looks like no symbol of the notes.
    """
    given = {
        Freedom(number, index): name
        for number, body in enumerate(system.bodies, start=1)
        for index in range(len(FREEDOMS))
        if (name := body.joint.freedom_name(index))
    }
    meanings = Counter(parameter.name for parameter in system.parameters)
    meanings.update(name + end for name in given.values() for end in ("", RATE, SECOND_RATE))
    return StateSymbols(
        {
            freedom: name
            for freedom, name in given.items()
            if _IDENTIFIER.fullmatch(name)
            and name not in _OF_EXPRESSIONS
            and not is_symbol_of_notes(name)
            and all(meanings[name + end] == 1 for end in ("", RATE, SECOND_RATE))
        }
    )
