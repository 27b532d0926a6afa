"""Functions of CasADi of some systems, each compiled once."""

import functools

import pytest

import kanegen as kg
from kanegen.artifacts.casadi import casadi_functions, symbol, usual_outputs
from kanegen.interop import casadi
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
