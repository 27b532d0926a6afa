"""A tree of rigid bodies: the source language of kanegen.

Body K (numbered from 1) hangs on its lower body J = L(K) < K, 0 being the ground. Its free coordinates make
up {x}; the locked ones leave {x}, {y}, [A] and {f}.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, TypeVar

from kanegen import arrays, validation
from kanegen.body import FREEDOMS, IDENTITY, ORIENTATIONS, QUATERNION, SPEEDS, Body, Joint, Point
from kanegen.choices import require_one
from kanegen.errors import ModelError, WriteError
from kanegen.files import write_whole
from kanegen.names import check_identifier
from kanegen.numbers import Number, Parameter, Vector, map_numbers, numbers, value_of, word
from kanegen.right_angles import checked
from kanegen.sequences import NOTES
from kanegen.suggest import did_you_mean
from kanegen.toml_text import toml_text

GRAVITY: Vector = (0.0, 0.0, -9.81)
"""Default gravity, inertial components, m/s^2."""

_S = TypeVar("_S", bound="System")


@dataclass(frozen=True)
class Freedom:
    """One free coordinate: `index` counts `FREEDOMS`, `body` counts bodies from 1."""

    body: int
    index: int

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle (rad) rather than a translation (m)."""
        return self.index < 3

    @property
    def axis(self) -> int:
        """0, 1 or 2: which of the three angles or translations."""
        return self.index % 3

    @property
    def unit(self) -> Literal["rad", "m"]:
        """Unit of the coordinate."""
        return "rad" if self.is_angle else "m"


@dataclass(frozen=True)
class Coordinate:
    """One element of {x}: of a freedom its angle or translation, or one of the four of a quaternion.

    Attributes:
        body: From 1.
        index: Counts `FREEDOMS`, and `QUATERNION` behind them.
    """

    body: int
    index: int

    @property
    def name(self) -> str:
        """Without that of the body."""
        return (*FREEDOMS, *QUATERNION)[self.index]

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle (rad)."""
        return self.index < 3

    @property
    def is_translation(self) -> bool:
        """Whether it is a translation (m)."""
        return 3 <= self.index < len(FREEDOMS)

    @property
    def unit(self) -> Literal["rad", "m", "1"]:
        """Its unit."""
        if self.is_angle:
            return "rad"
        return "m" if self.is_translation else "1"


@dataclass(frozen=True)
class System:
    """A tree of rigid bodies, its gravity and its name.

    Raises:
        ModelError: If the tree, a number or a name is not usable.
    """

    name: str
    bodies: tuple[Body, ...]
    gravity: Vector = GRAVITY

    def __post_init__(self) -> None:
        check_identifier(self.name, "system name")
        bodies = validation.instances(self.bodies, Body, "bodies")
        validation.store(self, bodies=bodies, gravity=numbers(self.gravity, (3,), "gravity"))
        validation.connection(self.connection)
        validation.unique("body name", [body.name for body in self.bodies])
        if not self.freedoms:
            raise ModelError(f"system {self.name!r} has no free freedom: every joint is locked.")
        validation.unique("freedom name", self.freedom_names)
        validation.unique("coordinate name", self.coordinate_names)
        validation.unique("speed name", self.speed_names)
        validation.unique("point name", self.point_names)
        validation.parameter_names(self.parameters, self.number_of_bodies)

    @classmethod
    def from_arrays(
        cls: type[_S],
        connection: Any,
        mass: Any,
        inertia: Any,
        mass_center: Any,
        joint_position: Any,
        joint_orientation: Any = None,
        free: Any = None,
        locked: Any = None,
        gravity: Any = GRAVITY,
        loads: Any = None,
        name: str = "system",
        sequence: Any = NOTES,
        speeds: Any = SPEEDS[0],
        coordinates: Any = ORIENTATIONS[0],
    ) -> _S:
        """A system from one array a quantity; body K is row K - 1 and is called `bodyK`.

        Any number may be a `Parameter`, which stays open until run time.

        Args:
            connection: (N,) lower body of each body, 0 for the ground.
            mass: (N,) kg.
            inertia: (N, 3, 3) about the mass centre, in body components, kg m^2.
            mass_center: (N, 3) from O_K to G_K, in body components, m.
            joint_position: (N, 3) from O_J to Q_K, in lower body components, m.
            joint_orientation: (N, 3, 3) rotations, lower body to joint frame; default identity.
            free: (N, 6) bool, columns as `FREEDOMS`; default all free.
            locked: (N, 6) values of the locked freedoms, rad and m; default 0.
            gravity: (3,) inertial components, m/s^2.
            loads: None, True or (N,) bool: bodies that take force and torque inputs.
            name: A C identifier; prefix of everything in the generated code.
            sequence: One name or (N,) names of `sequences.SEQUENCES`: about which axes the angles turn.
            speeds: One name or (N,) names of `body.SPEEDS`: what the speeds of the angles are.
            coordinates: One name or (N,) names of `body.ORIENTATIONS`: what stands for the orientation.

        Raises:
            ModelError: If a shape, a number, the tree or the name is not usable.
        """
        lower = validation.connection(arrays.integers(connection, "connection"))
        count = len(lower)
        rows = arrays.Rows(count)
        masses = numbers(mass, (count,), "mass")
        inertias = numbers(inertia, (count, 3, 3), "inertia")
        centers = numbers(mass_center, (count, 3), "mass_center")
        positions = numbers(joint_position, (count, 3), "joint_position")
        orientations = rows.numbers(joint_orientation, (3, 3), IDENTITY, "joint_orientation")
        frees = rows.flags(free, 6, True, "free")
        lockeds = rows.numbers(locked, (6,), (0.0,) * 6, "locked")
        loaded = rows.loads(loads)
        kinds = rows.names(speeds, "speeds")
        order = rows.names(sequence, "sequence")
        held = rows.names(coordinates, "coordinates")
        bodies = []
        for k in range(count):
            try:
                turning = {"sequence": order[k], "speeds": kinds[k], "coordinates": held[k]}
                joint = Joint(positions[k], orientations[k], frees[k], lockeds[k], **turning)
            except ModelError as error:
                raise ModelError(f"body {k + 1}: {error}") from None
            label = f"body{k + 1}"
            bodies.append(Body(label, lower[k], masses[k], inertias[k], centers[k], joint, loaded[k]))
        return cls(name=name, bodies=tuple(bodies), gravity=gravity)

    @property
    def number_of_bodies(self) -> int:
        """N."""
        return len(self.bodies)

    @cached_property
    def connection(self) -> tuple[int, ...]:
        """The connection array: `connection[K-1]` is the lower body of body K."""
        return tuple(body.lower for body in self.bodies)

    @cached_property
    def freedoms(self) -> tuple[Freedom, ...]:
        """The freedoms in the order of {y}: those of angles of all bodies, then of translations (Eq. 1)."""
        every = [
            Freedom(k, index)
            for k, body in enumerate(self.bodies, start=1)
            for index, is_free in enumerate(body.joint.free)
            if is_free
        ]
        return tuple(f for f in every if f.is_angle) + tuple(f for f in every if not f.is_angle)

    @cached_property
    def places(self) -> dict[Freedom, int]:
        """The place of every freedom in {y}, from 0."""
        return {freedom: i for i, freedom in enumerate(self.freedoms)}

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """{x}: as the freedoms, but with the four of a quaternion where its joint has one."""
        found: list[Coordinate] = []
        for freedom in self.freedoms:
            if not (freedom.is_angle and self.bodies[freedom.body - 1].joint.is_quaternion):
                found.append(Coordinate(freedom.body, freedom.index))
            elif freedom.index == 0:
                four = range(len(FREEDOMS), len(FREEDOMS) + len(QUATERNION))
                found += [Coordinate(freedom.body, index) for index in four]
        return tuple(found)

    @cached_property
    def coordinate_places(self) -> dict[Coordinate, int]:
        """The place of every coordinate in {x}, from 0."""
        return {coordinate: i for i, coordinate in enumerate(self.coordinates)}

    def coordinate_place(self, body: int, index: int) -> int:
        """The place of a coordinate in {x}, from 0.

        Args:
            body: From 1.
            index: Counts `FREEDOMS`, and `QUATERNION` behind them.

        Raises:
            KeyError: If {x} does not hold it.
        """
        return self.coordinate_places[Coordinate(body, index)]

    @cached_property
    def coordinate_names(self) -> tuple[str, ...]:
        """Unique names in the order of {x}: of the freedoms, or `<body>.e0` ... `<body>.e3`."""
        return tuple(
            self._freedom_name(Freedom(coordinate.body, coordinate.index))
            if coordinate.index < len(FREEDOMS)
            else f"{self.bodies[coordinate.body - 1].name}.{coordinate.name}"
            for coordinate in self.coordinates
        )

    @cached_property
    def freedom_names(self) -> tuple[str, ...]:
        """n unique names of the freedoms: the joint's name, or `<body>.theta1` ... `<body>.s3`.

        Where a quaternion turns the body, they are `<body>.omega1`, `omega2`, `omega3`.
        """
        names = zip(self.freedoms, self.speed_names, strict=True)
        return tuple(
            name if self.bodies[freedom.body - 1].joint.is_quaternion else self._freedom_name(freedom)
            for freedom, name in names
        )

    @cached_property
    def speed_names(self) -> tuple[str, ...]:
        """n unique names in the order of {y}: of the coordinate whose rate it is, or of the component.

        The components of a relative angular velocity, Eq. (8), are `<body>.omega1`, `omega2`, `omega3`.
        """
        return tuple(
            f"{self.bodies[freedom.body - 1].name}.omega{freedom.axis + 1}"
            if self.spins(freedom)
            else self._freedom_name(freedom)
            for freedom in self.freedoms
        )

    @cached_property
    def points(self) -> tuple[tuple[int, Point], ...]:
        """The points of all bodies, body by body, each with the number of its body."""
        return tuple((k, point) for k, body in enumerate(self.bodies, start=1) for point in body.points)

    @cached_property
    def point_names(self) -> tuple[str, ...]:
        """Their names, in this order: that of the rows of outputs that are about points."""
        return tuple(point.name for _, point in self.points)

    def with_points(self: _S, points: Mapping[str, tuple[str | int, Any]]) -> _S:
        """The same system with further points.

        Args:
            points: By name the body, its name or number from 1, and (3,) the position from its origin, in
                body components (m).

        Raises:
            ModelError: If there is no such body, a name is taken or unusable, or a position is none.
        """
        bodies, names = list(self.bodies), [body.name for body in self.bodies]
        for name, (body, position) in points.items():
            if body not in names and body not in range(1, len(names) + 1):
                raise ModelError(f"point {name!r}: there is no body {body!r}. {did_you_mean(body, names)}")
            k = names.index(body) if isinstance(body, str) else body - 1
            bodies[k] = replace(bodies[k], points=(*bodies[k].points, Point(name, position)))
        return replace(self, bodies=tuple(bodies))

    def spins(self, freedom: Freedom) -> bool:
        """Whether the speed at the place of `freedom` is a component of a relative angular velocity."""
        return freedom.is_angle and self.bodies[freedom.body - 1].joint.spins

    @property
    def speeds_are_rates(self) -> bool:
        """Whether {xdot} = {y}, Eq. (45)."""
        return not any(body.joint.spins for body in self.bodies)

    def with_speeds(self: _S, speeds: str) -> _S:
        """The same system with other generalized speeds at every joint that has three free angles.

        Args:
            speeds: One of `body.SPEEDS`: "angle_rates", or "angular_velocity" for the components of
                `omega_hat'_K`, Eq. (8), with which [A] is regular everywhere. Other joints stay as they are,
                and so do those with a quaternion, which has no angles.

        Raises:
            OptionError: If there are no such speeds.
        """
        require_one("speeds", speeds, SPEEDS)
        return self._turning(lambda joint: replace(joint, speeds=speeds))

    def with_coordinates(self: _S, coordinates: str) -> _S:
        """The same system with other coordinates at every joint that has three free angles.

        Args:
            coordinates: One of `body.ORIENTATIONS`: "angles", in the sequence 1-2-3 where there were none, or
                "quaternion", with which neither [A] nor {xdot} is singular in any orientation. Other joints
                stay as they are. The speeds of a joint that had a quaternion stay its angular velocity.

        Raises:
            OptionError: If there are no such coordinates.
        """
        require_one("coordinates", coordinates, ORIENTATIONS)

        def change(joint: Joint) -> Joint:
            sequence = NOTES if coordinates == "quaternion" else joint.sequence
            return replace(joint, coordinates=coordinates, sequence=sequence)

        return self._turning(change)

    def with_right_angles(self: _S, tolerance: float) -> _S:
        """The same system with exact right angles, where constant orientations miss them by little.

        Args:
            tolerance: How far (rad) an orientation or a locked angle may be from a right angle to be taken
                for it; 0 changes nothing. Parameters stay as they are.

        Raises:
            OptionError: If it makes no sense, see `right_angles.checked`.
        """
        limit = checked(tolerance)

        def exact(body: Body) -> Body:
            joint = body.joint.with_right_angles(limit)
            return body if joint == body.joint else replace(body, joint=joint)

        return replace(self, bodies=tuple(map(exact, self.bodies)))

    def _turning(self: _S, change: Callable[[Joint], Joint]) -> _S:
        """The same system with `change` applied to every joint that has three free angles."""
        bodies = (
            replace(body, joint=change(body.joint)) if body.joint.turns_freely else body
            for body in self.bodies
        )
        return replace(self, bodies=tuple(bodies))

    def _freedom_name(self, freedom: Freedom) -> str:
        body = self.bodies[freedom.body - 1]
        if body.joint.name and sum(body.joint.free) == 1:
            return body.joint.name
        return f"{body.name}.{FREEDOMS[freedom.index]}"

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The run-time parameters, each once, in the order of first use."""
        found: dict[str, Parameter] = {}

        def collect(value: Number) -> None:
            if isinstance(value, Parameter) and found.setdefault(value.name, value) != value:
                raise ModelError(
                    f"parameter {value.name!r} has two values, {found[value.name].value!r} and "
                    f"{value.value!r}. One name, one value."
                )

        map_numbers(self.gravity, collect)
        for body in self.bodies:
            joint = body.joint
            map_numbers((body.mass, body.inertia, body.mass_center), collect)
            map_numbers(tuple(point.position for point in body.points), collect)
            map_numbers((joint.position, joint.orientation, joint.locked), collect)
        return tuple(found.values())

    def with_parameters(self: _S, values: Mapping[str, float]) -> _S:
        """The same system with other default values of its parameters.

        Raises:
            ModelError: If a name is unknown or a value makes the model unusable.
        """
        known = [parameter.name for parameter in self.parameters]
        for name in values:
            if name not in known:
                raise ModelError(f"unknown parameter {name!r}. {did_you_mean(name, known)}")

        def change(value: Number) -> Number:
            if isinstance(value, Parameter) and value.name in values:
                return Parameter(value.name, values[value.name])
            return value

        bodies = tuple(body.changed(change) for body in self.bodies)
        return replace(self, bodies=bodies, gravity=map_numbers(self.gravity, change))

    def values(self) -> arrays.SystemArrays:
        """Every number of the model as NumPy arrays, parameters at their defaults."""
        joints = [body.joint for body in self.bodies]
        return arrays.system_arrays(
            connection=self.connection,
            mass=map_numbers(tuple(body.mass for body in self.bodies), value_of),
            inertia=map_numbers(tuple(body.inertia for body in self.bodies), value_of),
            mass_center=map_numbers(tuple(body.mass_center for body in self.bodies), value_of),
            joint_position=map_numbers(tuple(joint.position for joint in joints), value_of),
            joint_orientation=tuple(map_numbers(joint.orientation, value_of) for joint in joints),
            free=tuple(joint.free for joint in joints),
            locked=map_numbers(tuple(joint.locked for joint in joints), value_of),
            gravity=map_numbers(self.gravity, value_of),
            loads=tuple(body.loads for body in self.bodies),
            sequence=tuple(joint.sequence for joint in joints),
            speeds=tuple(joint.speeds for joint in joints),
            coordinates=tuple(joint.coordinates for joint in joints),
        )

    def as_table(self) -> dict[str, Any]:
        """The model in the words of a model file: what `save` writes."""
        table: dict[str, Any] = {"name": self.name, "gravity": map_numbers(self.gravity, word)}
        if self.parameters:
            table["parameters"] = {parameter.name: parameter.value for parameter in self.parameters}
        # In a file, "ground" always means the ground; a body of this name is called by its number.
        names = ["ground", *(body.name for body in self.bodies)]
        words = [k if k > 0 and name == "ground" else name for k, name in enumerate(names)]
        return {**table, "body": [body.as_table(words[body.lower]) for body in self.bodies]}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a TOML model file; loading it gives an equal system.

        Raises:
            WriteError: If `path` does not end in .toml or cannot be written.
        """
        file = Path(path)
        if file.suffix.lower() != ".toml":
            raise WriteError(f"{file}: a model file ends in .toml.")
        write_whole(file, toml_text(self.as_table()))
