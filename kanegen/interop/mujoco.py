"""MuJoCo: its qpos and qvel, its efforts and matrices, and those of a system with the same joints.

A free joint has qpos = (position, quaternion w x y z) and qvel = (linear velocity in world axes, angular
velocity in the body); a ball joint has the quaternion and the angular velocity alone. MuJoCo itself is not
imported.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from kanegen.errors import OptionError, quoted
from kanegen.interop.blocks import Block, Floating, Follower
from kanegen.interop.matching import ALL_SIX, TURNING, Matching
from kanegen.interop.state_map import StateMap, state_map_of
from kanegen.model.description import require_system
from kanegen.model.system import System


class JointType(IntEnum):
    """Values of `mjtJoint` for joints with a quaternion; a slide and a hinge have one coordinate."""

    FREE = 0
    BALL = 1


def state_map(system: System, model: Any) -> StateMap:
    """Return the map between a system and a model of MuJoCo, whose joints are matched by name.

    Slides and hinges are matched with the freedoms of their names, ball and free joints with the body of
    kanegen that has the name of their body. Joint frames must be the same, as they are where kanegen has read
    the same file.

    Args:
        system: The system, from the same file as the model.
        model: A `mujoco.MjModel`.

    Raises:
        OptionError: If an argument is no system or no model.
        ModelError: If a joint has no counterpart, or a freedom of the system has none.

    Example:
        states = kg.interop.mujoco.state_map(system, model)
        data.qpos, data.qvel = states.to_q(x), states.to_v(x, y)
        f = states.from_bias(x, y, m, data.qfrc_bias)
    """
    require_system(system)
    if not all(hasattr(model, name) for name in ("njnt", "jnt_type", "nq", "nv")):
        raise OptionError(f"{quoted(model)} is no compiled model of MuJoCo.")
    matching = Matching(system, "MuJoCo")
    blocks = [_block(matching, model, joint) for joint in range(model.njnt)]
    return state_map_of(blocks, system, model.nq, model.nv, "MuJoCo")


def _block(matching: Matching, model: Any, joint: int) -> Block | Follower:
    """Return the block of one joint."""
    number, kind = int(model.jnt_bodyid[joint]), int(model.jnt_type[joint])
    name = model.joint(joint).name or f"joint{joint}"
    names = (model.body(number).name or f"body{number}", name)
    first_q, first_v = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
    match kind:
        case JointType.FREE:
            body = matching.body(names, ALL_SIX)
            q, v = tuple(range(first_q, first_q + 7)), tuple(range(first_v, first_v + 6))
            x, y = matching.translations(body)
            ball = matching.ball(body, q[3:], v[3:], scalar_last=False)
            return Floating((*x, *ball.x), (*y, *ball.y), q, v, ball, is_local=False)
        case JointType.BALL:
            q, v = tuple(range(first_q, first_q + 4)), tuple(range(first_v, first_v + 3))
            return matching.ball(matching.body(names, TURNING), q, v, scalar_last=False)
        case _:
            return matching.joint(name, (first_q,), (first_v,))
