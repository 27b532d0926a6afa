"""URDF robot files.

A link's frame and {x} are exactly those of the file, except that a body's own frame may be turned: where a
joint's axis is not +x, +y or +z, a constant rotation [B] takes body components from link components, so that
the joint moves along or about a basis vector. Masses, centres, inertias and further joints turn with it.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from kanegen.errors import KanegenWarning, ModelError, ReadError
from kanegen.model.body import Body
from kanegen.model.joint import Joint
from kanegen.model.right_angles import AS_WRITTEN
from kanegen.model.rotations import UNIT, Square, apply, product, rotation_to_axis, transpose
from kanegen.model.system import System
from kanegen.readers.labels import identifier, label
from kanegen.readers.rigid import Frame, lump
from kanegen.readers.robot import Robot, RobotJoint, read_robot
from kanegen.readers.text import read_text
from kanegen.readers.tree import GROUND, MovingLink, moving_links
from kanegen.readers.xml import parse


def read_urdf(path: Path, floating_base: bool = False, right_angles: float = AS_WRITTEN) -> System:
    """The system that a URDF file describes.

    Args:
        path: The file.
        floating_base: Whether the root link moves freely: body 1, with its translation in world axes and
            1-2-3 angles. Otherwise it is the ground.
        right_angles: Tolerance (rad) within which the orientations of all frames and axes are made exact.

    Raises:
        ReadError: If the file is not well formed, not one tree, or has a body that cannot exist.

    Warns:
        KanegenWarning: Of joints with `mimic`, which move on their own here, and of names changed.
    """
    robot = read_robot(parse(read_text(path), str(path)), right_angles)
    moving = moving_links(robot, floating_base)
    if not moving:
        raise ReadError(
            f"{robot.where}: no joint of this robot moves. floating_base=True frees its root link."
        )
    _warn_of_mimic(robot, path)
    _warn_of_names(moving, path)
    turns = [_turn(link.joint) for link in moving]
    bodies = tuple(_bodies(moving, turns))
    try:
        return System(identifier(robot.name), bodies)
    except ModelError as error:
        raise ReadError(f"{path}: {error}") from None


@dataclass(frozen=True)
class _Turn:
    """How a body's frame stands in its link.

    Attributes:
        matrix: [B], from link components to body components.
        free: The freedoms that the joint leaves the turned body, as `Joint.free`.
    """

    matrix: Square
    free: tuple[bool, ...]


def _turn(joint: RobotJoint) -> _Turn:
    if joint.kind == "floating":
        return _Turn(UNIT, (True,) * 6)
    axis, matrix = rotation_to_axis(joint.axis)
    along = tuple(i == axis for i in range(3))
    across = tuple(i != axis for i in range(3))
    locked = (False,) * 3
    angles = locked if joint.kind == "prismatic" else along
    translations = {"prismatic": along, "planar": across}.get(joint.kind, locked)
    return _Turn(matrix, angles + translations)


def _bodies(moving: Sequence[MovingLink], turns: Sequence[_Turn]) -> Iterator[Body]:
    for link, turn in zip(moving, turns, strict=True):
        below = UNIT if link.lower == GROUND else turns[link.lower - 1].matrix
        where = link.parts[0][0].where
        try:
            yield _body(link, below, turn)
        except ModelError as error:
            raise ReadError(f"{where}: {error}") from None


def _body(link: MovingLink, below: Square, turn: _Turn) -> Body:
    """The body, seen in its turned frame, on a lower body whose frame is turned by `below`."""
    rigid = lump([part.rigid.seen_from(place) for part, place in link.parts])
    rigid = rigid.seen_from(Frame(rotation=turn.matrix))
    to_joint_frame = product(turn.matrix, transpose(link.origin.rotation))
    joint = Joint(
        position=apply(below, link.origin.position),
        orientation=product(to_joint_frame, transpose(below)),
        free=turn.free,
        name=label(link.joint.name) if link.joint.name else "",
    )
    return Body(label(link.joint.child), link.lower, rigid.mass, rigid.inertia, rigid.center, joint)


def _warn_of_mimic(robot: Robot, path: Path) -> None:
    mimics = [joint.name for joint in robot.joints.values() if joint.mimic and joint.kind != "fixed"]
    if mimics:
        _warn(f"{path}: <mimic> is not kept: these joints move on their own: {', '.join(mimics)}.")


def _warn_of_names(moving: Sequence[MovingLink], path: Path) -> None:
    names = [name for link in moving for name in (link.joint.name, link.joint.child) if name]
    changed = [f"{name!r} is called {label(name)!r}" for name in names if label(name) != name]
    if changed:
        _warn(f"{path}: names that kanegen cannot use are changed: {', '.join(changed)}.")


def _warn(message: str) -> None:
    warnings.warn(message, KanegenWarning, stacklevel=5)
