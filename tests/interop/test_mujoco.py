"""States, forces and matrices of kanegen and of MuJoCo, converted both ways."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import kanegen as kg
from kanegen.interop.mujoco import state_map
from kanegen.model.arrays import Floats
from kanegen.reference import equations as reference
from tests.support.mujoco_models import MODELS, random_model

TOLERANCE = 1e-11
"""Relative to the largest entry. MuJoCo itself rounds inertias of bodies to its own principal axes."""


ROBOTS = ("ant", "humanoid", "hopper", "walker2d")
"""Models with free joints, and with several hinges and slides of one body."""


def _model(path: Path) -> Any:
    """A model without contacts, limits, passive forces and motors, which {f} does not have."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = mujoco.MjSpec.from_file(str(path)).compile()
    off = mujoco.mjtDisableBit
    for bit in (off.mjDSBL_CONSTRAINT, off.mjDSBL_SPRING, off.mjDSBL_DAMPER, off.mjDSBL_ACTUATION):
        model.opt.disableflags |= int(bit)
    model.dof_armature[:] = 0
    return model


def _without_motors(system: kg.System) -> kg.System:
    """The bodies alone, as `_model` has them."""
    joints = (replace(body.joint, armature=(0.0,) * 6) for body in system.bodies)
    bodies = tuple(replace(body, joint=joint) for body, joint in zip(system.bodies, joints, strict=True))
    return kg.System(system.name, bodies, gravity=system.gravity)


def _close(found: Floats, expected: Floats) -> None:
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() <= TOLERANCE * max(np.abs(expected).max(), 1e-3)


def _agrees(system: kg.System, model: Any, seed: int) -> None:
    """Make sure that both programs compute the same of one state, in the conventions of either."""
    rng, data, states = np.random.default_rng(seed), mujoco.MjData(model), state_map(system, model)
    data.qpos[:] = rng.uniform(-1.2, 1.2, model.nq)
    mujoco.mj_normalizeQuat(model, data.qpos)
    data.qvel[:] = rng.normal(size=model.nv)
    x = states.from_q(data.qpos)
    y = states.from_v(x, data.qvel)
    mujoco.mj_forward(model, data)
    m = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, m)
    a, f = reference.mass_matrix(system, x), reference.forcing(system, x, y)
    _close(states.from_mass_matrix(x, m), a)
    _close(states.from_bias(x, y, m, data.qfrc_bias), f)
    _close(states.to_bias(x, y, a, f), data.qfrc_bias)
    ydot = rng.normal(size=model.nv)
    data.qacc[:] = states.to_vdot(x, y, ydot)
    mujoco.mj_inverse(model, data)
    _close(states.from_tau(x, data.qfrc_inverse), a @ ydot - f)
    _close(states.to_tau(x, a @ ydot - f), data.qfrc_inverse)
    _close(states.from_vdot(x, y, states.to_vdot(x, y, ydot)), ydot)
    assert np.abs(states.from_q(states.to_q(x)) - x).max() < 1e-14


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(
    "path", [path for path in MODELS if path.stem in ("ant", "humanoid", "hopper", "walker2d")]
)
def test_robots_with_free_and_ball_joints(path: Path) -> None:
    _agrees(_without_motors(kg.load(path)), _model(path), 1)


@pytest.mark.parametrize("formulation", ["quaternion", "angular velocity", "angle rates"])
@pytest.mark.parametrize("seed", range(6))
def test_random_models(seed: int, formulation: str, tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(random_model(seed))
    system = _without_motors(kg.load(path))
    if formulation != "quaternion":
        system = system.with_coordinates("angles")
    if formulation == "angle rates":
        system = system.with_speeds("angle_rates")
    _agrees(system, _model(path), seed)


FREE = """<mujoco><worldbody><body name="base"><freejoint/>
<inertial mass="1" pos="0 0 0" diaginertia="1 2 3"/>
<body name="arm"><joint name="elbow" axis="0 0 1"/><inertial mass="1" pos="1 0 0" diaginertia="1 1 1"/></body>
</body></worldbody></mujoco>"""


def test_a_free_joint_has_its_scalar_first_and_its_linear_velocity_in_world_axes(tmp_path: Path) -> None:
    path = tmp_path / "free.xml"
    path.write_text(FREE)
    system, model = kg.load(path), _model(path)
    states = state_map(system, model)
    x = np.zeros(len(system.coordinates))
    x[system.coordinate_names.index("base.e0")] = x[system.coordinate_names.index("base.e3")] = 2.0
    x[system.coordinate_names.index("base.s2")] = 0.25
    y = np.zeros(len(system.freedoms))
    y[system.speed_names.index("base.s2")], y[system.speed_names.index("base.omega1")] = 3.0, 4.0
    half = np.sqrt(0.5)
    assert states.to_q(x) == pytest.approx([0, 0.25, 0, half, 0, 0, half, 0], abs=1e-15)
    assert states.to_v(x, y).tolist() == [0, 3, 0, 4, 0, 0, 0]


def test_a_joint_without_counterpart_is_named(tmp_path: Path) -> None:
    path = tmp_path / "free.xml"
    path.write_text(FREE)
    system, model = kg.load(path), _model(path)
    with pytest.raises(kg.ModelError, match="MuJoCo's joint 'elbow' is no free freedom"):
        state_map(system.with_locked({"elbow": 0.2}), model)
    with pytest.raises(kg.ModelError, match="MuJoCo's joint 'base' moves theta1, theta2, theta3, s1, s2, s3"):
        state_map(system.with_locked({"base.s1": 0.2}), model)


GRIPPER = """<mujoco><worldbody><body name="palm"><joint name="turn" axis="0 1 0"/>
<inertial mass="1" pos="0.1 0 0" diaginertia="1 2 2.5"/>
<body name="left"><joint name="left" type="slide" axis="1 0 0"/>
<inertial mass="0.5" pos="0 0 0.2" diaginertia="1 1 1"/></body>
<body name="right"><joint name="right" type="slide" axis="0 1 0"/>
<inertial mass="0.7" pos="0 0.1 0.2" diaginertia="1 1 1"/></body></body></worldbody>
<equality><joint joint1="right" joint2="left" polycoef="0.05 -2 0 0 0"/></equality></mujoco>"""


def test_an_equality_of_joints_is_a_coupling(tmp_path: Path) -> None:
    """MuJoCo keeps three degrees of freedom and forces; kanegen has two, and [A] = [J]^T M [J]."""
    path = tmp_path / "gripper.xml"
    path.write_text(GRIPPER)
    system, model = kg.load(path), _model(path)
    states, data = state_map(system, model), mujoco.MjData(model)
    assert (states.n, states.nv, len(states.followers)) == (2, 3, 1)
    x, y = np.array([0.3, -0.2]), np.array([0.7, 1.1])
    data.qpos[:], data.qvel[:] = states.to_q(x), states.to_v(x, y)
    left, right = x[system.coordinate_names.index("left")], data.qpos[2]
    assert right == pytest.approx(0.05 - 2 * left)
    mujoco.mj_forward(model, data)
    m = np.zeros((3, 3))
    mujoco.mj_fullM(model, data, m)
    _close(states.from_mass_matrix(x, m), reference.mass_matrix(system, x))
    _close(states.from_bias(x, y, m, data.qfrc_bias), reference.forcing(system, x, y))
