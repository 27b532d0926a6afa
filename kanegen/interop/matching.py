"""The counterparts in a system of the joints of another program's model, found by name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.interop.blocks import Ball, Places
from kanegen.interop.orientations import Orientation
from kanegen.model.coordinates import ANGLES, FREEDOMS, TRANSLATIONS, Coordinate, Freedom, selected_freedoms
from kanegen.model.system import System

ALL_SIX = (True,) * len(FREEDOMS)
"""(6,) freedoms of a body that moves freely."""

TURNING = (True, True, True, False, False, False)
"""(6,) freedoms of a ball joint."""


class Matching:
    """The lookup of joints by name in one system.

    Args:
        system: The system.
        program: Name of the other program, for messages.
    """

    def __init__(self, system: System, program: str) -> None:
        self._system, self._program = system, program
        self._arrays = system.values()

    def scalar(self, name: str) -> tuple[Places, Places]:
        """Return the places in {x} and {y} of a freedom with a coordinate of its own.

        Raises:
            ModelError: If no free freedom has this name.
        """
        system = self._system
        if name not in system.coordinate_names or name not in system.freedom_names:
            raise ModelError(
                f"{self._program}'s joint {quoted(name)} is no free freedom of system {quoted(system.name)}. "
                f"{did_you_mean(name, system.freedom_names)}"
            )
        return (system.coordinate_names.index(name),), (system.freedom_names.index(name),)

    def body(self, names: Iterable[str], free: Sequence[bool]) -> int:
        """Return the number of the body that has one of some names, or whose joint has, with these freedoms.

        Args:
            names: Names of the other program's joint and body.
            free: (6,) the freedoms that the body must have, or more.

        Raises:
            ModelError: If there is no such body.
        """
        known = list(names)
        for k, body in enumerate(self._system.bodies, start=1):
            has = all(own for own, needed in zip(body.joint.free, free, strict=True) if needed)
            if has and {body.name, body.joint.name}.intersection(known):
                return k
        raise ModelError(
            f"{self._program}'s joint {quoted(known[0])} moves {', '.join(selected_freedoms(free))}. "
            f"No body of system {quoted(self._system.name)} or its joint has this name and these freedoms."
        )

    def floating(self) -> int:
        """Return the number of the first body with six freedoms.

        Raises:
            ModelError: If there is none.
        """
        for k, body in enumerate(self._system.bodies, start=1):
            if all(body.joint.free):
                return k
        raise ModelError(
            f"{self._program}'s model has a floating base, and system {quoted(self._system.name)} has none. "
            "Load it with floating_base=True."
        )

    def freedoms(self, body: int, indices: Sequence[int]) -> tuple[Places, Places]:
        """Return the places in {x} and {y} of freedoms of a body that have coordinates of their own."""
        system = self._system
        x = tuple(system.coordinate_places[Coordinate(body, index)] for index in indices)
        return x, tuple(system.places[Freedom(body, index)] for index in indices)

    def translations(self, body: int) -> tuple[Places, Places]:
        """Return the places in {x} and {y} of the three translations of a body."""
        return self.freedoms(body, TRANSLATIONS)

    def ball(self, body: int, q: Places, v: Places, *, scalar_last: bool) -> Ball:
        """Return the orientation of a body with three free angles, or a quaternion, as a ball joint.

        Args:
            body: Number of the body.
            q: Places of the quaternion in the other program's coordinates.
            v: Places of the angular velocity in its velocities.
            scalar_last: Whether its quaternions have the scalar last.
        """
        system = self._system
        kinds = system.bodies[body - 1].joint.rotation.coordinates
        x = tuple(system.coordinate_places[Coordinate(body, kind)] for kind in kinds)
        y = tuple(system.places[Freedom(body, index)] for index in ANGLES)
        return Ball(x, y, q, v, Orientation(self._arrays, body - 1), scalar_last)
