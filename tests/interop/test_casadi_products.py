"""Derivatives along directions, gradients and Hessians in CasADi, from products without Jacobians."""

import functools
import subprocess

import casadi as ca
import numpy as np
import pytest

import kanegen as kg
from kanegen.artifacts import with_artifacts
from kanegen.interop import casadi
from tests.support.casadi_functions import SIZES, SYSTEMS, WARNINGS, called, inputs_of, textbook

BASES = ("forward_dynamics", "forcing")


@functools.cache
def source(case, *endings, bases=BASES[:1]):
    """Return the source of some outputs and of their products, or whole derivatives."""
    outputs = (*bases, *(f"{base}_{ending}" for base in bases for ending in endings))
    return kg.generate(SYSTEMS[case](), outputs, functions=outputs, batches=False)


def directions(function, seed=0):
    """Return a random direction of all inputs, as a dense matrix for each."""
    rng = np.random.default_rng(seed)
    return {
        name: ca.DM(function.sparsity_in(k), rng.uniform(-1, 1, function.nnz_in(k)))
        for k, name in enumerate(function.name_in())
    }


def in_order(columns, given):
    """Return the elements of matrices by name in an array of all variables, each matrix row by row."""
    found = np.zeros(max(part.stop for part in columns.values()))
    for name, part in columns.items():
        found[part] = np.ravel(given[name].full())
    return found


@pytest.mark.parametrize(
    "case", ["parameters", "quaternion", pytest.param("everything", marks=pytest.mark.slow)]
)
def test_products_are_those_of_the_library_bit_for_bit(case):
    """Loads, parameters and a quaternion; the order of elements of CasADi is another one."""
    bases = BASES if case == "parameters" else BASES[:1]
    code = source(case, "jvp", "vjp", "hvp", bases=bases)
    library = kg.build(SYSTEMS[case](), code.outputs, functions=code.outputs, flags="-O0")
    values = inputs_of(library)
    for base in bases:
        function = casadi.function(code, base)
        given = {name: ca.DM(np.atleast_1d(values[name])) for name in function.name_in() if name in values}
        given["parameters"] = ca.DM([*library.parameters.values()]) if library.parameters else ca.DM()
        given = {name: given[name] for name in function.name_in()}
        moved, columns = directions(function), library.derivative_columns(f"{base}_vjp")
        along, arrays = in_order(columns, moved), {n: values[n] for n in function.name_in() if n in values}
        arrays.pop("parameters", None)
        named = {"state_direction" if base == "forcing" else "direction": along}
        (output,) = function.name_out()
        forward = function.forward(1)(**given, **{f"fwd_{name}": one for name, one in moved.items()})
        np.testing.assert_array_equal(
            forward[f"fwd_{output}"].full().ravel(), getattr(library, f"{base}_jvp")(**arrays, **named)
        )
        weights = np.linspace(-1.0, 2.0, library.n)
        reverse = function.reverse(1)
        found = reverse(**given, **{f"adj_{output}": weights})
        right = getattr(library, f"{base}_vjp")(**arrays, weights=weights)
        gradients = {name: found[f"adj_{name}"] for name in function.name_in()}
        np.testing.assert_array_equal(in_order(columns, gradients), right)
        twice = reverse.forward(1)
        change = np.linspace(0.5, 1.0, library.n)
        seeds = {f"fwd_{name}": one for name, one in moved.items()} | {f"fwd_adj_{output}": change}
        second = twice(**given, **{f"adj_{output}": weights}, **seeds)
        expected = getattr(library, f"{base}_hvp")(**arrays, weights=weights, **named)
        expected = expected + getattr(library, f"{base}_vjp")(**arrays, weights=change)
        gradients = {name: second[f"fwd_adj_{name}"] for name in function.name_in()}
        np.testing.assert_array_equal(in_order(columns, gradients), expected)


def test_first_derivatives_need_no_jacobian():
    """Against the equations of the textbook, from a library without whole derivatives."""
    code = source("parameters", "jvp", "vjp")
    by_hand, compiled = textbook([name for name, _ in code.model.parameters]), casadi.function(code)
    given = [np.linspace(0.5, 1.5, size) for size in SIZES.values()]
    symbols = {name: ca.MX.sym(name, size) for name, size in SIZES.items()}
    every, weight = ca.vertcat(*symbols.values()), ca.DM([3.0, -2.0])
    for derivative in (
        lambda ydot: ca.gradient(ca.dot(weight, ydot), every),
        lambda ydot: ca.jtimes(ydot, every, ca.DM(np.linspace(1.0, 2.0, every.numel()))),
        lambda ydot: ca.jacobian(ydot, every),
    ):
        one, other = (
            ca.Function("derivative", [*symbols.values()], [derivative(of(**symbols)["acceleration"])])
            for of in (compiled, by_hand)
        )
        np.testing.assert_allclose(one(*given).full(), other(*given).full(), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["forward_dynamics", "ode"])
def test_hessians_are_those_of_the_textbook(name):
    code = source("parameters", "vjp", "hvp")
    by_hand, compiled = textbook([name for name, _ in code.model.parameters]), casadi.function(code, name)
    given = [np.linspace(0.5, 1.5, size) for size in SIZES.values()]
    symbols = {name: ca.MX.sym(name, size) for name, size in SIZES.items()}
    every = ca.vertcat(*symbols.values())

    def scalar(function):
        """A function of {xdot}, where that is {y}, and {ydot}."""
        rates = function(**symbols)
        return ca.sumsqr(rates["acceleration"] * rates.get("xdot", symbols["y"])) + ca.sum1(
            rates["acceleration"]
        )

    one, other = (
        ca.Function("derivatives", [*symbols.values()], [*ca.hessian(scalar(of), every)])
        for of in (compiled, by_hand)
    )
    for found, right in zip(one(*given), other(*given), strict=True):
        np.testing.assert_allclose(found.full(), right.full(), rtol=1e-11, atol=1e-10)


def test_casadi_takes_the_way_of_fewer_operations():
    code = source("quaternion", "derivatives", "input_derivatives", "jvp", "vjp")
    function = casadi.function(code)
    symbols = {name: ca.MX.sym(name, function.sparsity_in(name)) for name in function.name_in()}
    ydot, x = function(**symbols)["acceleration"], symbols["x"]

    def called_by(derivative):
        used = ca.Function("derivative", [*symbols.values()], [derivative]).find_functions()
        return {one.name().partition("_satellite")[0] for one in used} - {"satellite_casadi_forward_dynamics"}

    assert called_by(ca.gradient(ca.sum1(ydot), x)) == {"adj1"}
    assert called_by(ca.jtimes(ydot, x, ca.DM.ones(9))) == {"fwd1"}
    assert called_by(ca.jacobian(ydot, x)) == {"jac"}


def test_ipopt_gets_exact_hessians():
    """A swing-up by multiple shooting of Runge and Kutta steps, with no approximation of the Hessian."""
    code = source("loads", "derivatives", "jvp", "vjp", "hvp")
    ode = casadi.function(code, "ode")
    N, length = 20, 0.1
    state, force = ca.MX.sym("state", 4), ca.MX.sym("force")
    tau = ca.vertcat(*(force if name == "cart_position" else 0 for name in code.model.freedom_names))

    def rates(now):
        found = ode(x=now[:2], y=now[2:], tau=tau)
        return ca.vertcat(found["xdot"], found["acceleration"])

    k1 = rates(state)
    k2 = rates(state + length / 2 * k1)
    step = ca.Function("step", [state, force], [state + length * k2])
    states, forces = ca.MX.sym("states", 4, N + 1), ca.MX.sym("forces", 1, N)
    start = np.array([0.5 if name == "pole" else 0.0 for name in (*code.model.freedom_names, "", "")])
    gaps = states[:, 1:] - step.map(N)(states[:, :-1], forces)
    problem = {
        "x": ca.veccat(states, forces),
        "f": ca.sumsqr(states) + 0.1 * ca.sumsqr(forces),
        "g": ca.veccat(gaps, states[:, 0] - start),
    }
    counts = {}
    for kind in ("exact", "limited-memory"):
        quiet = {"print_level": 0, "sb": "yes", "hessian_approximation": kind, "max_iter": 200}
        solver = ca.nlpsol("solver", "ipopt", problem, {"print_time": False, "ipopt": quiet})
        found = solver(x0=0.0, lbg=0.0, ubg=0.0)
        assert solver.stats()["success"]
        counts[kind] = solver.stats()["iter_count"], float(found["f"])
    assert counts["exact"][1] == pytest.approx(counts["limited-memory"][1], rel=1e-6)
    assert counts["exact"][0] < counts["limited-memory"][0]


def test_c_of_casadi_calls_the_products(tmp_path, monkeypatch):
    """Without warnings, for loads and a state whose rates are copied; gradient and Hessian in generated C."""
    code = source("parameters", "jvp", "vjp", "hvp")
    for case, own in (
        ("parameters", code),
        ("quaternion", source("quaternion", "derivatives", "input_derivatives", "jvp", "vjp")),
    ):
        files = with_artifacts(own, "casadi")
        files.write(tmp_path / case)
        for compiler in ("gcc", "clang"):
            command = [compiler, *WARNINGS, "-fsyntax-only", f"{own.model.name}_casadi.c"]
            subprocess.run(command, cwd=tmp_path / case, check=True)
    state = ca.MX.sym("state", 4)
    rates = casadi.function(code, "ode")(x=state[:2], y=state[2:])
    hessian, gradient = ca.hessian(ca.sumsqr(rates["acceleration"]) + ca.dot(rates["xdot"], state[:2]), state)
    function = ca.Function("curvature", [state], [ca.densify(hessian), gradient])
    monkeypatch.chdir(tmp_path / "parameters")
    function.generate("curvature.c", {"main": True, "casadi_int": "int"})
    files = ["curvature.c", "double_pendulum_casadi.c", "double_pendulum.c"]
    flags = ["-std=c99", "-O1", "-ffp-contract=off", "-Dcasadi_int=int"]
    subprocess.run(["gcc", *flags, *files, "-lm", "-o", "program"], check=True)
    given = np.linspace(0.1, 1.0, 4)
    words = "\n".join(map(str, given))
    printed = subprocess.run(
        ["./program", "curvature"], input=words, capture_output=True, text=True, check=True
    )
    right = np.concatenate([one.full().ravel(order="F") for one in function(given)])
    np.testing.assert_array_equal(np.array(printed.stdout.split(), float), right)


def test_a_status_makes_derivatives_fail():
    function = casadi.function(source("parameters", "jvp", "vjp"))
    with pytest.raises(RuntimeError):
        function.reverse(1)(x=[0.0, 0.0], y=[0.0, 0.0], parameters=[0.0] * 5, adj_acceleration=[1.0, 0.0])
    assert called(function, {"x": np.zeros(2), "y": np.zeros(2)})["acceleration"].shape == (2, 1)
