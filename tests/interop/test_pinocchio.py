"""States, forces and matrices of kanegen and of Pinocchio, converted both ways."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import kanegen as kg
from kanegen.interop.pinocchio import state_map
from kanegen.model.arrays import Floats
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states
from tests.support import systems
from tests.support.robots import robot_file

TOLERANCE = 1e-12
"""Relative to the largest entry: about a hundred roundings of sums over a robot, on two ways."""

FORMULATIONS: dict[str, dict[str, str]] = {
    "angle rates": {},
    "angular velocity": {"speeds": "angular_velocity"},
    "quaternion": {"coordinates": "quaternion"},
}


def _reformulated(system: kg.System, formulation: str) -> kg.System:
    for name, value in FORMULATIONS[formulation].items():
        system = getattr(system, f"with_{name}")(value)
    return system


def _close(found: Floats, expected: Floats) -> None:
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() <= TOLERANCE * max(np.abs(expected).max(), 1e-3)


def _symmetric(upper: Floats) -> Floats:
    return np.triu(upper) + np.triu(upper, 1).T


def _agrees(system: kg.System, model: Any) -> None:
    """Make sure that both programs compute the same of a batch of states, in the conventions of either."""
    states, data = state_map(system, model), model.createData()
    sample = random_states(system, 12, seed=1)
    x, y = np.clip(sample.x, -1.3, 1.3), sample.y
    tau = np.random.default_rng(2).uniform(-1, 1, y.shape)
    a, f = reference.mass_matrix(system, x), reference.forcing(system, x, y)
    ydot = np.linalg.solve(a, (f + tau)[..., None])[..., 0]
    q, v = states.to_q(x), states.to_v(x, y)
    m = np.array([_symmetric(pin.crba(model, data, one)) for one in q])
    bias = np.array([pin.nonLinearEffects(model, data, *one) for one in zip(q, v, strict=True)])
    vdot = np.linalg.solve(m, (states.to_tau(x, tau) - bias)[..., None])[..., 0]
    if not model.mimicking_joints:  # which `aba` does not take
        one = pin.aba(model, data, q[0], v[0], states.to_tau(x, tau)[0])
        assert np.abs(one - vdot[0]).max() <= 1e-9 * np.abs(one).max()  # times the condition of M
    _close(states.from_mass_matrix(x, m), a)
    _close(states.to_mass_matrix(x, a), m)
    _close(states.from_bias(x, y, m, bias), f)
    _close(states.to_bias(x, y, a, f), bias)
    _close(states.from_vdot(x, y, vdot), ydot)
    _close(states.to_vdot(x, y, ydot), vdot)
    _close(states.from_v(x, v), y)
    _close(states.from_tau(x, states.to_tau(x, tau)), tau)
    again = states.from_q(q)
    assert np.abs(states.to_q(again) - q).max() < 1e-14
    for row in (0, 7):
        assert np.array_equal(states.to_q(x[row]), q[row])
        assert np.array_equal(states.to_v(x[row], y[row]), v[row])


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize("name", ["panda", "ur5_robot", "kinova"])
def test_arms(name: str) -> None:
    """kinova has hinges without limits, for which Pinocchio has cosine and sine."""
    file = robot_file(name)
    _agrees(kg.load(file), pin.buildModelFromUrdf(str(file), mimic=True))


def _follows(system: kg.System, model: Any) -> None:
    """Make sure that a model whose joints all move by themselves agrees where they keep the couplings."""
    states, data = state_map(system, model), model.createData()
    assert states.followers
    sample = random_states(system, 6, seed=1)
    x, y = sample.x, sample.y
    ydot = np.random.default_rng(2).uniform(-1, 1, y.shape)
    a, f = reference.mass_matrix(system, x), reference.forcing(system, x, y)
    q, v, vdot = states.to_q(x), states.to_v(x, y), states.to_vdot(x, y, ydot)
    m = np.array([_symmetric(pin.crba(model, data, one)) for one in q])
    bias = np.array([pin.nonLinearEffects(model, data, *one) for one in zip(q, v, strict=True)])
    tau = np.array([pin.rnea(model, data, *one) for one in zip(q, v, vdot, strict=True)])
    _close(states.from_mass_matrix(x, m), a)
    _close(states.from_bias(x, y, m, bias), f)
    _close(states.from_tau(x, tau), np.einsum("bij,bj->bi", a, ydot) - f)
    _close(states.from_v(x, v), y)
    _close(states.from_vdot(x, y, vdot), ydot)
    _close(states.from_q(q), x)
    with pytest.raises(kg.ModelError, match="of its velocities follow others, so there is more than one"):
        states.to_tau(x, ydot)


def test_a_gripper_whose_fingers_move_by_themselves_in_pinocchio() -> None:
    file = robot_file("panda")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        system = kg.load(file)
    _follows(system, pin.buildModelFromUrdf(str(file), mimic=False))


def test_couplings_that_follow_each_other() -> None:
    """b follows a, and c follows b and d; Pinocchio has four joints that move by themselves."""
    rng, model, bodies = np.random.default_rng(3), pin.Model(), []
    for k, name in enumerate("abcd"):
        rotation, position = systems.random_rotation(rng), rng.uniform(-1, 1, 3)
        inertia = np.asarray(systems.random_inertia(rng, 1.0, 0.6)) + np.eye(3)
        free = (False, k % 2 == 0, False, k % 2 == 1, False, False)
        joint = kg.Joint(position=position, orientation=rotation, free=free, name=name)
        bodies.append(kg.Body(name, k, 1.0, inertia, (0.1, 0.2, 0.3), joint))
        kind = pin.JointModelRY() if k % 2 == 0 else pin.JointModelPX()
        number = model.addJoint(k, kind, pin.SE3(rotation.T, position), name)
        center = np.array([0.1, 0.2, 0.3])
        model.appendBodyToJoint(number, pin.Inertia(1.0, center, inertia), pin.SE3.Identity())
    couplings = kg.Coupling("c", {"b": 0.5, "d": -1.5}, 0.2), kg.Coupling("b", {"a": 2.0}, -0.1)
    system = kg.System("four", tuple(bodies)).with_couplings(*couplings)
    _follows(system, model)
    with pytest.raises(kg.ModelError, match="joint 'c' follows a prescribed freedom"):
        state_map(system.with_prescribed("d"), model)


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_a_floating_base(formulation: str) -> None:
    file = robot_file("solo12")
    system = _reformulated(kg.load(file, floating_base=True), formulation)
    _agrees(system, pin.buildModelFromUrdf(str(file), pin.JointModelFreeFlyer()))


BODIES = {
    "rail": ((False, False, False, True, True, True), pin.JointModelTranslation),
    "table": ((False, False, True, True, True, False), pin.JointModelPlanar),
    "ball": ((True, True, True, False, False, False), pin.JointModelSpherical),
    "flyer": ((True,) * 6, pin.JointModelFreeFlyer),
    "hinge": ((False, True, False, False, False, False), pin.JointModelRUBY),
}


def _every_joint(sequence: str = "1-2-3") -> tuple[kg.System, pin.Model]:
    """A chain with each of Pinocchio's joints, the frames of which are turned and shifted."""
    rng, model, bodies = np.random.default_rng(5), pin.Model(), []
    for k, (name, (free, kind)) in enumerate(BODIES.items()):
        rotation, position = systems.random_rotation(rng), rng.uniform(-1, 1, 3)
        mass, center = float(rng.uniform(1, 2)), rng.uniform(-0.5, 0.5, 3)
        inertia = np.asarray(systems.random_inertia(rng, mass, 0.6)) + np.eye(3)
        axes = sequence if all(free[:3]) else "1-2-3"
        joint = kg.Joint(position=position, orientation=rotation, free=free, name=name, sequence=axes)
        bodies.append(kg.Body(name, k, mass, inertia, center, joint))
        number = model.addJoint(k, kind(), pin.SE3(rotation.T, position), name)
        model.appendBodyToJoint(number, pin.Inertia(mass, center, inertia), pin.SE3.Identity())
    model.gravity.linear = np.array([1.0, -2.0, -9.0])
    return kg.System("every", tuple(bodies), gravity=(1.0, -2.0, -9.0)), model


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_every_joint_of_pinocchio(formulation: str) -> None:
    system, model = _every_joint()
    _agrees(_reformulated(system, formulation), model)


@pytest.mark.parametrize("sequence", ["3-2-1", "2-1-3", "3-1-3", "1-3-1", "2-3-2"])
def test_other_sequences_of_axes(sequence: str) -> None:
    system, model = _every_joint(sequence)
    proper = sequence[0] == sequence[-1]
    if proper:  # states away from theta2 = 0, where the axes lie in a plane
        states = state_map(system, model)
        x = np.full((3, len(system.coordinates)), 0.7) * np.array([[1.0], [-1.0], [2.0]])
        q = states.to_q(x)
        assert np.abs(states.to_q(states.from_q(q)) - q).max() < 1e-14
        a = reference.mass_matrix(system, x)
        m = np.array([_symmetric(pin.crba(model, model.createData(), one)) for one in q])
        _close(states.from_mass_matrix(x, m), a)
    else:
        _agrees(system, model)


def test_half_turns_and_gimbal_lock_keep_the_orientation() -> None:
    system, model = _every_joint()
    states = state_map(system, model)
    x = np.zeros((4, len(system.coordinates)))
    places = [system.coordinate_names.index(f"ball.theta{i}") for i in (1, 2, 3)]
    x[:, places] = [[np.pi, 0, 0], [0.3, np.pi / 2, -0.8], [np.pi, 0, np.pi], [-3.0, -np.pi / 2, 3.0]]
    q = states.to_q(x)
    signs = np.sign((states.to_q(states.from_q(q)) * q).sum(axis=1, keepdims=True))
    assert np.abs(states.to_q(states.from_q(q)) * signs - q * signs * signs).max() < 1e-8


def test_jacobians_by_other_velocities() -> None:
    """The Jacobian of a point by central differences over {x}, and by Pinocchio's frame Jacobian."""
    file = robot_file("solo12")
    system = kg.load(file, floating_base=True)
    model = pin.buildModelFromUrdf(str(file), pin.JointModelFreeFlyer())
    data, states = model.createData(), state_map(system, model)
    frame = model.getFrameId(system.bodies[3].name)
    library = kg.build(system.with_points({"at": (system.bodies[3].name, (0, 0, 0))}), ("point_jacobians",))
    x = np.linspace(-0.6, 0.7, len(system.coordinates))
    theirs = pin.computeFrameJacobian(model, data, states.to_q(x), frame, pin.LOCAL_WORLD_ALIGNED)
    mine = library.point_jacobians(x)[0]
    linear = mine if mine.shape[0] == 3 else mine[-3:]
    _close(states.from_columns(x, theirs)[:3], linear)
    _close(states.to_columns(x, linear), theirs[:3])


def test_what_has_no_counterpart_is_named() -> None:
    system, model = _every_joint()
    with pytest.raises(kg.ModelError, match=r"no joints for these freedoms: hinge\. Lock them"):
        state_map(system, _without_last())
    with pytest.raises(kg.ModelError, match=r"joint 'hinge' is no free freedom of system 'every'"):
        state_map(system.with_locked({"hinge": 0.1}), model)
    with pytest.raises(kg.ModelError, match=r"Pinocchio's joint 'ball' moves theta1, theta2, theta3"):
        state_map(system.with_locked({"ball.theta1": 0.1}), model)
    states = state_map(system, model)
    with pytest.raises(kg.ArrayError, match=r"x: expected shape \(16,\) or \(B, 16\), got \(3,\)"):
        states.to_q([1, 2, 3])
    with pytest.raises(kg.ArrayError, match="a quaternion has the length 2; it must be 1"):
        states.from_q(np.where(pin.neutral(model) == 1, 2.0, 0.0))
    with pytest.raises(kg.ArrayError, match=r"y: expected shape \(2, 16\) to go with x, got \(3, 16\)"):
        states.to_v(np.zeros((2, 16)), np.zeros((3, 16)))
    with pytest.raises(kg.ArrayError, match=r"M: expected shape \(2, 16, 16\) to go with x, got \(16, 16\)"):
        states.from_mass_matrix(np.zeros((2, 16)), np.eye(16))
    with pytest.raises(kg.ArrayError, match="x: expected real numbers"):
        states.to_q(["a"] * 16)
    with pytest.raises(kg.OptionError, match="None is no model of Pinocchio"):
        state_map(system, None)
    with pytest.raises(kg.OptionError, match="None is no System"):
        state_map(None, model)  # type: ignore[arg-type]
    with pytest.raises(kg.ArrayError, match=r"M: expected shape \(16, 16\)"):
        states.from_mass_matrix(np.zeros(16), np.eye(3))


def _without_last() -> pin.Model:
    model = pin.Model()
    for k, (name, (_, kind)) in enumerate(list(BODIES.items())[:-1]):
        model.addJoint(k, kind(), pin.SE3.Identity(), name)
    return model
