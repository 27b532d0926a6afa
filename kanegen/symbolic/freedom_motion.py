"""The motion of a freedom in terms of {x}, {y} and prescribed motion; shared by both derivations.

A free or prescribed freedom has symbols of its own. A coupled freedom is a linear function of such freedoms;
where it follows freedoms that are coupled themselves, the functions are put into each other here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

from sympy import Add, Expr, S, Symbol

from kanegen.model.coordinates import Freedom
from kanegen.model.numbers import Number
from kanegen.model.system import System
from kanegen.symbolic.state_symbols import NOTES, StateSymbols

Shares = Mapping[Freedom, Expr]
"""Factors of freedoms in a linear function, by freedom."""


@dataclass(frozen=True)
class FreedomMotions:
    """The motion of the free, prescribed and coupled freedoms of a system whose speeds are rates.

    Attributes:
        system: The system.
        number: Converts a number of the model to SymPy.
        symbols: The symbols of coordinates and speeds.
    """

    system: System
    number: Callable[[Number], Expr]
    symbols: StateSymbols = NOTES

    def shares(self, freedom: Freedom) -> Shares:
        """Return the free and prescribed freedoms that move a freedom, each with its factor."""
        return self._functions[freedom][0] if freedom in self._functions else {freedom: S.One}

    def coordinate(self, freedom: Freedom) -> Expr:
        """Return the coordinate of a freedom that moves (rad, m)."""
        offset = self._functions[freedom][1] if freedom in self._functions else S.Zero
        return self._sum(freedom, self.symbols.coordinate) + offset

    def speed(self, freedom: Freedom) -> Expr:
        """Return the rate of a freedom that moves (rad/s, m/s)."""
        return self._sum(freedom, self.symbols.speed)

    def acceleration(self, freedom: Freedom) -> Expr:
        """Return the second derivative of a freedom that moves (rad/s^2, m/s^2)."""
        return self._sum(freedom, self.symbols.acceleration)

    def _sum(self, freedom: Freedom, symbol: Callable[[int, int], Symbol]) -> Expr:
        """Return the sum of the symbols of the freedoms that move a freedom, times their factors."""
        pairs = self.shares(freedom).items()
        return Add(*(share * symbol(other.body, other.index) for other, share in pairs))

    @cached_property
    def _functions(self) -> dict[Freedom, tuple[dict[Freedom, Expr], Expr]]:
        """Shares and offset by coupled freedom."""
        found: dict[Freedom, tuple[dict[Freedom, Expr], Expr]] = {}
        for one in self.system.coupled:
            shares: dict[Freedom, Expr] = {}
            offset = self.number(one.offset)
            for other, factor in one.terms:
                inner, constant = found.get(other, ({other: S.One}, S.Zero))
                scale = self.number(factor)
                offset += scale * constant
                for freedom, share in inner.items():
                    shares[freedom] = shares.get(freedom, S.Zero) + scale * share
            found[one.freedom] = {key: share for key, share in shares.items() if share != 0}, offset
        return found
