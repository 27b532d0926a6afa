"""The counterparts in a system of the joints of another program's model, found by name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.interop.blocks import Ball, Follower, Places, Scalars
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

    def joint(self, name: str, q: Places, v: Places) -> Scalars | Follower:
        """Return a joint with the coordinate of a freedom, free or coupled.

        Args:
            name: Name of the freedom.
            q: Place in the other program's coordinates.
            v: Place in its velocities.

        Raises:
            ModelError: If no freedom that is free or coupled has this name, or what it follows is prescribed.
        """
        names = self._system.coupled_names
        if name not in names:
            return Scalars(*self.scalar(name), q, v)
        factors, offset = self._terms(self._system.coupled[names.index(name)].freedom, name)
        freedoms = tuple(factors)
        x = tuple(self._system.coordinate_places[Coordinate(one.body, one.index)] for one in freedoms)
        y = tuple(self._system.places[one] for one in freedoms)
        return Follower(x, y, q, v, tuple(factors.values()), offset)

    def _terms(self, freedom: Freedom, name: str) -> tuple[dict[Freedom, float], float]:
        """Return the factors of the free freedoms that a freedom follows, and its offset.

        Raises:
            ModelError: If it follows a prescribed freedom.
        """
        if freedom in self._system.places:
            return {freedom: 1.0}, 0.0
        coupled = {one.freedom: one for one in self._arrays.coupled}
        if freedom not in coupled:
            raise ModelError(f"{self._program}'s joint {quoted(name)} follows a prescribed freedom. Free it.")
        factors: dict[Freedom, float] = {}
        offset = coupled[freedom].offset
        for other, factor in coupled[freedom].terms:
            own, shift = self._terms(other, name)
            offset += factor * shift
            for one, part in own.items():
                factors[one] = factors.get(one, 0.0) + factor * part
        return factors, offset

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
