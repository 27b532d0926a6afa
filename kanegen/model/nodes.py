"""Trees of expressions: numbers, variables, operations and powers, and how to go through them.

`expression.Expression` holds such a tree, and `grammar` makes one of a text. Everything here works on lists,
because a tree may be deeper than Python's recursion allows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeVar

from kanegen.errors import ModelError

_T = TypeVar("_T")

FUNCTIONS = {
    "abs": 1,
    "atan2": 2,
    "cos": 1,
    "exp": 1,
    "log": 1,
    "max": 2,
    "min": 2,
    "sign": 1,
    "sin": 1,
    "sqrt": 1,
    "tan": 1,
    "tanh": 1,
}
"""Functions that an expression may call, with their numbers of operands. Their results have the same bits on
every machine."""

COMPARISONS = ("<", "<=", ">", ">=")
"""Operators that make a condition of two numbers."""

MAX_OPERATIONS = 2000
"""Largest number of operations of an expression."""

MAX_DEPTH = 200
"""Largest depth of nested operations."""

MAX_EXPONENT = 64
"""Largest exponent, and largest product of the exponents of nested powers."""

PI = "pi"
"""Name of the number pi."""

TIME = "t"
"""Name of the variable that is the time (s)."""


@dataclass(frozen=True)
class Constant:
    """A number of the model.

    Attributes:
        value: A float, an integer that a double holds, or an `expression.Parameter`.
    """

    value: Any


@dataclass(frozen=True)
class Variable:
    """A variable: `t`, `x.<coordinate>` or `y.<speed>`; a system refuses other names."""

    name: str


Leaf = Constant | Variable


@dataclass(frozen=True)
class Power:
    """A power whose exponent is an integer, never a parameter."""

    base: Node
    exponent: int


@dataclass(frozen=True)
class Operation:
    """An operation on numbers or on conditions.

    Attributes:
        operator: One of `+ - * /`, "negate", one of `FUNCTIONS`, or `PI`, which has no operands. Conditions
            are one of `COMPARISONS`, "and", "or" and "not". "if" takes a condition, the number where it
            holds, and the number elsewhere.
        operands: The numbers or conditions.
    """

    operator: str
    operands: tuple[Node, ...]


Node = Constant | Variable | Power | Operation

Step = Leaf | int | tuple[str, int]
"""A node of a tree in a list: a leaf, the exponent of a power, or an operator and its number of operands."""


def folded(
    root: Node, leaf: Callable[[Leaf], _T], operation: Callable[[Operation | Power, list[_T]], _T]
) -> _T:
    """Return the value of a tree of any depth, from the values of its leaves and operations.

    Args:
        root: The tree.
        leaf: Function that returns the value of a leaf.
        operation: Function that returns the value of an operation or power from those of its operands.
    """
    waiting, nodes = [root], []
    while waiting:
        nodes.append(waiting.pop())
        waiting += operands_of(nodes[-1])
    values: list[_T] = []
    for node in reversed(nodes):
        if isinstance(node, Constant | Variable):
            values.append(leaf(node))
        else:
            count = len(operands_of(node))
            operands = values[len(values) - count :]
            values[len(values) - count :] = [operation(node, operands)]
    return values[0]


def operands_of(node: Node) -> tuple[Node, ...]:
    """Return the operands of a node, none of a leaf."""
    match node:
        case Operation(_, operands):
            return operands
        case Power(base):
            return (base,)
    return ()


def postfix(root: Node) -> tuple[Step, ...]:
    """Return the nodes of a tree, operands before their operation."""
    steps: list[Step] = []

    def operation(node: Operation | Power, operands: list[None]) -> None:
        steps.append(node.exponent if isinstance(node, Power) else (node.operator, len(operands)))

    folded(root, steps.append, operation)
    return tuple(steps)


def rebuilt(steps: tuple[Step, ...]) -> Node:
    """Return the tree that `postfix` made a list of."""
    made: list[Node] = []
    for step in steps:
        match step:
            case int(exponent):
                made.append(Power(made.pop(), exponent))
            case (operator, count):
                operands = made[len(made) - count :]
                made[len(made) - count :] = [Operation(operator, tuple(operands))]
            case leaf:
                made.append(leaf)
    return made[0]


def mapped(root: Node, function: Callable[[Leaf], Node]) -> Node:
    """Return the tree with `function` applied to its leaves."""

    def again(node: Operation | Power, operands: list[Node]) -> Node:
        return (
            Power(operands[0], node.exponent)
            if isinstance(node, Power)
            else replace(node, operands=tuple(operands))
        )

    return folded(root, function, again)


def leaves(root: Node) -> list[Leaf]:
    """Return the numbers and variables of a tree, from the left."""
    found: list[Leaf] = []
    folded(root, found.append, lambda node, operands: None)
    return found


class _Size(NamedTuple):
    """The number of operations of a tree, their depth, and the largest product of nested exponents."""

    operations: int = 0
    depth: int = 0
    exponent: int = 1


def check_size(root: Node) -> Node:
    """Return a tree that is no larger than the limits of this module.

    Raises:
        ModelError: If it has too many operations, or they are nested too deeply, or a power is too large.
    """

    def operation(node: Operation | Power, operands: list[_Size]) -> _Size:
        factor = max(abs(node.exponent), 1) if isinstance(node, Power) else 1
        return _Size(
            sum(one.operations for one in operands) + 1,
            max((one.depth for one in operands), default=0) + 1,
            factor * max((one.exponent for one in operands), default=1),
        )

    size = folded(root, lambda leaf: _Size(), operation)
    if size.operations > MAX_OPERATIONS + 1:
        raise ModelError(f"an expression has more than {MAX_OPERATIONS} operations.")
    if size.depth > MAX_DEPTH + 1:
        raise ModelError(f"an expression has more than {MAX_DEPTH} operations inside each other.")
    if size.exponent > MAX_EXPONENT:
        raise ModelError(f"an expression has a huge power; together exponents reach at most {MAX_EXPONENT}.")
    return root
