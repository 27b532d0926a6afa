"""Forward and inverse dynamics as programs: against the reference, each other, and high precision."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.lowering.definitions import lower_definitions
from kanegen.model.coordinates import FREEDOMS
from kanegen.program import passes
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Program
from kanegen.recursion import Methods, derive, methods
from kanegen.recursion.factorisation import worth_trying
from kanegen.recursion.outputs import input_arrays, output_array
from kanegen.reference import equations as reference
from tests.support import systems
from tests.support.cases import slow_except

Arrays = dict[str, np.ndarray]


def program(system: kg.System, way: Methods) -> Program:
    form = derive(system, way)
    arrays = {output_array(system, name, way): form.outputs[name] for name in way}
    return passes.run(lower_definitions(input_arrays(system), form.definitions, arrays))[0]


def inputs(system: kg.System, rng: np.random.Generator) -> Arrays:
    n, bodies = len(system.freedoms), system.number_of_bodies
    takes = np.array([body.loads for body in system.bodies])[:, None]
    values = dict(zip(("x", "y", "tau", "ydot"), rng.normal(size=(4, n)), strict=True))
    return values | {name: rng.normal(size=(bodies, 3)) * takes for name in ("force", "torque")}


def run(system: kg.System, way: Methods, values: Arrays) -> dict[str, np.ndarray]:
    flat = {name: value.ravel() for name, value in values.items()}
    return {name: np.array(v) for name, v in evaluate(program(system, way), flat, np).items()}


FORWARD: dict[str, Methods] = {
    name: {"forward_dynamics": name} for name in ("articulated bodies", "factorisation")
}
INVERSE: Methods = {"inverse_dynamics": "recursion of forces"}


@pytest.mark.parametrize("seed", slow_except(range(25), *range(8)))
def test_inverse_dynamics_is_a_ydot_minus_f(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system = systems.random_system(rng, bodies=int(rng.integers(1, 8)))
    values = inputs(system, rng)
    a = reference.mass_matrix(system, values["x"])
    f = reference.forcing(system, values["x"], values["y"], values["force"], values["torque"])
    expected = a @ values["ydot"] - f
    found = run(system, INVERSE, values)["generalized_force"]
    assert np.abs(found - expected).max() <= 1e-13 * np.abs(a).max() * (1 + np.abs(f).max())


@pytest.mark.parametrize("way", FORWARD)
@pytest.mark.parametrize("seed", slow_except(range(25), *range(3)))
def test_forward_dynamics_solves_the_equations(seed: int, way: str) -> None:
    rng = np.random.default_rng(seed)
    system = systems.random_system(rng, bodies=int(rng.integers(1, 8)))
    values = inputs(system, rng)
    a = reference.mass_matrix(system, values["x"])
    f = reference.forcing(system, values["x"], values["y"], values["force"], values["torque"])
    found = run(system, FORWARD[way], values)["acceleration"]
    scale = np.sqrt(np.diag(a))
    condition = np.linalg.cond(a / np.outer(scale, scale))
    expected = np.linalg.solve(a / np.outer(scale, scale), (f + values["tau"]) / scale)
    # The solution of the reference loses condition times 2^-53, and the program about as much.
    assert np.abs(found * scale - expected).max() <= 1e-15 * 20 * condition * np.abs(expected).max() + 1e-12


@pytest.mark.parametrize("seed", slow_except(range(10), *range(3)))
def test_inverse_undoes_forward(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system = systems.chain(6, ["theta1", "s2"], seed=seed, loads=True)
    values = inputs(system, rng)
    values["ydot"] = run(system, FORWARD["articulated bodies"], values)["acceleration"]
    found = run(system, INVERSE, values)["generalized_force"]
    size = np.abs(reference.mass_matrix(system, values["x"])).max() * np.abs(values["ydot"]).max()
    assert np.abs(found - values["tau"]).max() <= 1e-13 * size


@pytest.mark.parametrize("distance", [1e-1, 1e-4, 1e-8, 1e-12])
def test_angular_acceleration_is_regular_where_the_angles_are_not(distance: float) -> None:
    """With all bodies near gimbal lock, theta2 = pi/2 - distance, angular accelerations lose no digits."""
    system = systems.eight_body(loads=False)
    rng = np.random.default_rng(5)
    values = inputs(system, rng)
    values["tau"] *= 0.0  # generalized forces themselves are singular there: their torque grows like 1/cos
    for i, freedom in enumerate(system.freedoms):
        if FREEDOMS[freedom.index] == "theta2":
            values["x"][i] = np.pi / 2 - distance
    compiled = program(system, FORWARD["articulated bodies"])
    flat = {name: value.ravel() for name, value in values.items()}
    found = np.array(evaluate(compiled, flat, np)["acceleration"])
    with mpmath.workdps(60):
        exact = {name: [mpmath.mpf(float(v)) for v in value] for name, value in flat.items()}
        truth = np.array([float(v) for v in evaluate(compiled, exact, mpmath, mpmath.mpf)["acceleration"]])
    index = np.array([freedom.index for freedom in system.freedoms])
    for part in (np.isin(index, (1, 3, 4, 5)), np.isin(index, (0, 2))):  # regular; growing like 1/cos(theta2)
        error = np.abs(found - truth)[part].max()
        assert error <= 80 * 8 * 2.0**-53 * np.abs(truth[part]).max()


def test_a_joint_with_all_freedoms_passes_nothing_but_its_efforts() -> None:
    operations = compile_module(systems.eight_body(loads=False), ("forward_dynamics",)).operations
    total = operations["add"] + operations["multiply"] + operations["divide"]
    assert total <= 2297
    assert operations["divide"] == 8


COUNTS = {"hinges 6": 1021, "hinges 20": 5524, "free bodies 10": 2919}


@pytest.mark.parametrize("name", slow_except(COUNTS, "hinges 6"))
def test_operations_do_not_rise(name: str) -> None:
    kind, number = name.rsplit(" ", 1)
    bodies = int(number)
    free = systems.flags(bodies, FREEDOMS)
    if kind == "hinges":
        free = np.eye(6, dtype=bool)[[k % 3 for k in range(bodies)]]
    system = systems.random_system(
        np.random.default_rng(1),
        bodies,
        connection=range(bodies),
        free=free,
        loads=False,
        orientations=False,
        locked=False,
        gravity=(0, 0, -9.81),
    )
    operations = compile_module(system, ("forward_dynamics",)).operations
    assert operations["add"] + operations["multiply"] + operations["divide"] <= COUNTS[name]


def test_the_cheaper_solver_is_chosen_and_named() -> None:
    short, long = systems.chain(3), systems.chain(20)
    assert compile_module(short, ("forward_dynamics",)).methods == FORWARD["factorisation"]
    assert compile_module(long, ("forward_dynamics",)).methods == FORWARD["articulated bodies"]
    header = kg.generate(short, outputs=("forward_dynamics",)).files["chain.h"]
    assert "by factorisation" in header


def test_three_angles_are_never_factorised() -> None:
    gimbal = systems.chain(2, ["theta1", "theta2", "theta3"])
    assert not worth_trying(gimbal)
    assert methods(gimbal, ("forward_dynamics",)) == (FORWARD["articulated bodies"],)


@pytest.mark.slow
def test_cost_grows_linearly_with_the_bodies() -> None:
    costs = []
    for bodies in (16, 32):
        system = replace(systems.chain(bodies, ["theta1"]), name="chain")
        costs.append(sum(compile_module(system, ("forward_dynamics",)).operations.values()))
    assert costs[1] <= 2.1 * costs[0]
