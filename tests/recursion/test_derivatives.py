"""Derivatives of {f}, of generalized forces and of {ydot}: against complex steps through the reference."""

from __future__ import annotations

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.lowering import solution_columns
from kanegen.program.count import count
from kanegen.recursion.outputs import DERIVATIVES
from kanegen.reference.kinematics import kinematics
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.complex_steps import STEP, dynamics, state
from tests.support.orientation_trees import (
    ANGULAR_VELOCITY,
    close,
    mixed,
    values,
    with_quaternions,
)
from tests.support.paths import MODELS

DYNAMICS = [f"{name}_derivatives" for name in ("forcing", "inverse_dynamics", "forward_dynamics")]
"""The outputs of this module; `test_quantity_derivatives` has the others."""


def expected(system: kg.System, inputs: dict[str, np.ndarray], name: str) -> np.ndarray:
    """Return a derivative by complex steps, whose errors are those of the reference itself."""

    def value(changed: dict[str, np.ndarray]) -> np.ndarray:
        matrix, forcing = dynamics(system, changed)
        if name == "forcing_derivatives":
            return forcing
        if name == "inverse_dynamics_derivatives":
            return matrix @ inputs["ydot"] - forcing
        return np.linalg.solve(matrix, forcing + changed["tau"])

    columns = []
    for array in DERIVATIVES[name].by:
        for k in range(len(inputs[array])):
            moved = inputs[array].astype(complex)
            moved[k] += 1j * STEP
            columns.append(value(inputs | {array: moved}).imag / STEP)
    return np.stack(columns, axis=1)


SYSTEMS = {
    "rates": mixed,
    "angular velocities": lambda seed: mixed(seed).with_speeds(ANGULAR_VELOCITY),
    "quaternions": with_quaternions,
    "slides and hinges": lambda seed: systems.random_system(np.random.default_rng(seed), 5, loads=True),
}


@pytest.mark.parametrize("name", DYNAMICS)
@pytest.mark.parametrize("kind", slow_except(SYSTEMS, "quaternions", "rates"))
@pytest.mark.parametrize("seed", slow_except(range(3), 1))
def test_derivatives_agree_with_complex_steps(seed: int, kind: str, name: str) -> None:
    system = SYSTEMS[kind](seed)
    inputs = state(system, seed)
    right = expected(system, inputs, name)
    close(values(system, inputs, name)[name], right, 1e-11)


@pytest.mark.parametrize(
    "kind", slow_except(("angular velocities", "quaternions", "slides and hinges"), "slides and hinges")
)
@pytest.mark.parametrize("seed", slow_except(range(3), 1))
def test_derivatives_in_loops_agree_with_complex_steps(
    seed: int, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solution_columns, "LOOPED", 0)
    system, name = SYSTEMS[kind](seed), DYNAMICS[-1]
    inputs = state(system, seed)
    close(values(system, inputs, name)[name], expected(system, inputs, name), 1e-11)


@pytest.mark.parametrize("seed", slow_except((1, 2), 1))
def test_derivatives_share_intermediates_with_their_outputs(seed: int) -> None:
    """No value changes, and the intermediates are shared."""
    system = mixed(seed).with_speeds(ANGULAR_VELOCITY)
    inputs = state(system, seed)
    names = ("forward_dynamics", "forward_dynamics_derivatives", "inverse_dynamics")
    together = values(system, inputs, *names)
    for name, array in zip(names, ("acceleration", names[1], "generalized_force"), strict=True):
        close(together[array], values(system, inputs, name)[array])
    module = compile_module(system, names).module
    cost = {name: sum(count(function).values()) for name, function in module.functions.items()}
    assert cost["evaluate"] < sum(cost[name] for name in names)
    (alone,) = compile_module(system, names[1:2]).module.functions.values()
    assert sum(count(alone).values()) == cost["forward_dynamics_derivatives"]


@pytest.mark.parametrize("name", DYNAMICS)
def test_compiled_code_and_parameters(name: str) -> None:
    """Columns by parameters against central differences of compiled code in doubles."""
    system = kg.load(MODELS / "gantry_crane.toml")
    base = name.removesuffix("_derivatives")
    library = kg.build(system, (name, base))
    rng = np.random.default_rng(3)
    n = library.n
    third = {"inverse_dynamics": "ydot", "forward_dynamics": "tau"}.get(base)
    x, y, more = rng.uniform(-0.5, 0.5, (3, n))
    arguments = (x, y, more) if third else (x, y)
    found = getattr(library, name)(*arguments)
    columns = library.derivative_columns(name)
    assert list(columns) == [*DERIVATIVES[name].by, "parameters"]
    assert found.shape == (n, columns["parameters"].stop)
    for k, (parameter, value) in enumerate(library.parameters.items()):
        step = 1e-6 * (abs(value) or 1.0)
        high, low = (
            getattr(library.with_parameters({parameter: value + sign * step}), base)(*arguments)
            for sign in (1, -1)
        )
        close(found[:, columns["parameters"]][:, k], (high - low) / (2 * step), 1e-7)
    batch = getattr(library, name)(*(np.stack([one, one]) for one in arguments))
    assert (batch[0] == batch[1]).all()
    close(batch[1], found)


def test_the_derivative_by_tau_is_the_inverse_of_the_mass_matrix() -> None:
    system = kg.load(MODELS / "scara.toml")
    library = kg.build(system, ("forward_dynamics_derivatives", "mass_matrix"))
    x, y = np.random.default_rng(1).uniform(-1, 1, (2, library.n))
    found = library.forward_dynamics_derivatives(x, y)
    inverse = found[:, library.derivative_columns("forward_dynamics_derivatives")["tau"]]
    close(inverse @ library.mass_matrix(x), np.eye(library.n), 1e-11)


def test_the_header_documents_the_columns() -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    header = " ".join(kg.generate(system, ("forcing_derivatives",)).files["double_pendulum.h"].split())
    assert "by x (columns 0 to 1), then y (columns 2 to 3), then parameters (columns 4 to 8)" in header


def test_a_singular_state_is_refused() -> None:
    system = kg.load(MODELS / "free_body.toml")
    library = kg.build(system, ("forward_dynamics_derivatives",))
    x = np.zeros(6)
    x[1] = np.nan
    with pytest.raises(kg.SingularError):
        library.forward_dynamics_derivatives(x, np.zeros(6))
    with pytest.raises(kg.OptionError, match="Did you mean 'forcing_derivatives'"):
        library.derivative_columns("forcing_derivative")


def test_complex_steps_reach_every_rotation() -> None:
    """The reference takes complex states: [^J R_K] then turns by their imaginary part."""
    system = mixed(0)
    x = np.full(len(system.coordinates), 0.3)
    moved = kinematics(system.values(), x + 1j * STEP, np.zeros(len(system.freedoms), complex))
    assert any(np.abs(body.relative_rotation.imag).max() > 0.1 * STEP for body in moved)
