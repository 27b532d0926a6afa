"""The artifact "casadi" in CasADi itself: values, sparsities, Jacobians, statuses, and what it refuses."""

import pickle
import subprocess

import casadi as ca
import numpy as np
import pytest

import kanegen as kg
from kanegen import extras
from kanegen.artifacts import with_artifacts
from kanegen.errors import MissingError, OptionError
from kanegen.interop import casadi
from kanegen.reference import equations as reference
from tests.support import pages
from tests.support.casadi_functions import (
    CASES,
    SIZES,
    SYSTEMS,
    WARNINGS,
    by_reference,
    called,
    inputs_of,
    made,
    textbook,
)
from tests.support.cases import slow_except
from tests.support.paths import MODELS

EPSILON = np.finfo(float).eps


def method(library, name, values):
    """Return the results of the same function by the library, in the order of its outputs."""
    signature = next(one for one in library.source.functions if one.name == name)
    given = {array.name: values[array.name] for array in signature.inputs if array.name != "prepared"}
    if name == "step_rk4":
        return library.step(**given, method="rk4")
    return [getattr(library, name)(**given)]


@pytest.mark.parametrize("case", slow_except(CASES, *(case for case in CASES if case != "everything")))
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


@pytest.mark.parametrize("case", slow_except(CASES, *(case for case in CASES if case != "everything")))
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
    for case in ("loads", "quaternion"):
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
    light = kg.build(system)
    np.testing.assert_array_equal(function(x, list(light.parameters.values())).full(), light.mass_matrix(x))
    assert not np.array_equal(light.mass_matrix(x), expected)


def test_a_parameter_that_is_no_number_is_not_replaced():
    _, library, functions = made("parameters")
    values = [float("nan") if name == "m1" else 1.0 for name in library.parameter_names]
    with pytest.raises(RuntimeError):
        functions["mass_matrix"](x=[0.1, 0.2], parameters=values)


def test_a_status_makes_the_evaluation_fail():
    _, _, functions = made("parameters")
    with pytest.raises(RuntimeError):
        functions["forward_dynamics"](x=[0.0, 0.0], y=[0.0, 0.0], parameters=[0.0] * 5)
    with pytest.raises(RuntimeError):
        functions["ode"].jacobian()(x=[float("inf"), 0.0])


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


def test_code_without_what_casadi_needs():
    system = SYSTEMS["loads"]()
    with pytest.raises(OptionError, match="Add --output forcing_derivatives --output forcing_input"):
        kg.generate(system, ("forcing",), artifacts="casadi")
    with pytest.raises(OptionError, match="no function of an output, only derivatives"):
        kg.generate(system, ("forcing_derivatives",), artifacts="casadi")
    with pytest.raises(OptionError, match=r"casadi: .* are of precision 'float'\. Take --precision double"):
        kg.generate(system, artifacts="casadi", precision="float")


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


def test_derivatives_are_those_of_the_equations_of_the_textbook():
    """Jacobians and forward and reverse derivatives of the C; Hessians of the expression."""
    _, library, functions = made("parameters")
    by_hand, compiled = textbook(library.parameter_names), functions["forward_dynamics"]
    given = {name: np.linspace(0.5, 1.5, size) for name, size in SIZES.items()}
    for one, other in ((compiled.jacobian(), by_hand.jacobian()), (compiled, by_hand)):
        for name, expected in other(**given).items():
            np.testing.assert_allclose(one(**given)[name].full(), expected.full(), rtol=1e-12, atol=1e-12)
    symbols = {name: ca.MX.sym(name, size) for name, size in SIZES.items()}
    every, weight = ca.vertcat(*symbols.values()), ca.DM([3.0, -2.0])
    seed = ca.DM(np.linspace(1.0, 2.0, every.numel()))
    expression = casadi.expression(library, "forward_dynamics")
    for made_of, derivative in (
        (compiled, lambda ydot: ca.jtimes(ydot, every, seed)),
        (compiled, lambda ydot: ca.jtimes(ydot, every, weight, True)),
        (expression, lambda ydot: ca.hessian(ca.dot(weight, ydot), every)[0]),
    ):
        one, other = (
            ca.Function("derivative", [*symbols.values()], [derivative(of(**symbols)["acceleration"])])
            for of in (made_of, by_hand)
        )
        found, expected = (each(*given.values()).full() for each in (one, other))
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-10)


def test_a_swing_up_converges_with_exact_derivatives_and_keeps_the_equations():
    """Multiple shooting with Ipopt; each step is that of the method of Runge and Kutta with the reference."""
    system, _, functions = made("loads")
    N, length = 40, 0.05
    states, forces = ca.MX.sym("states", 4, N + 1), ca.MX.sym("forces", 1, N)
    state, force = ca.MX.sym("state", 4), ca.MX.sym("force")
    tau = [force if name == "cart_position" else 0 for name in system.freedom_names]
    after = functions["step_rk4"](x=state[:2], y=state[2:], tau=ca.vertcat(*tau), step=length)
    step = ca.Function("step", [state, force], [ca.vertcat(after["x_next"], after["y_next"])])
    start = np.array([np.pi if name == "pole" else 0.0 for name in (*system.freedom_names, "", "")])
    defects = states[:, 1:] - step.map(N)(states[:, :-1], forces)
    problem = {
        "x": ca.veccat(states, forces),
        "f": ca.sumsqr(forces),
        "g": ca.veccat(defects, states[:, 0] - start, states[:, N]),
    }
    quiet = {"print_level": 0, "sb": "yes", "hessian_approximation": "limited-memory", "max_iter": 200}
    solver = ca.nlpsol("solver", "ipopt", problem, {"print_time": False, "ipopt": quiet})
    guess = np.concatenate([np.linspace(start, 0.0 * start, N + 1).ravel(), np.zeros(N)])
    found = solver(x0=guess, lbg=0.0, ubg=0.0)["x"].full().ravel()
    assert solver.stats()["success"]
    assert solver.stats()["iter_count"] < 100
    path, forces = found[: 4 * (N + 1)].reshape(N + 1, 4), found[4 * (N + 1) :]
    assert np.abs(forces).max() > 1.0
    for before, after, force in zip(path, path[1:], forces, strict=False):
        np.testing.assert_allclose(by_reference(system, before, force, length), after, atol=1e-6)
    np.testing.assert_allclose(path[-1], 0.0, atol=1e-6)


def test_c_that_casadi_generates_calls_the_functions(tmp_path, monkeypatch):
    """As for acados: explicit dynamics, their Jacobian and an adjoint, with `int` as CasADi's integers."""
    system = SYSTEMS["parameters"]()
    source = kg.generate(system, casadi.outputs_needed(system, "ode"), artifacts="casadi", batches=False)
    source.write(tmp_path / "model")
    x, y, tau, weight = (ca.MX.sym(name, size) for name, size in {"x": 2, "y": 2, "tau": 2, "w": 4}.items())
    rates = casadi.function(source, "ode")(x=x, y=y, tau=tau)
    rate, state = ca.vertcat(rates["xdot"], rates["acceleration"]), ca.vertcat(x, y)
    results = [
        rate,
        ca.densify(ca.jacobian(rate, ca.vertcat(state, tau))),
        ca.jtimes(rate, state, weight, True),
    ]
    function = ca.Function("explicit_ode", [x, y, tau, weight], results)
    monkeypatch.chdir(tmp_path / "model")
    function.generate("explicit_ode.c", {"main": True, "casadi_int": "int"})
    files = ["explicit_ode.c", "double_pendulum_casadi.c", "double_pendulum.c"]
    flags = ["-std=c99", "-O1", "-ffp-contract=off", "-Dcasadi_int=int"]
    subprocess.run(["gcc", *flags, *files, "-lm", "-o", "program"], check=True)
    given = np.linspace(0.1, 1.0, 10)
    words = "\n".join(map(str, given))
    printed = subprocess.run(
        ["./program", "explicit_ode"], input=words, capture_output=True, text=True, check=True
    )
    expected = function(*np.split(given, [2, 4, 6]))
    right = np.concatenate([one.full().ravel(order="F") for one in expected])
    np.testing.assert_array_equal(np.array(printed.stdout.split(), float), right)


def test_integrators_follow_a_motion():
    """CVODES with the Jacobian of the compiled function, against many short steps of the library."""
    _, library, functions = made("loads")
    x, y = ca.MX.sym("x", 2), ca.MX.sym("y", 2)
    rates = functions["ode"](x=x, y=y)
    motion = {"x": ca.vertcat(x, y), "ode": ca.vertcat(rates["xdot"], rates["acceleration"])}
    tolerances = {"abstol": 1e-10, "reltol": 1e-10}
    integrator = ca.integrator("motion", "cvodes", motion, 0.0, 1.0, tolerances)
    start = np.array([0.5, 0.1, -0.2, 0.3])
    x, y = start[:2], start[2:]
    for _ in range(1000):
        x, y = library.step(x, y, step=1e-3, method="rk4")
    np.testing.assert_allclose(integrator(x0=start)["xf"].full().ravel(), [*x, *y], atol=1e-7)


@pytest.mark.slow
def test_the_page(tmp_path, monkeypatch):
    """Its blocks run one after the other, in a copy of the checkout."""
    monkeypatch.chdir(pages.copy_of_checkout(tmp_path))
    names = {}
    for block in pages.fenced("embedding/casadi"):
        if block.file:
            continue  # tests/embedding/test_acados.py runs it
        if block.language == "python":
            exec(compile(block.text, "casadi.md", "exec"), names)
        else:
            pages.run_console(block.text, tmp_path)
    matrix = kg.build(names["cart_pole"]).mass_matrix([0.3, 0.0])
    found = ca.Function("A", [names["x"], names["y"]], [names["hessian"]])([0.3, 0.0], [1.0, 2.0])
    np.testing.assert_allclose(found.full(), matrix, rtol=1e-14, atol=1e-15)
    assert names["ode"].name_out() == ["xdot", "acceleration"]


def test_functions_are_pickled_with_the_path_of_their_library():
    _, _, functions = made("parameters")
    again = pickle.loads(pickle.dumps(functions["mass_matrix"]))
    np.testing.assert_array_equal(
        again(x=[0.1, 0.2])["A"].full(), functions["mass_matrix"](x=[0.1, 0.2])["A"].full()
    )
