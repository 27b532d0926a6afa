"""Every link of real robots as a frame, against Pinocchio: poses, Jacobians, velocities, accelerations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.interop.pinocchio import state_map
from kanegen.interop.state_map import StateMap
from kanegen.program.evaluate import evaluate
from kanegen.recursion.outputs import MOTIONS_OF_FRAMES
from tests.support.robots import robot_file

pytestmark = pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")

TOLERANCE = 1e-12
"""Largest difference, in units of the largest entry that Pinocchio gives for the link, or of 1 where all are
smaller; the paths of these robots have up to 15 joints, and neither side loses more than 1e-14."""

STATES = 3

ROBOTS = [
    pytest.param("panda", False),
    pytest.param("pr2", False),
    pytest.param("go2", True),
    pytest.param("hyq_no_sensors", True),
    pytest.param("g1_29dof_rev_1_0", True, marks=pytest.mark.slow),
    pytest.param("tiago_dual", False, marks=pytest.mark.slow),
]

ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
ANGULAR_FIRST = [3, 4, 5, 0, 1, 2]
"""Rows of Pinocchio's LOCAL_WORLD_ALIGNED in kanegen's order."""


def reading(name: str, floating: bool) -> tuple[kg.System, pin.Model, StateMap]:
    """Return a robot with all links chosen, Pinocchio's model of it, and the conversion of states.

    Joints with `mimic` follow others in kanegen and move by themselves in Pinocchio's model.
    """
    path = robot_file(name)
    system = kg.load(path, floating_base=floating)
    root = (pin.JointModelFreeFlyer(),) if floating else ()
    model = pin.buildModelFromUrdf(str(path), *root)
    links = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
    return system.with_poses(links), model, state_map(system, model)


def of_kanegen(system: kg.System, given: dict[str, Any]) -> dict[str, Any]:
    """Return every output in a batch of states: {x}, {y}, {ydot} by name, each (B, n)."""
    module = compile_module(system, MOTIONS_OF_FRAMES).module
    rows = {name: values.T for name, values in given.items()}
    found = {}
    for name in MOTIONS_OF_FRAMES:
        entries = evaluate(module.functions[name], rows, np)[name]
        stacked = [np.broadcast_to(entry, (len(given["x"]),)) for entry in entries]
        found[name] = np.stack(stacked, axis=-1)
    return found


def of_pinocchio(model: pin.Model, states: StateMap, x: Any, y: Any, ydot: Any) -> dict[str, list[Any]]:
    """Return every output in one state, link by link."""
    q, v = states.to_q(x), states.to_v(x, y)
    moving, unaccelerated = model.createData(), model.createData()
    pin.forwardKinematics(model, moving, q, v, states.to_vdot(x, y, ydot))
    pin.forwardKinematics(model, unaccelerated, q, v, states.to_vdot(x, y, 0 * ydot))
    pin.computeJointJacobians(model, moving, q)
    pin.updateFramePlacements(model, moving)
    found: dict[str, list[Any]] = {name: [] for name in MOTIONS_OF_FRAMES}
    for number, frame in enumerate(model.frames):
        if frame.type == pin.FrameType.BODY:
            place = moving.oMf[number]
            jacobian = pin.getFrameJacobian(model, moving, number, ALIGNED)[ANGULAR_FIRST]
            velocity = pin.getFrameVelocity(model, moving, number, ALIGNED)
            found["body_poses"].append(np.vstack([place.rotation.T, place.translation]))
            found["frame_jacobians"].append(states.from_columns(x, jacobian))
            found["frame_velocities"].append(velocity.vector[ANGULAR_FIRST])
            for name, data in (("frame_accelerations", moving), ("frame_bias_accelerations", unaccelerated)):
                classical = pin.getFrameClassicalAcceleration(model, data, number, ALIGNED)
                found[name].append(classical.vector[ANGULAR_FIRST])
    return found


@pytest.mark.parametrize(("name", "floating"), ROBOTS)
def test_every_link_of_a_robot(name: str, floating: bool) -> None:
    system, model, states = reading(name, floating)
    rng, n = np.random.default_rng(7), len(system.freedoms)
    given = {vector: rng.uniform(-2, 2, (STATES, n)) for vector in ("x", "y", "ydot")}
    ours = of_kanegen(system, given)
    for state in range(STATES):
        theirs = of_pinocchio(model, states, *(values[state] for values in given.values()))
        for output, links in theirs.items():
            rows = ours[output][state].reshape(len(links), *links[0].shape)
            for link, mine, right in zip(system.pose_names, rows, links, strict=True):
                scale = max(1.0, np.abs(right).max())
                assert np.abs(mine - right).max() <= TOLERANCE * scale, (output, link)


def test_conventions_of_pinocchio_are_one_line_away() -> None:
    """The lines of the documentation turn rows into those of LOCAL_WORLD_ALIGNED and of LOCAL."""
    system, model, states = reading("panda", False)
    system = system.with_poses(["panda_hand"])
    library = kg.build(system, ("body_poses", "frame_jacobians"))
    x = np.random.default_rng(1).uniform(-1, 1, library.n)
    (jacobian,), ((*rotation, _),) = library.frame_jacobians(x), library.body_poses(x)
    aligned = jacobian[[3, 4, 5, 0, 1, 2]]
    local = np.kron(np.eye(2), rotation) @ aligned
    data = model.createData()
    q = states.to_q(x)
    number = model.getFrameId("panda_hand", pin.FrameType.BODY)
    for mine, convention in ((aligned, ALIGNED), (local, pin.ReferenceFrame.LOCAL)):
        theirs = pin.computeFrameJacobian(model, data, q, number, convention)
        assert mine == pytest.approx(states.from_columns(x, theirs), abs=1e-14)
