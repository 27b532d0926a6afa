"""The operations of expressions in SymPy, and numbers of a model that are expressions of parameters."""

from __future__ import annotations

import operator
from collections.abc import Callable

import sympy
from sympy import Expr

from kanegen.model.expression import Expression, Parameter
from kanegen.model.nodes import Constant, Leaf, Operation, Power, folded
from kanegen.symbolic import functions

OPERATIONS: dict[str, Callable[..., Expr]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negate": operator.neg,
    "abs": sympy.Abs,
    "cos": sympy.cos,
    "sin": sympy.sin,
    "sqrt": sympy.sqrt,
    "tan": lambda angle: sympy.sin(angle) / sympy.cos(angle),
    "exp": functions.exp,
    "log": functions.log,
    "tanh": functions.tanh,
    "atan2": functions.atan2,
    "sign": functions.sign,
    "min": functions.minimum,
    "max": functions.maximum,
    "pi": lambda: sympy.pi,
    "if": functions.choice,
    ">": functions.greater,
    "<": lambda a, b: functions.greater(b, a),
    ">=": functions.not_less,
    "<=": lambda a, b: functions.not_less(b, a),
    "and": functions.both,
    "or": functions.either,
    "not": functions.negated,
}
"""Functions of SymPy expressions for the operations of expressions; a condition holds where it is
positive."""


def of_parameters(expression: Expression, number: Callable[[float | Parameter], Expr]) -> Expr:
    """Return an expression without variables in SymPy.

    Args:
        expression: The expression.
        number: Converts the numbers and parameters in it.
    """

    def leaf(node: Leaf) -> Expr:
        assert isinstance(node, Constant)
        return number(node.value if isinstance(node.value, Parameter) else float(node.value))

    def operation(node: Operation | Power, operands: list[Expr]) -> Expr:
        if isinstance(node, Power):
            return operands[0] ** node.exponent
        return OPERATIONS[node.operator](*operands)

    return folded(expression.root, leaf, operation)
