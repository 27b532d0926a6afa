"""What every kind of force element can do: its fields hold names, numbers, expressions or tuples."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Self

from kanegen.model.force_elements.expression import Constant, Expression
from kanegen.model.numbers import Number, map_numbers, word


@dataclass(frozen=True)
class ForceElement:
    """What acts on the bodies beside gravity, inertia and what a caller passes.

    Attributes:
        KEY: The array of tables of its kind in a model file.
        WRITTEN: Fields of its kind that hold expressions.
    """

    KEY: ClassVar[str]
    WRITTEN: ClassVar[tuple[str, ...]] = ()

    def changed(self, change: Callable[[Number], Number]) -> Self:
        """The same with `change` applied to every number."""

        def leaf(held: Any) -> Any:
            if isinstance(held, Expression):
                return held.changed(change)
            return held if isinstance(held, str) else change(held)

        return self._mapped(leaf)

    def renamed(self, rename: Callable[[str], str]) -> Self:
        """The same with other names of coordinates and speeds in expressions."""
        return self._mapped(lambda held: held.renamed(rename) if isinstance(held, Expression) else held)

    def numbers(self) -> Iterator[Number]:
        """Its numbers, those of expressions included."""
        for held in self._leaves():
            if isinstance(held, Expression):
                yield from held.numbers()
            elif not isinstance(held, str):
                yield held

    def expressions(self) -> Iterator[Expression]:
        """What it holds of them."""
        return (held for held in self._leaves() if isinstance(held, Expression))

    @property
    def words(self) -> str:
        """In a line, for readers of generated code."""
        return f"{self.KEY}: {', '.join(f'{key} = {_line(value)}' for key, value in self.as_table().items())}"

    def as_table(self) -> dict[str, Any]:
        """In the words of a model file, defaults left out."""
        held = {field.name: (getattr(self, field.name), field.default) for field in fields(self)}
        return {
            name: map_numbers(value, _word) for name, (value, default) in held.items() if value != default
        }

    def _mapped(self, function: Callable[[Any], Any]) -> Self:
        """The same with `function` applied to all that it holds."""
        return replace(self, **{f.name: map_numbers(getattr(self, f.name), function) for f in fields(self)})

    def _leaves(self) -> Iterator[Any]:
        """All that it holds, in order."""
        for field in fields(self):
            yield from _leaves(getattr(self, field.name))


def _leaves(value: Any) -> Iterator[Any]:
    if isinstance(value, tuple):
        for item in value:
            yield from _leaves(item)
    else:
        yield value


def _word(held: str | Number | Expression) -> str | float:
    """In a model file; an expression that is but a number is that number."""
    if isinstance(held, Expression):
        return word(held.root.value) if isinstance(held.root, Constant) else str(held)
    return held if isinstance(held, str) else word(held)


def _line(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_line, value))})"
    return value if isinstance(value, str) else repr(value)
