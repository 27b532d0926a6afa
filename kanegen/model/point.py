"""A point that moves with a body."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from kanegen.model import validation
from kanegen.model.names import check_label
from kanegen.model.numbers import Number, Vector, map_numbers, numbers, word


@dataclass(frozen=True)
class Point:
    """A point that moves with a body, such as the tip of a tool.

    Attributes:
        name: Label, unique in the system.
        position: From O_K, in body components (m).
        loads: Whether it takes a force and a moment as inputs, inertial components.
    """

    name: str
    position: Vector
    loads: bool = False

    def __post_init__(self) -> None:
        check_label(self.name, "point name")
        what = f"point {self.name!r}"
        position = numbers(self.position, (3,), what)
        validation.store(self, position=position, loads=validation.flags((self.loads,), 1, what)[0])

    def changed(self, change: Callable[[Number], Number]) -> Point:
        """The same point with `change` applied to every number."""
        return replace(self, position=map_numbers(self.position, change))

    def as_word(self) -> Any:
        """The point in the words of a model file: its position, or a table where there is more to say."""
        position = map_numbers(self.position, word)
        return {"position": position, "loads": True} if self.loads else position
