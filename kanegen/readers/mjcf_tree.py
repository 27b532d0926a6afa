"""The bodies and frames of a compiled MJCF model, and the names of its coordinates and speeds.

Bodies with several joints may need further bodies without mass between them. A body without a joint is welded
to its parent. Each body and each site is a frame under its own name, where it is in the file.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from kanegen.model import right_angles
from kanegen.model.body import Body
from kanegen.model.coordinates import ANGLES, FREEDOMS, QUATERNION, SPEED_KINDS
from kanegen.model.frame import GROUND as INERTIAL
from kanegen.model.frame import Frame as NamedFrame
from kanegen.model.joint import Joint
from kanegen.model.limits import Limits
from kanegen.model.rotations import transpose
from kanegen.readers.mjcf_compiled import ROUNDING, Compiled, MjcfJoint
from kanegen.readers.mjcf_joints import JointGroup, joint_groups
from kanegen.readers.welding import Frame, Rigid, weld

GROUND = 0

TRANSLATIONS = FREEDOMS[3:]
OMEGA = tuple(kind.name for kind in SPEED_KINDS if not kind.is_rate)


@dataclass(frozen=True)
class MjcfTree:
    """The tree of a compiled model in kanegen's terms.

    Attributes:
        bodies: The bodies, lower ones first.
        frames: Frames of bodies, where they are not those of the model, and of sites.
        coordinates: (nq,) name in kanegen of each element of MuJoCo's `qpos`.
        speeds: (nv,) name in kanegen of each element of MuJoCo's `qvel`.
        moving: Names of the frames of the bodies that move, by their number in MuJoCo.
        sites: Names of the frames of the sites, by their number in MuJoCo.
        renamed: Names of the file that are taken already, each with the one that it has instead.
    """

    bodies: tuple[Body, ...]
    frames: tuple[NamedFrame, ...]
    coordinates: tuple[str, ...]
    speeds: tuple[str, ...]
    moving: dict[int, str]
    sites: dict[int, str]
    renamed: dict[str, str]


def mjcf_tree(model: Compiled) -> MjcfTree:
    """Return the tree of a compiled model.

    Raises:
        ModelError: If a body cannot exist.
    """
    names = _Names(model)
    builder = _Builder(model, names)
    for body in range(1, int(model.model.nbody)):
        builder.add(body)
    coordinates: list[str] = []
    speeds: list[str] = []
    for body in range(1, int(model.model.nbody)):
        for joint in model.joints(body):
            coordinates += names.coordinates(joint, body)
            speeds += names.speeds(joint, body)
    return MjcfTree(
        bodies=tuple(builder.bodies()),
        frames=tuple(builder.frames()),
        coordinates=tuple(coordinates),
        speeds=tuple(speeds),
        moving={body: names.bodies[body] for body in builder.moving()},
        sites=names.sites,
        renamed=names.renamed,
    )


def body_names(model: Compiled) -> list[str]:
    """Return the name of the frame of each body of a compiled model; that of the world is "ground".

    Example:
        body_names(compiled(ModelFile(Path("robot.xml"))))[1]
    """
    return [INERTIAL, *_Names(model).bodies[1:]]


class _Names:
    """Names of bodies, joints and sites in kanegen.

    Attributes:
        bodies: Name of each body by its number; that of the world is not used.
        joints: Name of each joint by its number.
        sites: Name of each site that has a name in the file, by its number.
        renamed: Names of the file that are changed, each with its new one.
    """

    def __init__(self, model: Compiled) -> None:
        self.renamed: dict[str, str] = {}
        compiled = model.model
        self.bodies = self._unique(model.names("body", range(int(compiled.nbody))), set())
        self.joints = self._unique(model.names("joint", range(int(compiled.njnt))), set())
        named = [site for site in range(int(compiled.nsite)) if compiled.site(site).name]
        sites = self._unique(model.names("site", named), set(self.bodies), "_site")
        self.sites = dict(zip(named, sites, strict=True))

    def _unique(self, names: Iterable[str], taken: set[str], suffix: str = "") -> list[str]:
        """Return names, each of its own and none of them `taken`, with `suffix` where it would be."""
        found = []
        for name in names:
            label, number = name, 1
            if label in taken:
                label += suffix
            base = label
            while label in taken:
                number += 1
                label = f"{base}_{number}"
            taken.add(label)
            found.append(label)
            if label not in (name, name + suffix):
                self.renamed[name] = label
        return found

    def coordinates(self, joint: MjcfJoint, body: int) -> Iterator[str]:
        """Yield the names of the coordinates of a joint on a body in MuJoCo's order."""
        own = {"free": (*TRANSLATIONS, *QUATERNION), "ball": QUATERNION}.get(joint.type)
        yield from (f"{self.bodies[body]}.{one}" for one in own) if own else (self.joints[joint.number],)

    def speeds(self, joint: MjcfJoint, body: int) -> Iterator[str]:
        """Yield the names of the speeds of a joint on a body in MuJoCo's order."""
        own = {"free": (*TRANSLATIONS, *OMEGA), "ball": OMEGA}.get(joint.type)
        yield from (f"{self.bodies[body]}.{one}" for one in own) if own else (self.joints[joint.number],)


@dataclass(frozen=True)
class _Moving:
    """A body of kanegen: one that the file has, or one without mass between two of its joints.

    Attributes:
        name: Name of the body.
        lower: Number of the lower body; `GROUND` for none.
        joint: The joint below it.
        parts: Mass properties of the bodies of the file that belong to it, in its frame.
    """

    name: str
    lower: int
    joint: Joint
    parts: list[Rigid] = field(default_factory=list)


class _Builder:
    """The bodies of a compiled model, added parents first."""

    def __init__(self, model: Compiled, names: _Names) -> None:
        self._model, self._names = model, names
        self._moving: list[_Moving] = []
        self._places: list[tuple[int, Frame]] = [(GROUND, Frame())]  # of each body of the file so far

    def add(self, body: int) -> None:
        """Add a body of the file by its number."""
        number, frame = self._places[self._model.parent(body)]
        frame = frame.then(self._model.place(body))
        groups = list(joint_groups(self._model.joints(body)))
        for group in groups:
            joints = [self._names.joints[joint.number] for joint in group.joints]
            name = self._names.bodies[body]
            label = name if group is groups[-1] else f"{name}:{'-'.join(joints)}"
            below = Frame() if group.joints[0].type == "free" else frame
            self._moving.append(_Moving(label, number, _joint(group, joints, below)))
            number, frame = len(self._moving), group.after
        self._places.append((number, frame))
        if number != GROUND:
            self._moving[number - 1].parts.append(self._model.rigid(body).resolved_in(frame))

    def moving(self) -> Iterator[int]:
        """Yield the numbers of the bodies of the file that are not welded to the ground."""
        return (body for body, (number, _) in enumerate(self._places) if number != GROUND)

    def bodies(self) -> Iterator[Body]:
        """Yield the bodies of the system."""
        for one in self._moving:
            rigid = weld(one.parts)
            yield Body(one.name, one.lower, rigid.mass, rigid.inertia, rigid.center, one.joint)

    def frames(self) -> Iterator[NamedFrame]:
        """Yield the frames of the bodies that are not those of the model, then the frames of the sites."""
        moving = {one.name: k for k, one in enumerate(self._moving, start=1)}
        for body, (number, frame) in enumerate(self._places[1:], start=1):
            named = _named(self._names.bodies[body], number, frame)
            if moving.get(named.name) != number or not named.is_trivial:
                yield named
        for site, name in self._names.sites.items():
            number, frame = self._places[int(self._model.model.site_bodyid[site])]
            yield _named(name, number, frame.then(self._model.site(site)))


def _named(name: str, body: int, frame: Frame) -> NamedFrame:
    """Return a frame with a name."""
    orientation = right_angles.rotation(transpose(frame.rotation), ROUNDING)
    return NamedFrame(name, body, frame.position, orientation)


def _joint(group: JointGroup, names: list[str], place: Frame) -> Joint:
    """Return the joint of a group.

    Args:
        group: Joints of the file that are one joint.
        names: Their names.
        place: The frame of the body of the file before these joints, in the lower body.
    """
    frame = place.then(group.frame)
    named = dict(zip(group.indices, names, strict=False))
    is_alone = len(names) == 1
    return Joint(
        position=frame.position,
        orientation=right_angles.rotation(transpose(frame.rotation), ROUNDING),
        free=group.free,
        name=names[0] if is_alone else "",
        sequence=group.sequence,
        coordinates=group.coordinates,
        freedom_names=tuple("" if is_alone else named.get(i, "") for i in range(len(FREEDOMS))),
        limits=_limits(group),
        armature=_armature(group),
    )


def _armature(group: JointGroup) -> tuple[float, ...]:
    """Return (6,) the reflected inertias of the freedoms of a group (kg m^2, kg)."""
    found = [0.0] * len(FREEDOMS)
    for index, joint in zip(group.indices, group.joints, strict=False):
        found[index] = joint.armature
    for index in ANGLES if group.joints[-1].type == "ball" else ():
        found[index] = group.joints[-1].armature
    return (group.joints[0].armature,) * len(FREEDOMS) if group.joints[0].type == "free" else tuple(found)


def _limits(group: JointGroup) -> Limits:
    """Return the limits of the freedoms of a group."""
    limits = Limits()
    for index, joint in zip(group.indices, group.joints, strict=False):
        table: dict[str, object] = {"position": joint.range} if any(map(math.isfinite, joint.range)) else {}
        limits = limits.with_freedom(index, {**table, "effort": joint.effort})
    return limits
