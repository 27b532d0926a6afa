"""Functions of CasADi of some systems, each compiled once, and steps of the reference."""

import functools

import numpy as np
import pytest

import kanegen as kg
from kanegen.artifacts.casadi import casadi_functions, symbol, usual_outputs
from kanegen.interop import casadi
from kanegen.reference import equations as reference
from tests.support.paths import MODELS
from tests.support.random_trees import everything

SYSTEMS = {
    "parameters": lambda: kg.load(MODELS / "double_pendulum.toml"),
    "loads": lambda: kg.load(MODELS / "cart_pole.toml"),
    "quaternion": lambda: kg.load(MODELS / "satellite.toml"),
    "everything": lambda: everything(2, 1),
    "panda": lambda: kg.load(MODELS / "panda_arm.toml"),
}

FURTHER = {
    "loads": ("step_rk4", "step_rk4_derivatives"),
    "quaternion": ("body_poses", "frame_jacobians", "point_positions", "point_positions_derivatives"),
}
"""Outputs beside those of dynamics."""

CASES = [*list(SYSTEMS)[:-1], pytest.param("panda", marks=pytest.mark.slow)]


@functools.cache
def made(case):
    """Return a system, a library, and its functions of CasADi by name."""
    system = SYSTEMS[case]()
    outputs = (*usual_outputs(system), *FURTHER.get(case, ()))
    library = kg.build(system, outputs, functions=outputs, on_status="ignore")
    names = [one.name for one in casadi_functions(library.source) if not one.unread]
    begin = symbol(library.source.model, "")
    functions = {n: casadi.function(library, n.removeprefix(f"{begin}_")) for n in names}
    return system, library, {n.removeprefix(f"{begin}_"): one for n, one in functions.items()}


def by_reference(system, state, force, length):
    """Return the state after a step by the classical method of Runge and Kutta, with [A] and {f} in NumPy."""
    tau = np.array([force if name == "cart_position" else 0.0 for name in system.freedom_names])

    def rates(state):
        A, f = reference.mass_matrix(system, state[:2]), reference.forcing(system, state[:2], state[2:])
        return np.concatenate([state[2:], np.linalg.solve(A, f + tau)])

    k1 = rates(state)
    k2 = rates(state + length / 2 * k1)
    k3 = rates(state + length / 2 * k2)
    k4 = rates(state + length * k3)
    return state + length / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
