"""Rotors of geared motors: bodies of revolution that spin in a carrier, as fast as a freedom times a ratio.

A rotor turns about an axis that is fixed in its carrier, normally the lower body of the joint that it drives.
Its mass and its whole inertia, as if it stood still in the carrier, belong to the carrier; a rotation about
its axis changes neither. What the rotor adds is its spin: the angular momentum J n y along the axis, where y
is the rate of the freedom, J the inertia about the axis and n the ratio of the gear. This gives a reflected
inertia J n^2, a coupling of the freedom with the rotation of the carrier, and a gyroscopic moment on it
(Murphy, Wen and Saridis 1991; Featherstone 2008, section 9.6). `Joint.armature` is the first part alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.body import Body
from kanegen.model.coordinates import FREEDOMS, SPEED_KINDS, Freedom
from kanegen.model.names import check_label
from kanegen.model.numbers import (
    Number,
    Vector,
    described,
    factor_text,
    is_fixed,
    map_numbers,
    number,
    numbers,
    toml_number,
    value_of,
)


@dataclass(frozen=True)
class Rotor:
    """A rotor that spins about `axis` in its carrier at `ratio` times the rate of a freedom.

    Attributes:
        name: Label, unique among the rotors of a system.
        freedom: Name of the freedom that it drives: that of its joint, or `<body>.theta1` to `<body>.s3`.
        axis: (3,) direction of its axis, of any length, in components of `body`.
        inertia: Moment of inertia J about the axis (kg m^2).
        ratio: Ratio n of the gear: angle of the rotor in its carrier by coordinate of the freedom (1, or
            rad/m for a translation); negative where the rotor turns the other way.
        body: Name of the body or frame that carries it, or "ground"; "" is the lower body of the joint.

    Raises:
        ModelError: If a name or a number is not usable, the inertia is negative, or the axis or the ratio is
            zero.

    Example:
        kg.Rotor("motor3", "elbow", axis=(0, 0, 1), inertia=3.3e-5, ratio=100.0)
    """

    name: str
    freedom: str
    axis: tuple[float, float, float]
    inertia: Number
    ratio: Number = 1.0
    body: str = ""

    def __post_init__(self) -> None:
        check_label(self.name, "rotor name")
        label = f"rotor {quoted(self.name)}"
        axis = numbers(self.axis, (3,), f"{label}: axis")
        validation.store(self, axis=map_numbers(axis, _plain(f"{label}: axis")))
        validation.store(self, inertia=number(self.inertia, f"{label}: inertia"))
        validation.store(self, ratio=number(self.ratio, f"{label}: ratio"))
        if not any(self.axis):
            raise ModelError(f"{label}: its axis has no direction. Give one such as [0, 0, 1].")
        if value_of(self.inertia) < 0:
            raise ModelError(f"{label}: its inertia {described(self.inertia)} kg m^2 is negative.")
        if self.ratio == 0:
            raise ModelError(f"{label}: with the ratio 0 it never turns. Leave it out.")
        if not isinstance(self.body, str):
            raise ModelError(f"{label}: {quoted(self.body)} is no name of a body or frame.")

    @property
    def direction(self) -> tuple[float, float, float]:
        """(3,) unit vector along the axis, in components of `body`."""
        largest = max(map(abs, self.axis))
        x, y, z = (component / largest for component in self.axis)
        length = math.hypot(x, y, z)
        return x / length, y / length, z / length

    @property
    def summary(self) -> str:
        """The rotor in one line, as `kanegen info` shows it."""
        ratio, inertia = factor_text(self.ratio), factor_text(self.inertia)
        where = f" in {self.body}" if self.body else ""
        return f"{self.name}: {inertia} kg m^2{where}, turns {ratio} times {self.freedom}"

    def map_numbers(self, change: Callable[[Number], Number]) -> Rotor:
        """Return the same rotor with `change` applied to its inertia and its ratio.

        Example:
            plain = rotor.map_numbers(value_of)  # parameters at their defaults
        """
        return replace(self, inertia=change(self.inertia), ratio=change(self.ratio))

    def as_table(self) -> dict[str, Any]:
        """Return the table `[[rotor]]` of a model file, defaults left out.

        Example:
            kg.Rotor("motor", "elbow", (0, 0, 1), 3.3e-5, 100.0).as_table()
        """
        table: dict[str, Any] = {"name": self.name, "freedom": self.freedom, "axis": self.axis}
        table["inertia"] = toml_number(self.inertia)
        if self.ratio != 1:
            table["ratio"] = toml_number(self.ratio)
        return table | ({"body": self.body} if self.body else {})


@dataclass(frozen=True)
class MountedRotor:
    """A rotor with what its names mean in a system.

    Attributes:
        rotor: The rotor.
        freedom: The freedom that it drives.
        body: Number of its carrier, 0 for the ground.
        frame: Name of the frame in which its axis is given; "" for the inertial frame.
    """

    rotor: Rotor
    freedom: Freedom
    body: int
    frame: str

    @property
    def direction(self) -> Vector:
        """(3,) unit vector along the axis, in components of its frame."""
        return self.rotor.direction


def check_freedoms(mounted: Sequence[MountedRotor], bodies: Sequence[Body]) -> None:
    """Make sure that every rotor drives a freedom whose rate is a speed, or follows from speeds.

    Raises:
        ModelError: If one drives another freedom; the message names it.
    """
    validation.unique("rotor name", [one.rotor.name for one in mounted])
    for one in mounted:
        body, label = bodies[one.freedom.body - 1], f"rotor {quoted(one.rotor.name)}"
        if not SPEED_KINDS[body.joint.speed_kinds[one.freedom.index]].is_rate:
            raise ModelError(
                f"{label}: the speeds of body {quoted(body.name)} are its angular velocity, so none is the "
                f"rate of {quoted(one.rotor.freedom)}. Keep angles and their rates there."
            )


def check_carriers(mounted: Sequence[MountedRotor], bodies: Sequence[Body], axes: Sequence[Any]) -> None:
    """Make sure that the inertia of every carrier contains that of its rotors.

    Args:
        mounted: The rotors.
        bodies: The bodies.
        axes: (3,) unit vector along the axis of each rotor, in components of its carrier.

    Raises:
        ModelError: If the inertia of a body is less than that of its rotors about some axis.
    """
    rest: dict[int, NDArray[np.float64]] = {}
    for one, axis in zip(mounted, axes, strict=True):
        if one.body:
            own = rest.get(one.body, np.array(map_numbers(bodies[one.body - 1].inertia, value_of)))
            rest[one.body] = own - value_of(one.rotor.inertia) * np.outer(axis, axis)
    for k, inertia in rest.items():
        moments = np.linalg.eigvalsh(inertia)
        if moments[0] < -validation.INERTIA_ROUNDING * np.abs(moments).max():
            raise ModelError(
                f"body {quoted(bodies[k - 1].name)}: its inertia is less than that of its rotors about their "
                "axes. Mass and inertia of a body include those of the rotors that it carries, as if they "
                "stood still."
            )


def mounted_rotors(
    rotors: Sequence[Rotor],
    bodies: Sequence[Body],
    freedom: Callable[[object, str], Freedom],
    carrier: Callable[[str, str], tuple[int, str]],
) -> tuple[MountedRotor, ...]:
    """Return rotors with what their names mean.

    Args:
        rotors: The rotors.
        bodies: The bodies.
        freedom: Function from a name and a label for messages to the freedom of that name.
        carrier: Function from a name and a label for messages to the body and the name of a frame.
    """
    found = []
    for rotor in rotors:
        label = f"rotor {quoted(rotor.name)}"
        driven = freedom(rotor.freedom, label)
        lower = bodies[driven.body - 1].lower
        default = (lower, bodies[lower - 1].name if lower else "")
        body, frame = carrier(rotor.body, label) if rotor.body else default
        found.append(MountedRotor(rotor, driven, body, frame))
    return tuple(found)


def permanent_name(freedom: Freedom, bodies: Sequence[Body]) -> str:
    """Return the name of a freedom that does not change when it is locked: `<body>.<freedom>`."""
    return f"{bodies[freedom.body - 1].name}.{FREEDOMS[freedom.index]}"


def _plain(label: str) -> Callable[[Number], float]:
    """Return a function that returns a number that is no parameter, for messages with a label."""

    def plain(value: Number) -> float:
        if not is_fixed(value):
            raise ModelError(f"{label}: a direction has no parameters.")
        return value_of(value)

    return plain
