"""A cached property of a body that is computed from the ground outwards."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Protocol, TypeVar, overload

T = TypeVar("T")


class Linked(Protocol):
    """An object with a predecessor of the same kind, as a body has its lower body."""

    @property
    def lower(self) -> Linked | None:
        """The predecessor, one step towards the ground; None next to the ground."""


class outward_property(cached_property[T]):
    """A cached property of a body whose definition may read the same property of its lower body.

    The values of the lower bodies are computed first, ground outwards. A recursive definition such as Eq. (3)
    therefore never nests deeper than one body, and no chain is too long for Python's stack.
    """

    @overload
    def __get__(self, instance: None, owner: type[Any] | None = None) -> outward_property[T]: ...
    @overload
    def __get__(self, instance: object, owner: type[Any] | None = None) -> T: ...
    def __get__(self, instance: Any, owner: type[Any] | None = None) -> outward_property[T] | T:
        """Compute the value of `instance`; Python calls this only while the value is not cached."""
        if instance is None:
            return self
        for body in _uncached_from_ground(instance.lower, self.func.__name__):
            super().__get__(body, owner)
        value: T = super().__get__(instance, owner)
        return value


def _uncached_from_ground(body: Linked | None, name: str) -> list[Linked]:
    """Return `body` and its predecessors, ground first, up to one that has the property `name` cached."""
    missing: list[Linked] = []
    while body is not None and name not in vars(body):
        missing.append(body)
        body = body.lower
    return missing[::-1]
