"""The lines of docs/conventions.md on Pinocchio, MuJoCo and ROS, each held against the other program."""

from __future__ import annotations

import re
from inspect import signature
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

import kanegen as kg
from kanegen.interop.state_map import StateMap, exchanged_rows
from kanegen.model.arrays import Floats
from kanegen.model.rotations import rotation_rpy
from kanegen.reference import equations as reference
from tests.support.conventions import Robot, robot, write_mjcf, write_urdf
from tests.support.paths import ROOT

NAMES = ("base", "arm", "tool")


def _close(found: Any, expected: Any) -> None:
    """Make sure that two results agree to 1e-13 of the largest entry: roundings of three bodies."""
    size = max(np.abs(expected).max(), 1e-3)
    assert np.shape(found) == np.shape(expected)
    assert np.abs(np.asarray(found) - expected).max() <= 1e-13 * size


def test_the_page_names_every_conversion_with_its_arguments() -> None:
    page = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8")
    table = page.partition("## State")[0]
    written = set(re.findall(r"`((?:to|from)_\w+\(.*?\))`", table))
    methods = [name for name in vars(StateMap) if name.startswith(("to_", "from_"))]
    calls = {f"{name}({', '.join([*signature(getattr(StateMap, name)).parameters][1:])})" for name in methods}
    assert written == calls


class InPinocchio:
    """The robot and its state in Pinocchio, with everything computed."""

    def __init__(self, folder: Path) -> None:
        self.mine: Robot = robot()
        self.model = pin.buildModelFromUrdf(str(write_urdf(folder)), pin.JointModelFreeFlyer())
        self.data = self.model.createData()
        self.map = kg.interop.pinocchio.state_map(self.mine.system, self.model)
        x, y, ydot = self.mine.x, self.mine.y, self.mine.ydot
        self.q, self.v, self.a = self.map.to_q(x), self.map.to_v(x, y), self.map.to_vdot(x, y, ydot)
        pin.forwardKinematics(self.model, self.data, self.q, self.v, self.a)
        pin.updateFramePlacements(self.model, self.data)
        pin.computeJointJacobians(self.model, self.data, self.q)
        self.frames = [self.model.getFrameId(name) for name in NAMES]


class InMujoco:
    """The robot and its state in MuJoCo, with everything computed."""

    def __init__(self, folder: Path) -> None:
        self.mine: Robot = robot()
        self.model = mujoco.MjModel.from_xml_path(str(write_mjcf(folder)))
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
        self.model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
        self.data = mujoco.MjData(self.model)
        self.map = kg.interop.mujoco.state_map(self.mine.system, self.model)
        x, y, ydot = self.mine.x, self.mine.y, self.mine.ydot
        self.data.qpos[:], self.data.qvel[:] = self.map.to_q(x), self.map.to_v(x, y)
        mujoco.mj_forward(self.model, self.data)
        self.data.qacc[:] = self.map.to_vdot(x, y, ydot)
        self.numbers = [self.model.body(name).id for name in NAMES]


@pytest.fixture
def pinocchio(tmp_path: Path) -> InPinocchio:
    return InPinocchio(tmp_path)


@pytest.fixture
def in_mujoco(tmp_path: Path) -> InMujoco:
    return InMujoco(tmp_path)


def _place(system: kg.System, name: str) -> int:
    return system.coordinate_names.index(name)


def test_order_of_coordinates(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """kanegen has rotations of all bodies, then translations; the others go joint by joint."""
    system = robot().system
    kinds = [coordinate.is_translation for coordinate in system.coordinates]
    assert kinds == sorted(kinds)
    assert list(pinocchio.model.names) == ["universe", "root_joint", "shoulder", "slide"]
    assert [in_mujoco.model.joint(i).name for i in range(3)] == ["", "shoulder", "slide"]
    x = robot().x
    for q in (pinocchio.q, in_mujoco.data.qpos):
        assert q[7:].tolist() == [x[_place(system, "shoulder")], x[_place(system, "slide")]]


def test_coordinates_of_a_floating_base(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """Position first in both; the scalar of the quaternion last in Pinocchio and first in MuJoCo."""
    system, x = robot().system, robot().x
    position = [x[_place(system, f"base.s{i}")] for i in (1, 2, 3)]
    scalar, *vector = (x[_place(system, f"base.e{i}")] for i in range(4))
    _close(pinocchio.q[:7], np.array([*position, *vector, scalar]))
    _close(in_mujoco.data.qpos[:7], np.array([*position, scalar, *vector]))


def test_velocity_of_a_floating_base(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """Linear first in both: Pinocchio in the body, MuJoCo in world axes; angular velocity in the body."""
    mine = robot()
    names = mine.system.speed_names
    linear = np.array([mine.y[names.index(f"base.s{i}")] for i in (1, 2, 3)])
    angular = np.array([mine.y[names.index(f"base.omega{i}")] for i in (1, 2, 3)])
    rotation = mine.results["body_poses"][0, :3]
    _close(pinocchio.v[:6], np.concatenate([rotation @ linear, angular]))
    _close(in_mujoco.data.qvel[:6], np.concatenate([linear, angular]))
    _close(mine.results["frame_velocities"][0], np.concatenate([rotation.T @ angular, linear]))


def test_acceleration_of_a_floating_base(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """Pinocchio's is the derivative of body components, so {omega} x {v} less than that of the origin."""
    mine = robot()
    rotation, acceleration = mine.results["body_poses"][0, :3], mine.results["frame_accelerations"][0]
    linear, angular = pinocchio.v[:3], pinocchio.v[3:6]
    _close(pinocchio.a[:3] + np.cross(angular, linear), rotation @ acceleration[3:])
    _close(pinocchio.a[3:6], rotation @ acceleration[:3])
    _close(in_mujoco.data.qacc[:3], acceleration[3:])
    _close(in_mujoco.data.qacc[3:6], rotation @ acceleration[:3])


def test_rotations_and_positions(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """kanegen's [R_K] takes inertial to body components; both others have its transpose."""
    poses = robot().results["body_poses"]
    for k, (frame, number) in enumerate(zip(pinocchio.frames, in_mujoco.numbers, strict=True)):
        _close(pinocchio.data.oMf[frame].rotation.T, poses[k, :3])
        _close(pinocchio.data.oMf[frame].translation, poses[k, 3])
        _close(in_mujoco.data.xmat[number].reshape(3, 3).T, poses[k, :3])
        _close(in_mujoco.data.xpos[number], poses[k, 3])


def test_jacobians(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """kanegen's are LOCAL_WORLD_ALIGNED with the angular rows first; LOCAL and WORLD follow from them."""
    mine = robot()
    for k, (frame, number) in enumerate(zip(pinocchio.frames, in_mujoco.numbers, strict=True)):
        jacobian, pose = mine.results["frame_jacobians"][k], mine.results["body_poses"][k]
        aligned = pin.getFrameJacobian(pinocchio.model, pinocchio.data, frame, pin.LOCAL_WORLD_ALIGNED)
        _close(exchanged_rows(pinocchio.map.from_columns(mine.x, aligned)), jacobian)
        local = pin.getFrameJacobian(pinocchio.model, pinocchio.data, frame, pin.LOCAL)
        in_body = np.concatenate([pose[:3] @ jacobian[:3], pose[:3] @ jacobian[3:]])
        _close(exchanged_rows(pinocchio.map.from_columns(mine.x, local)), in_body)
        world = pin.getFrameJacobian(pinocchio.model, pinocchio.data, frame, pin.WORLD)
        at_origin = jacobian[3:] - np.cross(jacobian[:3].T, pose[3]).T
        _close(exchanged_rows(pinocchio.map.from_columns(mine.x, world))[3:], at_origin)
        linear, angular = np.zeros((3, in_mujoco.model.nv)), np.zeros((3, in_mujoco.model.nv))
        mujoco.mj_jacBody(in_mujoco.model, in_mujoco.data, linear, angular, number)
        _close(in_mujoco.map.from_columns(mine.x, np.concatenate([angular, linear])), jacobian)


def test_accelerations_of_frames(pinocchio: InPinocchio) -> None:
    """Pinocchio's classical acceleration in LOCAL_WORLD_ALIGNED, with its rows exchanged."""
    for k, frame in enumerate(pinocchio.frames):
        found = pin.getFrameClassicalAcceleration(
            pinocchio.model, pinocchio.data, frame, pin.LOCAL_WORLD_ALIGNED
        ).vector
        _close(np.concatenate([found[3:], found[:3]]), robot().results["frame_accelerations"][k])


def test_mass_matrix(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """[A] = [J]^T M [J]; in both programs M is full after `crba` and `mj_fullM`."""
    mine = robot()
    m = np.array(pin.crba(pinocchio.model, pinocchio.data, pinocchio.q))
    _close(m, m.T)
    _close(pinocchio.map.from_mass_matrix(mine.x, m), mine.results["mass_matrix"])
    full = np.zeros((in_mujoco.model.nv,) * 2)
    mujoco.mj_fullM(in_mujoco.model, in_mujoco.data, full)
    _close(in_mujoco.map.from_mass_matrix(mine.x, full), mine.results["mass_matrix"])


def test_forcing_is_minus_the_bias(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    mine = robot()
    m = np.array(pin.crba(pinocchio.model, pinocchio.data, pinocchio.q))
    bias = pin.nonLinearEffects(pinocchio.model, pinocchio.data, pinocchio.q, pinocchio.v)
    _close(pinocchio.map.from_bias(mine.x, mine.y, m, bias), mine.results["forcing"])
    full = np.zeros((in_mujoco.model.nv,) * 2)
    mujoco.mj_fullM(in_mujoco.model, in_mujoco.data, full)
    found = in_mujoco.map.from_bias(mine.x, mine.y, full, in_mujoco.data.qfrc_bias)
    _close(found, mine.results["forcing"])


def test_gravity_forces(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    mine = robot()
    theirs = pin.computeGeneralizedGravity(pinocchio.model, pinocchio.data, pinocchio.q)
    _close(pinocchio.map.from_tau(mine.x, -theirs), mine.results["gravity_forces"])
    in_mujoco.data.qvel[:] = 0
    mujoco.mj_forward(in_mujoco.model, in_mujoco.data)
    found = in_mujoco.map.from_tau(mine.x, -in_mujoco.data.qfrc_bias)
    _close(found, mine.results["gravity_forces"])


def test_coriolis_matrix(pinocchio: InPinocchio) -> None:
    """[C] = [J]^T (C' [J] + M [Jdot]) with Pinocchio's C': both are the same sum over particles."""
    mine, model, data = robot(), pinocchio.model, pinocchio.data
    jacobian = pinocchio.map.jacobian(mine.x)
    rate = np.zeros_like(jacobian)
    rate[:3] = -np.cross(pinocchio.v[3:6], jacobian[:3], axisb=0, axisc=0)  # translations, in turning axes
    _close(rate @ mine.y, pinocchio.map.drift(mine.x, mine.y))
    m = np.array(pin.crba(model, data, pinocchio.q))
    theirs = pin.computeCoriolisMatrix(model, data, pinocchio.q, pinocchio.v)
    _close(jacobian.T @ (theirs @ jacobian + m @ rate), mine.results["coriolis_matrix"])


def test_inverse_dynamics(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    mine = robot()
    tau = pin.rnea(pinocchio.model, pinocchio.data, pinocchio.q, pinocchio.v, pinocchio.a)
    _close(pinocchio.map.from_tau(mine.x, tau), mine.results["inverse_dynamics"])
    mujoco.mj_inverse(in_mujoco.model, in_mujoco.data)
    found = in_mujoco.map.from_tau(mine.x, in_mujoco.data.qfrc_inverse)
    _close(found, mine.results["inverse_dynamics"])


def test_gravity_is_an_acceleration_in_inertial_components(
    pinocchio: InPinocchio, in_mujoco: InMujoco
) -> None:
    mine = robot().system.gravity
    assert mine == tuple(pinocchio.model.gravity.linear)
    assert mine == tuple(in_mujoco.model.opt.gravity)


def test_energies_and_momentum(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """Potential energy is zero at the inertial origin; centroidal momentum has linear rows first."""
    results = robot().results
    model, data = pinocchio.model, pinocchio.data
    kinetic = pin.computeKineticEnergy(model, data, pinocchio.q, pinocchio.v)
    potential = pin.computePotentialEnergy(model, data, pinocchio.q)
    _close([kinetic, potential], np.array([results["kinetic_energy"], results["potential_energy"]]))
    potential, kinetic = in_mujoco.data.energy
    _close([kinetic, potential], np.array([results["kinetic_energy"], results["potential_energy"]]))
    momentum = pin.computeCentroidalMomentum(model, data, pinocchio.q, pinocchio.v).vector
    _close(momentum, results["momentum"])
    _close(pin.centerOfMass(model, data, pinocchio.q), results["mass_center"])
    mujoco.mj_subtreeVel(in_mujoco.model, in_mujoco.data)
    root = in_mujoco.numbers[0]
    linear = in_mujoco.data.subtree_linvel[root] * in_mujoco.model.body_subtreemass[root]
    _close(np.concatenate([linear, in_mujoco.data.subtree_angmom[root]]), results["momentum"])


def test_momentum_by_speeds_and_regressor(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """Both are linear in velocities of a joint, so that columns change with [J]; MuJoCo has angular rows."""
    mine = robot()
    model, data, states = pinocchio.model, pinocchio.data, pinocchio.map
    pin.computeCentroidalMapTimeVariation(model, data, pinocchio.q, pinocchio.v)
    _close(states.from_columns(mine.x, data.Ag), mine.results["centroidal_momentum_matrix"])
    still = states.to_vdot(mine.x, mine.y, 0 * mine.ydot)
    _close(data.Ag @ still + data.dAg @ pinocchio.v, mine.results["centroidal_momentum_bias"])
    theirs = pin.computeJointTorqueRegressor(model, data, pinocchio.q, pinocchio.v, pinocchio.a)
    rows = np.stack([states.from_tau(mine.x, column) for column in theirs.T], axis=-1)
    assert [model.names[k] for k in range(2, model.njoints)] == ["shoulder", "slide"]
    _close(rows, mine.results["regressor"])
    matrix = np.zeros((3, in_mujoco.model.nv))
    mujoco.mj_angmomMat(in_mujoco.model, in_mujoco.data, matrix, in_mujoco.numbers[0])
    found = in_mujoco.map.from_columns(mine.x, matrix)
    _close(found, mine.results["centroidal_momentum_matrix"][3:])


def test_inertias(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """About the mass centre, products as entries of the matrix; MuJoCo has principal moments and axes."""
    for k, body in enumerate(robot().system.bodies):
        inertia = np.asarray(body.inertia, dtype=float)
        theirs = pinocchio.model.inertias[k + 1]
        _close(theirs.inertia, inertia)
        _close(theirs.lever, np.asarray(body.mass_center))
        number = in_mujoco.numbers[k]
        moments = in_mujoco.model.body_inertia[number]
        axes = Rotation.from_quat(in_mujoco.model.body_iquat[number], scalar_first=True).as_matrix()
        _close(axes @ np.diag(moments) @ axes.T, inertia)


def test_wrenches(pinocchio: InPinocchio, in_mujoco: InMujoco) -> None:
    """In the body: at the mass centre; Pinocchio at the joint. MuJoCo: at the mass centre, world axes."""
    mine, rng = robot(), np.random.default_rng(1)
    bodies = tuple(kg.Body(**{**vars(body), "loads": True}) for body in mine.system.bodies)
    system = kg.System("robot", bodies)
    force, torque = rng.normal(size=(2, 3, 3))
    loaded = reference.forcing(system, mine.x, mine.y, force, torque)
    external, poses = pin.StdVec_Force(), mine.results["body_poses"]
    external.append(pin.Force.Zero())
    for k, body in enumerate(bodies):
        about_joint = torque[k] + np.cross(np.asarray(body.mass_center, dtype=float), force[k])
        external.append(pin.Force(force[k], about_joint))
        rotation = poses[k, :3]
        in_mujoco.data.xfrc_applied[in_mujoco.numbers[k]] = [
            *(rotation.T @ force[k]),
            *(rotation.T @ torque[k]),
        ]
    model, data, still = pinocchio.model, pinocchio.data, np.zeros(pinocchio.model.nv)
    m = np.array(pin.crba(model, data, pinocchio.q))
    bias = pin.rnea(model, data, pinocchio.q, pinocchio.v, still, external)
    _close(pinocchio.map.from_bias(mine.x, mine.y, m, bias), loaded)
    work = np.zeros(in_mujoco.model.nv)
    for number in in_mujoco.numbers:
        part: Floats = np.zeros(in_mujoco.model.nv)
        wrench = in_mujoco.data.xfrc_applied[number]
        point = in_mujoco.data.xipos[number]
        mujoco.mj_applyFT(in_mujoco.model, in_mujoco.data, wrench[:3], wrench[3:], point, number, part)
        work += part
    _close(mine.results["forcing"] + in_mujoco.map.from_tau(mine.x, work), loaded)


def test_ros_quaternions_have_the_scalar_last_and_take_body_to_world() -> None:
    """scipy has the convention of ROS's geometry_msgs/Quaternion: x, y, z, w."""
    mine = robot()
    scalar, *vector = (mine.x[_place(mine.system, f"base.e{i}")] for i in range(4))
    _close(Rotation.from_quat([*vector, scalar]).as_matrix().T, mine.results["body_poses"][0, :3])


def test_roll_pitch_yaw_are_the_angles_of_the_sequence_3_2_1_backwards() -> None:
    """rpy of URDF and ROS turns about fixed x, y, z; theta1, theta2, theta3 are yaw, pitch and roll."""
    rpy = (0.4, -0.7, 1.9)
    _close(Rotation.from_euler("xyz", rpy).as_matrix(), np.array(rotation_rpy(rpy)))
    _close(pin.rpy.rpyToMatrix(*rpy), np.array(rotation_rpy(rpy)))
    body = kg.Body("b", 0, 1.0, np.eye(3).tolist(), joint=kg.Joint(sequence="3-2-1"))
    library = kg.build(kg.System("cube", (body,)), outputs=("body_poses",))
    roll, pitch, yaw = rpy
    _close(library.body_poses([yaw, pitch, roll, 0, 0, 0])[0, :3].T, np.array(rotation_rpy(rpy)))
