"""Lowering of definitions in SymPy to straight-line code: every definition becomes a few instructions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cmp_to_key, reduce

import sympy
from sympy import Basic, Expr, Symbol

from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.constants import DOUBLE_CONSTANTS, Constants
from kanegen.program.ir import Array, Op, Output, Program
from kanegen.recursion.tree import Derived
from kanegen.symbolic import functions
from kanegen.symbolic.definitions import Definition

FUNCTIONS: dict[type[Expr], Op] = {
    sympy.sin: Op.SIN,
    sympy.cos: Op.COS,
    sympy.Abs: Op.ABS,
    sympy.sign: Op.SIGN,
    functions.sign: Op.SIGN,
    functions.minimum: Op.MIN,
    functions.maximum: Op.MAX,
    functions.choice: Op.SELECT,
    functions.exp: Op.EXP,
    functions.log: Op.LOG,
    functions.tanh: Op.TANH,
    functions.atan2: Op.ATAN2,
}
"""The instruction for each function of SymPy and of `kanegen.symbolic.functions`."""


def lower_definitions(
    inputs: Mapping[Array, Sequence[tuple[Symbol, str]]],
    definitions: Sequence[Definition],
    outputs: Mapping[Array, Derived],
    constants: Constants = DOUBLE_CONSTANTS,
) -> Program:
    """Return a program that evaluates `definitions` and stores `outputs`.

    Args:
        inputs: For every input array the symbol and the name in C of each element.
        definitions: Definitions in order of evaluation.
        outputs: Derived entries by output array.
        constants: Precision of the numbers.
    """
    builder = Builder(tuple(inputs))
    lowering = _Lowering(builder, constants)
    for array, elements in inputs.items():
        for index, (symbol, name) in enumerate(elements):
            lowering.values[symbol] = builder.input(array.name, index, name)
    for definition in definitions:
        value = lowering.value(definition.value)
        lowering.values[definition.symbol] = builder.name(value, definition.symbol.name, definition.note)
    filled = [
        Output(
            array,
            lowering.all_values(derived.entries),
            lowering.all_values(derived.exists_if_positive),
            accurate_if_positive=lowering.all_values(derived.accurate_if_positive),
        )
        for array, derived in outputs.items()
    ]
    return check(builder.program(filled))


class _Lowering:
    """The translation of small expressions into values of a builder."""

    def __init__(self, builder: Builder, constants: Constants) -> None:
        self.builder = builder
        self.constants = constants
        self.values: dict[Expr, int] = {}

    def all_values(self, expressions: Sequence[Expr]) -> tuple[int, ...]:
        """Return the numbers of the values of several expressions."""
        return tuple(self.value(expression) for expression in expressions)

    def value(self, expression: Expr) -> int:
        """Return the number of the value of an expression, adding instructions where they are new."""
        known = self.values.get(expression)
        if known is not None:
            return known
        if expression.is_Rational:
            return self.builder.constant(self.constants.quotient(expression.p, expression.q))
        if expression.is_Float:
            return self.builder.constant(float(expression))
        arguments = expression.args
        if expression.is_Add:
            return self._sum(arguments)
        if expression.is_Mul:
            return reduce(self.builder.multiply, (self.value(factor) for factor in arguments))
        if expression.is_Pow and arguments[1].is_Rational and arguments[1].q.bit_count() == 1:
            return self._power(self.value(arguments[0]), arguments[1].p, arguments[1].q)
        if expression is sympy.pi:
            return self.builder.constant(self.constants.functions.pi)
        function = FUNCTIONS.get(type(expression))
        if function is not None:
            return self.builder.function(function, *map(self.value, arguments))
        raise TypeError(f"no instruction for {type(expression).__name__}: {expression}")

    def _power(self, base: int, numerator: int, denominator: int) -> int:
        """Return the power of a value by squaring and square roots; the denominator is a power of two."""
        if numerator < 0:
            one = self.builder.constant(self.constants.quotient(1, 1))
            return self.builder.divide(one, self._power(base, -numerator, denominator))
        whole, rest = divmod(numerator, denominator)
        factors, root = [], base
        while rest:
            root, rest = self.builder.function(Op.SQRT, root), 2 * rest
            if rest >= denominator:
                factors.append(root)
                rest -= denominator
        while whole:
            if whole % 2:
                factors.append(base)
            whole //= 2
            base = self.builder.multiply(base, base) if whole else base
        return reduce(self.builder.multiply, factors)

    def _sum(self, terms: Sequence[Expr]) -> int:
        """Return the sum of terms, added from left to right; a number comes last, where SymPy puts it first.

        The order does not depend on numbers in front of the terms, as SymPy's does: so the same system in
        units that are smaller by powers of two has the same program, and every result the same bits.
        """
        return reduce(self.builder.add, (self.value(term) for term in sorted(terms, key=_without_number)))


def _without_number(term: Expr) -> tuple[bool, object]:
    """Return the sort key of a term of a sum: its factors in SymPy's order, numbers after everything."""
    _, factors = term.as_coeff_Mul()
    return bool(term.is_Number), _SYMPY_ORDER(factors)


_SYMPY_ORDER = cmp_to_key(Basic.compare)
