"""Expressions in a model: trees of numbers, variables, operations and powers, and their conversion to text.

`grammar` parses expressions. The derivation differentiates and lowers them through SymPy; the reference
evaluates them in NumPy, independently.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from keyword import iskeyword
from typing import TypeVar

from kanegen.model.numbers import Number, toml_number

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

PI = "pi"
"""Name of the number pi."""

TIME = "t"
"""Name of the variable that is the time (s)."""


@dataclass(frozen=True)
class Constant:
    """A number of the model, which may be a parameter."""

    value: Number


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
        are
            one of `COMPARISONS`, "and", "or" and "not". "if" takes a condition, the number where it holds,
            and the number elsewhere.
        operands: The numbers or conditions.
    """

    operator: str
    operands: tuple[Node, ...]


Node = Constant | Variable | Power | Operation

Step = Leaf | int | tuple[str, int]
"""A node of a tree in a list: a leaf, the exponent of a power, or an operator and its number of operands."""

_LEVELS = {
    **{"if": 1, "or": 2, "and": 3, "not": 4},
    **dict.fromkeys(COMPARISONS, 5),
    **{"+": 6, "-": 6, "*": 7, "/": 7, "negate": 8},
}
_UNDEFINED_SOMEWHERE = frozenset(("/", "sqrt", "tan", "log", "exp", "atan2"))
"""Operators and functions that have no finite value, or no finite slope, for some finite operands."""

_POWER = 9
_ATOM = 10


@dataclass(frozen=True)
class Expression:
    """A number that depends on the state, the time and parameters.

    Example:
        kg.parse("k*x.slider.s1 - 2*y.slider.s1", [kg.Parameter("k", 40.0)])
    """

    root: Node

    def __str__(self) -> str:
        """Return the text of the expression as `grammar.parse` reads it, parameters by their names."""
        return _text(self.root)

    def __repr__(self) -> str:
        """The text of the expression, with the function that reads it."""
        return f"parse({str(self)!r})"

    def __deepcopy__(self, memo: object) -> Expression:
        """Return the expression itself, which never changes."""
        return self

    def __reduce__(self) -> tuple[Callable[[tuple[Step, ...]], Expression], tuple[tuple[Step, ...]]]:
        """Return the tree as a list, because pickle takes trees of limited depth only."""
        return _rebuilt, (_postfix(self.root),)

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the variables, each once, in the order of first use."""
        return tuple(dict.fromkeys(leaf.name for leaf in _leaves(self.root) if isinstance(leaf, Variable)))

    def numbers(self) -> Iterator[Number]:
        """Return the numbers of the expression, from the left.

        Example:
            list(kg.parse("2*x.slider.s1 + 3").numbers())  # [2.0, 3.0]
        """
        return (leaf.value for leaf in _leaves(self.root) if isinstance(leaf, Constant))

    def operations(self) -> Iterator[Operation]:
        """Return the operations of the expression, operands before the operations on them.

        Example:
            [one.operator for one in kg.parse("2*x.slider.s1 + 3").operations()]  # ["*", "+"]
        """
        found: list[Operation] = []

        def operation(node: Operation | Power, operands: list[None]) -> None:
            if isinstance(node, Operation):
                found.append(node)

        folded(self.root, lambda node: None, operation)
        return iter(found)

    @property
    def may_be_undefined(self) -> bool:
        """Whether the expression, or its slope, is undefined or infinite for some finite variables."""
        steps = _postfix(self.root)
        for last, step in pairwise((None, *steps)):
            if isinstance(step, int) and step < 0:
                return True
            if isinstance(step, tuple) and step[0] in _UNDEFINED_SOMEWHERE:
                is_number = isinstance(last, Constant) and isinstance(last.value, float) and last.value != 0
                if step[0] != "/" or not is_number:
                    return True
        return False

    def map_numbers(self, change: Callable[[Number], Number]) -> Expression:
        """Return the same expression with `change` applied to every number.

        Example:
            plain = expression.map_numbers(value_of)  # parameters at their defaults
        """

        def leaf(found: Leaf) -> Node:
            return Constant(change(found.value)) if isinstance(found, Constant) else found

        return Expression(_mapped(self.root, leaf))

    def with_variables_renamed(self, rename: Callable[[str], str]) -> Expression:
        """Return the same expression with `rename` applied to the names of its variables.

        Example:
            kg.parse("x.arm.theta3").with_variables_renamed(lambda name: "x.elbow.theta3")
        """

        def leaf(found: Leaf) -> Node:
            return Variable(rename(found.name)) if isinstance(found, Variable) else found

        return Expression(_mapped(self.root, leaf))

    def with_constants(self, values: Mapping[str, Number]) -> Expression:
        """Return the same expression with numbers in place of some variables.

        Example:
            kg.parse("2*x.arm.s1").with_constants({"x.arm.s1": 0.5})  # 2.0*0.5
        """

        def leaf(found: Leaf) -> Node:
            if isinstance(found, Variable) and found.name in values:
                return Constant(values[found.name])
            return found

        return Expression(_mapped(self.root, leaf))


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
        waiting += _operands(nodes[-1])
    values: list[_T] = []
    for node in reversed(nodes):
        if isinstance(node, Constant | Variable):
            values.append(leaf(node))
        else:
            count = len(_operands(node))
            operands = values[len(values) - count :]
            values[len(values) - count :] = [operation(node, operands)]
    return values[0]


def _operands(node: Node) -> tuple[Node, ...]:
    """Return the operands of a node, none of a leaf."""
    match node:
        case Operation(_, operands):
            return operands
        case Power(base):
            return (base,)
    return ()


def _postfix(root: Node) -> tuple[Step, ...]:
    """Return the nodes of a tree, operands before their operation."""
    steps: list[Step] = []

    def operation(node: Operation | Power, operands: list[None]) -> None:
        steps.append(node.exponent if isinstance(node, Power) else (node.operator, len(operands)))

    folded(root, steps.append, operation)
    return tuple(steps)


def _rebuilt(steps: tuple[Step, ...]) -> Expression:
    """Return the expression whose tree `_postfix` made a list of."""
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
    return Expression(made[0])


def _mapped(root: Node, function: Callable[[Leaf], Node]) -> Node:
    """Return the tree with `function` applied to its leaves."""

    def again(node: Operation | Power, operands: list[Node]) -> Node:
        return (
            Power(operands[0], node.exponent)
            if isinstance(node, Power)
            else replace(node, operands=tuple(operands))
        )

    return folded(root, function, again)


def _leaves(root: Node) -> list[Leaf]:
    """Return the numbers and variables of a tree, from the left."""
    found: list[Leaf] = []
    folded(root, found.append, lambda node, operands: None)
    return found


def _text(root: Node) -> str:
    """Return the text of a tree."""
    return folded(root, _text_of_leaf, _text_of_operation)[0]


Text = tuple[str, int]
"""The text of a tree, and how tightly its outermost operator binds, as in `_LEVELS`."""


def _text_of_leaf(leaf: Leaf) -> Text:
    """Return the text of a number or a variable."""
    if isinstance(leaf, Variable):
        return _variable(leaf.name), _ATOM
    number = toml_number(leaf.value)
    if isinstance(number, str):
        return number, _ATOM
    return repr(number), _LEVELS["negate"] if number < 0 else _ATOM


def _text_of_operation(node: Operation | Power, operands: list[Text]) -> Text:
    """Return the text of an operation from those of its operands."""
    if isinstance(node, Power):
        return f"{_within(operands[0], _ATOM)}**{node.exponent}", _POWER
    level = _LEVELS.get(node.operator, _ATOM)
    if node.operator == "negate":
        return f"-{_within(operands[0], level)}", level
    if node.operator == "not":
        return f"not {_within(operands[0], level)}", level
    if node.operator == "if":
        condition, then, otherwise = operands
        return f"{_within(then, level + 1)} if {_within(condition, level + 1)} else {otherwise[0]}", level
    if node.operator == PI:
        return PI, _ATOM
    if node.operator in FUNCTIONS:
        return f"{node.operator}({', '.join(text for text, _ in operands)})", level
    # Without brackets, an operation of the same level on the right would be evaluated first.
    left, right = (
        _within(operands[0], level + (node.operator in COMPARISONS)),
        _within(operands[1], level + 1),
    )
    return f"{left} {node.operator} {right}", level


def _within(operand: Text, level: int) -> str:
    """Return the text of a tree, in brackets if it binds more loosely than `level`."""
    text, own = operand
    return text if own >= level else f"({text})"


def _variable(name: str) -> str:
    """Return the text of a variable, with dots if all parts are plain identifiers, else with brackets.

    Identifiers beyond ASCII are no plain ones, because Python's parser changes some of their characters.
    """
    parts = name.split(".")
    plain = all(part.isidentifier() and part.isascii() and not iskeyword(part) for part in parts)
    if plain or len(parts) == 1:  # a single name that is no parameter, which systems refuse
        return name
    vector, rest = name.split(".", 1)
    return f"{vector}[{json.dumps(rest, ensure_ascii=False)}]"
