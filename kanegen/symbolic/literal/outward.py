"""A cached property that is computed from the ground outwards."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Protocol, TypeVar, overload

T = TypeVar("T")


class Linked(Protocol):
    """Something that stands on a lower one of its kind, or on nothing."""

    @property
    def lower(self) -> Linked | None:
        """The next one towards the ground."""


class outward(cached_property[T]):
    """A cached property of a body that may read the same property of its lower body.

    The lower bodies' values are computed first, ground outwards, so that a recursive definition such as
    Eq. (3) never nests deeper than one body and no chain is too long for Python's stack.
    """

    @overload
    def __get__(self, instance: None, owner: type[Any] | None = None) -> outward[T]: ...
    @overload
    def __get__(self, instance: object, owner: type[Any] | None = None) -> T: ...
    def __get__(self, instance: Any, owner: type[Any] | None = None) -> outward[T] | T:
        """The value of `instance`; reached only while it is not cached."""
        if instance is None:
            return self
        for body in _from_ground(instance.lower, self.func.__name__):
            super().__get__(body, owner)
        value: T = super().__get__(instance, owner)
        return value


def _from_ground(body: Linked | None, name: str) -> list[Linked]:
    missing: list[Linked] = []
    while body is not None and name not in vars(body):
        missing.append(body)
        body = body.lower
    return missing[::-1]
