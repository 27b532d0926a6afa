"""The run-time parameters of a model file, and the strings that stand for them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError
from kanegen.model.force_elements.expression import Expression
from kanegen.model.numbers import Parameter


@dataclass(frozen=True)
class Parameters:
    """The parameters by name, and which of them a number of the model has named so far."""

    known: Mapping[str, Parameter]
    used: set[str] = field(default_factory=set)

    @classmethod
    def read(cls, table: Any) -> Parameters:
        """The parameters of a table `name = default`.

        Raises:
            ModelError: If it is no table, a name is no C identifier, or a default is no finite number.
        """
        if not isinstance(table, Mapping):
            raise ModelError("parameters: write a table, [parameters], with lines 'name = default'.")
        return cls({name: Parameter(name, default) for name, default in table.items()})

    def resolve(self, value: Any, what: str) -> Any:
        """`value` with a `Parameter` for every string in it, at any depth of nested lists.

        Raises:
            ModelError: If a string names no parameter.
        """
        if isinstance(value, list):
            return [self.resolve(item, what) for item in value]
        if not isinstance(value, str):
            return value
        if value not in self.known:
            hint = did_you_mean(value, self.known)
            raise ModelError(f"{what}: a string stands for a parameter, but there is no {value!r}. {hint}")
        self.used.add(value)
        return self.known[value]

    def noted(self, expression: Expression) -> Expression:
        """An expression, after taking note of the parameters in it."""
        self.used.update(value.name for value in expression.numbers() if isinstance(value, Parameter))
        return expression

    def unused(self) -> list[str]:
        """Names that no number of the model has used, in the file's order."""
        return [name for name in self.known if name not in self.used]
