"""A system as MuJoCo's XML, in kanegen's coordinates.

A body of MuJoCo has any number of hinges and slides, each given by where it stands in the body's frame while
all of them are at zero, and must have a mass. So a joint with nothing beyond it is given to the next one's
body.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as xml

import numpy as np

from kanegen.errors import MissingError
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.studies.bench.peers.joints import HERE, KINDS, Joint, Placement, single_joints

_WITHOUT = ("constraint", "contact", "actuation", "sensor", "spring", "damper", "island")


@dataclass(frozen=True)
class Link:
    """The joints of one body, from the ground outwards, and the link on which it hangs, counted from 1."""

    parent: int
    joints: tuple[Joint, ...]


def mjcf(system: System) -> str:
    """The XML; a joint is called after its place in {x}.

    Raises:
        MissingError: If a body that moves has no mass.
    """
    root = xml.Element("mujoco")
    xml.SubElement(root, "compiler", angle="radian", autolimits="false", inertiafromgeom="false")
    option = xml.SubElement(root, "option", gravity=_words(system.values().gravity))
    xml.SubElement(option, "flag", dict.fromkeys(_WITHOUT, "disable"))
    elements = [xml.SubElement(root, "worldbody")]
    for link in links(single_joints(system)):
        elements.append(_body(elements[link.parent], link))
    return xml.tostring(root, encoding="unicode")


def links(joints: Sequence[Joint]) -> list[Link]:
    """The joints, those with nothing beyond them together with the next one."""
    outer = [
        [i for i, other in enumerate(joints) if other.parent == place + 1] for place in range(len(joints))
    ]
    found: list[Link] = []
    number = {0: 0}  # of a joint's link
    for place, joint in enumerate(joints):
        if not joint.body.mass:
            if len(outer[place]) != 1:
                raise MissingError("MuJoCo takes no moving body without mass")
            continue
        together = [joint]
        while together[0].parent and not joints[together[0].parent - 1].body.mass:
            together.insert(0, joints[together[0].parent - 1])
        found.append(Link(number[together[0].parent], tuple(together)))
        number[place + 1] = len(found)
    return found


def _body(parent: xml.Element, link: Link) -> xml.Element:
    inner = [HERE]  # of each joint, the last one first: the body's frame in the frame beyond the joint
    for joint in reversed(link.joints):
        inner.insert(0, joint.placement * inner[0])
    frame, body = inner[0], link.joints[-1].body
    element = xml.SubElement(parent, "body", pos=_words(frame.position), xyaxes=_axes(frame.rotation))
    inertia = body.central_inertia
    full = [inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    centre = _words(body.centre)
    xml.SubElement(element, "inertial", pos=centre, mass=repr(float(body.mass)), fullinertia=_words(full))
    for joint, beyond in zip(link.joints, inner[1:], strict=True):
        _joint(element, joint, beyond.inverse)
    return element


def _joint(element: xml.Element, joint: Joint, place: Placement) -> None:
    """A joint whose frame stands at `place` in the body's."""
    index = KINDS.index(joint.kind)
    xml.SubElement(
        element,
        "joint",
        name=str(joint.columns[0]),
        type="hinge" if index < 3 else "slide",
        axis=_words(place.rotation[:, index % 3]),
        pos=_words(place.position),
    )


def _axes(rotation: Floats) -> str:
    return f"{_words(rotation[:, 0])} {_words(rotation[:, 1])}"


def _words(values: Floats | list[float]) -> str:
    return " ".join(repr(float(value)) for value in np.ravel(values))
