"""The text of a tree of an expression, as `grammar.parse` reads it."""

from __future__ import annotations

import json
from keyword import iskeyword

from kanegen.model.nodes import COMPARISONS, FUNCTIONS, PI, Leaf, Node, Operation, Power, Variable, folded

_LEVELS = {
    **{"if": 1, "or": 2, "and": 3, "not": 4},
    **dict.fromkeys(COMPARISONS, 5),
    **{"+": 6, "-": 6, "*": 7, "/": 7, "negate": 8},
}
"""How tightly operators bind; functions bind as tightly as `_ATOM`."""

_POWER = 9
_ATOM = 10

Text = tuple[str, int]
"""The text of a tree, and how tightly its outermost operator binds, as in `_LEVELS`."""


def text_of(root: Node) -> str:
    """Return the text of a tree."""
    return folded(root, _text_of_leaf, _text_of_operation)[0]


def _text_of_leaf(leaf: Leaf) -> Text:
    """Return the text of a number or a variable."""
    if isinstance(leaf, Variable):
        return _variable(leaf.name), _ATOM
    if not isinstance(leaf.value, int | float):
        return str(leaf.value.name), _ATOM
    return repr(leaf.value), _LEVELS["negate"] if leaf.value < 0 else _ATOM


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
