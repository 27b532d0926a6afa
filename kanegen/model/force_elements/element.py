"""`ForceElement`, the base class of force elements; fields hold names, numbers, expressions or tuples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Self

from kanegen.model.expression import Expression
from kanegen.model.nodes import Constant
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

        def in_expression(value: Expression) -> Expression:
            return value.map_numbers(change)

        def leaf(value: Any) -> Any:
            return value if isinstance(value, str) else change(value)

        return self._mapped(in_expression, leaf)

    def with_variables_renamed(self, rename: Callable[[str], str]) -> Self:
        """Return the same element with `rename` applied to the variables of its expressions.

        Example:
            element.with_variables_renamed(lambda name: name.replace("x.old.", "x.new."))
        """
        return self._mapped(lambda value: value.with_variables_renamed(rename))

    def with_constants(self, values: Mapping[str, Number]) -> Self:
        """Return the same element with numbers in place of some variables of its expressions.

        Example:
            element.with_constants({"x.arm.s1": 0.5})
        """
        return self._mapped(lambda value: value.with_constants(values))

    def numbers(self) -> Iterator[Number]:
        """Yield every number of the element, also inside expressions.

        Example:
            list(kg.JointSpring("arm.theta3", stiffness=40.0).numbers())  # [40.0, 0.0, 0.0]
        """
        for field in fields(self):
            for value in _leaves(getattr(self, field.name)):
                if field.name in self.EXPRESSION_FIELDS:
                    yield from value.numbers()
                elif not isinstance(value, str):
                    yield value

    def expressions(self) -> Iterator[Expression]:
        """Return the expressions of the state; numbers that are expressions of parameters are not among them.

        Example:
            [str(one) for one in kg.Drive("arm.theta3", "2*sin(t)").expressions()]
        """
        return (value for name in self.EXPRESSION_FIELDS for value in _leaves(getattr(self, name)))

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

    def _mapped(
        self,
        in_expression: Callable[[Any], Any],
        leaf: Callable[[Any], Any] = lambda value: value,
    ) -> Self:
        """Return the same element with functions applied to its expressions, and to its names and numbers."""
        return replace(
            self,
            **{
                field.name: map_numbers(
                    getattr(self, field.name),
                    in_expression if field.name in self.EXPRESSION_FIELDS else leaf,
                )
                for field in fields(self)
            },
        )


def _leaves(value: Any) -> Iterator[Any]:
    """Yield the items of nested tuples."""
    if isinstance(value, tuple):
        for item in value:
            yield from _leaves(item)
    else:
        yield value


def _toml_value(value: str | Number | Expression) -> str | float:
    """Return a value as a model file holds it; an expression that is one number becomes that number."""
    if isinstance(value, Expression) and isinstance(value.root, Constant):
        return toml_number(value.simplest)
    return value if isinstance(value, str) else toml_number(value)


def _line(value: Any) -> str:
    """Return a value of a table as text in one line."""
    if isinstance(value, tuple):
        return f"({', '.join(map(_line, value))})"
    return value if isinstance(value, str) else repr(value)
