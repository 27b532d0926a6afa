"""`SystemFields`: what a system is made of."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from kanegen.model.body import Body
from kanegen.model.contact import Contact
from kanegen.model.coupling import Coupling
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.frame import Frame
from kanegen.model.names import identifier
from kanegen.model.numbers import Vector
from kanegen.model.rotor import Rotor

GRAVITY: Vector = (0.0, 0.0, -9.81)
"""Default gravity in inertial components (m/s^2)."""


@dataclass(frozen=True)
class SystemFields:
    """The fields of a `System`, its tree and its identifier. Bodies count from 1."""

    name: str
    bodies: tuple[Body, ...]
    gravity: Vector = GRAVITY
    force_elements: tuple[ForceElement, ...] = ()
    poses: tuple[str, ...] | None = None
    reactions: tuple[str, ...] | None = None
    couplings: tuple[Coupling, ...] = ()
    frames: tuple[Frame, ...] = ()
    rotors: tuple[Rotor, ...] = ()
    contacts: tuple[Contact, ...] = ()
    geometry: Path | None = field(default=None, compare=False, repr=False)

    @cached_property
    def identifier(self) -> str:
        """The C identifier with which files, functions and constants of generated code begin.

        It is the name of the system where this is an identifier, and else derived from it: see
        `names.identifier`.
        """
        return identifier(self.name)

    @property
    def number_of_bodies(self) -> int:
        """Number N of bodies, without the ground."""
        return len(self.bodies)

    @cached_property
    def connection(self) -> tuple[int, ...]:
        """The connection array: `connection[K-1]` is the number of the lower body of body K."""
        return tuple(body.lower for body in self.bodies)
