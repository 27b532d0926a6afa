"""Named intermediates, which keep every expression of a derivation small; shared by both derivations.

A recursion over a tree writes each result in terms of symbols that stand for earlier results. The list of
definitions is in order of evaluation and every symbol is defined once, so the list can be read, substituted
back or lowered to a program, and no expression ever grows.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import NamedTuple

import sympy
from sympy import Expr, Symbol

from kanegen.program.constants import DOUBLE_CONSTANTS, Constants
from kanegen.symbolic.constant_sums import ConstantSums

AXES = "xyz"
"""Endings of the names of vector components."""


class Vector(NamedTuple):
    """The three components of a vector in some frame."""

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
    """A named intermediate.

    Attributes:
        symbol: The symbol that stands for the value.
        value: An expression in earlier symbols and in the variables of the system.
        note: Name of the group of quantities that it belongs to, used as a comment.
    """

    symbol: Symbol
    value: Expr
    note: str


class Definitions:
    """Collects definitions during a recursion.

    Args:
        parameters: Names of the parameters, which definitions must not use.
        constants: Arithmetic in which the sines and cosines of constant angles are computed.
        taken: Further names that definitions must not use.
    """

    def __init__(
        self,
        parameters: Iterable[str] = (),
        constants: Constants = DOUBLE_CONSTANTS,
        taken: Iterable[str] = (),
    ) -> None:
        self.constants = constants
        self._list: list[Definition] = []
        constant = set(parameters)
        self._names = constant.union(taken)
        self._sums = ConstantSums(Symbol(name, real=True) for name in constant)
        self._known: dict[Expr, Symbol] = {}
        self._numbers: dict[str, int] = {}
        self._note = ""
        self._mark = ""

    def listed(self) -> tuple[Definition, ...]:
        """Return all definitions so far, in order of evaluation."""
        return tuple(self._list)

    def about(self, note: str) -> None:
        """Set the note of the following definitions."""
        self._note = note

    @contextmanager
    def marking(self, mark: str) -> Iterator[None]:
        """End the names of all definitions with a mark, which says for which case they are made."""
        before, self._mark = self._mark, mark
        try:
            yield
        finally:
            self._mark = before

    def define(self, name: str, value: Expr) -> Expr:
        """Return a symbol for `value`, or `value` itself where it is a number or a symbol up to its sign.

        Equal values share one symbol. A name that is taken gets an underscore at its end. Terms that cancel
        in a sum of constants are left out, see `ConstantSums`.
        """
        name += self._mark
        is_constant = self._sums.is_constant(value)
        if is_constant:
            value = self._sums.without_cancellation(value)
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
        if is_constant:
            self._sums.record(symbol, value)
        self._list.append(Definition(symbol, value, self._note))
        return symbol

    def define_next(self, prefix: str, value: Expr) -> Expr:
        """Return what `define` returns, with the name `<prefix>_<n>`, where n counts from 1."""
        number, before = self._numbers.get(prefix, 1), len(self._list)
        symbol = self.define(f"{prefix}_{number}", value)
        self._numbers[prefix] = number + len(self._list) - before
        return symbol

    def vector(self, name: str, value: Vector) -> Vector:
        """Return symbols `name_x`, `name_y`, `name_z` for the components of `value`."""
        return Vector(*(self.define(f"{name}_{axis}", v) for axis, v in zip(AXES, value, strict=True)))

    def symmetric(self, name: str, value: Symmetric) -> Symmetric:
        """Return symbols `name_xx` ... `name_yz` for the entries of `value`."""
        entries = zip(Symmetric._fields, value, strict=True)
        return Symmetric(*(self.define(f"{name}_{entry}", v) for entry, v in entries))


def is_atom(value: Expr) -> bool:
    """Return whether `value` costs nothing to evaluate: it is a number, or a symbol up to its sign."""
    if value.is_Number or value.is_Symbol:
        return True
    return (
        bool(value.is_Mul)
        and value.args[0] is sympy.S.NegativeOne
        and len(value.args) == 2
        and bool(value.args[1].is_Symbol)
    )
