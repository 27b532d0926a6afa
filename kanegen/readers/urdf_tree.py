"""The tree of a URDF robot: moving links, each with the links that fixed joints weld to it."""

from __future__ import annotations

from dataclasses import dataclass, field

from kanegen.errors import ReadError, quoted
from kanegen.readers.urdf_elements import Link, Robot, RobotJoint
from kanegen.readers.welding import Frame

GROUND = 0


@dataclass(frozen=True)
class MovingLink:
    """A link that moves relative to the link below it, with the links that are welded to it.

    Attributes:
        joint: The joint below the link; its child is this link.
        lower: Number of the moving link below, counted from 1; `GROUND` for none.
        origin: Frame of the link at joint position zero, in the frame of the moving link below.
        parts: The link and those welded to it, each with its frame in the frame of this link.
    """

    joint: RobotJoint
    lower: int
    origin: Frame
    parts: list[tuple[Link, Frame]] = field(default_factory=list)


@dataclass(frozen=True)
class RobotTree:
    """The links of a robot by the body to which they belong.

    Attributes:
        moving: The moving links, depth first, in the order in which the file has the joints.
        grounded: The links that are welded to the ground, each with its frame in the inertial frame.
    """

    moving: list[MovingLink]
    grounded: list[tuple[Link, Frame]]


def robot_tree(robot: Robot, floating_base: bool) -> RobotTree:
    """Return the tree of a robot. With `floating_base` the root link moves too, and is the first.

    Raises:
        ReadError: If the links and joints are not one tree.
    """
    root = _root(robot)
    joints_on = _joints_by_parent(robot)
    moving: list[MovingLink] = []
    grounded: list[tuple[Link, Frame]] = []
    base = _base_joint(robot.links[root], "floating" if floating_base else "fixed")
    waiting = [(base, GROUND, Frame())]
    while waiting:
        joint, number, place = waiting.pop()
        if joint.kind != "fixed":
            moving.append(MovingLink(joint, number, place))
            number, place = len(moving), Frame()
        parts = grounded if number == GROUND else moving[number - 1].parts
        parts.append((robot.links[joint.child], place))
        for above in reversed(joints_on[joint.child]):
            waiting.append((above, number, place.then(above.origin)))
    return RobotTree(moving, grounded)


def _base_joint(root: Link, kind: str) -> RobotJoint:
    """Return a joint of some kind between the ground and the root link."""
    return RobotJoint("", kind, "", root.name, Frame(), (1.0, 0.0, 0.0), None, root.where)


def _joints_by_parent(robot: Robot) -> dict[str, list[RobotJoint]]:
    """Return the joints by name of their lower link."""
    joints_on: dict[str, list[RobotJoint]] = {name: [] for name in robot.links}
    for joint in robot.joints.values():
        joints_on[joint.parent].append(joint)
    return joints_on


def _root(robot: Robot) -> str:
    """Return the name of the one link without a parent, from which all others hang."""
    below: dict[str, RobotJoint] = {}
    for joint in robot.joints.values():
        first = below.setdefault(joint.child, joint)
        if first is not joint:
            raise ReadError(
                f"{joint.where}: link {quoted(joint.child)} has two parents, by the joints "
                f"{quoted(first.name)} and {quoted(joint.name)}. kanegen takes trees only: cut the loop."
            )
    _refuse_loops(robot, below)
    roots = [name for name in robot.links if name not in below]
    if len(roots) > 1:
        raise ReadError(
            f"{robot.where}: several links have no parent: {', '.join(map(repr, roots))}. "
            "Join them to one root."
        )
    return roots[0]


def _refuse_loops(robot: Robot, below: dict[str, RobotJoint]) -> None:
    """Raise a `ReadError` if the walk down from a link meets a link of the same walk again."""
    grounded: set[str] = set()
    for link in robot.links:
        trail: dict[str, RobotJoint] = {}
        name = link
        while name in below and name not in grounded:
            if name in trail:
                names = list(trail)
                loop = " on ".join(map(repr, [*names[names.index(name) :], name]))
                raise ReadError(
                    f"{below[name].where}: the joints form a loop: {loop}. kanegen takes trees only."
                )
            trail[name] = below[name]
            name = below[name].parent
        grounded.update(trail)
