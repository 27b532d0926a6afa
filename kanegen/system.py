"""A tree of rigid bodies: the source language of kanegen.

Body K (numbered from 1) hangs on its lower body J = L(K) < K, 0 being the ground. Its free coordinates make
up {x}; the locked ones leave {x}, {y}, [A] and {f}, and so do the prescribed ones, whose motion is an input.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np

from kanegen import arrays, reported, validation
from kanegen.body import FREEDOMS, IDENTITY, ORIENTATIONS, QUATERNION, SPEEDS, Body, Joint, Point
from kanegen.choices import require_one
from kanegen.errors import ModelError, WriteError
from kanegen.files import write_whole
from kanegen.force_elements import KINDS, ForceElement
from kanegen.force_elements.expression import TIME
from kanegen.force_elements.names import resolved, variable_places
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
    """One of the six freedoms of a body: `index` counts `FREEDOMS`, `body` counts bodies from 1."""

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

    @property
    def effort(self) -> Literal["N m", "N"]:
        """Unit of its generalized force."""
        return "N m" if self.is_angle else "N"


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
    """A tree of rigid bodies, its gravity, what else acts on it, its name, and what outputs are about.

    Attributes:
        name: A C identifier; prefix of everything in the generated code.
        bodies: Lower bodies first.
        gravity: Inertial components (m/s^2).
        force_elements: Springs, dampers, drives, loads on points, potentials.
        poses: Names of the bodies that `body_poses` gives, in the order of its rows; None for all.
        reactions: Names of the locked directions that `reaction_loads` gives, `<body>.theta2` or `<body>.s1`,
            in its order; None for all.

    Raises:
        ModelError: If the tree, a number or a name is not usable.
    """

    name: str
    bodies: tuple[Body, ...]
    gravity: Vector = GRAVITY
    force_elements: tuple[ForceElement, ...] = ()
    poses: tuple[str, ...] | None = None
    reactions: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        check_identifier(self.name, "system name")
        bodies = validation.instances(self.bodies, Body, "bodies")
        elements = validation.instances(self.force_elements, ForceElement, "force_elements")
        validation.store(self, bodies=bodies, gravity=numbers(self.gravity, (3,), "gravity"))
        validation.connection(self.connection)
        validation.unique("body name", [body.name for body in self.bodies])
        validation.store(self, poses=reported.poses(self.bodies, self.poses))
        validation.store(self, reactions=reported.reactions(self.bodies, self.reactions))
        if not self.freedoms:
            what = "locked or prescribed" if self.prescribed else "locked"
            raise ModelError(f"system {self.name!r} has no free freedom: every joint is {what}.")
        validation.unique("freedom name", (*self.freedom_names, *self.prescribed_names))
        validation.unique("coordinate name", self.coordinate_names)
        validation.unique("speed name", self.speed_names)
        validation.unique("point name", self.point_names)
        validation.store(self, force_elements=resolved(elements, self.bodies))
        validation.parameter_names(self.parameters, self.number_of_bodies)
        if self.depends_on_time and any(parameter.name == TIME for parameter in self.parameters):
            raise ModelError(f"parameter name {TIME!r} is the time in expressions. Choose another name.")

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
        prescribed: Any = None,
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
            free: (N, 6) bool, columns as `FREEDOMS`; default all but those that are prescribed.
            locked: (N, 6) values of the locked freedoms, rad and m; default 0.
            gravity: (3,) inertial components, m/s^2.
            loads: None, True or (N,) bool: bodies that take force and torque inputs.
            name: A C identifier; prefix of everything in the generated code.
            sequence: One name or (N,) names of `sequences.SEQUENCES`: about which axes the angles turn.
            speeds: One name or (N,) names of `body.SPEEDS`: what the speeds of the angles are.
            coordinates: One name or (N,) names of `body.ORIENTATIONS`: what stands for the orientation.
            prescribed: (N, 6) bool: freedoms whose motion is an input; default none.

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
        told = rows.flags(prescribed, 6, False, "prescribed")
        rest = tuple(tuple(not flag for flag in row) for row in told)
        frees = rest if free is None else rows.flags(free, 6, True, "free")
        lockeds = rows.numbers(locked, (6,), (0.0,) * 6, "locked")
        loaded = rows.loads(loads)
        kinds = rows.names(speeds, "speeds")
        order = rows.names(sequence, "sequence")
        held = rows.names(coordinates, "coordinates")
        bodies = []
        for k in range(count):
            try:
                turning = {"sequence": order[k], "speeds": kinds[k], "coordinates": held[k]}
                joint = Joint(
                    positions[k], orientations[k], frees[k], lockeds[k], **turning, prescribed=told[k]
                )
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
        return self._ordered(lambda joint: joint.free)

    @cached_property
    def prescribed(self) -> tuple[Freedom, ...]:
        """The freedoms whose motion is an input, in the same order."""
        return self._ordered(lambda joint: joint.prescribed)

    @cached_property
    def prescribed_names(self) -> tuple[str, ...]:
        """Their names, made as `freedom_names`: the order of the columns of the input `prescribed`."""
        return tuple(self._freedom_name(freedom) for freedom in self.prescribed)

    def _ordered(self, which: Callable[[Joint], tuple[bool, ...]]) -> tuple[Freedom, ...]:
        """Some freedoms of each joint in the order of Eq. (1)."""
        every = [
            Freedom(k, index)
            for k, body in enumerate(self.bodies, start=1)
            for index, is_one in enumerate(which(body.joint))
            if is_one
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
        bodies = list(self.bodies)
        for name, (body, position) in points.items():
            k = reported.body_number(bodies, body, f"point {name!r}") - 1
            bodies[k] = replace(bodies[k], points=(*bodies[k].points, Point(name, position)))
        return replace(self, bodies=tuple(bodies))

    def with_force_elements(self: _S, *elements: ForceElement) -> _S:
        """The same system with further force elements.

        Raises:
            ModelError: If a name stands for nothing, or an element makes no sense where it acts.
        """
        return replace(self, force_elements=(*self.force_elements, *elements))

    @cached_property
    def depends_on_time(self) -> bool:
        """Whether a force element does."""
        return any(
            TIME in expression.variables
            for element in self.force_elements
            for expression in element.expressions()
        )

    @cached_property
    def pose_names(self) -> tuple[str, ...]:
        """Names of the bodies of `body_poses`, in the order of its rows."""
        return tuple(body.name for body in self.bodies) if self.poses is None else self.poses

    @cached_property
    def posed(self) -> tuple[int, ...]:
        """Their numbers, from 1."""
        numbers_of = {body.name: k for k, body in enumerate(self.bodies, start=1)}
        return tuple(numbers_of[name] for name in self.pose_names)

    def with_poses(self: _S, bodies: Iterable[str | int] | None) -> _S:
        """The same system with other bodies in `body_poses`.

        Args:
            bodies: Names, or numbers from 1, in the order of the rows; None for all.

        Raises:
            ModelError: If one does not exist or is there twice, or there is none.
        """
        return replace(self, poses=reported.poses(self.bodies, bodies))

    @cached_property
    def reaction_names(self) -> tuple[str, ...]:
        """Names of the locked directions of `reaction_loads`, in its order; by default that of {y}."""
        return tuple(reported.locked(self.bodies)) if self.reactions is None else self.reactions

    @cached_property
    def reacting(self) -> tuple[Freedom, ...]:
        """The same as freedoms."""
        known = reported.locked(self.bodies)
        return tuple(Freedom(*known[name]) for name in self.reaction_names)

    def with_reactions(self: _S, directions: Iterable[str] | None) -> _S:
        """The same system with other directions in `reaction_loads`.

        Args:
            directions: Names of locked freedoms such as `<body>.theta2`, in the order of the loads; None for
                all.

        Raises:
            ModelError: If one is free, does not exist or is there twice, or there is none.
        """
        return replace(self, reactions=reported.reactions(self.bodies, directions))

    def with_prescribed(self: _S, names: Iterable[str] | str) -> _S:
        """The same system, where the motion of some freedoms is an input; they leave {x}, {y}, [A] and {f}.

        Args:
            names: Of free freedoms, one or several: `freedom_names`, or `<body>.theta1` ... `<body>.s3`.

        Raises:
            ModelError: If there is no such freedom, it is locked, or a joint cannot do without it.
        """
        every = {self._freedom_name(freedom): freedom for freedom in self._ordered(lambda joint: (True,) * 6)}
        bodies = list(self.bodies)
        for name in (names,) if isinstance(names, str) else names:
            if name not in every:
                free = [known for known, freedom in every.items() if freedom in self.places]
                raise ModelError(f"prescribed: there is no freedom {name!r}. {did_you_mean(name, free)}")
            k, index = every[name].body - 1, every[name].index
            if not bodies[k].joint.moving[index]:
                raise ModelError(f"prescribed: {name!r} is locked; free it, then prescribe it.")
            try:
                bodies[k] = replace(bodies[k], joint=bodies[k].joint.prescribing(index))
            except ModelError as error:
                raise ModelError(f"prescribed: {name!r}: {error}") from None
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
        if body.joint.name and body.joint.moving[freedom.index] and sum(body.joint.moving) == 1:
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
        for element in self.force_elements:
            for value in element.numbers():
                collect(value)
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

        return self.changed(change)

    def changed(self: _S, change: Callable[[Number], Number]) -> _S:
        """The same system with `change` applied to every number."""
        bodies = tuple(body.changed(change) for body in self.bodies)
        elements = tuple(element.changed(change) for element in self.force_elements)
        return replace(
            self, bodies=bodies, gravity=map_numbers(self.gravity, change), force_elements=elements
        )

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
            prescribed=tuple(joint.prescribed for joint in joints),
            forces=self._forces(),
        )

    def _forces(self) -> arrays.ForceArrays:
        places = {p.name: (k, np.array(map_numbers(p.position, value_of))) for k, p in self.points}
        return arrays.ForceArrays(
            elements=tuple(element.changed(value_of) for element in self.force_elements),
            variables=variable_places(self.bodies),
            points=places,
            loaded=np.array([point.loads for _, point in self.points], dtype=np.bool_),
        )

    def as_table(self) -> dict[str, Any]:
        """The model in the words of a model file: what `save` writes."""
        table: dict[str, Any] = {"name": self.name, "gravity": map_numbers(self.gravity, word)}
        if self.parameters:
            table["parameters"] = {parameter.name: parameter.value for parameter in self.parameters}
        outputs = {"body_poses": self.poses, "reaction_loads": self.reactions}
        if chosen := {output: names for output, names in outputs.items() if names}:
            table["outputs"] = chosen
        # In a file, "ground" always means the ground; a body of this name is called by its number.
        names = ["ground", *(body.name for body in self.bodies)]
        words = [k if k > 0 and name == "ground" else name for k, name in enumerate(names)]
        table["body"] = [body.as_table(words[body.lower]) for body in self.bodies]
        elements = {kind: [e.as_table() for e in self.force_elements if type(e) is kind] for kind in KINDS}
        return table | {kind.KEY: tables for kind, tables in elements.items() if tables}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a TOML model file; loading it gives an equal system.

        Raises:
            WriteError: If `path` does not end in .toml or cannot be written.
        """
        file = Path(path)
        if file.suffix.lower() != ".toml":
            raise WriteError(f"{file}: a model file ends in .toml.")
        write_whole(file, toml_text(self.as_table()))
