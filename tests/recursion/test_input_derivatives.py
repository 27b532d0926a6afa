"""Derivatives by loads, time and prescribed motion, against differences of the reference."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Module
from kanegen.recursion.outputs import DERIVATIVES
from kanegen.reference import equations as reference
from tests.support.acting import acted_on
from tests.support.cases import slow_except
from tests.support.orientation_trees import close
from tests.support.paths import MODELS
from tests.support.prescribed_trees import state, tree

NAMES = [name for name in DERIVATIVES if name.endswith("_input_derivatives")]

CASES = [(kind, seed) for kind in ("small", "slides and hinges", "sequences") for seed in (1, 2)]

STEPS = {"t": 2.0**-17, "prescribed": 2.0**-17}
"""Steps of differences; 1 for loads, on which the equations depend linearly."""


def of_reference(system: kg.System, name: str, given: dict[str, np.ndarray]) -> np.ndarray:
    """Return the output that is differentiated, from [A] and {f} of the reference."""
    x, y, prescribed = given["x"], given["y"], given["prescribed"]
    loads = {key: given[key] for key in ("force", "torque", "point_force", "point_moment", "t")}
    f = reference.forcing(system, x, y, prescribed=prescribed, **loads)
    if name.startswith("forcing"):
        return f
    A = reference.mass_matrix(system, x, prescribed)
    return A @ given["ydot"] - f if name.startswith("inverse") else np.linalg.solve(A, f + given["tau"])


def small() -> kg.System:
    """Return a cart with two poles that follows a given motion; the cart and a pole take loads."""
    system = kg.load(MODELS / "cart_two_poles.toml").with_prescribed(["position"])
    bodies = (replace(body, loads=k != 1) for k, body in enumerate(system.bodies))
    return replace(system, bodies=tuple(bodies))


@functools.cache
def compiled(kind: str, seed: int) -> tuple[kg.System, Module]:
    """Return a tree on which everything acts, and the programs that become C."""
    system = acted_on(small() if kind == "small" else tree(kind, seed), seed)
    return system, compile_module(system, NAMES).module


def values(system: kg.System, module: Module, name: str, given: dict[str, np.ndarray]) -> np.ndarray:
    """Return the result of the program of an output."""
    inputs = {key: value.ravel() for key, value in given.items()}
    if module.prepare is not None:
        parameters = [parameter.value for parameter in system.parameters]
        inputs |= evaluate(module.prepare, {"parameters": parameters}, np)
    found = evaluate(module.functions[name], inputs, np)[name]
    return np.reshape(np.array(found, float), (len(system.freedoms), -1))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("case", slow_except(CASES, ("small", 1)))
def test_differences_of_the_reference(case: tuple[str, int], name: str) -> None:
    seed = case[1]
    system, module = compiled(*case)
    rng = np.random.default_rng(seed)
    points = (len(system.points), 3)
    given = state(system, seed) | {"t": np.array(0.3)}
    given |= {key: rng.normal(size=points) for key in ("point_force", "point_moment")}
    for key, parts in (("force", system.bodies), ("point_force", [one for _, one in system.points])):
        for row, one in enumerate(parts):
            if not one.loads:
                given[key][row] = given[{"force": "torque"}.get(key, "point_moment")][row] = 0.0
    found = values(system, module, name, given)
    columns = DERIVATIVES[name].columns_of(system)
    assert list(columns) == ["force", "torque", "point_force", "point_moment", "t", "prescribed"]
    for key, part in columns.items():
        step = STEPS.get(key, 1.0)
        for element, column in enumerate(range(part.start, part.stop)):
            ends = []
            for sign in (1, -1):
                moved = given[key].copy().reshape(-1)
                moved[element] += sign * step
                changed = given | {key: moved.reshape(given[key].shape)}
                ends.append(of_reference(system, name, changed))
            expected = (ends[0] - ends[1]) / (2 * step)
            if not is_read(system, key, element):
                expected = np.zeros_like(expected)
            close(found[:, column], expected, 1e-6 if key in STEPS else 1e-10)


def is_read(system: kg.System, key: str, element: int) -> bool:
    """Return whether generated code reads an element: rows of bodies and points without loads it does not."""
    if key in ("force", "torque"):
        return system.bodies[element // 3].loads
    return not key.startswith("point") or system.points[element // 3][1].loads


def test_methods_of_a_library() -> None:
    system = kg.load(MODELS / "satellite.toml")
    library = kg.build(system, (*NAMES, "mass_matrix"))
    x, y, more = np.linspace(0.1, 0.9, 9), np.linspace(-1.0, 1.0, 8), np.ones(8)
    by = library.derivative_columns("forcing_input_derivatives")
    assert by == {"force": slice(0, 9), "torque": slice(9, 18)}
    of_f = library.forcing_input_derivatives(x, y)
    close(library.inverse_dynamics_input_derivatives(x, y, more), -of_f)
    close(library.mass_matrix(x) @ library.forward_dynamics_input_derivatives(x, y, more), of_f, 1e-11)
    assert (of_f[:, 3:9] == 0.0).all() and of_f[:, 0:3].any()


def test_systems_without_such_inputs() -> None:
    with pytest.raises(kg.OptionError, match="has neither loads nor prescribed freedoms"):
        kg.generate(kg.load(MODELS / "double_pendulum.toml"), ("forcing_input_derivatives",))
