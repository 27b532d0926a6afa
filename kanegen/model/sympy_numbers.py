"""Expressions of SymPy as trees of expressions, and back. SymPy is imported where one is converted."""

from __future__ import annotations

import operator
import sys
from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any

from kanegen.errors import ModelError, quoted
from kanegen.model.finite import finite
from kanegen.model.nodes import (
    PI,
    Constant,
    Leaf,
    Node,
    Operation,
    Power,
    Variable,
    check_size,
    folded,
)

_FUNCTIONS = {
    "Abs": "abs",
    "atan2": "atan2",
    "cos": "cos",
    "exp": "exp",
    "log": "log",
    "Max": "max",
    "Min": "min",
    "sign": "sign",
    "sin": "sin",
    "tan": "tan",
    "tanh": "tanh",
}
"""Names of functions of expressions by their names in SymPy."""


def is_sympy(value: object) -> bool:
    """Return whether an object is an expression of SymPy, without importing SymPy."""
    sympy = sys.modules.get("sympy")
    return sympy is not None and isinstance(value, sympy.Expr)


def from_sympy(value: Any, symbol: Callable[[str], Node]) -> Node:
    """Return the tree of an expression of SymPy.

    Args:
        value: The expression.
        symbol: Function that returns the tree of a symbol by its name.

    Raises:
        ModelError: If the expression is not real, or contains what expressions of a model cannot.

    Example:
        from_sympy(sympy.Symbol("m") / 2, lambda name: Constant(kg.Parameter(name, 1.0)))
    """
    if value.is_extended_real is False or value.is_commutative is False:
        raise ModelError(f"{_shown(value)} is no real number.")
    try:
        return check_size(_node(value, symbol))
    except RecursionError:
        raise ModelError(f"{_shown(value)}: nested too deeply.") from None


def to_sympy(root: Node) -> Any:
    """Return a tree without variables and conditions as an expression of SymPy, parameters as real symbols.

    Raises:
        ModelError: If it contains what has no value without a state.
    """
    import sympy  # noqa: PLC0415 - whoever converts to SymPy has loaded it

    def leaf(node: Leaf) -> Any:
        if not isinstance(node, Constant):
            raise ModelError(f"{quoted(node.name)} has no symbol without a system.")
        if isinstance(node.value, int | float):
            whole = float(node.value).is_integer()
            return sympy.Integer(int(node.value)) if whole else sympy.Float(node.value, precision=53)
        return sympy.Symbol(node.value.name, real=True)

    def operation(node: Operation | Power, operands: list[Any]) -> Any:
        if isinstance(node, Power):
            return operands[0] ** node.exponent
        return in_sympy(node.operator, operands)

    return folded(root, leaf, operation)


def in_sympy(name: str, operands: Sequence[Any]) -> Any:
    """Return an operation on expressions of SymPy, and on trees, as an expression of SymPy.

    Raises:
        ModelError: If it is a condition.
    """
    import sympy  # noqa: PLC0415 - whoever converts to SymPy has loaded it

    known: dict[str, Callable[..., Any]] = {
        "+": operator.add,
        "-": operator.sub,
        "*": operator.mul,
        "/": operator.truediv,
        "negate": operator.neg,
        "sqrt": sympy.sqrt,
        PI: lambda: sympy.pi,
        **{own: getattr(sympy, other) for other, own in _FUNCTIONS.items()},
    }
    if name not in known:
        raise ModelError(f"SymPy has no counterpart of {quoted(name)} here. Keep the expression as it is.")
    trees = Constant | Variable | Power | Operation
    return known[name](*(to_sympy(one) if isinstance(one, trees) else one for one in operands))


def _node(value: Any, symbol: Callable[[str], Node]) -> Node:
    """Return the tree of an expression of SymPy."""
    if value.is_Symbol:
        return symbol(value.name)
    if value.is_Rational:
        return _quotient([_whole(value.p)], [_whole(value.q)] if value.q != 1 else [])
    if value.is_Float:
        return Constant(finite(float(value), _shown(value)))
    if value.is_Mul:
        return _product(value, symbol)
    if value.is_Pow:
        return _power(value, symbol)
    arguments = [_node(one, symbol) for one in value.args]
    if value.is_Add:
        return reduce(_added, arguments)
    return _called(value, arguments)


def _called(value: Any, arguments: list[Node]) -> Node:
    """Return a constant or the call of a function as a tree."""
    name = type(value).__name__
    if name == "Pi":
        return Operation(PI, ())
    if name == "Exp1":
        return Operation("exp", (Constant(1),))
    if name == "atan":
        return Operation("atan2", (*arguments, Constant(1)))
    if name not in _FUNCTIONS:
        raise ModelError(
            f"{_shown(value)}: a number of a model cannot contain {name} of SymPy. There are sums, products, "
            f"whole powers, square roots, pi, and {', '.join(_FUNCTIONS)}."
        )
    function = _FUNCTIONS[name]
    if function in ("min", "max"):
        return reduce(lambda a, b: Operation(function, (a, b)), arguments)
    return Operation(function, tuple(arguments))


def _added(a: Node, b: Node) -> Node:
    """Return the sum of two trees, or their difference where the second has a minus."""
    match b:
        case Operation("negate", (positive,)):
            return Operation("-", (a, positive))
    return Operation("+", (a, b))


def _product(value: Any, symbol: Callable[[str], Node]) -> Node:
    """Return a product as a quotient, with its sign before it."""
    coefficient, rest = value.as_coeff_Mul()
    negative = bool(coefficient.is_negative)
    size = -coefficient if negative else coefficient
    nodes: list[Node] = []
    under: list[Node] = []
    if not size.is_Rational:
        nodes.append(_node(size, symbol))
    elif size.p != 1:
        nodes.append(_whole(size.p))
    if size.is_Rational and size.q != 1:
        under.append(_whole(size.q))
    for factor in rest.as_ordered_factors():
        if factor.is_Pow and factor.exp.is_Rational and factor.exp.is_negative:
            under.append(_node(1 / factor, symbol))
        else:
            nodes.append(_node(factor, symbol))
    found = _quotient(nodes or [Constant(1)], under)
    return Operation("negate", (found,)) if negative else found


def _quotient(above: list[Node], below: list[Node]) -> Node:
    """Return the product of some trees over that of others."""
    top = _multiplied(above)
    return Operation("/", (top, _multiplied(below))) if below else top


def _multiplied(factors: list[Node]) -> Node:
    """Return the product of trees."""
    return reduce(lambda a, b: Operation("*", (a, b)), factors)


def _whole(value: Any) -> Node:
    """Return an integer exactly: as one double, or as the sum of several."""
    rest, parts = int(value), list[Node]()
    while rest or not parts:
        part = int(finite(rest, "an integer of SymPy"))
        parts.append(Constant(part))
        rest -= part
    return reduce(lambda a, b: Operation("+", (a, b)), parts)


def _power(value: Any, symbol: Callable[[str], Node]) -> Node:
    """Return a power whose exponent is whole or a multiple of a half, or whose base is e."""
    base, exponent = value.base, value.exp
    if type(base).__name__ == "Exp1":
        return Operation("exp", (_node(exponent, symbol),))
    if exponent.is_negative and exponent.is_Rational:
        return Operation("/", (Constant(1), _node(1 / value, symbol)))
    if exponent.is_Integer:
        return Power(_node(base, symbol), int(exponent))
    if exponent.is_Rational and exponent.q == 2:
        root = Operation("sqrt", (_node(base, symbol),))
        return root if exponent.p == 1 else Power(root, int(exponent.p))
    raise ModelError(f"{_shown(value)}: an exponent is a whole number, or a multiple of 1/2.")


def _shown(value: Any) -> str:
    """Return an expression of SymPy for an error message."""
    return f"SymPy's {quoted(str(value))}"
