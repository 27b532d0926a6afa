"""A tree of rigid bodies: the source language of kanegen.

Body K (numbered from 1) hangs on its lower body J = L(K) < K, 0 being the ground. Seen from J, the point
Q_K stands at `position`; there the joint frame has the constant orientation [C_K]; in it the origin O_K is
displaced by s'_K; and body K is turned by the 1-2-3 body-fixed angles, so that [^J R_K] = [R_123] [C_K].
Any of the six freedoms can be locked at a value; it then leaves {x}, {y}, [A] and {f}.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, TypeVar

from kanegen import arrays, validation
from kanegen.errors import ModelError, WriteError
from kanegen.files import write_whole
from kanegen.names import check_identifier, check_label
from kanegen.numbers import Matrix, Number, Parameter, Vector, map_numbers, number, numbers, value_of
from kanegen.toml_text import toml_text

FREEDOMS = ("theta1", "theta2", "theta3", "s1", "s2", "s3")
"""The six relative freedoms of a body, in the order of `Joint.free`: angles in rad, translations in m."""

GRAVITY: Vector = (0.0, 0.0, -9.81)
"""Default gravity, inertial components, m/s^2."""

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

_S = TypeVar("_S", bound="System")


@dataclass(frozen=True)
class Joint:
    """How a body is attached to its lower body J.

    Attributes:
        position: `q'_K`, from O_J to Q_K, in J (m).
        orientation: `[C_K]`, from J components to joint-frame components: a (3, 3) rotation, or three
            constant 1-2-3 angles (rad) where an angle is to stay a parameter. Angles that are all plain
            numbers become the matrix, with exact zeros and ones at right angles.
        free: Which of `FREEDOMS` are free.
        locked: Values of those that are not (rad, m); 0 at the free ones.
        name: Name of the joint in a robot file; names the freedom where there is only one.
    """

    position: Vector = (0.0, 0.0, 0.0)
    orientation: Matrix | Vector = IDENTITY
    free: tuple[bool, ...] = (True,) * 6
    locked: tuple[Number, ...] = (0.0,) * 6
    name: str = ""

    def __post_init__(self) -> None:
        if self.name != "":
            check_label(self.name, "joint name")
        position = numbers(self.position, (3,), "joint position")
        free = validation.flags(self.free, 6, "free")
        locked = numbers(self.locked, (6,), "locked")
        orientation = validation.orientation(self.orientation)
        locked = tuple(0.0 if is_free else value for is_free, value in zip(free, locked, strict=True))
        _set(self, position=position, orientation=orientation, free=free, locked=locked)

    def as_table(self) -> dict[str, Any]:
        """The joint in the words of a model file, defaults left out."""
        table: dict[str, Any] = {"name": self.name} if self.name else {}
        if any(self.position):
            table["position"] = map_numbers(self.position, _word)
        if self.orientation != IDENTITY:
            key = "orientation" if isinstance(self.orientation[0], tuple) else "orientation_angles"
            table[key] = map_numbers(self.orientation, _word)
        free = tuple(name for name, is_free in zip(FREEDOMS, self.free, strict=True) if is_free)
        table["free"] = "all" if all(self.free) else free or "none"
        locked = zip(FREEDOMS, self.locked, strict=True)
        table["locked"] = {name: _word(value) for name, value in locked if value}
        return table


@dataclass(frozen=True)
class Body:
    """A rigid body and the joint below it.

    Attributes:
        name: Label, unique in the system.
        lower: Number of the lower body, 0 for the ground.
        mass: kg.
        inertia: `[I'_{G_K}]`, about the mass centre, in body components (kg m^2).
        mass_center: `r'_K`, from O_K to G_K, in body components (m).
        joint: How it hangs on its lower body.
        loads: Whether it takes a force and a torque as inputs.
    """

    name: str
    lower: int
    mass: Number
    inertia: Matrix
    mass_center: Vector = (0.0, 0.0, 0.0)
    joint: Joint = field(default_factory=Joint)
    loads: bool = False

    def __post_init__(self) -> None:
        check_label(self.name, "body name")
        try:
            _set(
                self,
                lower=validation.integer(self.lower, "connection"),
                mass=validation.mass(number(self.mass, "mass")),
                inertia=validation.inertia(numbers(self.inertia, (3, 3), "inertia"), self.name),
                mass_center=numbers(self.mass_center, (3,), "mass centre"),
                loads=validation.flags((self.loads,), 1, "loads")[0],
            )
        except ModelError as error:
            raise ModelError(f"body {self.name!r}: {error}") from None

    def as_table(self, lower: int | str) -> dict[str, Any]:
        """The body in the words of a model file, `lower` being its connection there; defaults left out."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = self.inertia
        table: dict[str, Any] = {"name": self.name, "connection": lower, "mass": _word(self.mass)}
        if any(self.mass_center):
            table["mass_center"] = map_numbers(self.mass_center, _word)
        table["inertia"] = map_numbers(self.inertia if xy or xz or yz else (xx, yy, zz), _word)
        if self.loads:
            table["loads"] = True
        return {**table, "joint": self.joint.as_table()}


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
        _set(self, bodies=tuple(self.bodies), gravity=numbers(self.gravity, (3,), "gravity"))
        validation.connection(self.connection)
        validation.unique("body name", [body.name for body in self.bodies])
        if not self.freedoms:
            raise ModelError(f"system {self.name!r} has no free freedom: every joint is locked.")
        validation.unique("freedom name", self.freedom_names)
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
        bodies = []
        for k in range(count):
            try:
                joint = Joint(positions[k], orientations[k], frees[k], lockeds[k])
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
        """The free coordinates in the order of {x}: angles of all bodies, then translations (Eq. 1)."""
        every = [
            Freedom(k, index)
            for k, body in enumerate(self.bodies, start=1)
            for index, is_free in enumerate(body.joint.free)
            if is_free
        ]
        return tuple(f for f in every if f.is_angle) + tuple(f for f in every if not f.is_angle)

    @cached_property
    def freedom_names(self) -> tuple[str, ...]:
        """n unique names in the order of {x}: the joint's name, or `<body>.theta1` ... `<body>.s3`."""
        return tuple(self._freedom_name(freedom) for freedom in self.freedoms)

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
            map_numbers((joint.position, joint.orientation, joint.locked), collect)
        return tuple(found.values())

    def with_parameters(self: _S, values: Mapping[str, float]) -> _S:
        """The same system with other default values of its parameters.

        Raises:
            ModelError: If a name is unknown or a value makes the model unusable.
        """
        known = {parameter.name for parameter in self.parameters}
        for name in values:
            if name not in known:
                raise ModelError(
                    f"unknown parameter {name!r}. The system has {sorted(known) or 'no parameters'}."
                )

        def change(value: Number) -> Number:
            if isinstance(value, Parameter) and value.name in values:
                return Parameter(value.name, values[value.name])
            return value

        bodies = []
        for body in self.bodies:
            old = body.joint
            joint = replace(
                old,
                position=map_numbers(old.position, change),
                orientation=map_numbers(old.orientation, change),
                locked=map_numbers(old.locked, change),
            )
            bodies.append(
                replace(
                    body,
                    mass=change(body.mass),
                    inertia=map_numbers(body.inertia, change),
                    mass_center=map_numbers(body.mass_center, change),
                    joint=joint,
                )
            )
        return replace(self, bodies=tuple(bodies), gravity=map_numbers(self.gravity, change))

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
        )

    def as_table(self) -> dict[str, Any]:
        """The model in the words of a model file: what `save` writes."""
        table: dict[str, Any] = {"name": self.name, "gravity": map_numbers(self.gravity, _word)}
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


def _word(value: Number) -> float | str:
    """A number in a model file: itself, or its parameter's name."""
    return value.name if isinstance(value, Parameter) else value


def _set(instance: object, **values: Any) -> None:
    """Store checked values in a frozen dataclass while it is being made."""
    for name, value in values.items():
        object.__setattr__(instance, name, value)
