"""Tables of a TOML model file: their keys, and the strings in them that stand for run-time parameters."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model.expression import Expression
from kanegen.model.grammar import parse, parse_number
from kanegen.model.names import check_identifier
from kanegen.model.nodes import PI
from kanegen.model.numbers import Number, Parameter, number

Table = Mapping[str, Any]

ORIGIN = (0, 0, 0)
"""Default of a position (m)."""


def check_keys(table: Table, known: Sequence[str], required: Sequence[str] = (), label: str = "") -> None:
    """Make sure that a table has no key but `known` ones, and all that are `required`.

    Raises:
        ModelError: If a key is unknown or missing; the message begins with `label`.
    """
    for key in table:
        if key not in known:
            raise ModelError(f"{label}unknown key {quoted(key)}. {did_you_mean(key, known)}")
    for key in required:
        if key not in table:
            raise ModelError(f"{label}{key} is missing.")


def tables_named(table: Table, key: str) -> list[Table]:
    """Return the tables [[key]] of a model file, in its order; [] if there are none.

    Raises:
        ModelError: If `key` stands for anything but such tables.
    """
    entries = table.get(key, [])
    if not isinstance(entries, list) or not all(isinstance(entry, Mapping) for entry in entries):
        raise ModelError(f"{key}: begin each with a line [[{key}]], in double brackets.")
    return entries


class TextError(ModelError):
    """An error in a text of a model file.

    Attributes:
        text: The text as it stands in the file.
    """

    def __init__(self, message: str, text: str) -> None:
        super().__init__(message)
        self.text = text


@dataclass(frozen=True)
class Parameters:
    """The run-time parameters of a model file, and names for expressions of them.

    Attributes:
        known: The parameters, and the named expressions, by name.
        named_in: For each named expression, the names that stand in it.
        used: Names that a number of the model has used so far.
    """

    known: Mapping[str, Number]
    named_in: Mapping[str, Sequence[str]] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)

    @classmethod
    def read(cls, table: Any) -> Parameters:
        """Return the parameters of a table `name = default`.

        A string gives its name to an expression of other parameters, before or after it in the table.

        Raises:
            ModelError: If `table` is no table, a name is no C identifier, a default is no finite number, or
                expressions name each other in a circle.
        """
        if not isinstance(table, Mapping):
            raise ModelError("parameters: write a table, [parameters], with lines 'name = default'.")
        texts = {name: value for name, value in table.items() if isinstance(value, str)}
        known: dict[str, Number] = {
            name: Parameter(name, value) for name, value in table.items() if name not in texts
        }
        named_in = {name: [other for other in _names(text) if other in table] for name, text in texts.items()}
        for name in _in_order(texts, named_in):
            check_identifier(name, "parameter name")
            known[name] = cls(known).resolve(texts[name], f"parameter {quoted(name)}")
        return cls({name: known[name] for name in table}, named_in)

    def resolve(self, value: Any, label: str) -> Any:
        """Return `value` with a number of the model for every string in it, at any depth of nested lists.

        Args:
            value: A number, a string or nested lists of these.
            label: Name of the quantity, for the message.

        Raises:
            TextError: If a string is neither a parameter nor an expression of parameters and numbers.
        """
        if isinstance(value, list):
            return [self.resolve(item, label) for item in value]
        if not isinstance(value, str):
            return value
        if value.isidentifier() and value not in (*self.known, PI):
            hint = did_you_mean(value, self.known)
            raise TextError(
                f"{label}: a string stands for a parameter, but there is no {quoted(value)}. {hint}", value
            )
        self._use(_names(value))
        if value in self.known:
            return self.known[value]
        try:
            expression = parse_number(value, self.known)
        except ModelError as error:
            raise TextError(f"{label}: {error}", value) from None
        try:
            return number(expression, label, warns=False)  # the model checks it in its place
        except ModelError as error:
            raise TextError(str(error), value) from None

    def expression(self, value: Any) -> Expression:
        """Return the expression of the state of a system, from a text or a number of a model file.

        Raises:
            TextError: If the text is no expression.
        """
        if isinstance(value, str):
            self._use(_names(value))
        try:
            return parse(value, self.known)
        except ModelError as error:
            raise TextError(str(error), str(value)) from None

    def _use(self, names: Sequence[str]) -> None:
        """Mark names as used, and those in the expressions that they stand for."""
        waiting = [name for name in names if name in self.known]
        while waiting:
            name = waiting.pop()
            if name not in self.used:
                self.used.add(name)
                waiting += self.named_in.get(name, ())

    def unused(self) -> list[str]:
        """Return the names that no number of the model has used, in the order of the file."""
        return [name for name in self.known if name not in self.used]


def _names(text: str) -> list[str]:
    """Return what may be names in a text."""
    return re.findall(r"[A-Za-z_]\w*", text)


def _in_order(texts: Mapping[str, str], named_in: Mapping[str, Sequence[str]]) -> Sequence[str]:
    """Return the names of expressions so that each stands after those that it names.

    Raises:
        TextError: If expressions name each other in a circle.
    """
    needed = {name: [other for other in named_in[name] if other in texts] for name in texts}
    try:
        return [*TopologicalSorter(needed).static_order()]
    except CycleError as error:
        circle = error.args[1][::-1]
        raise TextError(
            f"parameters: {', which needs '.join(map(quoted, circle))}: a circle. Give one of them a number.",
            texts[circle[0]],
        ) from None
