"""Couplings of a URDF file: a joint with <mimic> follows another one, x = multiplier x_other + offset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kanegen.choices import did_you_mean
from kanegen.errors import ReadError, quoted
from kanegen.model.body import Body
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.coupling import Coupling
from kanegen.readers.urdf_elements import Mimic, Robot
from kanegen.readers.urdf_tree import MovingLink


def mimic_couplings(
    robot: Robot, moving: Sequence[MovingLink], bodies: Sequence[Body]
) -> tuple[Coupling, ...]:
    """Return the couplings of a robot.

    Args:
        robot: The robot.
        moving: Its moving links.
        bodies: The body of each moving link.

    Raises:
        ReadError: If a joint follows one that does not exist, cannot move or has more than one freedom, if it
            has no freedom of its own to give up, or if joints follow each other in a circle.
    """
    _require_no_circle(robot)
    body_of = {link.joint.name: body for link, body in zip(moving, bodies, strict=True)}
    found = []
    for name, joint in robot.joints.items():
        if joint.mimic and joint.kind != "fixed":
            own = _freedom(name, "has <mimic>", joint.mimic, robot, body_of)
            other = _freedom(joint.mimic.joint, "is to be followed", joint.mimic, robot, body_of)
            found.append(Coupling(own, {other: joint.mimic.multiplier}, joint.mimic.offset))
    return tuple(found)


def _freedom(name: str, role: str, mimic: Mimic, robot: Robot, body_of: Mapping[str, Body]) -> str:
    """Return the name of the only freedom of a joint; `role` says for messages what the joint has to do."""
    if name not in robot.joints:
        hint = did_you_mean(name, robot.joints)
        raise ReadError(f"{mimic.where}: <mimic>: there is no joint {quoted(name)}. {hint}")
    joint = robot.joints[name]
    if joint.kind == "fixed" or name not in body_of:
        raise ReadError(
            f"{mimic.where}: <mimic>: joint {quoted(name)} is to be followed, but is fixed. Name one that "
            "moves, or make this joint fixed, too."
        )
    body = body_of[name]
    if sum(body.joint.free) != 1:
        raise ReadError(
            f"{mimic.where}: <mimic>: joint {quoted(name)} {role}, but is {joint.kind} and has "
            f"{sum(body.joint.free)} freedoms. Only joints with one freedom can follow each other."
        )
    return f"{body.name}.{FREEDOMS[body.joint.free.index(True)]}"


def _require_no_circle(robot: Robot) -> None:
    """Raise a `ReadError` if joints follow each other in a circle."""
    for name, joint in robot.joints.items():
        path, mimic = [name], joint.mimic
        while mimic and mimic.joint not in path:
            path.append(mimic.joint)
            mimic = robot.joints[mimic.joint].mimic if mimic.joint in robot.joints else None
        if mimic and mimic.joint == name and joint.mimic:
            circle = " follows ".join(map(quoted, [*path, name]))
            raise ReadError(
                f"{joint.mimic.where}: <mimic>: joint {circle}: a circle. Delete one <mimic>, so that "
                "a joint remains that moves by itself."
            )
