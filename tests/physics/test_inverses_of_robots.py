"""Compiled [A]^-1 and operational inertia of robots against Pinocchio's `computeMinverse` and Jacobians."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import kanegen as kg
from kanegen.model.arrays import Floats
from tests.support.robots import floating_model, places, robot_file

OUTPUTS = ("mass_matrix_inverse", "operational_inertia_inverse", "operational_inertia", "operational_bias")
ANGULAR_FIRST = [3, 4, 5, 0, 1, 2]
"""Rows of Pinocchio's LOCAL_WORLD_ALIGNED in kanegen's order."""

ROBOTS = [
    ("ur5_robot", "tool0", False),
    pytest.param("kinova", "j2s6s200_end_effector", False, marks=pytest.mark.slow),
    pytest.param("xarm7", "link7", False, marks=pytest.mark.slow),
    pytest.param("hyq_no_sensors", "lh_foot", True, marks=pytest.mark.slow),
    pytest.param("solo12", "HL_FOOT", True, marks=pytest.mark.slow),
]


def reading(name: str, floating: bool) -> tuple[kg.System, pin.Model, list[int]]:
    """Return a robot, Pinocchio's model of it, and for every velocity of that model its place in {y}."""
    path = robot_file(name)
    system = kg.load(path, floating_base=floating)
    model, several = floating_model(path, system) if floating else (pin.buildModelFromUrdf(str(path)), {})
    return system, model, list(places(system, model, several))


def scaled(matrix: Floats, size: Floats) -> Floats:
    return matrix / size[:, None] / size[None, :]


def check(found: Floats, right: Floats, lost: float) -> None:
    """Require equal symmetric matrices, entry (i, j) relative to the root of entries (i, i) and (j, j)."""
    size = np.sqrt(np.diagonal(right))
    assert np.abs(scaled(found - right, size)).max() <= lost


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(("name", "frame", "floating"), ROBOTS)
def test_c_agrees_with_pinocchio(name: str, frame: str, floating: bool) -> None:
    """Each side loses some roundoffs times the condition numbers of [A] and J [A]^-1 J^T, scaled."""
    system, model, order = reading(name, floating)
    library = kg.build(system.with_poses([frame]), OUTPUTS, on_status="ignore")
    rng, n = np.random.default_rng(7), len(order)
    x, y, tau = rng.uniform(-1, 1, (3, 20, n))
    found = library.evaluate(x, y, tau=tau)
    number = model.getFrameId(frame)
    for state in range(len(x)):
        data = model.createData()
        q = pin.integrate(model, pin.neutral(model), x[state][order])
        upper = np.triu(np.array(pin.computeMinverse(model, data, q)))
        right = np.zeros((n, n))
        right[np.ix_(order, order)] = upper + np.triu(upper, 1).T
        lost = 1e-14 * np.linalg.cond(scaled(right, np.sqrt(np.diagonal(right))))
        check(found.mass_matrix_inverse[state], right, lost)
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        j = np.zeros((6, n))
        j[:, order] = pin.getFrameJacobian(model, data, number, pin.LOCAL_WORLD_ALIGNED)[ANGULAR_FIRST]
        mobility = j @ right @ j.T
        check(found.operational_inertia_inverse[state, 0], mobility, lost)
        lost *= np.linalg.cond(scaled(mobility, np.sqrt(np.diagonal(mobility))))
        inertia = np.linalg.inv(mobility)
        check(found.operational_inertia[state, 0], inertia, lost)
        a = acceleration(model, number, q, y[state][order], tau[state][order])
        size = np.sqrt(np.diagonal(inertia))
        error = np.abs((found.operational_bias[state, 0] + inertia @ a) / size).max()
        assert error <= 10 * lost * np.abs(inertia @ a / size).max()


def acceleration(model: pin.Model, frame: int, q: Floats, v: Floats, tau: Floats) -> Floats:
    """Return the acceleration of a frame under {tau}, by Pinocchio's `aba`."""
    data = model.createData()
    vdot = pin.aba(model, data, q, v, tau)
    pin.forwardKinematics(model, data, q, v, vdot)
    found = pin.getFrameClassicalAcceleration(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
    return np.asarray(found.vector)[ANGULAR_FIRST]
