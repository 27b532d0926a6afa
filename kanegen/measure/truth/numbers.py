"""Numbers of a model in balls: expressions are evaluated here, parameters at their defaults."""

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import reduce
from typing import Any

from kanegen.measure.truth.balls import arb
from kanegen.model.expression import Expression
from kanegen.model.nodes import PI, Constant, Leaf, Operation, Power, folded
from kanegen.model.numbers import Number, value_of

_OPERATIONS: dict[str, Callable[..., Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negate": operator.neg,
    "abs": abs,
    "sign": lambda a: a.sgn(),
    "min": lambda a, b: a.min(b),
    "max": lambda a, b: a.max(b),
    "atan2": lambda y, x: arb(0) if y == 0 and x == 0 else arb.atan2(y, x),
    **{name: getattr(arb, name) for name in ("cos", "exp", "log", "sin", "sqrt", "tan", "tanh")},
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "not": operator.not_,
    "and": lambda p, q: p and q,
    "or": lambda p, q: p or q,
    "if": lambda p, a, b: a if p else b,
    PI: arb.pi,
}


def ball(number: Number) -> arb:
    """Return a number of a model as a ball of the working precision; a float is taken exactly."""
    if not isinstance(number, Expression):
        return arb(value_of(number))

    def leaf(node: Leaf) -> arb:
        assert isinstance(node, Constant)
        return arb(value_of(node.value))

    def operation(node: Operation | Power, operands: list[Any]) -> Any:
        if isinstance(node, Power):
            product = reduce(operator.mul, operands * abs(node.exponent), arb(1))
            return product if node.exponent >= 0 else 1 / product
        return _OPERATIONS[node.operator](*operands)

    value: arb = folded(number.root, leaf, operation)
    return value
