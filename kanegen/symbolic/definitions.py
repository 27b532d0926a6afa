"""Named intermediates: what keeps every expression of a recursion small.

A recursion over a tree writes each result in terms of symbols that stand for earlier results. The list of
definitions is in order of evaluation and every symbol is defined once, so it can be read, substituted back
or lowered to a program, and nothing ever grows.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import sympy
from sympy import Expr, Symbol

from kanegen.program.constants import DOUBLE_CONSTANTS, Constants

AXES = "xyz"


class Vector(NamedTuple):
    """Three components in some frame."""

    x: Expr
    y: Expr
    z: Expr


class Symmetric(NamedTuple):
    """The six entries of a symmetric 3 x 3 matrix."""

    xx: Expr
    yy: Expr
    zz: Expr
    xy: Expr
    xz: Expr
    yz: Expr


@dataclass(frozen=True, slots=True)
class Definition:
    """`symbol` stands for `value`; `note` says what group of quantities it belongs to."""

    symbol: Symbol
    value: Expr
    note: str


class Definitions:
    """Collects definitions during a recursion.

    Args:
        taken: Names that definitions must not use, such as those of parameters.
        constants: How exact sines of constant angles are.
    """

    def __init__(self, taken: Iterable[str] = (), constants: Constants = DOUBLE_CONSTANTS) -> None:
        self.constants = constants
        self._list: list[Definition] = []
        self._names = set(taken)
        self._known: dict[Expr, Symbol] = {}
        self._note = ""

    def listed(self) -> tuple[Definition, ...]:
        """Everything defined so far, in order of evaluation."""
        return tuple(self._list)

    def about(self, note: str) -> None:
        """Say what the following definitions are."""
        self._note = note

    def define(self, name: str, value: Expr) -> Expr:
        """A symbol for `value`; `value` itself where it is a number or a symbol up to its sign."""
        if is_atom(value):
            return value
        known = self._known.get(value)
        if known is not None:
            return known
        while name in self._names:
            name += "_"
        symbol = Symbol(name, real=True)
        self._names.add(name)
        self._known[value] = symbol
        self._list.append(Definition(symbol, value, self._note))
        return symbol

    def vector(self, name: str, value: Vector) -> Vector:
        """Symbols `name_x`, `name_y`, `name_z` for the components of `value`."""
        return Vector(*(self.define(f"{name}_{axis}", v) for axis, v in zip(AXES, value, strict=True)))

    def symmetric(self, name: str, value: Symmetric) -> Symmetric:
        """Symbols `name_xx` ... `name_yz` for the entries of `value`."""
        entries = zip(Symmetric._fields, value, strict=True)
        return Symmetric(*(self.define(f"{name}_{entry}", v) for entry, v in entries))


def is_atom(value: Expr) -> bool:
    """Whether `value` costs nothing: a number, or a symbol up to its sign."""
    if value.is_Number or value.is_Symbol:
        return True
    return (
        bool(value.is_Mul)
        and value.args[0] is sympy.S.NegativeOne
        and len(value.args) == 2
        and bool(value.args[1].is_Symbol)
    )
