"""The elements and attributes of URDF, and what becomes of others that stand in a file.

An element that kanegen does not know, or that stands in the wrong place, may hold mass or motion. If it does,
reading on would give the equations of another robot, so it is an error. Otherwise it is listed in a warning.
Elements that say nothing about the motion, such as `<visual>` and `<transmission>`, are passed over.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kanegen.errors import QUOTED, excerpt, quoted
from kanegen.readers.xml import Element


@dataclass(frozen=True)
class Vocabulary:
    """What may stand in an element.

    Attributes:
        attributes: Names of the attributes.
        children: Names of the elements inside that are read.
        passed_over: Names of elements inside that say nothing about the motion.
        moves: Whether the element places or moves something, so that any other content is an error.
        has_more: Whether further attributes have no effect.
    """

    attributes: tuple[str, ...] = ()
    children: tuple[str, ...] = ()
    passed_over: tuple[str, ...] = ()
    moves: bool = False
    has_more: bool = False


_PASSED_OVER_IN_LINK = (
    *("visual", "collision", "collision_checking", "self_collision_checking", "self_filter"),
    *("contact", "surface", "sensor", "material", "kinematic", "gravity"),
)
_MATRIX = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

ELEMENTS = {
    "robot": Vocabulary(
        ("name", "version"),
        ("link", "joint"),
        ("material", "gazebo", "transmission", "sensor", "ros2_control", "mujoco"),
    ),
    "link": Vocabulary(
        ("name", "type"),
        ("inertial",),
        _PASSED_OVER_IN_LINK,
    ),
    "joint": Vocabulary(
        ("name", "type", "dont_collapse"),
        ("origin", "axis", "parent", "child", "mimic", "limit", "dynamics"),
        ("calibration", "safety_controller", "hardwareInterface"),
    ),
    "inertial": Vocabulary((), ("origin", "mass", "inertia")),
    "origin": Vocabulary(("xyz", "rpy", "quat_xyzw"), moves=True),
    "axis": Vocabulary(("xyz",), moves=True),
    "mass": Vocabulary(("value",), moves=True),
    "inertia": Vocabulary(_MATRIX, moves=True),
    "parent": Vocabulary(("link",), moves=True),
    "child": Vocabulary(("link",), moves=True),
    "mimic": Vocabulary(("joint", "multiplier", "offset"), moves=True),
    "limit": Vocabulary(("lower", "upper", "velocity", "effort"), has_more=True),
    "dynamics": Vocabulary(("damping", "friction")),
}
"""The elements whose content matters, by name; each occurs in one place or with one meaning."""

MASSES = ("inertial", "mass", "inertia")
"""Elements that give mass, wherever they stand."""

CONNECTIONS = ("parent", "child")
"""Elements that join links, wherever they stand."""

PLACES = ("xyz", "rpy", "quat_xyzw")
"""Attributes that place or direct something."""

REMARKS = {
    "loop_joint": "the loop stays open",
    "joint_properties": "damping and friction stand in <dynamics>",
}
"""What it means that an element is not read, by its name."""

OF_GAZEBO = {
    "turnGravityOff": ("1", "true"),
    "gravity": ("0", "false"),
    "static": ("1", "true"),
    "kinematic": ("1", "true"),
}
"""Extensions for Gazebo that change the motion, with the values that do so."""

SPRINGS_OF_GAZEBO = ("springStiffness", "dampingFactor")
"""Extensions for Gazebo that change the motion unless they are 0."""

NEAR = 0.75
"""Least likeness of a misspelt name to one of the vocabulary, as `difflib` measures it."""

MOST_LINES = 3
"""Largest number of lines that a warning gives for one kind of content."""


@dataclass(frozen=True)
class Unread:
    """Content that is not read.

    Attributes:
        what: The content in words, the same for all of its kind.
        line: Its line.
    """

    what: str
    line: int


def unread(robot: Element) -> tuple[Unread, ...]:
    """Return the content of a robot that is not read although it is not known to be without effect.

    Raises:
        ReadError: If the file is for xacro, or unknown content holds mass or motion; the message has the
            line of this content.
    """
    _refuse_xacro(robot)
    found = [*_content(robot)]
    for element in robot.children:
        if element.tag in ("link", "joint"):
            found += _content(element)
        if element.tag in ("link", "gazebo"):
            found += _extensions(element)
    return tuple(found)


def listed(found: Sequence[Unread]) -> str:
    """Return content that is not read as one list of kinds, each with its first lines."""
    lines: dict[str, list[int]] = {}
    for one in found:
        lines.setdefault(one.what, []).append(one.line)
    return ", ".join(f"{what} ({_lines(places)})" for what, places in lines.items())


def _lines(places: Sequence[int]) -> str:
    """Return the first of some lines, and the number of the others."""
    if len(places) == 1:
        return f"line {places[0]}"
    shown, left_out = ", ".join(map(str, places[:MOST_LINES])), len(places) - MOST_LINES
    return f"lines {shown} and {left_out} more" if left_out > 0 else f"lines {shown}"


def _refuse_xacro(robot: Element) -> None:
    """Raise a `ReadError` at the first element that belongs to xacro, whichever prefix the file gives it."""
    prefixes = {"xacro"}
    for element in robot.walk():
        for name, value in element.attributes.items():
            if name.startswith("xmlns:") and "xacro" in value.lower():
                prefixes.add(name.removeprefix("xmlns:"))
        prefix, colon, _ = element.tag.partition(":")
        if colon and prefix in prefixes:
            raise element.error(f"<{element.shown}> is a xacro instruction. Run xacro on the file first.")


def _content(element: Element) -> Iterator[Unread]:
    """Yield the unknown content of an element and of known elements inside; see `unread`."""
    known = ELEMENTS[element.tag]
    yield from _attributes(element, known)
    if element.content:
        text = f"text {quoted(element.content)}"
        if known.moves:
            raise element.error(f"{text} in <{element.tag}> would be lost. {_spelt(element.tag)}")
        yield Unread(f"text in <{element.tag}>", element.line)
    for child in element.children:
        if child.tag in known.children:
            if element.tag != "robot":
                yield from _content(child)
        elif child.tag in known.passed_over:
            _refuse_mass(element, child)
        elif not _says_zero(child):
            _refuse_loss(element, child)
            remark = REMARKS.get(child.tag)
            what = f"<{child.shown}> in <{element.tag}>" + (f": {remark}" if remark else "")
            yield Unread(what, child.line)


def _attributes(element: Element, known: Vocabulary) -> Iterator[Unread]:
    """Yield the unknown attributes of an element; one that may place or move something is an error."""
    for name, value in element.attributes.items():
        is_foreign = name.startswith("xmlns") or (":" in name and not known.moves)
        if name in known.attributes or is_foreign or _is_zero(value):
            continue
        shown = f'{excerpt(name, QUOTED)}="{excerpt(value, QUOTED)}"'
        if name.lower() in known.attributes:
            raise element.error(f"<{element.tag} {shown}>: write {name.lower()} in lower case.")
        if name.lower() in (*MASSES, *CONNECTIONS, *PLACES, "axis", "origin", "mimic"):
            raise element.error(
                f"<{element.tag} {shown}>: this attribute would be lost.{_place(name.lower())}"
            )
        if known.has_more:
            continue
        if known.moves:
            raise element.error(f"<{element.tag} {shown}> would be lost. {_spelt(element.tag)}")
        yield Unread(f"attribute {excerpt(name, QUOTED)} of <{element.tag}>", element.line)


def _refuse_mass(element: Element, child: Element) -> None:
    """Raise a `ReadError` if an element of a link or a joint that is passed over holds mass or motion."""
    lost = {"link": MASSES, "joint": (*MASSES, *CONNECTIONS, "origin", "axis")}.get(element.tag, ())
    for inner in child.walk():
        if inner.tag.lower() in lost:
            place = _place(inner.tag.lower())
            raise inner.error(f"<{inner.shown}> in <{child.tag}> would be lost.{place}")


def _refuse_loss(element: Element, child: Element) -> None:
    """Raise a `ReadError` if an unknown element holds mass or motion, or is a misspelt one that does."""
    known = ELEMENTS[element.tag]
    if child.tag.lower() in known.children:
        raise child.error(f"<{child.shown}>: write <{child.tag.lower()}> in lower case.")
    if child.tag.lower() in ELEMENTS.keys() - {"robot", "dynamics", "limit"}:
        raise child.error(f"<{child.shown}> in <{element.tag}> would be lost.{_place(child.tag.lower())}")
    hint = _hint(child, known)
    for inner in child.walk():
        name = inner.tag.lower()
        if name in MASSES or (element.tag == "robot" and name in CONNECTIONS):
            what = f"<{child.shown}> is no part of URDF: <{inner.shown}> in it"
            raise inner.error(f"{what} would be lost.{_place(name)}")
        if element.tag in ("joint", "inertial") and any(place in inner.attributes for place in PLACES):
            raise child.error(
                f"<{child.shown}> in <{element.tag}> is no part of URDF and would be lost.{hint}"
            )
    if known.moves:
        hint = f" {_spelt(element.tag)}"
    if hint:
        raise child.error(f"<{child.shown}> in <{element.tag}> is no part of URDF and would be lost.{hint}")


def _hint(child: Element, known: Vocabulary) -> str:
    """Return a sentence with the element of motion or mass that an unknown one resembles, or ""."""
    names = [name for name in known.children if name not in ("limit", "dynamics")]
    near = difflib.get_close_matches(child.tag.lower(), names, n=1, cutoff=NEAR)
    return f" Did you mean <{near[0]}>?" if near else ""


def _place(tag: str) -> str:
    """Return a sentence that says where an element belongs, "" for what is no element."""
    owners = " or ".join(f"<{name}>" for name, known in ELEMENTS.items() if tag in known.children)
    return f" <{tag}> is an element inside {owners}." if owners else ""


def _spelt(tag: str) -> str:
    """Return a sentence with the attributes of an element."""
    names = [name for name in ELEMENTS[tag].attributes if name != "quat_xyzw"]
    attributes = " ".join(f'{name}="..."' for name in names)
    return f"Write <{tag} {attributes}/>."


def _says_zero(element: Element) -> bool:
    """Return whether an element has no effect, because it holds attributes alone and all of them are zero."""
    values = element.attributes.values()
    return bool(values) and not element.children and not element.content and all(map(_is_zero, values))


def _is_zero(value: str) -> bool:
    """Return whether a value has no effect, because it is blank or holds zeros alone."""
    try:
        return not any(float(word) for word in value.split())
    except ValueError:
        return False


def _extensions(element: Element) -> Iterator[Unread]:
    """Yield the extensions for Gazebo in an element that change the motion, or give mass to a link."""
    for child in element.children:
        if element.tag == "gazebo" and _gives_mass(child):
            yield Unread(f"<inertial> in <{element.tag}>", child.line)
            continue
        value = child.content or child.attributes.get("value", "")
        changes = value.lower() in OF_GAZEBO.get(child.tag, ())
        if changes or (child.tag in SPRINGS_OF_GAZEBO and not _is_zero(value)):
            yield Unread(f"<{child.tag}> in <{element.tag}>", child.line)


def _gives_mass(extension: Element) -> bool:
    """Return whether an extension for Gazebo, other than a plugin, is or holds an `<inertial>`."""
    return extension.tag != "plugin" and any(inner.tag == "inertial" for inner in extension.walk())
