"""Expressions of force elements in NumPy: values, slopes, and how far rounding can carry them.

Nothing is shared with the derivation but the tree that the text was read into.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from functools import partial

from kanegen.model.force_elements.expression import Constant, Expression, Node, Operation, Power, Variable
from kanegen.model.numbers import value_of
from kanegen.reference.arithmetics import Dual, Rounded, Value, function
from kanegen.reference.matrices import Numbers

Variables = Mapping[str, Numbers]

_OPERATIONS: dict[str, Callable[..., Value]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negate": operator.neg,
    "tan": lambda angle: function("sin", angle) / function("cos", angle),
    **{name: partial(function, name) for name in ("abs", "cos", "sin", "sqrt")},
}


def value(expression: Expression, variables: Variables) -> tuple[Numbers, Numbers]:
    """The value of an expression, and the size of its rounding, in units of roundoff."""
    exact = evaluate(expression, variables, lambda number: number)
    rounded = {name: Rounded(held, 0.0) for name, held in variables.items()}
    return exact, evaluate(expression, rounded, _precise).error


def slope(expression: Expression, variables: Variables, by: str) -> tuple[Numbers, Numbers]:
    """The derivative of an expression by a variable, and the size of its rounding."""
    moved = {name: 1.0 if name == by else 0.0 for name in variables}
    exact = {name: Dual(held, moved[name]) for name, held in variables.items()}
    rounded = {name: Dual(_precise(held), _precise(moved[name])) for name, held in variables.items()}
    found = evaluate(expression, exact, lambda number: Dual(number, 0.0)).slope
    size = evaluate(expression, rounded, lambda number: Dual(_precise(number), _precise(0.0))).slope.error
    return found, size


def evaluate(
    expression: Expression, variables: Mapping[str, Value], constant: Callable[[float], Value]
) -> Value:
    """The value of an expression in any arithmetic.

    Args:
        expression: It; parameters stand at their defaults.
        variables: Values by name.
        constant: What stands for a number.
    """

    def of(node: Node) -> Value:
        match node:
            case Constant(number):
                return constant(value_of(number))
            case Variable(name):
                return variables[name]
            case Power(base, exponent):
                return _power(of(base), exponent, constant(1.0))
            case Operation(name, operands):
                return _OPERATIONS[name](*map(of, operands))

    return of(expression.root)


def _power(base: Value, exponent: int, one: Value) -> Value:
    result = one
    for _ in range(abs(exponent)):
        result = result * base
    return result if exponent >= 0 else one / result


def _precise(held: Value) -> Rounded:
    return Rounded(held, 0.0)
