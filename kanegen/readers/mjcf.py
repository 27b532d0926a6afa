"""Reads MJCF files, the models of MuJoCo, through MuJoCo's own compiler.

{x} and {y} are MuJoCo's `qpos` and `qvel` in another order: a ball joint is a quaternion with the angular
velocity in the body, a free joint has its translation in world axes beside it, and slides and hinges are
single freedoms with the names of their joints.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from kanegen.errors import ModelError, OptionError, ReadError
from kanegen.model import right_angles
from kanegen.model.body import Body
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.joint import Joint
from kanegen.model.names import usable_identifier, usable_label
from kanegen.model.rotations import ZERO, Triple, transpose
from kanegen.model.system import System
from kanegen.readers.mjcf_compiled import ROUNDING, Compiled, compiled
from kanegen.readers.mjcf_joints import JointGroup, joint_groups
from kanegen.readers.reader import ModelFile, Reader, ReadOptions
from kanegen.readers.welding import Frame, Rigid, weld

GROUND = 0


def read_mjcf(file: ModelFile, options: ReadOptions) -> System:
    """Return the system that an MJCF file describes, as MuJoCo compiles it.

    Args:
        file: The file.
        options: `floating_base` must not be set: an MJCF file says itself which body moves freely.

    Raises:
        ReadError: If MuJoCo refuses the file, or the model has a body that cannot exist.
        OptionError: If `floating_base` is set.
        MissingError: If MuJoCo is not installed.
    """
    if options.floating_base:
        raise OptionError(
            f"{file.path}: floating_base is for URDF files. In an MJCF file, put <freejoint/> into the body."
        )
    model = compiled(file)
    tree = _Tree(model)
    for body in range(1, int(model.model.nbody)):
        tree.add(body)
    if not tree.moving:
        raise ReadError(f"{file.path}: no joint of this model moves. A body moves by <joint> or <freejoint>.")
    name = file.root.attributes.get("model", "") or file.path.stem
    try:
        return System(usable_identifier(name), tuple(tree.bodies()), gravity=_gravity(model))
    except ModelError as error:
        raise ReadError(f"{file.path}: {error}") from None


READER = Reader("MJCF", ".xml", read_mjcf, root="mujoco")


@dataclass(frozen=True)
class _Moving:
    """A body of kanegen: one that the file has, or one without mass between two of its joints.

    Attributes:
        name: Name of the body.
        lower: Number of the lower body; `GROUND` for none.
        joint: The joint below it.
        parts: The bodies of the file that belong to it, in its frame.
    """

    name: str
    lower: int
    joint: Joint
    parts: list[Rigid] = field(default_factory=list)


@dataclass
class _Tree:
    """The bodies of a compiled model, added parents first.

    Attributes:
        model: The compiled model.
        moving: The bodies of kanegen so far.
        places: Number of the body of kanegen to which each body of the file belongs, and its frame there.
    """

    model: Compiled
    moving: list[_Moving] = field(default_factory=list)
    places: list[tuple[int, Frame]] = field(default_factory=lambda: [(GROUND, Frame())])

    def add(self, body: int) -> None:
        """Add a body of the file by its number."""
        number, frame = self.places[self.model.parent(body)]
        frame = frame.then(self.model.place(body))
        name = self.model.name("body", body)
        groups = list(joint_groups(self.model.joints(body)))
        for group in groups:
            is_last = group is groups[-1]
            label = name if is_last else f"{name}:{'-'.join(j.name for j in group.joints)}"
            joint = _joint(group, Frame() if group.joints[0].type == "free" else frame)
            self.moving.append(_Moving(usable_label(label), number, joint))
            number, frame = len(self.moving), group.after
        self.places.append((number, frame))
        if number != GROUND:
            self.moving[number - 1].parts.append(self.model.rigid(body).resolved_in(frame))

    def bodies(self) -> Iterator[Body]:
        """Yield the bodies of the system."""
        for one in self.moving:
            rigid = weld(one.parts)
            yield Body(one.name, one.lower, rigid.mass, rigid.inertia, rigid.center, one.joint)


def _joint(group: JointGroup, place: Frame) -> Joint:
    """Return the joint of a group; `place` is the frame of the file's body before it, in the lower body."""
    frame = place.then(group.frame)
    names = [usable_label(joint.name) for joint in group.joints]
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
    )


def _gravity(model: Compiled) -> Triple:
    """Return the acceleration of gravity in world axes (m/s^2), zero where the file switches it off."""
    if model.disables("GRAVITY"):
        return ZERO
    x, y, z = (float(component) for component in model.model.opt.gravity)
    return x, y, z
