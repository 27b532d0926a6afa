"""The artifact "casadi" in CasADi itself: values, sparsities, Jacobians, statuses, and what it refuses."""

import functools
import subprocess

import casadi as ca
import numpy as np
import pytest

import kanegen as kg
from kanegen import extras
from kanegen.artifacts import with_artifacts
from kanegen.artifacts.casadi import casadi_functions, symbol, usual_outputs
from kanegen.errors import MissingError, OptionError
from kanegen.interop import casadi
from kanegen.reference import equations as reference
from tests.support.paths import MODELS
from tests.support.random_trees import everything

WARNINGS = "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror".split()

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

EPSILON = np.finfo(float).eps


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


def method(library, name, values):
    """Return the results of the same function by the library, in the order of its outputs."""
    signature = next(one for one in library.source.functions if one.name == name)
    given = {array.name: values[array.name] for array in signature.inputs if array.name != "prepared"}
    if name == "step_rk4":
        return library.step(**given, method="rk4")
    return [getattr(library, name)(**given)]


@pytest.mark.parametrize("case", CASES)
def test_values_are_those_of_the_library_bit_for_bit(case):
    _, library, functions = made(case)
    for seed in range(3):
        values = inputs_of(library, seed)
        for name, function in functions.items():
            if name == "ode":
                continue
            for one, expected in zip(
                called(function, values).values(), method(library, name, values), strict=True
            ):
                np.testing.assert_array_equal(one, np.reshape(expected, one.shape), name)


@pytest.mark.parametrize("case", ["parameters", "loads"])
def test_dynamics_solve_the_equations_of_the_reference(case):
    system, library, functions = made(case)
    values = inputs_of(library)
    parameters = {p.name: 1.1 * p.value for p in system.parameters}
    other = system.with_parameters(parameters)
    loads = {name: values[name] for name in ("force", "torque") if name in values}
    given = {name: values[name] for name in functions["ode"].name_in() if name != "parameters"}
    rates = functions["ode"](**given, parameters=list(parameters.values()))
    np.testing.assert_array_equal(rates["xdot"].full().ravel(), values["y"])
    A = reference.mass_matrix(other, values["x"])
    right = reference.forcing(other, values["x"], values["y"], **loads) + values["tau"]
    residual = A @ rates["acceleration"].full().ravel() - right
    np.testing.assert_allclose(residual, 0.0, atol=100 * EPSILON * np.abs(right).max())


@pytest.mark.parametrize("case", CASES)
def test_jacobians_are_the_derivatives_of_the_library_bit_for_bit(case):
    _, library, functions = made(case)
    values = inputs_of(library)
    for name in ("inverse_dynamics", "forward_dynamics"):
        (array,) = functions[name].name_out()
        found = called(functions[name].jacobian(), values)
        for output in (f"{name}_derivatives", f"{name}_input_derivatives"):
            if output in library.outputs:
                (expected,) = method(library, output, values)
                for by, columns in library.derivative_columns(output).items():
                    block = found.pop(f"jac_{array}_{by}")
                    np.testing.assert_array_equal(block, in_columns(expected[:, columns], values, by), by)
        assert set(found) <= {f"jac_{array}_ydot"}
        for block in found.values():
            np.testing.assert_array_equal(block, library.mass_matrix(**only(values, "x")))


def in_columns(derivatives, values, by):
    """Return derivatives by the elements of an array, row by row, in CasADi's order, column by column."""
    shape = values[by].shape if by in values else derivatives.shape[1:]
    order = np.arange(derivatives.shape[1]).reshape(shape or 1)
    return derivatives[:, order.ravel(order="F")]


def only(values, *names):
    return {name: values[name] for name in (*names, "prescribed") if name in values}


@pytest.mark.parametrize("case", ["loads", "quaternion"])
def test_patterns_are_exactly_the_entries_that_some_state_has(case):
    _, library, functions = made(case)
    states = [inputs_of(library, seed) for seed in range(5)]
    for function in (functions["mass_matrix"], functions["inverse_dynamics"].jacobian()):
        found = [called(function, values) for values in states]
        for place, name in enumerate(function.name_out()):
            largest = np.max([np.abs(one[name]) for one in found], axis=0)
            stored = ca.DM(function.sparsity_out(place), 1.0).full() == 1.0
            np.testing.assert_array_equal(largest != 0.0, stored, name)


def test_the_file_gives_no_warnings(tmp_path):
    for case in ("loads", "quaternion", "everything"):
        _, library, _ = made(case)
        source = with_artifacts(library.source, "casadi")
        source.write(tmp_path / case)
        for compiler in ("gcc", "clang"):
            command = [compiler, *WARNINGS, "-fsyntax-only", f"{source.model.name}_casadi.c"]
            subprocess.run(command, cwd=tmp_path / case, check=True)


def test_parameters_that_are_left_out_have_the_values_of_the_library():
    system = kg.load(MODELS / "double_pendulum.toml")
    heavy = kg.build(system).with_parameters({"m1": 3.0})
    function = casadi.function(heavy, "mass_matrix")
    x = [0.1, 0.2]
    expected = heavy.mass_matrix(x)
    np.testing.assert_array_equal(function(x=x)["A"].full(), expected)
    np.testing.assert_array_equal(function(x, list(heavy.parameters.values())).full(), expected)
    assert not np.array_equal(function(x, [1, 0.5, 1, 0.7, 9.81]).full(), expected)


def test_a_parameter_that_is_no_number_is_not_replaced():
    _, _, functions = made("parameters")
    with pytest.raises(RuntimeError):
        functions["mass_matrix"]([0.1, 0.2], [1.0, float("nan"), 1.0, 0.7, 9.81])


def test_a_status_makes_the_evaluation_fail():
    _, _, functions = made("parameters")
    with pytest.raises(RuntimeError):
        functions["forward_dynamics"](x=[0.0, 0.0], y=[0.0, 0.0], parameters=[0.0, 0.0, 0.0, 0.0, 9.81])
    with pytest.raises(RuntimeError):
        functions["ode"].jacobian()(x=[float("inf"), 0.0], parameters=[1, 0.5, 1, 0.7, 9.81])


def test_functions_that_there_are_not():
    with pytest.raises(
        OptionError, match=r"unknown function 'forward_dynamic'\. Did you mean 'forward_dynamics'"
    ):
        casadi.function(SYSTEMS["loads"](), "forward_dynamic")
    library = kg.build(SYSTEMS["loads"]())
    with pytest.raises(
        OptionError, match=r"no function 'ode'. Generate it with outputs=\('forward_dynamics', "
    ):
        casadi.function(library, "ode")
    with pytest.raises(OptionError, match="'cart_pole' is no system"):
        casadi.function("cart_pole")


def test_numbers_other_than_doubles_are_refused():
    source = kg.generate(SYSTEMS["loads"](), precision="float")
    assert "casadi" not in source.artifacts
    with pytest.raises(OptionError, match=r"numbers of CasADi are doubles, those in the arrays .* 'float'"):
        casadi.function(source, "mass_matrix")
    mixed = kg.build(SYSTEMS["quaternion"](), precision="double-double", tier=kg.Variant(storage="double"))
    assert casadi.function(mixed, "mass_matrix").sparsity_out(0).nnz() == 26


def test_without_casadi(monkeypatch):
    monkeypatch.setattr(extras.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingError, match=r"casadi is not installed \(pip install 'kanegen\[casadi\]'\)"):
        casadi.function(SYSTEMS["loads"]())


def test_two_underscores_of_a_name_become_one():
    library = kg.build(kg.load(MODELS / "planar_pendulum.toml").with_name("arm__2_"))
    assert casadi.function(library, "mass_matrix").name() == "arm_2_casadi_mass_matrix"
