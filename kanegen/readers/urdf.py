"""Reads URDF robot files.

{x} is exactly that of the file, without the joints that follow others by <mimic>, and every link and joint is
a frame under its own name. The frame in which a body has its mass centre and inertia may be turned: where a
joint's axis is not +x, +y or +z, a constant rotation [B] takes link components to body components, so that
the joint moves along or about a basis vector. Masses, centres, inertias and further joints turn with it;
poses, points and loads are those of the link.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from kanegen.errors import ModelError, ReadError, quoted, warn
from kanegen.model.body import Body
from kanegen.model.coordinates import ORIENTATIONS
from kanegen.model.joint import Joint
from kanegen.model.limits import NO_LIMITS, Limits
from kanegen.model.rotations import UNIT, Square, apply, product, rotation_to_axis, transpose
from kanegen.model.system import System
from kanegen.readers.reader import ModelFile, Reader, ReadOptions
from kanegen.readers.urdf_dynamics import dynamic_elements
from kanegen.readers.urdf_dynamics import left_out as dynamics_left_out
from kanegen.readers.urdf_elements import BALLS, JointLimit, Robot, RobotJoint, read_robot
from kanegen.readers.urdf_frames import robot_frames, shadowed_joints
from kanegen.readers.urdf_mimic import mimic_couplings
from kanegen.readers.urdf_tree import GROUND, MovingLink, robot_tree
from kanegen.readers.urdf_visuals import urdf_visuals
from kanegen.readers.urdf_vocabulary import listed, unread
from kanegen.readers.welding import Frame, weld


def read_urdf(file: ModelFile, options: ReadOptions) -> System:
    """Return the system that a URDF file describes.

    Args:
        file: The file.
        options: With `floating_base` the root link moves freely and is body 1, with its translation in world
            axes and 1-2-3 angles; otherwise it is the ground. Orientations of frames and axes are made exact
            within the tolerance `right_angles`. With `joint_dynamics` damping and friction become force
            elements.

    Raises:
        ReadError: If the file is not well formed, not one tree, or has a body that cannot exist.

    Warns:
        KanegenWarning: If a fixed joint has `mimic`, a joint a limit that leaves no motion or the name of a
            link other than its own; or if content of the file is not read, or damping and friction are left
            out.
    """
    left_out = unread(file.root)
    robot = read_robot(file.root, options.right_angles)
    tree = robot_tree(robot, options.floating_base)
    moving = tree.moving
    if not moving:
        raise ReadError(
            f"{robot.where}: no joint of this robot moves. floating_base=True frees its root link."
        )
    if left_out:
        warn(f"{file.path}: this is not read: {listed(left_out)}.")
    _warn_of_mimic(robot, file.path)
    _warn_of_limits(moving, file.path)
    _warn_of_names(robot, file.path)
    frames = [_body_frame(link.joint) for link in moving]
    bodies = tuple(_bodies(moving, frames))
    couplings = mimic_couplings(robot, moving, bodies)
    try:
        named = robot_frames(robot, tree, [frame.matrix for frame in frames])
        system = System(robot.name, bodies, frames=named, couplings=couplings)
    except ModelError as error:
        raise ReadError(f"{file.path}: {error}") from None
    if options.joint_dynamics:
        return system.with_force_elements(*dynamic_elements(moving, bodies))
    if message := dynamics_left_out(moving, system, file.path):
        warn(message)
    return system


READER = Reader("URDF", ".urdf", read_urdf, root="robot", visuals=urdf_visuals)


@dataclass(frozen=True)
class _BodyFrame:
    """The frame of a body in its link, and the freedoms of the body.

    Attributes:
        matrix: [B], from link components to body components.
        free: (6,) the freedoms that the joint leaves to the body in this frame, as `Joint.free`.
        coordinates: Coordinates of its orientation, as `Joint.coordinates`.
    """

    matrix: Square
    free: tuple[bool, ...]
    coordinates: str = ORIENTATIONS[0]


def _body_frame(joint: RobotJoint) -> _BodyFrame:
    """Return a frame in which the joint moves along or about a basis vector; that of the link for several."""
    if joint.kind == "floating":
        return _BodyFrame(UNIT, (True,) * 6)
    if joint.kind in BALLS:
        return _BodyFrame(UNIT, (*(True,) * 3, *(False,) * 3), ORIENTATIONS[1])
    axis, matrix = rotation_to_axis(joint.axis)
    along = tuple(i == axis for i in range(3))
    across = tuple(i != axis for i in range(3))
    locked = (False,) * 3
    angles = locked if joint.kind == "prismatic" else along
    translations = {"prismatic": along, "planar": across}.get(joint.kind, locked)
    return _BodyFrame(matrix, angles + translations)


def _bodies(moving: Sequence[MovingLink], frames: Sequence[_BodyFrame]) -> Iterator[Body]:
    """Yield the bodies of the moving links, each in its frame."""
    for link, frame in zip(moving, frames, strict=True):
        below = UNIT if link.lower == GROUND else frames[link.lower - 1].matrix
        where = link.parts[0][0].where
        try:
            yield _body(link, below, frame)
        except ModelError as error:
            raise ReadError(f"{where}: {error}") from None


def _body(link: MovingLink, below: Square, frame: _BodyFrame) -> Body:
    """Return a body in its own frame; `below` takes components of the lower link to its body's frame."""
    rigid = weld([part.rigid.resolved_in(place) for part, place in link.parts])
    rigid = rigid.resolved_in(Frame(rotation=frame.matrix))
    to_joint_frame = product(frame.matrix, transpose(link.origin.rotation))
    joint = Joint(
        position=apply(below, link.origin.position),
        orientation=product(to_joint_frame, transpose(below)),
        free=frame.free,
        coordinates=frame.coordinates,
        limits=_limits(link.joint.limit, frame.free),
        name=link.joint.name,
    )
    return Body(link.joint.child, link.lower, rigid.mass, rigid.inertia, rigid.center, joint)


def _limits(limit: JointLimit, free: tuple[bool, ...]) -> Limits:
    """Return the limits of a joint with one freedom; those of no other joint are read."""
    if limit.is_none:
        return NO_LIMITS
    ends = {"position": (limit.lower, limit.upper), "speed": limit.speed, "effort": limit.effort}
    return NO_LIMITS.with_freedom(free.index(True), ends)


def _warn_of_limits(moving: Sequence[MovingLink], path: Path) -> None:
    """Warn of limits that leave nothing, which count as none."""
    empty = [
        f"{quoted(link.joint.name)} ({', '.join(link.joint.limit.empty)})"
        for link in moving
        if link.joint.limit.empty
    ]
    if empty:
        warn(f"{path}: limits that leave no motion or no effort are taken for none: {', '.join(empty)}.")


def _warn_of_mimic(robot: Robot, path: Path) -> None:
    """Warn of fixed joints with `mimic`, which says nothing there."""
    fixed = [joint.name for joint in robot.joints.values() if joint.mimic and joint.kind == "fixed"]
    if fixed:
        warn(f"{path}: these joints are fixed, so their <mimic> says nothing: {', '.join(fixed)}.")


def _warn_of_names(robot: Robot, path: Path) -> None:
    """Warn of names of joints that mean a link."""
    if shadowed := list(shadowed_joints(robot)):
        warn(f"{path}: links and joints share names: {', '.join(shadowed)}.")
