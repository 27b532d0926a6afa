"""`SystemCoordinates`: the elements of {x} and {y}, their order and their names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model.coordinates import FREEDOMS, Coordinate, Freedom, Speed
from kanegen.model.coupling import CoupledFreedom, ordered
from kanegen.model.joint import Joint
from kanegen.model.numbers import Number
from kanegen.model.system_frames import SystemFrames


@dataclass(frozen=True)
class SystemCoordinates(SystemFrames):
    """The elements of {x} and {y} of a `System`: freedoms, coordinates and speeds, their order and names.

    Places in {x} and {y} count from 0.
    """

    @cached_property
    def freedoms(self) -> tuple[Freedom, ...]:
        """The free freedoms in the order of {y}: angles of all bodies, then translations, Eq. (1)."""
        return self._ordered(lambda joint: joint.free)

    @cached_property
    def prescribed(self) -> tuple[Freedom, ...]:
        """The freedoms whose motion is an input, in the order of Eq. (1)."""
        return self._ordered(lambda joint: joint.prescribed)

    @cached_property
    def coupled(self) -> tuple[CoupledFreedom[Number], ...]:
        """The freedoms that follow others, each after those coupled freedoms that it follows."""
        return ordered(self.couplings, self.bodies)

    @cached_property
    def moving_places(self) -> dict[Freedom, int]:
        """The place of every freedom that moves: `freedoms`, then `prescribed`, then `coupled`."""
        coupled = (one.freedom for one in self.coupled)
        return {one: i for i, one in enumerate((*self.freedoms, *self.prescribed, *coupled))}

    @cached_property
    def in_couplings(self) -> frozenset[Freedom]:
        """The freedoms that are coupled, or that a coupled freedom follows."""
        return frozenset(
            freedom for one in self.coupled for freedom in (one.freedom, *(other for other, _ in one.terms))
        )

    def _ordered(self, which: Callable[[Joint], tuple[bool, ...]]) -> tuple[Freedom, ...]:
        """Return the freedoms that `which` selects at each joint, in the order of Eq. (1)."""
        selected = [
            Freedom(k, index)
            for k, body in enumerate(self.bodies, start=1)
            for index, is_selected in enumerate(which(body.joint))
            if is_selected
        ]
        return (*(f for f in selected if f.is_angle), *(f for f in selected if not f.is_angle))

    @cached_property
    def places(self) -> dict[Freedom, int]:
        """The place of every free freedom in {y}."""
        return {freedom: i for i, freedom in enumerate(self.freedoms)}

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """{x}: the coordinates of orientations of all bodies, then the translations, Eq. (1)."""
        found = [
            Coordinate(k, kind)
            for k, body in enumerate(self.bodies, start=1)
            for kind in body.joint.free_coordinate_kinds
        ]
        return (*(c for c in found if not c.is_translation), *(c for c in found if c.is_translation))

    @cached_property
    def coordinate_places(self) -> dict[Coordinate, int]:
        """The place of every coordinate in {x}."""
        return {coordinate: i for i, coordinate in enumerate(self.coordinates)}

    @cached_property
    def neutral_coordinates(self) -> tuple[float, ...]:
        """(m,) coordinates of the position in which no joint is turned or displaced (rad, m, 1).

        Example:
            x = np.array(system.neutral_coordinates)
        """
        found = []
        for coordinate in self.coordinates:
            rotation = self.bodies[coordinate.body - 1].joint.rotation
            values = dict(zip(rotation.coordinates, rotation.neutral, strict=True))
            found.append(values.get(coordinate.index, 0.0))
        return tuple(found)

    def coordinate_place(self, body: int, kind: int) -> int:
        """Return the place of a coordinate in {x}.

        Args:
            body: Number of the body, from 1.
            kind: Index of the coordinate in `COORDINATE_KINDS`.

        Raises:
            KeyError: If the coordinate is not in {x}.

        Example:
            x[system.coordinate_place(1, 2)]  # theta3 of body 1
        """
        return self.coordinate_places[Coordinate(body, kind)]

    def speed_of(self, freedom: Freedom) -> Speed:
        """Return the generalized speed at the place of `freedom` in {y}.

        Example:
            system.speed_of(system.freedoms[0]).kind.is_rate
        """
        return Speed(freedom.body, self.bodies[freedom.body - 1].joint.speed_kinds[freedom.index])

    @cached_property
    def speeds(self) -> tuple[Speed, ...]:
        """{y}: the generalized speeds, at the places of `freedoms`."""
        return tuple(map(self.speed_of, self.freedoms))

    @property
    def speeds_are_rates(self) -> bool:
        """Whether {xdot} = {y}, Eq. (45)."""
        return all(speed.kind.is_rate for speed in self.speeds)

    @cached_property
    def freedom_names(self) -> tuple[str, ...]:
        """(n,) unique names of the free freedoms: of a robot file, or `<body>.theta1` to `<body>.s3`.

        A freedom without a coordinate of its own in {x}, as with a quaternion, has the name of its speed.
        """
        names = zip(self.freedoms, self.speed_names, strict=True)
        return tuple(
            self._freedom_name(freedom)
            if freedom.index in self.bodies[freedom.body - 1].joint.coordinate_kinds
            else speed_name
            for freedom, speed_name in names
        )

    @cached_property
    def coordinate_names(self) -> tuple[str, ...]:
        """(m,) unique names in the order of {x}: of the freedoms, or `<body>.e0` to `<body>.e3`."""
        return tuple(
            self._freedom_name(Freedom(coordinate.body, coordinate.index))
            if coordinate.index < len(FREEDOMS)
            else f"{self.bodies[coordinate.body - 1].name}.{coordinate.name}"
            for coordinate in self.coordinates
        )

    @cached_property
    def speed_names(self) -> tuple[str, ...]:
        """(n,) unique names in the order of {y}.

        A rate has the name of its coordinate; the components of a relative angular velocity, Eq. (8), are
        `<body>.omega1`, `<body>.omega2`, `<body>.omega3`.
        """
        return tuple(
            self._freedom_name(freedom)
            if speed.kind.is_rate
            else f"{self.bodies[speed.body - 1].name}.{speed.kind.name}"
            for freedom, speed in zip(self.freedoms, self.speeds, strict=True)
        )

    @cached_property
    def prescribed_names(self) -> tuple[str, ...]:
        """(p,) names of the prescribed freedoms: the order of the columns of the input `prescribed`."""
        return tuple(self._freedom_name(freedom) for freedom in self.prescribed)

    @cached_property
    def coupled_names(self) -> tuple[str, ...]:
        """Names of the coupled freedoms, in the order of `coupled`."""
        return tuple(self._freedom_name(one.freedom) for one in self.coupled)

    def _freedom_name(self, freedom: Freedom) -> str:
        """Return the name of a freedom: that of a robot file, or `<body>.<freedom>`."""
        body = self.bodies[freedom.body - 1]
        return body.joint.freedom_name(freedom.index) or f"{body.name}.{FREEDOMS[freedom.index]}"

    def freedom(self, name: object, label: str = "freedom") -> Freedom:
        """Return one of the six freedoms of a body, free or not, by its name.

        Args:
            name: One of `freedom_names`, or `<body>.theta1` to `<body>.s3`.
            label: What the name is for, with which the message begins.

        Raises:
            ModelError: If there is no such freedom.

        Example:
            system.freedom("elbow").body
        """
        every = self._freedoms_by_name
        if not isinstance(name, str) or name not in every:
            hint = self.whereabouts(name) or did_you_mean(name, self.freedom_names)
            raise ModelError(f"{label}: there is no freedom {quoted(name)}. {hint}")
        return every[name]

    @cached_property
    def _freedoms_by_name(self) -> dict[str, Freedom]:
        """The six freedoms of every body, by every name that they have."""
        six = self._ordered(lambda joint: (True,) * 6)
        found = dict(zip(self.freedom_names, self.freedoms, strict=True))
        found |= {self._freedom_name(freedom): freedom for freedom in six}
        for freedom in six:
            found.setdefault(f"{self.bodies[freedom.body - 1].name}.{FREEDOMS[freedom.index]}", freedom)
        return found
