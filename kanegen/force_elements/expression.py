"""Expressions that a model may hold: what they can say, and how they print.

An expression is a small tree of numbers, variables and operations. It is read by `grammar`, differentiated
and lowered through SymPy by the derivation, and evaluated in NumPy by the reference, each on its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from kanegen.numbers import Number, word

FUNCTIONS = ("abs", "cos", "sin", "sqrt", "tan")
"""What an expression may call. All of them are exactly defined on every machine; others, such as exp, are the
C library's and differ in their last bits from one to the next."""

TIME = "t"
"""The variable that is the time (s)."""


@dataclass(frozen=True)
class Constant:
    """A number of the model."""

    value: Number


@dataclass(frozen=True)
class Variable:
    """`t`, `x.<coordinate>` or `y.<speed>`; another name stands for nothing, which a system refuses."""

    name: str


@dataclass(frozen=True)
class Operation:
    """`operator` is one of `+ - * / ^`, "negate" or one of `FUNCTIONS`; the exponent of ^ is a number."""

    operator: str
    operands: tuple[Node, ...]


Node = Constant | Variable | Operation

_LEVELS = {"+": 1, "-": 1, "*": 2, "/": 2, "negate": 3, "^": 4}
_ATOM = 5


@dataclass(frozen=True)
class Expression:
    """A number that depends on the state, the time and parameters."""

    root: Node

    def __str__(self) -> str:
        """As `grammar.parse` reads it, parameters by their names."""
        return _text(self.root)

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of its variables, each once, in the order of first use."""
        return tuple(dict.fromkeys(node.name for node in _nodes(self.root) if isinstance(node, Variable)))

    def numbers(self) -> Iterator[Number]:
        """Its numbers but exponents, from the left."""
        return (node.value for node in _nodes(self.root) if isinstance(node, Constant))

    def changed(self, change: Callable[[Number], Number]) -> Expression:
        """The same with `change` applied to every number but exponents."""
        return Expression(_mapped(self.root, lambda node: _changed(node, change)))

    def renamed(self, rename: Callable[[str], str]) -> Expression:
        """The same with other names of variables."""
        return Expression(
            _mapped(
                self.root, lambda node: Variable(rename(node.name)) if isinstance(node, Variable) else node
            )
        )


def _changed(node: Node, change: Callable[[Number], Number]) -> Node:
    return Constant(change(node.value)) if isinstance(node, Constant) else node


def _mapped(node: Node, function: Callable[[Node], Node]) -> Node:
    """The tree with `function` applied to its leaves; exponents are no leaves but part of their operation."""
    if not isinstance(node, Operation):
        return function(node)
    if node.operator == "^":
        base, exponent = node.operands
        return Operation("^", (_mapped(base, function), exponent))
    return Operation(node.operator, tuple(_mapped(operand, function) for operand in node.operands))


def _nodes(node: Node) -> Iterator[Node]:
    yield node
    if isinstance(node, Operation):
        operands = node.operands[:1] if node.operator == "^" else node.operands
        for operand in operands:
            yield from _nodes(operand)


def _text(node: Node) -> str:
    if isinstance(node, Constant):
        held = word(node.value)
        return held if isinstance(held, str) else repr(held)
    if isinstance(node, Variable):
        return _variable(node.name)
    if node.operator in FUNCTIONS:
        return f"{node.operator}({_text(node.operands[0])})"
    level = _LEVELS[node.operator]
    if node.operator == "negate":
        return f"-{_within(node.operands[0], level)}"
    left, right = node.operands
    if node.operator == "^":
        assert isinstance(right, Constant)
        return f"{_within(left, _ATOM)}**{int(right.value)}"  # type: ignore[arg-type]
    # What stands on the right of a sign of the same level would be read in another order.
    return f"{_within(left, level)} {node.operator} {_within(right, level + 1)}"


def _within(node: Node, level: int) -> str:
    text = _text(node)
    return text if _level(node) >= level else f"({text})"


def _level(node: Node) -> int:
    if isinstance(node, Constant) and not isinstance(node.value, float):
        return _ATOM
    if isinstance(node, Constant):
        return _LEVELS["negate"] if node.value < 0 else _ATOM  # type: ignore[operator]
    return _LEVELS.get(node.operator, _ATOM) if isinstance(node, Operation) else _ATOM


def _variable(name: str) -> str:
    """With dots where Python's grammar has names between them, else with brackets."""
    if all(part.isidentifier() for part in name.split(".")):
        return name
    vector, rest = name.split(".", 1)
    return f'{vector}["{rest}"]'
