"""The frames of a URDF robot: every link and every joint under its own name, as the file has them.

The frame of a joint is that of its child link. A link and a joint of one name are told apart by what they
are in the file only, so there the name means the link.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from kanegen.errors import quoted
from kanegen.model.frame import Frame
from kanegen.model.rotations import UNIT, Square, apply, product, transpose
from kanegen.readers.urdf_elements import Robot
from kanegen.readers.urdf_tree import GROUND, RobotTree


def robot_frames(robot: Robot, tree: RobotTree, turns: Sequence[Square]) -> tuple[Frame, ...]:
    """Return the frames of all links and joints, but for bodies whose frame is that of their link.

    Args:
        robot: The robot.
        tree: Its links by the body to which they belong.
        turns: For each moving link, from link components to components of its body.
    """
    frames: dict[str, Frame] = {}
    for k, parts in enumerate((tree.grounded, *(link.parts for link in tree.moving))):
        turn = turns[k - 1] if k != GROUND else UNIT
        for link, place in parts:
            rotation = product(transpose(place.rotation), transpose(turn))
            frames[link.name] = Frame(link.name, k, apply(turn, place.position), rotation)
    of_joints = {
        joint.name: Frame(joint.name, frames[joint.child].body, frame=joint.child)
        for joint in robot.joints.values()
        if joint.name not in frames
    }
    bodies = {link.joint.child for link in tree.moving}
    of_links = (frame for frame in frames.values() if frame.name not in bodies or not frame.is_trivial)
    return (*of_links, *of_joints.values())


def shadowed_joints(robot: Robot) -> Iterator[str]:
    """Yield, for each joint with the name of a link that is not its child, what the name means."""
    for joint in robot.joints.values():
        if joint.name in robot.links and joint.name != joint.child:
            yield f"{quoted(joint.name)} means the link, not the joint below {quoted(joint.child)}"
