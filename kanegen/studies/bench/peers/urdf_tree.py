"""A system as a URDF file, for peers that read no other format and have a gravity of their own.

Such a peer has gravity against its third axis, with a magnitude that nobody can change. The tree is turned so
that gravity points there, and lengths are in another unit, in which gravity has that magnitude. The peer
computes as much as before, and its results are converted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from xml.etree import ElementTree as xml

import numpy as np

from kanegen.errors import MissingError
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.reference.states import ActuatedStates
from kanegen.studies.bench.peers.joints import KINDS, NOTHING, Joint, Mass, Placement, single_joints
from kanegen.studies.bench.results import Results

_FAR = repr(1e9)
"""Limit of slides, which nothing reaches."""


@dataclass(frozen=True)
class UrdfTree:
    """A tree as text, and the unit of its lengths.

    Attributes:
        text: The URDF file; the name of a joint is the index of its coordinate in {x}.
        unit: What a metre is in the unit of length of the file.
        turns: (n,) 1 for coordinates that are angles, 0 for translations.
    """

    text: str
    unit: float
    turns: Floats

    def states(self, states: ActuatedStates) -> ActuatedStates:
        """Convert states to the unit of the file."""
        lengths = self.unit ** (1 - self.turns)
        return ActuatedStates(
            states.x * lengths, states.y * lengths, tau=states.tau * self.unit ** (1 + self.turns)
        )

    def results(self, theirs: Results) -> Results:
        """Convert [A], {f} and {ydot} from the unit of the file."""
        converted = {}
        for task, values in theirs.items():
            scaled = values / self.unit ** (1 - self.turns)
            if values.shape[1] > 1:  # [A] with {f} below it
                powers = self.unit**self.turns
                scaled = values / powers
                scaled[:, :-1] /= powers[:, None]
                scaled[:, -1] /= self.unit
            converted[task] = scaled
        return converted


def urdf_tree(system: System, gravity: float) -> UrdfTree:
    """Return a system as URDF for a program whose gravity has one magnitude.

    Args:
        system: The model.
        gravity: Magnitude of the program's gravity (m/s^2), against its third axis.

    Raises:
        MissingError: If the system has no gravity or has motors with inertia, which the format lacks.
    """
    ours = system.values().gravity
    size = float(np.linalg.norm(ours))
    if not size:
        raise MissingError("it cannot switch gravity off")
    joints = single_joints(system)
    if any(any(joint.armature) for joint in joints):
        raise MissingError("it knows no inertia of motors")
    unit, upright = gravity / size, Placement(_upright(ours / size), np.zeros(3))
    root = xml.Element("robot", name="tree")
    _add_inertial(xml.SubElement(root, "link", name="link0"), NOTHING, unit)
    for number, joint in enumerate(joints, start=1):
        placement = joint.placement if joint.parent else upright * joint.placement
        _add_joint(root, number, replace(joint, placement=placement), unit)
    turns = np.zeros(len(joints))
    for joint in joints:
        turns[joint.columns[0]] = KINDS.index(joint.kind) < 3
    return UrdfTree(xml.tostring(root, encoding="unicode"), unit, turns)


def _upright(down: Floats) -> Floats:
    """Return a (3, 3) rotation that takes the unit vector `down` to the negative third axis."""
    target = np.array([0.0, 0.0, -1.0])
    if np.array_equal(down, target):
        return np.eye(3)
    if np.allclose(down, -target, atol=1e-12):
        return np.diag([1.0, -1.0, -1.0])
    axis, cosine = np.cross(down, target), float(down @ target)
    skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    rotation: Floats = np.eye(3) + skew + skew @ skew / (1 + cosine)
    return rotation


def _add_joint(root: xml.Element, number: int, joint: Joint, unit: float) -> None:
    """Add a joint and the link beyond it."""
    index = KINDS.index(joint.kind)
    kind = "continuous" if index < 3 else "prismatic"
    element = xml.SubElement(root, "joint", name=str(joint.columns[0]), type=kind)
    xml.SubElement(element, "parent", link=f"link{joint.parent}")
    xml.SubElement(element, "child", link=f"link{number}")
    place = joint.placement
    xml.SubElement(
        element, "origin", xyz=_words(place.position * unit), rpy=_words(roll_pitch_yaw(place.rotation))
    )
    xml.SubElement(element, "axis", xyz=_words(np.eye(3)[index % 3]))
    limits = {} if index < 3 else {"lower": f"-{_FAR}", "upper": _FAR}
    xml.SubElement(element, "limit", {"effort": _FAR, "velocity": _FAR, **limits})
    _add_inertial(xml.SubElement(root, "link", name=f"link{number}"), joint.body, unit)


def _add_inertial(link: xml.Element, body: Mass, unit: float) -> None:
    """Add the mass, mass centre and central inertia of a body."""
    element = xml.SubElement(link, "inertial")
    xml.SubElement(element, "origin", xyz=_words(body.center * unit), rpy="0 0 0")
    xml.SubElement(element, "mass", value=repr(float(body.mass)))
    inertia = body.central_inertia * unit**2
    entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    xml.SubElement(element, "inertia", {name: repr(float(inertia[at])) for name, at in entries.items()})


def roll_pitch_yaw(rotation: Floats) -> Floats:
    """Return the three angles of URDF of a rotation, Rz(yaw) Ry(pitch) Rx(roll).

    Each angle is computed from the matrix with the former ones undone, so that it is as accurate where the
    pitch is a right angle.
    """
    yaw = float(np.arctan2(rotation[1, 0], rotation[0, 0]))
    c, s = np.cos(yaw), np.sin(yaw)
    pitch = np.arctan2(-rotation[2, 0], c * rotation[0, 0] + s * rotation[1, 0])
    roll = np.arctan2(s * rotation[0, 2] - c * rotation[1, 2], c * rotation[1, 1] - s * rotation[0, 1])
    return np.array([roll, pitch, yaw])


def _words(values: Floats | Sequence[float]) -> str:
    """Return numbers separated by spaces."""
    return " ".join(repr(float(value)) for value in np.ravel(values))
