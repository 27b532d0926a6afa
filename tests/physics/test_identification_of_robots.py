"""Centroidal momentum and regressors of real robots, against Pinocchio."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.interop.pinocchio import state_map
from kanegen.interop.state_map import StateMap
from kanegen.program.evaluate import evaluate
from tests.support.cases import slow_among, slow_except
from tests.support.orientation_trees import close
from tests.support.robots import robot_file

pytestmark = pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")

OUTPUTS = ("centroidal_momentum_matrix", "centroidal_momentum_bias", "regressor")
FIXED = ("ur5_robot", "panda", "kinova")
FLOATING = ("hyq_no_sensors", "talos_reduced")
ROBOTS = slow_except((*FIXED, *FLOATING), "ur5_robot", "panda", "hyq_no_sensors")

LARGEST_ALONE = {
    "centroidal_momentum_matrix": {"ur5_robot": 344, "panda": 621, "talos_reduced": 3031},
    "centroidal_momentum_bias": {"ur5_robot": 348, "panda": 796, "talos_reduced": 3934},
    "regressor": {"ur5_robot": 837, "panda": 2304},
    "base_regressor": {"ur5_robot": 669, "panda": 1707, "talos_reduced": 12354},
}
"""Additions, multiplications and divisions of an output alone; one finger of panda follows the other."""


def reading(name: str) -> tuple[kg.System, pin.Model, StateMap]:
    """Return a robot, Pinocchio's model of it and the conversion of states.

    Joints with `mimic` follow others in kanegen and move by themselves in Pinocchio's model.
    """
    path = robot_file(name)
    system = kg.load(path, floating_base=name in FLOATING)
    root = (pin.JointModelFreeFlyer(),) if name in FLOATING else ()
    model = pin.buildModelFromUrdf(str(path), *root)
    return system, model, state_map(system, model)


def parameters(system: kg.System, model: pin.Model) -> np.ndarray:
    """Return Pinocchio's inertial parameters of every body of a system, in its order."""
    joints = {frame.name: frame.parentJoint for frame in model.frames if frame.type == pin.FrameType.BODY}
    return np.concatenate([model.inertias[joints[body.name]].toDynamicParameters() for body in system.bodies])


def places(system: kg.System, model: pin.Model) -> np.ndarray:
    """Return for each column of kanegen's regressor that of Pinocchio's, which counts joints from 0."""
    joints = {frame.name: frame.parentJoint for frame in model.frames if frame.type == pin.FrameType.BODY}
    first = [10 * (joints[body.name] - 1) for body in system.bodies]
    return np.add.outer(first, np.arange(10)).ravel()


@pytest.mark.parametrize("name", slow_among(ROBOTS, "hyq_no_sensors"))
def test_pinocchio(name: str) -> None:
    system, model, states = reading(name)
    close(kg.inertial_parameters(system), parameters(system, model), 1e-14)
    functions = compile_module(system, OUTPUTS).module.functions
    columns, n = places(system, model), len(system.freedoms)
    for seed in range(2):
        x, y, ydot = np.random.default_rng(seed).uniform(-1.2, 1.2, (3, n))
        ours = {
            output: np.array(evaluate(functions[output], {"x": x, "y": y, "ydot": ydot}, np)[output])
            for output in OUTPUTS
        }
        data, q, v = model.createData(), states.to_q(x), states.to_v(x, y)
        pin.computeCentroidalMapTimeVariation(model, data, q, v)
        close(ours[OUTPUTS[0]], states.from_columns(x, data.Ag))
        close(ours[OUTPUTS[1]], data.Ag @ states.to_vdot(x, y, 0 * ydot) + data.dAg @ v)
        theirs = pin.computeJointTorqueRegressor(model, data, q, v, states.to_vdot(x, y, ydot))
        rows = [states.from_tau(x, column) for column in theirs[:, columns].T]
        close(ours["regressor"], np.stack(rows, axis=-1))


def test_a_batch_of_panda_in_c() -> None:
    system, model, states = reading("panda")
    library = kg.build(system, OUTPUTS)
    x, y, ydot = np.random.default_rng(3).uniform(-1.2, 1.2, (3, 9, library.n))
    found = library.evaluate(x, y, ydot=ydot)
    for row in range(9):
        data, q, v = model.createData(), states.to_q(x[row]), states.to_v(x[row], y[row])
        pin.computeCentroidalMapTimeVariation(model, data, q, v)
        close(found.centroidal_momentum_matrix[row], states.from_columns(x[row], data.Ag))
        vdot = states.to_vdot(x[row], y[row], ydot[row])
        tau = states.from_tau(x[row], pin.rnea(model, data, q, v, vdot))
        close(found.regressor[row] @ kg.inertial_parameters(system), tau)


@pytest.mark.parametrize("output", slow_among(LARGEST_ALONE, "base_regressor"))
def test_operations_do_not_rise(output: str) -> None:
    for name, most in LARGEST_ALONE[output].items():
        counts = compile_module(reading(name)[0], (output,)).operations
        assert counts["add"] + counts["multiply"] + counts["divide"] <= most, name
