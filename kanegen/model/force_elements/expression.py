"""Expressions in a model: trees of numbers, variables, operations and powers, and their conversion to text.

`grammar` parses expressions. The derivation differentiates and lowers them through SymPy; the reference
evaluates them in NumPy, independently.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from kanegen.model.numbers import Number, toml_number

FUNCTIONS = ("abs", "cos", "sin", "sqrt", "tan")
"""Functions that an expression may call. Their results have the same bits on every machine; others, such as
exp, come from the C library, whose last bits differ between systems."""

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
    """An operation; `operator` is one of `+ - * /`, "negate" or one of `FUNCTIONS`."""

    operator: str
    operands: tuple[Node, ...]


Node = Constant | Variable | Power | Operation

_LEVELS = {"+": 1, "-": 1, "*": 2, "/": 2, "negate": 3}
_POWER = 4
_ATOM = 5


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

    def map_numbers(self, change: Callable[[Number], Number]) -> Expression:
        """Return the same expression with `change` applied to every number.

        Example:
            plain = expression.map_numbers(value_of)  # parameters at their defaults
        """

        def leaf(found: Leaf) -> Leaf:
            return Constant(change(found.value)) if isinstance(found, Constant) else found

        return Expression(_mapped(self.root, leaf))

    def with_variables_renamed(self, rename: Callable[[str], str]) -> Expression:
        """Return the same expression with `rename` applied to the names of its variables.

        Example:
            kg.parse("x.arm.theta3").with_variables_renamed(lambda name: "x.elbow.theta3")
        """

        def leaf(found: Leaf) -> Leaf:
            return Variable(rename(found.name)) if isinstance(found, Variable) else found

        return Expression(_mapped(self.root, leaf))


def _mapped(node: Node, function: Callable[[Leaf], Leaf]) -> Node:
    """Return the tree with `function` applied to its leaves."""
    match node:
        case Operation(operator, operands):
            return Operation(operator, tuple(_mapped(operand, function) for operand in operands))
        case Power(base, exponent):
            return Power(_mapped(base, function), exponent)
        case leaf:
            return function(leaf)


def _leaves(node: Node) -> Iterator[Leaf]:
    """Yield the numbers and variables of a tree, from the left."""
    match node:
        case Operation(_, operands):
            for operand in operands:
                yield from _leaves(operand)
        case Power(base):
            yield from _leaves(base)
        case leaf:
            yield leaf


def _text(node: Node) -> str:
    """Return the text of a tree."""
    match node:
        case Constant(value):
            number = toml_number(value)
            return number if isinstance(number, str) else repr(number)
        case Variable(name):
            return _variable(name)
        case Power(base, exponent):
            return f"{_within(base, _ATOM)}**{exponent}"
        case Operation("negate", (operand,)):
            return f"-{_within(operand, _LEVELS['negate'])}"
        case Operation(function, (operand,)):
            return f"{function}({_text(operand)})"
        case Operation(sign, (left, right)):
            # Without brackets, an operation of the same level on the right would be evaluated first.
            return f"{_within(left, _LEVELS[sign])} {sign} {_within(right, _LEVELS[sign] + 1)}"
    raise ValueError(node)


def _within(node: Node, level: int) -> str:
    """Return the text of a tree, in brackets if it binds more loosely than `level`."""
    text = _text(node)
    return text if _level(node) >= level else f"({text})"


def _level(node: Node) -> int:
    """Return how tightly the outermost operator of a tree binds, as in `_LEVELS`."""
    match node:
        case Constant(float(value)) if value < 0:
            return _LEVELS["negate"]
        case Power():
            return _POWER
        case Operation(operator):
            return _LEVELS.get(operator, _ATOM)
    return _ATOM


def _variable(name: str) -> str:
    """Return the text of a variable, with dots if all parts are identifiers, else with brackets."""
    if all(part.isidentifier() for part in name.split(".")):
        return name
    vector, rest = name.split(".", 1)
    return f'{vector}["{rest}"]'
