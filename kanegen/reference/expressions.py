"""Expressions of force elements: their values, their slopes, and bounds on the rounding of both.

An expression is evaluated in any of the `arithmetics`. Nothing is shared with the derivation that becomes C
but the parsed expression.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from kanegen.model.expression import Expression
from kanegen.model.nodes import PI, Constant, Leaf, Operation, Power, folded
from kanegen.model.numbers import value_of
from kanegen.reference import arithmetics
from kanegen.reference.arithmetics import Dual, Rounded, Value, function
from kanegen.reference.matrices import Numbers

Variables = Mapping[str, Numbers]
"""Values of the variables of an expression by name."""

_OPERATIONS: dict[str, Callable[..., Value]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negate": operator.neg,
    "tan": lambda angle: function("sin", angle) / function("cos", angle),
    **{name: partial(function, name) for name in ("abs", "cos", "exp", "log", "sign", "sin", "sqrt", "tanh")},
    "atan2": arithmetics.arctangent,
    "min": arithmetics.smaller,
    "max": arithmetics.larger,
    "if": arithmetics.chosen,
    "<": partial(arithmetics.compared, np.less),
    "<=": partial(arithmetics.compared, np.less_equal),
    ">": partial(arithmetics.compared, np.greater),
    ">=": partial(arithmetics.compared, np.greater_equal),
    "and": arithmetics.both,
    "or": arithmetics.either,
    "not": arithmetics.negated,
}


def value(expression: Expression, variables: Variables) -> tuple[Numbers, Numbers]:
    """Return the value of an expression, and the bound on its error in units of roundoff."""
    rounded = {name: Rounded(values, 0.0) for name, values in variables.items()}
    with np.errstate(all="ignore"):
        exact = evaluate(expression, variables, np.float64)
        return exact, evaluate(expression, rounded, lambda number: _precise(np.float64(number))).error


def slope(expression: Expression, variables: Variables, by: str) -> tuple[Numbers, Numbers]:
    """Return the derivative of an expression by a variable, and the bound on its error in roundoffs."""
    moved = {name: 1.0 if name == by else 0.0 for name in variables}
    exact = {name: Dual(values, moved[name]) for name, values in variables.items()}
    rounded = {name: Dual(_precise(values), _precise(moved[name])) for name, values in variables.items()}
    zero = np.float64(0.0)
    with np.errstate(all="ignore"):
        found = evaluate(expression, exact, lambda number: Dual(np.float64(number), zero)).slope
        parts = evaluate(
            expression, rounded, lambda number: Dual(_precise(np.float64(number)), _precise(zero))
        )
    return found, parts.slope.error


def evaluate(
    expression: Expression, variables: Mapping[str, Value], constant: Callable[[float], Value]
) -> Value:
    """Return the value of an expression in any arithmetic.

    Args:
        expression: Expression, whose parameters stand at their defaults.
        variables: Values of the variables by name.
        constant: Function that makes a value of the arithmetic from a number.
    """

    def leaf(node: Leaf) -> Value:
        return constant(value_of(node.value)) if isinstance(node, Constant) else variables[node.name]

    def operation(node: Operation | Power, operands: list[Value]) -> Value:
        if isinstance(node, Power):
            return _power(operands[0], node.exponent, constant(1.0))
        if node.operator == PI:
            return constant(np.pi) * constant(1.0)  # rounded
        return _OPERATIONS[node.operator](*operands)

    return folded(expression.root, leaf, operation)


def _power(base: Value, exponent: int, one: Value) -> Value:
    """Return a whole power by repeated multiplication; `one` is the number 1 of the arithmetic."""
    result = one
    for _ in range(abs(exponent)):
        result = result * base
    return result if exponent >= 0 else one / result


def _precise(value: Value) -> Rounded:
    """Return a number without error."""
    return Rounded(value, 0.0)
