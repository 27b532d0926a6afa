"""`ForceElement`, the base class of force elements; fields hold names, numbers, expressions or tuples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Self

from kanegen.model.force_elements.expression import Constant, Expression
from kanegen.model.numbers import Number, map_numbers, toml_number


@dataclass(frozen=True)
class ForceElement:
    """A load on the bodies beside gravity, inertia and the loads that a caller passes.

    Attributes:
        KEY: Name of the array of tables of this kind in a model file.
        EXPRESSION_FIELDS: Names of the fields that hold expressions.
    """

    KEY: ClassVar[str]
    EXPRESSION_FIELDS: ClassVar[tuple[str, ...]] = ()

    def map_numbers(self, change: Callable[[Number], Number]) -> Self:
        """Return the same element with `change` applied to every number, also inside expressions.

        Example:
            plain = element.map_numbers(value_of)  # parameters at their defaults
        """

        def leaf(value: Any) -> Any:
            if isinstance(value, Expression):
                return value.map_numbers(change)
            return value if isinstance(value, str) else change(value)

        return self._mapped(leaf)

    def with_variables_renamed(self, rename: Callable[[str], str]) -> Self:
        """Return the same element with `rename` applied to the variables of its expressions.

        Example:
            element.with_variables_renamed(lambda name: name.replace("x.old.", "x.new."))
        """
        return self._mapped(
            lambda value: value.with_variables_renamed(rename) if isinstance(value, Expression) else value
        )

    def with_constants(self, values: Mapping[str, Number]) -> Self:
        """Return the same element with numbers in place of some variables of its expressions.

        Example:
            element.with_constants({"x.arm.s1": 0.5})
        """
        return self._mapped(
            lambda value: value.with_constants(values) if isinstance(value, Expression) else value
        )

    def numbers(self) -> Iterator[Number]:
        """Yield every number of the element, also inside expressions.

        Example:
            list(kg.JointSpring("arm.theta3", stiffness=40.0).numbers())  # [40.0, 0.0, 0.0]
        """
        for value in self._leaves():
            if isinstance(value, Expression):
                yield from value.numbers()
            elif not isinstance(value, str):
                yield value

    def expressions(self) -> Iterator[Expression]:
        """Return the expressions of the element.

        Example:
            [str(one) for one in kg.Drive("arm.theta3", "2*sin(t)").expressions()]
        """
        return (value for value in self._leaves() if isinstance(value, Expression))

    @property
    def may_be_undefined(self) -> bool:
        """Whether the element is undefined or infinite in some state.

        Example:
            kg.Drive("arm.theta3", "1/x.arm.theta3").may_be_undefined  # True
        """
        return any(one.may_be_undefined for one in self.expressions())

    @property
    def summary(self) -> str:
        """The element in one line, as comments in generated code and `kanegen info` show it."""
        return f"{self.KEY}: {', '.join(f'{key} = {_line(value)}' for key, value in self.as_table().items())}"

    def as_table(self) -> dict[str, Any]:
        """Return the table of the element in a model file, defaults left out.

        Example:
            kg.JointSpring("arm.theta3", stiffness=40.0).as_table()
        """
        values = {field.name: (getattr(self, field.name), field.default) for field in fields(self)}
        return {
            name: map_numbers(value, _toml_value)
            for name, (value, default) in values.items()
            if value != default
        }

    def _mapped(self, function: Callable[[Any], Any]) -> Self:
        """Return the same element with `function` applied to every name, number and expression."""
        return replace(self, **{f.name: map_numbers(getattr(self, f.name), function) for f in fields(self)})

    def _leaves(self) -> Iterator[Any]:
        """Yield every name, number and expression in the order of the fields."""
        for field in fields(self):
            yield from _leaves(getattr(self, field.name))


def _leaves(value: Any) -> Iterator[Any]:
    """Yield the items of nested tuples."""
    if isinstance(value, tuple):
        for item in value:
            yield from _leaves(item)
    else:
        yield value


def _toml_value(value: str | Number | Expression) -> str | float:
    """Return a value as a model file holds it; an expression that is one number becomes that number."""
    if isinstance(value, Expression):
        return toml_number(value.root.value) if isinstance(value.root, Constant) else str(value)
    return value if isinstance(value, str) else toml_number(value)


def _line(value: Any) -> str:
    """Return a value of a table as text in one line."""
    if isinstance(value, tuple):
        return f"({', '.join(map(_line, value))})"
    return value if isinstance(value, str) else repr(value)
