"""Prescribed freedoms where they cannot be: in what has no way to be told their motion."""

from __future__ import annotations

from typing import Protocol

from kanegen.errors import OptionError


class Prescribing(Protocol):
    """A system, or what is known of it."""

    @property
    def name(self) -> str:
        """Of the system."""

    @property
    def prescribed_names(self) -> tuple[str, ...]:
        """Of the freedoms whose motion is an input."""


def require_unprescribed(system: Prescribing, what: str) -> None:
    """Make sure that everything that moves is a coordinate.

    Args:
        system: It.
        what: That asks for it.

    Raises:
        OptionError: If a freedom is prescribed.
    """
    if system.prescribed_names:
        raise OptionError(
            f"{what}: system {system.name!r} has prescribed freedoms ({', '.join(system.prescribed_names)}), "
            "whose motion cannot be given here. Free them or lock them."
        )
