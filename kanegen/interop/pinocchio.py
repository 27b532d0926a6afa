"""Pinocchio: its q and v, its efforts and matrices, and those of a system with the same joints.

A free-flyer has q = (position, quaternion x y z w) and v = (linear velocity in the body, angular velocity in
the body). A hinge without limits may have q = (cos, sin). Pinocchio itself is not imported.
"""

from __future__ import annotations

from typing import Any

from kanegen.errors import ModelError, OptionError, quoted
from kanegen.interop.blocks import Block, CosineSine, Floating, Follower, Places, Planar, Scalars
from kanegen.interop.matching import ALL_SIX, TURNING, Matching
from kanegen.interop.state_map import StateMap, state_map_of
from kanegen.model.description import require_system
from kanegen.model.system import System

ROOT_JOINT = "root_joint"
"""Name that Pinocchio gives to the joint of a root link that moves."""

SLIDING = (False, False, False, True, True, True)
"""(6,) freedoms of three translations."""

PLANE = (False, False, True, True, True, False)
"""(6,) freedoms of a planar joint of Pinocchio: the plane is always normal to axis 3."""


def state_map(system: System, model: Any) -> StateMap:
    """Return the map between a system and a model of Pinocchio, whose joints are matched by name.

    Joints with one coordinate are matched with the freedoms of their names, others with the joint or body of
    kanegen that has their name; the `root_joint` with the body whose six freedoms are free. A joint that is
    coupled in the system may move by itself in the model, as joints with `mimic` do unless Pinocchio is asked
    for it. Joint frames must be the same, as they are where both programs read the same file.

    Args:
        system: The system, from the same robot as the model.
        model: A `pinocchio.Model`.

    Raises:
        OptionError: If an argument is no system or no model.
        ModelError: If a joint has no counterpart, or a freedom of the system has none.

    Example:
        states = kg.interop.pinocchio.state_map(system, model)
        q, v = states.to_q(x), states.to_v(x, y)
        a = states.from_mass_matrix(x, pinocchio.crba(model, data, q))
    """
    require_system(system)
    if not all(hasattr(model, name) for name in ("names", "joints", "nq", "nv")):
        raise OptionError(f"{quoted(model)} is no model of Pinocchio.")
    matching = Matching(system, "Pinocchio")
    names = list(model.names)
    blocks = [
        _block(matching, names[number], joint)
        for number, joint in enumerate(model.joints)
        if number and joint.nv
    ]
    return state_map_of(blocks, system, model.nq, model.nv, "Pinocchio")


def _block(matching: Matching, name: str, joint: Any) -> Block | Follower:
    """Return the block of one joint.

    Raises:
        ModelError: If no freedom or body of the system has its name, or its type is unknown.
    """
    q, v = _places(joint.idx_q, joint.nq), _places(joint.idx_v, joint.nv)
    names, kind = (name,), joint.shortname()
    match joint.nq, joint.nv:
        case 1, 1:
            return matching.joint(names[0], q, v)
        case 2, 1:
            return CosineSine(*matching.scalar(names[0]), q, v)
        case 3, 3 if "Translation" in kind:
            return Scalars(*matching.translations(matching.body(names, SLIDING)), q, v)
        case 4, 3 if "Planar" in kind:
            return Planar(*matching.freedoms(matching.body(names, PLANE), (3, 4, 2)), q, v)
        case 4, 3:
            return matching.ball(matching.body(names, TURNING), q, v, scalar_last=True)
        case 7, 6:
            body = matching.floating() if name == ROOT_JOINT else matching.body(names, ALL_SIX)
            x, y = matching.translations(body)
            ball = matching.ball(body, q[3:], v[3:], scalar_last=True)
            return Floating((*x, *ball.x), (*y, *ball.y), q, v, ball, is_local=True)
    raise ModelError(
        f"Pinocchio's joint {quoted(name)} is a {kind}, which no joint of kanegen has the coordinates of. "
        "Model it by joints of one coordinate each, a ball joint or a free-flyer."
    )


def _places(first: int, count: int) -> Places:
    """Return `count` consecutive places, from the first."""
    return tuple(range(first, first + count))
