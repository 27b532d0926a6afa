"""Tables of a TOML model file: their keys, and the strings in them that stand for run-time parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model.force_elements.expression import Expression
from kanegen.model.numbers import Parameter

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


@dataclass(frozen=True)
class Parameters:
    """The run-time parameters of a model file.

    Attributes:
        known: The parameters by name.
        used: Names that a number of the model has used so far.
    """

    known: Mapping[str, Parameter]
    used: set[str] = field(default_factory=set)

    @classmethod
    def read(cls, table: Any) -> Parameters:
        """Return the parameters of a table `name = default`.

        Raises:
            ModelError: If `table` is no table, a name is no C identifier, or a default is no finite number.
        """
        if not isinstance(table, Mapping):
            raise ModelError("parameters: write a table, [parameters], with lines 'name = default'.")
        return cls({name: Parameter(name, default) for name, default in table.items()})

    def resolve(self, value: Any, label: str) -> Any:
        """Return `value` with a `Parameter` for every string in it, at any depth of nested lists.

        Args:
            value: A number, a string or nested lists of these.
            label: Name of the quantity, for the message.

        Raises:
            ModelError: If a string names no parameter.
        """
        if isinstance(value, list):
            return [self.resolve(item, label) for item in value]
        if not isinstance(value, str):
            return value
        if value not in self.known:
            hint = did_you_mean(value, self.known)
            raise ModelError(
                f"{label}: a string stands for a parameter, but there is no {quoted(value)}. {hint}"
            )
        self.used.add(value)
        return self.known[value]

    def mark_used(self, expression: Expression) -> Expression:
        """Return `expression`, with the parameters in it marked as used."""
        self.used.update(value.name for value in expression.numbers() if isinstance(value, Parameter))
        return expression

    def unused(self) -> list[str]:
        """Return the names that no number of the model has used, in the order of the file."""
        return [name for name in self.known if name not in self.used]
