"""Functions of CasADi of some systems, each compiled once, and steps of the reference."""

import functools

import casadi as ca
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

WARNINGS = "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror".split()
"""Flags of compilers for which the generated file has no warnings."""

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
    names = [one.name for one in casadi_functions(library.source) if not one.is_derivative]
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


def inputs_of(library, seed=0):
    """Return random values of every input by name, and those that the library takes by name."""
    rng = np.random.default_rng(seed)
    sizes = {array.name: array.shape for one in library.source.functions for array in one.inputs}
    found = {name: rng.uniform(-1.0, 1.0, shape) for name, shape in sizes.items() if name != "prepared"}
    for kind in ("body", "point"):
        for name in {"body": ("force", "torque"), "point": ("point_force", "point_moment")}[kind]:
            if name in found:
                found[name][list(library.source.model.unloaded(kind))] = 0.0
    return found | {"step": np.array(0.01)}


def called(function, values):
    """Return the results of a function of CasADi by name, as dense arrays."""
    given = {name: values[name] for name in function.name_in() if name in values and name != "parameters"}
    return {name: value.full() for name, value in function(**given).items()}


def textbook(names):
    """Return {ydot} of the double pendulum, written by hand, as a function of CasADi.

    Args:
        names: Names of the parameters in their order.
    """
    x, y, tau, parameters = (ca.SX.sym(name, size) for name, size in SIZES.items())
    by_name = dict(zip(names, ca.vertsplit(parameters), strict=True))
    m1, m2, l1, l2, g = (by_name[name] for name in ("m1", "m2", "l1", "l2", "g"))
    q1, q2 = ca.vertsplit(x)
    w1, w2 = ca.vertsplit(y)
    both = m2 * l2**2 + m2 * l1 * l2 * ca.cos(q2)
    first = (m1 + m2) * l1**2 + both + m2 * l1 * l2 * ca.cos(q2)
    A = ca.blockcat([[first, both], [both, m2 * l2**2]])
    h, weight = m2 * l1 * l2 * ca.sin(q2), m2 * g * l2 * ca.sin(q1 + q2)
    f = ca.vertcat(h * (2 * w1 * w2 + w2**2) - (m1 + m2) * g * l1 * ca.sin(q1) - weight, -h * w1**2 - weight)
    return ca.Function(
        "textbook", [x, y, tau, parameters], [ca.solve(A, f + tau)], [*SIZES], ["acceleration"]
    )


SIZES = {"x": 2, "y": 2, "tau": 2, "parameters": 5}
"""Inputs of the double pendulum and their numbers of elements."""
