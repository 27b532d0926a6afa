"""Hinges whose joint frame is turned about the axis of the hinge: both turns as one, by the sum of angles.

Files of robots often turn the frame of a joint about its axis, by angles that are right angles but for their
last digits. Where many vectors pass a joint, it pays to compute sine and cosine of the sum of the constant
angle and that of the hinge, and to turn every vector once.
"""

from __future__ import annotations

from dataclasses import replace

from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.tree import Tree
from kanegen.recursion.turns import PlanarTurn
from kanegen.symbolic.definitions import Definitions


def with_joined_turns(tree: Tree) -> Tree:
    """Return the same tree, where the turns of such hinges are one."""
    joints = []
    for joint in tree.joints:
        tree.about(joint.body, "the turn of the hinge together with that of its frame")
        joints.append(_joined(joint, tree.definitions))
    return replace(tree, joints=tuple(joints))


def _joined(joint: JointMotion, definitions: Definitions) -> JointMotion:
    """Return a joint with its constant turn and that of its hinge as one, if both are about one axis."""
    if not joint.hinge or len(joint.constant) != 1:
        return joint
    (constant,), hinge, k = joint.constant, joint.hinge, joint.body
    below, above = constant.turn, hinge.turn
    if not (isinstance(below, PlanarTurn) and isinstance(above, PlanarTurn) and below.axis == above.axis):
        return joint
    sine = definitions.define(f"St_{k}", below.cosine * above.sine + below.sine * above.cosine)
    cosine = definitions.define(f"Ct_{k}", below.cosine * above.cosine - below.sine * above.sine)
    turn = PlanarTurn(above.axis, sine, cosine)
    step = replace(hinge, turn=turn, frame=f"{k}t", sine=sine, cosine=cosine)
    return replace(joint, constant=(), angles=(step,))
