"""From SymPy to straight-line code: every definition of the recursive form becomes a few instructions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce

import sympy
from sympy import Expr, Symbol

from kanegen.errors import ModelError
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.ir import Array, Op, Output, Program
from kanegen.recursion.derived import Derived
from kanegen.symbolic.definitions import Definition

FUNCTIONS: dict[type[Expr], Op] = {sympy.sin: Op.SIN, sympy.cos: Op.COS}

POWERS = (2, -1)
"""Squares and reciprocals are all that a recursion makes of powers."""


def lower(
    inputs: Mapping[Array, Sequence[tuple[Symbol, str]]],
    definitions: Sequence[Definition],
    outputs: Mapping[Array, Derived],
) -> Program:
    """A program that evaluates `definitions` and stores `outputs`.

    Args:
        inputs: For every input array the symbol that each element stands for, and its name in C.
        definitions: In order of evaluation.
        outputs: What fills every output array.
    """
    builder = Builder(tuple(inputs))
    lowering = _Lowering(builder)
    for array, elements in inputs.items():
        for index, (symbol, name) in enumerate(elements):
            lowering.values[symbol] = builder.input(array.name, index, name)
    for definition in definitions:
        value = lowering.value(definition.value)
        lowering.values[definition.symbol] = builder.name(value, definition.symbol.name, definition.note)
    filled = [
        Output(array, lowering.all(derived.entries), lowering.all(derived.positive))
        for array, derived in outputs.items()
    ]
    return check(builder.program(filled))


class _Lowering:
    """Turns small expressions into values of a builder."""

    def __init__(self, builder: Builder) -> None:
        self.builder = builder
        self.values: dict[Expr, int] = {}

    def all(self, expressions: Sequence[Expr]) -> tuple[int, ...]:
        return tuple(self.value(expression) for expression in expressions)

    def value(self, expression: Expr) -> int:
        known = self.values.get(expression)
        if known is not None:
            return known
        if expression.is_Rational:
            return self.builder.constant(_rounded(expression.p, expression.q))
        if expression.is_Float:
            return self.builder.constant(float(expression))
        arguments = expression.args
        if expression.is_Add:
            return self._sum(arguments)
        if expression.is_Mul:
            return reduce(self.builder.multiply, (self.value(factor) for factor in arguments))
        if expression.is_Pow and arguments[1] in POWERS:
            base = self.value(arguments[0])
            if arguments[1] == -1:
                return self.builder.divide(self.builder.constant(1.0), base)
            return self.builder.multiply(base, base)
        function = FUNCTIONS.get(type(expression))
        if function is not None:
            return self.builder.function(function, self.value(arguments[0]))
        raise TypeError(f"no instruction for {type(expression).__name__}: {expression}")

    def _sum(self, terms: Sequence[Expr]) -> int:
        """Left to right; a number last, where SymPy puts it first."""
        ordered = sorted(terms, key=lambda term: bool(term.is_Number))
        return reduce(self.builder.add, (self.value(term) for term in ordered))


def _rounded(numerator: int, denominator: int) -> float:
    try:
        return numerator / denominator
    except OverflowError:
        raise ModelError(
            "a constant leaves the range of double precision; choose units nearer to 1."
        ) from None
