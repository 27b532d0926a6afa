"""The expressions of force elements in SymPy; shared by both derivations.

A long expression becomes a list of short parts, each with a symbol that later parts contain. SymPy never sees
a deep tree, what occurs twice is computed once, and a derivative takes as many steps as the expression, from
its value back through the parts (reverse accumulation: Griewank and Walther 2008, section 3.2).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import sympy
from sympy import Add, Dummy, Expr, S, Symbol

from kanegen.errors import ModelError, quoted
from kanegen.model.coordinates import FREEDOMS, Freedom
from kanegen.model.expression import Expression
from kanegen.model.force_elements.names import Place, variable_places
from kanegen.model.nodes import TIME, Constant, Leaf, Operation, Power, folded
from kanegen.model.numbers import Number, Parameter
from kanegen.model.system import System
from kanegen.symbolic import functions
from kanegen.symbolic.definitions import Definitions
from kanegen.symbolic.freedom_motion import FreedomMotions
from kanegen.symbolic.operations import OPERATIONS
from kanegen.symbolic.state_symbols import NOTES, StateSymbols
from kanegen.symbolic.symbols import time

LONGEST_PART = 24
"""Largest number of operations of one part of an expression, counted where they occur."""

MOST_BITS = 2**15
"""Largest number of bits of an exact number that is made of the constants of an expression."""

_COPIES = {"tan": 2}
"""How often an operand occurs in the SymPy of an operation, where it is not once."""


@dataclass(frozen=True)
class _Sized:
    """An expression in SymPy and the number of its operations."""

    value: Expr
    size: int = 0


class _Parts:
    """The translation of one expression into short parts.

    Attributes:
        values: The value of each part by its symbol, in order of evaluation.
    """

    def __init__(self, leaf: Callable[[Leaf], Expr], expression: Expression) -> None:
        self.values: dict[Symbol, Expr] = {}
        self._expression = expression
        self.root = folded(expression.root, lambda node: _Sized(leaf(node)), self._operation).value

    def _operation(self, node: Operation | Power, operands: list[_Sized]) -> _Sized:
        """Return an operation; its longest operands become parts where it would be too long."""
        name = "power" if isinstance(node, Power) else node.operator
        copies = _COPIES.get(name, 1)
        operands = [*operands]
        if name == "abs" and not operands[0].value.is_extended_real:
            # SymPy would differentiate the absolute value of what may be complex, such as a root.
            operands = [_Sized(self._part(operands[0].value))]
        while 1 + copies * sum(one.size for one in operands) > LONGEST_PART:
            longest = max(range(len(operands)), key=lambda k: operands[k].size)
            operands[longest] = _Sized(self._part(operands[longest].value))
        values = [one.value for one in operands]
        value = values[0] ** node.exponent if isinstance(node, Power) else OPERATIONS[name](*values)
        size = 0 if value.is_Number else 1 + copies * sum(one.size for one in operands)
        return _Sized(_checked(value, self._expression, Expression(node)), size)

    def _part(self, value: Expr) -> Symbol:
        """Return the symbol of a new part."""
        symbol = Dummy(real=True)
        self.values[symbol] = value
        return symbol

    def derivatives(self, by: Sequence[Symbol]) -> list[Expr]:
        """Return the derivatives of the root by symbols that are no parts; what they share becomes parts."""
        if any(map(functions.has_branches, (*self.values.values(), self.root))):
            return [self._directional(symbol) for symbol in by]
        terms: dict[Symbol, list[Expr]] = {symbol: [] for symbol in (*self.values, *by)}

        def spread(value: Expr, weight: Expr) -> None:
            inside = value.free_symbols
            for symbol, found in terms.items():
                if symbol in inside:
                    found.append(weight * sympy.diff(value, symbol))

        spread(self.root, S.One)
        for symbol, value in reversed([*self.values.items()]):
            spread(value, self._part(Add(*terms[symbol])))
        return [Add(*terms[symbol]) for symbol in by]

    def _directional(self, by: Symbol) -> Expr:
        """Return the derivative of the root by one symbol, in forward mode.

        A branch that is not taken may have a derivative without value, with which nothing must be multiplied,
        and neither must that of a square root where it is 0.
        """
        step = Dummy(real=True)
        slopes: dict[Symbol, Expr] = {by: S.One}

        def slope(value: Expr) -> Expr:
            moved = {s: s + step * slopes[s] for s in value.free_symbols if slopes.get(s, S.Zero) != 0}
            moving = functions.with_roots(value.xreplace(moved))
            return functions.without_roots(moving.diff(step).xreplace({step: S.Zero}))

        for symbol, value in [*self.values.items()]:
            slopes[symbol] = self._part(slope(value))
        return slope(self.root)


@dataclass(frozen=True)
class ExpressionTranslator:
    """Translates expressions of force elements, and the names of coordinates and speeds in them, to SymPy.

    Attributes:
        system: The system to which the force elements belong.
        number: Converts a number of the model to SymPy.
        definitions: Collects the definitions of the parts of long expressions.
        symbols: The symbols of coordinates and speeds.
    """

    system: System
    number: Callable[[Number], Expr]
    definitions: Definitions
    symbols: StateSymbols = NOTES

    def value(self, expression: Expression) -> Expr:
        """Return an expression in SymPy.

        Raises:
            ModelError: If the expression or a part of it has no value in any state: it divides by zero, or
                takes the root or the logarithm of a number that has none.
        """
        with self._named(expression):
            parts = _Parts(self._leaf, expression)
            (value,) = self._defined(expression, parts, [parts.root], {})
            return value

    def written_out(self, expression: Expression) -> Expr:
        """Return an expression in SymPy, with no part of it defined apart."""
        with self._named(expression):
            parts = _Parts(self._leaf, expression)
            value = parts.root
            for symbol, part in reversed([*parts.values.items()]):
                value = value.xreplace({symbol: part})
            return _checked(value, expression)

    def gradient(self, energy: Expression) -> dict[Place, Expr]:
        """Return the derivatives of an energy by its coordinates, also locked ones, by place (body, kind).

        Raises:
            ModelError: If a derivative divides by zero, or takes the root or the logarithm of a number that
                has none, in every state.
        """
        places = {name: self._places[name] for name in energy.variables}
        symbols = {place: self.symbols.coordinate(*place) for place in dict.fromkeys(places.values())}

        def leaf(node: Leaf) -> Expr:
            return self._number(node) if isinstance(node, Constant) else symbols[places[node.name]]

        with self._named(energy):
            parts = _Parts(leaf, energy)
            slopes = parts.derivatives([*symbols.values()])
            locked = {symbol: self._coordinate(place) for place, symbol in symbols.items()}
            return dict(zip(symbols, self._defined(energy, parts, slopes, locked), strict=True))

    @contextmanager
    def _named(self, expression: Expression) -> Iterator[None]:
        """Begin the message of an error about an expression with its force element, such as "drive 2"."""
        try:
            yield
        except ModelError as error:
            counts: Counter[str] = Counter()
            for element in self.system.force_elements:
                counts[element.KEY] += 1
                if expression in element.expressions():
                    raise ModelError(f"{element.KEY} {counts[element.KEY]}: {error}") from None
            raise

    def _defined(
        self, expression: Expression, parts: _Parts, results: Sequence[Expr], known: Mapping[Symbol, Expr]
    ) -> list[Expr]:
        """Return results in terms of definitions, which the parts become; `known` are further symbols."""
        replaced = dict(known)
        for symbol, value in parts.values.items():
            checked = _checked(value.xreplace(replaced), expression)
            replaced[symbol] = self.definitions.define_next("ex", checked)
        return [_checked(result.xreplace(replaced), expression) for result in results]

    def coordinate(self, name: str) -> Expr:
        """Return the coordinate of that name (rad, m), or the value at which it is locked."""
        return self._variable(f"x.{name}")

    def speed(self, name: str) -> Expr:
        """Return the speed of that name (rad/s, m/s), zero where it is locked."""
        return self._variable(f"y.{name}")

    def _leaf(self, node: Leaf) -> Expr:
        """Return a number or a variable in SymPy."""
        if isinstance(node, Constant):
            return self._number(node)
        return time() if node.name == TIME else self._variable(node.name)

    def _number(self, node: Constant) -> Expr:
        """Return a number or a parameter in SymPy."""
        return self.number(node.value if isinstance(node.value, Parameter) else float(node.value))

    def _variable(self, name: str) -> Expr:
        place = self._places[name]
        return self._coordinate(place) if name.startswith("x.") else self._speed(place)

    @cached_property
    def _places(self) -> dict[str, Place]:
        return variable_places(self.system.bodies)

    def _coordinate(self, place: Place) -> Expr:
        k, kind = place
        joint = self.system.bodies[k - 1].joint
        if kind < len(FREEDOMS) and joint.coupled[kind]:
            return self._motions.coordinate(Freedom(k, kind))
        is_symbol = kind >= len(FREEDOMS) or joint.moving[kind]
        return self.symbols.coordinate(k, kind) if is_symbol else self.number(joint.locked[kind])

    def _speed(self, place: Place) -> Expr:
        k, index = place
        joint = self.system.bodies[k - 1].joint
        if joint.coupled[index]:
            return self._motions.speed(Freedom(k, index))
        return self.symbols.speed(k, joint.speed_kinds[index]) if joint.moving[index] else S.Zero

    @cached_property
    def _motions(self) -> FreedomMotions:
        return FreedomMotions(self.system, self.number, self.symbols)


def _checked(value: Expr, expression: Expression, part: Expression | None = None) -> Expr:
    """Return `value` after a test that it is finite, real and no huge number.

    Args:
        value: The value of a part of `expression`, or of a derivative.
        expression: The whole expression.
        part: The part, where it can be shown.

    Raises:
        ModelError: If `value` is undefined or infinite in every state, or a number with too many digits.
    """
    # SymPy does not see by itself that the square root of cos(2) is no real number.
    try:
        number = value if value.free_symbols else value.evalf()
    except OverflowError:  # the exponential of a huge number
        number = S.Infinity
    if number.has(sympy.zoo, sympy.nan, sympy.oo, S.NegativeInfinity, sympy.I):
        what = f"expression {quoted(str(expression))}"
        if part is None:
            what += ": a part or a derivative of it"
        elif str(part) != str(expression):
            what += f": the part {quoted(str(part))}"
        raise ModelError(
            f"{what} has no value in any state: it divides by zero or takes the root of a negative number, "
            "or the logarithm of one that is not positive, or is infinite. Leave it out, or change its "
            "numbers."
        )
    if value.is_Rational and max(abs(value.p).bit_length(), value.q.bit_length()) > MOST_BITS:
        raise ModelError(
            f"expression {quoted(str(expression))}: a constant in it has more than {MOST_BITS} bits. Write "
            "it as one number."
        )
    return value
