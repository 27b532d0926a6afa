"""Reads the elements of a URDF file: links and joints as the file has them, each with its line."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, ReadError, quoted
from kanegen.model import right_angles
from kanegen.model.names import check_label
from kanegen.model.rotations import ZERO, Triple, dot, normalized, rotation_quaternion, rotation_rpy
from kanegen.readers.welding import Frame, Rigid
from kanegen.readers.xml import Element

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical", "ball")
BALLS = ("spherical", "ball")
"""Types of joints with three free angles, which are no part of URDF but of files in use."""

WITH_AXIS = ("revolute", "continuous", "prismatic", "planar")
WITH_LIMIT = ("revolute", "continuous", "prismatic")
UNLIMITED = 1e16
"""Smallest magnitude of a limit that stands for none, as in the files of SDFormat."""
UNNAMED = "robot"
"""Name of a robot that has none in its file."""

DEFAULT_AXIS: Triple = (1.0, 0.0, 0.0)

CANCELLED = 4 * sys.float_info.epsilon
"""An inertia of at most this many times m r^2, with r the distance of the mass centre from the link's origin,
is taken for zero. It is the rounding error that remains when a program moves the inertia of a point mass to
its centre, and often it is not even positive."""


@dataclass(frozen=True)
class Link:
    """A link.

    Attributes:
        name: Name in the file.
        rigid: Mass properties in the frame of the link.
        where: File and line.
    """

    name: str
    rigid: Rigid
    where: str


@dataclass(frozen=True)
class JointLimit:
    """The limits of the one coordinate of a joint.

    Attributes:
        lower: Smallest position (rad, m).
        upper: Largest position (rad, m).
        speed: Largest speed (rad/s, m/s).
        effort: Largest effort (N m, N).
        empty: Names of the attributes that leave nothing: no way, no speed or no effort. Programs write them
            for joints without limits, so they count as none.
    """

    lower: float = -math.inf
    upper: float = math.inf
    speed: float = math.inf
    effort: float = math.inf
    empty: tuple[str, ...] = ()

    @property
    def is_none(self) -> bool:
        """Whether the joint has no limit."""
        return self.lower == -math.inf and self.upper == self.speed == self.effort == math.inf


@dataclass(frozen=True)
class JointDynamics:
    """Viscous damping and Coulomb friction of a joint with one coordinate.

    Attributes:
        damping: Damping coefficient (N m s/rad, N s/m).
        friction: Magnitude of the friction (N m, N).
    """

    damping: float = 0.0
    friction: float = 0.0

    @property
    def is_none(self) -> bool:
        """Whether the joint has neither damping nor friction."""
        return not self.damping and not self.friction


@dataclass(frozen=True)
class Mimic:
    """The joint whose position another one follows: multiplier times its position, plus offset.

    Attributes:
        joint: Name of the joint that is followed.
        multiplier: Factor (1, m/rad or rad/m).
        offset: Position where that of the other joint is zero (rad, m).
        where: File and line.
    """

    joint: str
    multiplier: float
    offset: float
    where: str


@dataclass(frozen=True)
class RobotJoint:
    """A joint of a robot file.

    Attributes:
        name: Name in the file.
        kind: One of `JOINT_TYPES`.
        parent: Name of the lower link.
        child: Name of the upper link.
        origin: Frame of the child in the parent at joint position zero.
        axis: Unit vector, in child components.
        limit: Position, speed and effort at the most, infinite where the file has none.
        dynamics: Damping and friction, zero where the file has none.
        mimic: The joint that its position follows; None where it moves by itself.
        where: File and line.
    """

    name: str
    kind: str
    parent: str
    child: str
    origin: Frame
    axis: Triple
    mimic: Mimic | None
    where: str
    limit: JointLimit = field(default_factory=JointLimit)
    dynamics: JointDynamics = field(default_factory=JointDynamics)


@dataclass(frozen=True)
class Robot:
    """The parts of a robot file that the equations of motion need, in the order of the file.

    Attributes:
        name: Name of the robot, `UNNAMED` if the file has none.
        links: Links by name.
        joints: Joints by name.
        where: File and line of the root element.
    """

    name: str
    links: dict[str, Link]
    joints: dict[str, RobotJoint]
    where: str


def read_robot(top: Element, tolerance: float) -> Robot:
    """Return the robot of a document.

    Args:
        top: The root element, `<robot>`.
        tolerance: Largest distance (rad) of orientations from right angles that are made exact.

    Raises:
        ReadError: If an element is incomplete or has a bad number.
    """
    links = _unique([_link(element, tolerance) for element in top.all("link")], "link")
    if not links:
        raise top.error("the robot has no <link>.")
    joints = _unique([_joint(element, tolerance) for element in top.all("joint")], "joint")
    for joint in joints.values():
        for role, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in links:
                hint = did_you_mean(name, links)
                message = f"{role} link {quoted(name)} of joint {quoted(joint.name)} does not exist. {hint}"
                raise ReadError(f"{joint.where}: {message}")
    return Robot(_name(top) if top.attributes.get("name", "").strip() else UNNAMED, links, joints, top.where)


_Item = TypeVar("_Item", Link, RobotJoint)


def _unique(items: Sequence[_Item], kind: str) -> dict[str, _Item]:
    """Return items by name; a name that occurs twice is an error."""
    found: dict[str, _Item] = {}
    for item in items:
        if item.name in found:
            first = found[item.name].where
            raise ReadError(
                f"{item.where}: {kind} {quoted(item.name)} exists already, at {first}. Rename one."
            )
        found[item.name] = item
    return found


def _name(element: Element) -> str:
    """Return the name of a robot, a link or a joint, without blanks around it."""
    name = element.text("name")
    try:
        return check_label(name, f"name of this <{element.tag}>")
    except ModelError as error:
        raise element.error(str(error)) from None


def _link(element: Element, tolerance: float) -> Link:
    """Return the link of an element."""
    name = _name(element)
    inertial = element.optional("inertial")
    return Link(name, _rigid(inertial, tolerance) if inertial else Rigid(), element.where)


def _rigid(inertial: Element, tolerance: float) -> Rigid:
    """Return the mass properties of an `<inertial>` element in the frame of the link."""
    mass = inertial.child("mass")
    kilograms = mass.number("value")
    if kilograms < 0:
        raise mass.error(f"mass {quoted(kilograms)} kg is negative.")
    entries = inertial.child("inertia")
    xx, yy, zz, xy, xz, yz = (entries.number(f"i{name}") for name in ("xx", "yy", "zz", "xy", "xz", "yz"))
    place = origin_of(inertial, tolerance)
    offset = kilograms * dot(place.position, place.position)
    if max(map(abs, (xx, yy, zz, xy, xz, yz))) <= CANCELLED * offset:
        return Rigid(kilograms, place.position)
    return Rigid(kilograms, ZERO, ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))).resolved_in(place)


def _joint(element: Element, tolerance: float) -> RobotJoint:
    """Return the joint of an element."""
    name, kind = _name(element), element.text("type")
    if kind not in JOINT_TYPES:
        hint = did_you_mean(kind, JOINT_TYPES)
        raise element.error(f"joint {quoted(name)} has the unknown type {quoted(kind)}. {hint}")
    return RobotJoint(
        name=name,
        kind=kind,
        parent=element.child("parent").text("link"),
        child=element.child("child").text("link"),
        origin=origin_of(element, tolerance),
        axis=_axis(element, tolerance) if kind in WITH_AXIS else DEFAULT_AXIS,
        mimic=_mimic(element),
        where=element.where,
        limit=_limit(element, kind) if kind in WITH_LIMIT else JointLimit(),
        dynamics=_dynamics(element) if kind in WITH_LIMIT else JointDynamics(),
    )


def _mimic(element: Element) -> Mimic | None:
    """Return what the `<mimic>` of a joint says."""
    mimic = element.optional("mimic")
    if mimic is None:
        return None
    attributes = mimic.attributes
    multiplier = mimic.number("multiplier") if "multiplier" in attributes else 1.0
    offset = mimic.number("offset") if "offset" in attributes else 0.0
    if multiplier == 0:
        raise mimic.error(
            "<mimic multiplier>: 0 leaves no motion. Make the joint fixed, with its offset in its <origin>."
        )
    return Mimic(mimic.text("joint"), multiplier, offset, mimic.where)


def _limit(element: Element, kind: str) -> JointLimit:
    """Return the limits of a joint; a continuous one has none of its position.

    Raises:
        ReadError: If a limit is no number, the lower position exceeds the upper one, or a speed or an effort
            is negative.
    """
    limit = element.optional("limit")
    if limit is None:
        return JointLimit()
    words = ("lower", "upper", "velocity", "effort")
    lower, upper, speed, effort = (_end(limit, word) for word in words)
    if lower > upper:
        raise limit.error(f"<limit>: lower={lower!r} exceeds upper={upper!r}. Exchange them.")
    for word, value in (("velocity", speed), ("effort", effort)):
        if value < 0:
            raise limit.error(f"<limit {word}>: {value!r} is negative. Write the largest magnitude.")
    empty = tuple(word for word, value in (("velocity", speed), ("effort", effort)) if value == 0)
    if kind == "continuous":
        lower, upper = -math.inf, math.inf
    elif lower == upper:
        lower, upper, empty = -math.inf, math.inf, ("lower and upper", *empty)
    return JointLimit(lower, upper, speed or math.inf, effort or math.inf, empty)


def _dynamics(element: Element) -> JointDynamics:
    """Return what the `<dynamics>` of a joint says.

    Raises:
        ReadError: If damping or friction is negative.
    """
    dynamics = element.optional("dynamics")
    if dynamics is None:
        return JointDynamics()
    damping, friction = (
        dynamics.number(name) if name in dynamics.attributes else 0.0 for name in ("damping", "friction")
    )
    for name, value in (("damping", damping), ("friction", friction)):
        if value < 0:
            raise dynamics.error(f"<dynamics {name}>: {value!r} is negative; it would drive the joint.")
    return JointDynamics(damping, friction)


def _end(limit: Element, word: str) -> float:
    """Return an attribute of a limit; one that is absent is 0 for a position, otherwise infinity."""
    if word not in limit.attributes:
        return math.inf if word in ("velocity", "effort") else 0.0
    infinite = {"inf": math.inf, "+inf": math.inf, "-inf": -math.inf}
    text = limit.text(word).lower()
    value = infinite[text] if text in infinite else limit.number(word)
    return math.copysign(math.inf, value) if abs(value) >= UNLIMITED else value


def origin_of(element: Element, tolerance: float) -> Frame:
    """Return the frame that the `<origin>` of an element describes."""
    origin = element.optional("origin")
    if origin is None:
        return Frame()
    if "quat_xyzw" not in origin.attributes:
        roll, pitch, yaw = (right_angles.angle(value, tolerance) for value in origin.vector("rpy"))
        return Frame(origin.vector("xyz"), rotation_rpy((roll, pitch, yaw)))
    if "rpy" in origin.attributes:
        raise origin.error("<origin> has both rpy and quat_xyzw. Keep one.")
    x, y, z, w = origin.numbers("quat_xyzw", 4)
    if not any((x, y, z, w)):
        raise origin.error("<origin quat_xyzw>: a quaternion of zeros is no rotation.")
    return Frame(origin.vector("xyz"), right_angles.rotation(rotation_quaternion(x, y, z, w), tolerance))


def _axis(element: Element, tolerance: float) -> Triple:
    """Return the unit vector of a joint's axis, +x by default."""
    axis = element.optional("axis")
    if axis is None:
        return DEFAULT_AXIS
    x, y, z = axis.numbers("xyz", 3)
    if not any((x, y, z)):
        raise axis.error("the axis is zero: it has no direction.")
    return right_angles.direction(normalized((x, y, z)), tolerance)
