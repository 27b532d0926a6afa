"""`SystemDescription`: the fields of a system, and the orders and names of its coordinates and speeds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, OptionError, quoted
from kanegen.model.body import Body, Point
from kanegen.model.coordinates import FREEDOMS, Coordinate, Freedom, Speed
from kanegen.model.coupling import CoupledFreedom, Coupling, ordered
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.expression import TIME
from kanegen.model.frame import Frame, frames_by_name, placed, resolved, whereabouts
from kanegen.model.joint import Joint
from kanegen.model.limits import SystemLimits
from kanegen.model.names import identifier
from kanegen.model.numbers import Number, Parameter, Vector, map_numbers, toml_number
from kanegen.model.reaction import Reaction, every_reaction, reaction_rows
from kanegen.model.rotations import apply
from kanegen.model.rotor import MountedRotor, Rotor, mounted_rotors

GRAVITY: Vector = (0.0, 0.0, -9.81)
"""Default gravity in inertial components (m/s^2)."""


@dataclass(frozen=True)
class SystemDescription:
    """The fields of a `System`, and the elements of {x} and {y}, parameters and names that follow from them.

    Bodies count from 1, places in {x} and {y} from 0.
    """

    name: str
    bodies: tuple[Body, ...]
    gravity: Vector = GRAVITY
    force_elements: tuple[ForceElement, ...] = ()
    poses: tuple[str, ...] | None = None
    reactions: tuple[str, ...] | None = None
    couplings: tuple[Coupling, ...] = ()
    frames: tuple[Frame, ...] = ()
    rotors: tuple[Rotor, ...] = ()

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
    def points(self) -> tuple[tuple[int, Point], ...]:
        """The points of all bodies, body by body, each with the number of its body."""
        return tuple((k, point) for k, body in enumerate(self.bodies, start=1) for point in body.points)

    @cached_property
    def frames_by_name(self) -> dict[str, Frame]:
        """Every frame by its name: that of each body for its user, then the further ones of `frames`."""
        return frames_by_name(self.bodies, self.frames)

    @property
    def frame_names(self) -> tuple[str, ...]:
        """Names of all frames: the bodies, then the further frames, those of the ground first."""
        return tuple(self.frames_by_name)

    def frame(self, name: str | int, label: str = "frame") -> Frame:
        """Return the frame that a name means: a frame of the system, a body for its user, or "ground".

        Args:
            name: Name of a frame or body, or number of a body from 1.
            label: Name of the object that refers to the frame, for the message.

        Raises:
            ModelError: If there is no such frame.

        Example:
            system.frame("tool").body
        """
        return resolved(self.frames_by_name, self.bodies, name, label)

    def frame_path(self, name: str) -> tuple[Frame, ...]:
        """Return the frames by which a frame is given: each in the one before it, the first in its body.

        A name without a frame of its own, such as that of a body or "", is the body's frame of the model and
        has no such frames.

        Example:
            [frame.name for frame in system.frame_path("tool")]
        """
        found: list[Frame] = []
        while name in self._further_frames:
            found.append(self._further_frames[name])
            name = found[-1].frame
        return tuple(reversed(found))

    def whereabouts(self, name: object) -> str:
        """Return a sentence that says to what a frame is fixed and where; "" if the name is none of one.

        Args:
            name: Name of a frame, or of what would be a freedom of it, such as `<frame>.theta1`. A body is
                fixed to nothing.

        Example:
            system.whereabouts("panda_hand")  # 'panda_hand' is fixed to body 'panda_link7', at ...
        """
        for candidate in (name, name.rpartition(".")[0]) if isinstance(name, str) else ():
            frame = self._further_frames.get(candidate)
            body = self.bodies[frame.body - 1].name if frame and frame.body else ""
            if frame and frame.name != body:
                (x, y, z), _ = placed(self.frame_path(candidate))
                origin, rotation = placed(self.frame_path(body))
                arm = (x - origin[0], y - origin[1], z - origin[2])
                return whereabouts(frame, body, apply(rotation, arm))
        return ""

    def place(self, name: str) -> tuple[int, Point]:
        """Return where a spring ends or a load acts: at a point, or at the origin of a frame.

        Returns:
            Number of the body, 0 for the ground, and the point.

        Raises:
            KeyError: If there is neither a point nor a frame of this name.

        Example:
            body, point = system.place("tool")
        """
        if name in self._points_by_name:
            return self._points_by_name[name]
        return self.frames_by_name[name].body, Point(name, (0.0, 0.0, 0.0), frame=name)

    @cached_property
    def _points_by_name(self) -> dict[str, tuple[int, Point]]:
        """Every point by its name, with the number of its body."""
        return {point.name: (k, point) for k, point in self.points}

    @cached_property
    def _further_frames(self) -> dict[str, Frame]:
        """The frames beside the bodies' own of the model, by name."""
        return {frame.name: frame for frame in self.frames}

    @cached_property
    def mounted_rotors(self) -> tuple[MountedRotor, ...]:
        """The rotors, each with the freedom that it drives and with its carrier.

        Raises:
            ModelError: If there is no freedom, body or frame of a name.
        """

        def carrier(name: str, label: str) -> tuple[int, str]:
            frame = self.frame(name, label)
            return frame.body, frame.name if frame.name in self.frames_by_name else ""

        return mounted_rotors(self.rotors, self.bodies, self.freedom, carrier)

    @property
    def motor_summaries(self) -> tuple[str, ...]:
        """One line for the armature of each freedom that moves, and for each rotor."""
        moving = zip(
            self.moving_places,
            (*self.freedom_names, *self.prescribed_names, *self.coupled_names),
            strict=True,
        )
        armature = [
            (name, self.bodies[freedom.body - 1].joint.armature[freedom.index], freedom)
            for freedom, name in moving
        ]
        lines = [
            f"armature of {name}: {toml_number(value)} {'kg m^2' if freedom.is_angle else 'kg'}"
            for name, value, freedom in armature
            if value
        ]
        return (*lines, *(f"rotor {rotor.summary}" for rotor in self.rotors))

    @cached_property
    def depends_on_time(self) -> bool:
        """Whether an expression of a force element contains the time t."""
        return any(
            TIME in expression.variables
            for element in self.force_elements
            for expression in element.expressions()
        )

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The run-time parameters, each once, in the order of first use.

        Raises:
            ModelError: If two parameters have one name and different values.
        """
        found: dict[str, Parameter] = {}

        def collect(value: Number) -> None:
            if isinstance(value, Parameter) and found.setdefault(value.name, value) != value:
                raise ModelError(
                    f"parameter {quoted(value.name)} has two values, {quoted(found[value.name].value)} and "
                    f"{quoted(value.value)}. One name, one value."
                )

        map_numbers(self.gravity, collect)
        for body in self.bodies:
            joint = body.joint
            map_numbers((body.mass, body.inertia, body.mass_center), collect)
            map_numbers(tuple(point.position for point in body.points), collect)
            map_numbers((joint.position, joint.orientation, joint.locked, joint.armature), collect)
        for coupling in self.couplings:
            map_numbers(tuple(coupling.numbers()), collect)
        for frame in self.frames:
            map_numbers((frame.position, frame.orientation), collect)
        for rotor in self.rotors:
            map_numbers((rotor.inertia, rotor.ratio), collect)
        for element in self.force_elements:
            for value in element.numbers():
                collect(value)
        return tuple(found.values())

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
    def coupling_equations(self) -> tuple[str, ...]:
        """One line for each coupling, with the names of freedoms that `freedom_names` has."""
        names = {
            f"{self.bodies[one.body - 1].name}.{FREEDOMS[one.index]}": self._freedom_name(one)
            for one in self.in_couplings
        }
        return tuple(coupling.equation(names) for coupling in self.couplings)

    @cached_property
    def coupled_names(self) -> tuple[str, ...]:
        """Names of the coupled freedoms, in the order of `coupled`."""
        return tuple(self._freedom_name(one.freedom) for one in self.coupled)

    def _freedom_name(self, freedom: Freedom) -> str:
        """Return the name of a freedom: that of a robot file, or `<body>.<freedom>`."""
        body = self.bodies[freedom.body - 1]
        return body.joint.freedom_name(freedom.index) or f"{body.name}.{FREEDOMS[freedom.index]}"

    @cached_property
    def limits(self) -> SystemLimits:
        """The limits of position, speed and effort in the order of {x} and {y}; infinite where there is none.

        Example:
            system.limits.upper  # (m,)
        """
        of_coordinates = [
            (limits.lower[c.index], limits.upper[c.index])
            if c.index < len(FREEDOMS)
            else (-math.inf, math.inf)
            for c in self.coordinates
            for limits in (self.bodies[c.body - 1].joint.limits,)
        ]
        of_speeds = [
            (limits.speed[f.index], limits.effort[f.index])
            for f in self.freedoms
            for limits in (self.bodies[f.body - 1].joint.limits,)
        ]
        return SystemLimits(*np.array(of_coordinates).T, *np.array(of_speeds).T)

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
        found = {self._freedom_name(freedom): freedom for freedom in six}
        for freedom in six:
            found.setdefault(f"{self.bodies[freedom.body - 1].name}.{FREEDOMS[freedom.index]}", freedom)
        return found

    @cached_property
    def point_names(self) -> tuple[str, ...]:
        """(P,) names of the points, in the order of the rows of outputs about points."""
        return tuple(point.name for _, point in self.points)

    @cached_property
    def pose_names(self) -> tuple[str, ...]:
        """Names of the frames in the output `body_poses`, in the order of its rows."""
        return tuple(body.name for body in self.bodies) if self.poses is None else self.poses

    @cached_property
    def pose_frames(self) -> tuple[Frame, ...]:
        """The frames in the output `body_poses`, in the order of its rows."""
        return tuple(map(self.frame, self.pose_names))

    @cached_property
    def reaction_rows(self) -> tuple[Reaction, ...]:
        """The rows of the output `reaction_loads`; by default those of all joints, as in Eq. (1)."""
        if self.reactions is None:
            return tuple(every_reaction(self.bodies, self._further_frames).values())
        return reaction_rows(self.bodies, self.frames_by_name, self.reactions)

    @cached_property
    def reaction_names(self) -> tuple[str, ...]:
        """Names of the rows of the output `reaction_loads`."""
        return tuple(row.name for row in self.reaction_rows)


class HasPrescribedNames(Protocol):
    """An object with the names of prescribed freedoms: a system, or the description of one in a source."""

    @property
    def name(self) -> str:
        """Name of the system, used in messages."""

    @property
    def prescribed_names(self) -> Iterable[str]:
        """Names of the freedoms whose motion is an input."""


def require_unprescribed(system: HasPrescribedNames, label: str) -> None:
    """Make sure that no freedom is prescribed, for functions that cannot take a prescribed motion.

    Args:
        system: The system.
        label: Name of the function or study that cannot take one, for the message.

    Raises:
        OptionError: If a freedom is prescribed.
    """
    if names := tuple(system.prescribed_names):
        raise OptionError(
            f"{label}: system {quoted(system.name)} has prescribed freedoms ({', '.join(names)}), "
            "whose motion cannot be passed here. Free them or lock them."
        )


def require_system(system: object) -> None:
    """Make sure that an object is a `System`.

    Raises:
        OptionError: If `system` is no `System`.
    """
    if not isinstance(system, SystemDescription):
        raise OptionError(f"{quoted(system)} is no System. Make one with kg.load or kg.System.from_arrays.")
