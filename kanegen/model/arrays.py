"""Conversion between systems and NumPy arrays: bodies from a user's arrays, and arrays from a system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.body import Body
from kanegen.model.coordinates import Freedom, Rotation, rotation_of
from kanegen.model.coupling import CoupledFreedom, values_of
from kanegen.model.description import SystemDescription
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.names import Place, variable_places
from kanegen.model.frame import placed
from kanegen.model.joint import IDENTITY, Joint
from kanegen.model.numbers import listed, map_numbers, numbers, value_of
from kanegen.model.rotations import rotation_123

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class ForceArrays:
    """The force elements and points of a system, as numbers.

    Attributes:
        elements: Force elements, parameters at their defaults.
        variables: Body and freedom or coordinate of each variable of expressions, by name.
        points: Number of the body, from 1, and (3,) position from O_K, in K (m), by name of the point.
        loaded: (P,) which points take a force and a moment.
        load_frames: (P,) name of the frame of the components of these; "" for inertial ones.
    """

    elements: tuple[ForceElement, ...]
    variables: Mapping[str, Place]
    points: Mapping[str, tuple[int, Floats]]
    loaded: Flags
    load_frames: tuple[str, ...]


@dataclass(frozen=True)
class FrameArrays:
    """A frame that is fixed in a body, or in the ground, as numbers.

    Attributes:
        body: Number of the body, 0 for the ground.
        position: (3,) position of its origin from O_K, in K (m).
        rotation: (3, 3) rotation from components of K to components of the frame.
    """

    body: int
    position: Floats
    rotation: Floats

    def point(self, position: Any) -> Floats:
        """Return the position from O_K, in K, of a point that is given in the frame (m)."""
        found: Floats = self.position + self.rotation.T @ _floats(position)
        return found


@dataclass(frozen=True)
class RotorArrays:
    """A rotor as numbers.

    Attributes:
        body: Number of its carrier, 0 for the ground.
        freedom: The freedom that it drives.
        axis: (3,) unit vector along its axis, in components of its carrier.
        inertia: Moment of inertia about the axis (kg m^2).
        ratio: Ratio of the gear (1, rad/m).
    """

    body: int
    freedom: Freedom
    axis: Floats
    inertia: float
    ratio: float


@dataclass(frozen=True)
class SystemArrays:
    """The numbers of a system of N bodies; row K - 1 belongs to body K. Units as `System.from_arrays`.

    A row of `load_rotation` takes components of K to those of the frame in which loads on K are given.
    """

    connection: NDArray[np.int64]  # (N,)
    mass: Floats  # (N,)
    inertia: Floats  # (N, 3, 3)
    mass_center: Floats  # (N, 3)
    joint_position: Floats  # (N, 3)
    joint_orientation: Floats  # (N, 3, 3)
    free: Flags  # (N, 6)
    locked: Floats  # (N, 6)
    gravity: Floats  # (3,)
    loads: Flags  # (N,)
    sequence: tuple[str, ...]  # (N,)
    speeds: tuple[str, ...]  # (N,)
    coordinates: tuple[str, ...]  # (N,)
    forces: ForceArrays
    prescribed: Flags  # (N, 6)
    frames: Mapping[str, FrameArrays]
    load_rotation: Floats  # (N, 3, 3)
    armature: Floats  # (N, 6)
    coupled: tuple[CoupledFreedom[float], ...]  # each after those that it follows
    rotors: tuple[RotorArrays, ...]

    def rows(self) -> dict[str, Any]:
        """Return the arguments of `System.from_arrays` for the same bodies and nothing else."""
        others = ("forces", "frames", "load_rotation", "coupled", "rotors")
        return {field.name: getattr(self, field.name) for field in fields(self) if field.name not in others}

    def place(self, name: str) -> tuple[int, Floats]:
        """Return number of the body and position in it (m) of a point, or of the origin of a frame."""
        if name in self.forces.points:
            return self.forces.points[name]
        return self.frames[name].body, self.frames[name].position

    @property
    def rotations(self) -> tuple[Rotation, ...]:
        """(N,) rotation of each body in its joint frame, by angles or by a quaternion."""
        return tuple(map(rotation_of, self.coordinates, self.sequence))


def system_arrays(system: SystemDescription) -> SystemArrays:
    """Return every number of a system, parameters at their defaults, orientations as matrices."""
    joints = tuple(body.joint for body in system.bodies)
    return SystemArrays(
        connection=np.array(system.connection, dtype=np.int64),
        mass=_values([body.mass for body in system.bodies]),
        inertia=_values([body.inertia for body in system.bodies]),
        mass_center=_values([body.mass_center for body in system.bodies]),
        joint_position=_values([joint.position for joint in joints]),
        joint_orientation=np.array([_matrix(map_numbers(joint.orientation, value_of)) for joint in joints]),
        free=np.array([joint.free for joint in joints], dtype=np.bool_),
        locked=_values([joint.locked for joint in joints]),
        gravity=_values(system.gravity),
        loads=np.array([body.loads for body in system.bodies], dtype=np.bool_),
        sequence=tuple(joint.sequence for joint in joints),
        speeds=tuple(joint.speeds for joint in joints),
        coordinates=tuple(joint.coordinates for joint in joints),
        forces=_force_arrays(system),
        prescribed=np.array([joint.prescribed for joint in joints], dtype=np.bool_),
        frames={name: fixed_frame(system, name) for name in system.frame_names},
        load_rotation=np.array([fixed_frame(system, body.name).rotation for body in system.bodies]),
        armature=_values([joint.armature for joint in joints]),
        coupled=values_of(system.coupled),
        rotors=rotor_arrays(system),
    )


def fixed_frame(system: SystemDescription, name: str) -> FrameArrays:
    """Return a frame of a system as numbers; "" is the frame of the model of whatever body."""
    position, rotation = placed(system.frame_path(name))
    known = system.frames_by_name.get(name)
    return FrameArrays(known.body if known else 0, _floats(position), _floats(rotation))


def rotor_arrays(system: SystemDescription) -> tuple[RotorArrays, ...]:
    """Return the rotors of a system as numbers, parameters at their defaults."""
    found = []
    for one in system.mounted_rotors:
        axis = fixed_frame(system, one.frame).rotation.T @ _floats(one.direction)
        inertia, ratio = value_of(one.rotor.inertia), value_of(one.rotor.ratio)
        found.append(RotorArrays(one.body, one.freedom, axis, inertia, ratio))
    return tuple(found)


def _force_arrays(system: SystemDescription) -> ForceArrays:
    """Return the force elements and points of a system as numbers."""
    points = {
        point.name: (k, fixed_frame(system, point.frame).point(map_numbers(point.position, value_of)))
        for k, point in system.points
    }
    return ForceArrays(
        elements=tuple(element.map_numbers(value_of) for element in system.force_elements),
        variables=variable_places(system.bodies),
        points=points,
        loaded=np.array([point.loads for _, point in system.points], dtype=np.bool_),
        load_frames=tuple(point.load_frame for _, point in system.points),
    )


def _floats(values: Any) -> Floats:
    """Return nested tuples of numbers as doubles, parameters at their defaults."""
    return np.array(values, dtype=np.float64)


def _values(rows: Sequence[Any]) -> Floats:
    """Return a sequence of nested tuples of numbers as doubles, parameters at their defaults."""
    return _floats([map_numbers(one, value_of) for one in rows])


def _matrix(orientation: Any) -> Floats:
    """Return as a (3, 3) matrix an orientation that is a matrix or three 1-2-3 angles (rad)."""
    value = _floats(orientation)
    return value if value.shape == (3, 3) else np.array(rotation_123(orientation))


def bodies_from_arrays(
    *,
    connection: Any,
    mass: Any,
    inertia: Any,
    mass_center: Any,
    joint_position: Any,
    joint_orientation: Any,
    free: Any,
    locked: Any,
    loads: Any,
    sequence: Any,
    speeds: Any,
    coordinates: Any,
    prescribed: Any,
    armature: Any,
) -> tuple[Body, ...]:
    """Return the bodies of a tree from the arguments of `System.from_arrays`.

    Raises:
        ModelError: If a shape or a number is not usable; the message names the array and the body.
    """
    lower = validation.connection(_integers(connection, "connection"))
    rows = _Rows(len(lower))
    prescribed = rows.flags(prescribed, 6, False, "prescribed")
    not_prescribed = tuple(tuple(not flag for flag in row) for row in prescribed)
    of_joints = {
        "position": numbers(joint_position, (rows.count, 3), "joint_position"),
        "orientation": rows.numbers(joint_orientation, (3, 3), IDENTITY, "joint_orientation"),
        "free": not_prescribed if free is None else rows.flags(free, 6, True, "free"),
        "locked": rows.numbers(locked, (6,), (0.0,) * 6, "locked"),
        "speeds": rows.names(speeds, "speeds"),
        "sequence": rows.names(sequence, "sequence"),
        "coordinates": rows.names(coordinates, "coordinates"),
        "prescribed": prescribed,
        "armature": rows.numbers(armature, (6,), (0.0,) * 6, "armature"),
    }
    of_bodies = {
        "lower": lower,
        "mass": numbers(mass, (rows.count,), "mass"),
        "inertia": numbers(inertia, (rows.count, 3, 3), "inertia"),
        "mass_center": numbers(mass_center, (rows.count, 3), "mass_center"),
        "loads": rows.loads(loads),
    }
    bodies = []
    for k in range(rows.count):
        try:
            joint = Joint(**{name: values[k] for name, values in of_joints.items()})
        except ModelError as error:
            raise ModelError(f"body {k + 1}: {error}") from None
        own = {name: values[k] for name, values in of_bodies.items()}
        bodies.append(Body(name=f"body{k + 1}", joint=joint, **own))
    return tuple(bodies)


def _integers(value: Any, label: str) -> tuple[int, ...]:
    """Return `value` as a tuple of integers."""
    items = listed(value)
    if items is None:
        raise ModelError(f"{label}: expected a sequence of integers, got {quoted(value)}.")
    return tuple(validation.integer(item, f"{label}[{i}]") for i, item in enumerate(items))


@dataclass(frozen=True)
class _Rows:
    """Reads optional arrays that have one row for each of `count` bodies."""

    count: int

    def numbers(self, value: Any, shape: tuple[int, ...], default: Any, label: str) -> Any:
        """Return (count, *shape) numbers, or `default` in every row where `value` is None."""
        return (default,) * self.count if value is None else numbers(value, (self.count, *shape), label)

    def flags(self, value: Any, length: int, default: bool, label: str) -> tuple[tuple[bool, ...], ...]:
        """Return (count, length) flags, or `default` everywhere where `value` is None."""
        if value is None:
            return ((default,) * length,) * self.count
        rows = validation.sequence(value, self.count, label)
        return tuple(validation.flags(row, length, f"{label}[{k}]") for k, row in enumerate(rows))

    def names(self, value: Any, label: str) -> Sequence[Any]:
        """Return (count,) names, from one name for all bodies or one for each."""
        if isinstance(value, str):
            return (value,) * self.count
        return validation.sequence(value, self.count, label)

    def loads(self, value: Any) -> tuple[bool, ...]:
        """Return (count,) flags, from None, one flag for all bodies or one for each."""
        if value is None or isinstance(value, bool | np.bool_):
            return (bool(value),) * self.count
        return validation.flags(value, self.count, "loads")
