"""The peer MuJoCo: its library and headers come from the Python package `mujoco`, which is not imported.

The system is handed over as MuJoCo's XML, in the coordinates of kanegen. A body of MuJoCo has any number of
hinges and slides, each given by its place in the frame of the body while all of them are at zero, and must
have a mass. So a joint without a body beyond it belongs to the body of the next joint.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree as xml

import numpy as np

from kanegen.errors import MissingError
from kanegen.extras import require
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.joints import HERE, KINDS, Joint, Placement, single_joints
from kanegen.studies.bench.peers.problem import DERIVATIVES_TASKS, SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.results import BY_DIFFERENCES, Task
from kanegen.studies.bench.settings import AS_SHIPPED

MUJOCO = "MuJoCo"
"""Name of the participant."""


def builders(problem: Problem) -> Builders:
    """Yield the name and the builder of the only participant."""
    yield MUJOCO, functools.partial(_build, problem)


def _build(problem: Problem) -> list[Participant]:
    """Build the only participant, ready to run."""
    folder = require("mujoco")
    library = mujoco_library(folder)
    flags = (*AS_SHIPPED.flags, f"-I{folder / 'include'}")
    libraries = (str(library), f"-Wl,-rpath,{library.parent}", "-lm")
    program = compiled("mujoco", {"mujoco.c": driver("mujoco.c")}, flags, libraries)
    command, states = (str(program),), problem.states_file
    model = problem.write("model.xml", mjcf(problem.system, problem.has_derivatives))
    arguments: tuple[str, ...] = (model,)
    tasks: tuple[Task, ...] = SINGLE_STATE_TASKS
    if problem.has_derivatives:
        arguments, tasks = (model, "derivatives"), (*tasks, *map(_by_differences, DERIVATIVES_TASKS))
    return [Participant(MUJOCO, AS_SHIPPED, command, states, tasks, arguments)]


def _by_differences(task: Task) -> Task:
    """Return the task that approximates derivatives by differences."""
    return replace(task, tolerance=BY_DIFFERENCES)


def mujoco_library(folder: Path) -> Path:
    """Return the path of MuJoCo's shared library in the package folder."""
    found = sorted([*folder.glob("libmujoco.so*"), *folder.glob("libmujoco*.dylib")])
    if not found:
        raise MissingError(f"the Python package mujoco has no libmujoco in {folder}")
    return found[0]


_DISABLED = ("constraint", "contact", "sensor", "spring", "damper", "island")
"""Features of MuJoCo that a tree of rigid bodies does not need."""


@dataclass(frozen=True)
class Link:
    """A body of MuJoCo.

    Attributes:
        parent: Number of the link that carries it, from 1; 0 is the ground.
        joints: Joints of the body from the ground outwards.
    """

    parent: int
    joints: tuple[Joint, ...]


def mjcf(system: System, motors: bool = False) -> str:
    """Return the system as MuJoCo's XML; the name of a joint is the index of its coordinate in {x}.

    Args:
        system: The model.
        motors: Whether every joint has a motor, whose force is added to the others where MuJoCo makes a step.

    Raises:
        MissingError: If a body that moves has no mass.
    """
    root = xml.Element("mujoco")
    xml.SubElement(root, "compiler", angle="radian", autolimits="false", inertiafromgeom="false")
    option = xml.SubElement(root, "option", gravity=_words(system.values().gravity))
    xml.SubElement(
        option, "flag", dict.fromkeys(_DISABLED if motors else (*_DISABLED, "actuation"), "disable")
    )
    elements = [xml.SubElement(root, "worldbody")]
    for link in links(single_joints(system)):
        elements.append(_body(elements[link.parent], link))
    if motors:
        names = [joint.attrib["name"] for joint in root.iter("joint")]
        actuator = xml.SubElement(root, "actuator")
        for name in names:
            xml.SubElement(actuator, "motor", joint=name)
    return xml.tostring(root, encoding="unicode")


def links(joints: Sequence[Joint]) -> list[Link]:
    """Group joints into links: a joint without a body beyond it belongs to the link of the next joint."""
    outer = [
        [i for i, other in enumerate(joints) if other.parent == place + 1] for place in range(len(joints))
    ]
    found: list[Link] = []
    number = {0: 0}  # of the link, by number of the joint
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
    """Add a body with its joints below `parent` and return its element."""
    inner = [HERE]  # the frame of the body in the frame beyond each joint
    for joint in reversed(link.joints):
        inner.insert(0, joint.placement * inner[0])
    frame, body = inner[0], link.joints[-1].body
    element = xml.SubElement(parent, "body", pos=_words(frame.position), xyaxes=_axes(frame.rotation))
    inertia = body.central_inertia
    full = [inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    center = _words(body.center)
    xml.SubElement(element, "inertial", pos=center, mass=repr(float(body.mass)), fullinertia=_words(full))
    for joint, beyond in zip(link.joints, inner[1:], strict=True):
        _joint(element, joint, beyond.inverse)
    return element


def _joint(element: xml.Element, joint: Joint, place: Placement) -> None:
    """Add a joint whose frame is at `place` in the frame of the body."""
    index = KINDS.index(joint.kind)
    xml.SubElement(
        element,
        "joint",
        name=str(joint.columns[0]),
        type="hinge" if index < 3 else "slide",
        axis=_words(place.rotation[:, index % 3]),
        pos=_words(place.position),
        armature=_words(joint.armature),
    )


def _axes(rotation: Floats) -> str:
    """Return the first two columns of a rotation as MuJoCo's `xyaxes`."""
    return f"{_words(rotation[:, 0])} {_words(rotation[:, 1])}"


def _words(values: Floats | Sequence[float]) -> str:
    """Return numbers separated by spaces."""
    return " ".join(repr(float(value)) for value in np.ravel(values))
