"""Symbolic linear models: textbooks, the derivatives in C, 60 digits, and random trees."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
import sympy

import kanegen as kg
from kanegen.model.numbers import value_of
from kanegen.symbolic.printing import render_linear_model
from kanegen.symbolic.symbols import parameter
from tests.support.cases import slow_among
from tests.support.orientation_trees import KINDS, tree_of_kind
from tests.support.paths import MODELS
from tests.support.random_trees import everything


def symbols(names: str) -> Any:
    return sympy.symbols(names, real=True)


def close(found: kg.LinearModel, expected: kg.LinearModel, factor: float = 1e-12) -> None:
    """Require equal matrices and rates, up to `factor` times the largest entry of each."""
    for name in ("A", "B", "C", "D", "xdot", "ydot", "rate_map", "rate_map_rate"):
        one, other = getattr(found, name), getattr(expected, name)
        assert one.shape == other.shape
        if other.size:
            assert np.abs(one - other).max() <= factor * max(1.0, np.abs(other).max()), name
    assert found.state_names == expected.state_names
    assert found.input_names == expected.input_names
    assert found.output_names == expected.output_names


def test_a_double_pendulum_by_hand() -> None:
    """The textbook's equations about the lower position, with relative angles."""
    model = kg.derive(kg.load(MODELS / "double_pendulum.toml")).linearize(inputs=["q2"])
    m1, m2, l1, l2, g = symbols("m1 m2 l1 l2 g")
    assert model.state_names == ("x.q1", "x.q2", "y.q1", "y.q2")
    expected = sympy.Matrix(
        [
            [0, 0, 1, 0],
            [0, 0, 0, 1],
            [-g / l1, g * m2 / (l1 * m1), 0, 0],
            [g / l1, -g * (l1 * m1 + l1 * m2 + l2 * m2) / (l1 * l2 * m1), 0, 0],
        ]
    )
    assert expected == model.A
    assert (
        sympy.simplify(model.B[3, 0] - (l1**2 * m1 + m2 * (l1 + l2) ** 2) / (l1 * l1 * l2 * l2 * m1 * m2))
        == 0
    )
    assert model.is_equilibrium


def test_a_furuta_pendulum_by_hand() -> None:
    """About the upright position, with J = inertia + mass length^2 and the determinant of [A]."""
    model = kg.derive(kg.load(MODELS / "furuta_pendulum.toml")).linearize(inputs=["arm_angle"])
    r, m, length, inertia, arm = symbols("arm_length mass length inertia arm_inertia")
    J = inertia + m * length**2
    det = (arm + m * r**2) * J - (m * r * length) ** 2
    g = sympy.Rational(981, 100)
    right = {
        (2, 1): m**2 * length**2 * r * g / det,
        (3, 1): (arm + m * r**2) * m * length * g / det,
    }
    for place, value in right.items():
        assert sympy.simplify(sympy.nsimplify(model.A[place]) - value) == 0
    assert sympy.simplify(sympy.nsimplify(model.B[3, 0]) - m * r * length / det) == 0
    hanging = kg.derive(model_system("furuta_pendulum")).linearize({"pendulum": math.pi}, inputs="arm_angle")
    assert hanging.A[3, 1] == -model.A[3, 1]
    assert hanging.x[1] == sympy.pi


def model_system(name: str) -> kg.System:
    return kg.load(MODELS / f"{name}.toml")


CASES: dict[str, dict[str, Any]] = {
    "furuta_pendulum": {},
    "furuta_pendulum in motion": {"x": [0.4, 0.7], "y": [2.0, -1.0], "tau": [0.1, 0.0]},
    "cart_two_poles": {},
    "cart_two_poles in motion": {"x": [0.3, -0.2, 0.5], "y": [1.0, 2.0, -0.4], "tau": [1.0, 0.0, 0.3]},
    "quarter_car": {"prescribed": [0.0]},
    "quarter_car in motion": {"x": [0.01, -0.02], "y": [0.3, 0.1], "prescribed": [0.01, 0.1, 2.0]},
    "double_pendulum": {"x": {"q1": 0.3}, "outputs": ["kinetic_energy", "potential_energy", "momentum"]},
    "gantry_crane": {
        "x": {"rope_length": 5.0},
        "y": {"bridge_travel": 1.0},
        "outputs": ["mass_center", "x.rope_length"],
    },
    "spinning_top": {"x": [0.2, 0.4, 0.1], "y": [1.0, 2.0, 30.0]},
    "satellite": {"y": {"bus.omega3": 0.5}, "outputs": ["point_positions", "point_velocities"]},
    "scara": {"x": [0.1, 0.2, 0.3, 0.05], "outputs": ["kinetic_energy"]},
    "free_body": {"x": [0.1, 0.2, 0.3, 1.0, 2.0, 3.0], "y": [1, 2, 3, 4, 5, 6]},
}


SLOW = ("cart_two_poles in motion", "gantry_crane", "scara", "spinning_top", "furuta_pendulum")


@pytest.mark.parametrize("case", slow_among(CASES, *SLOW))
def test_against_the_derivatives_in_c(case: str) -> None:
    """Both derivations are independent; 1e-12 leaves room for a thousand roundoffs."""
    system, given = model_system(case.split(maxsplit=1)[0]), CASES[case]
    found = kg.derive(system).linearize(**given).numeric()
    further = {}
    if system.prescribed:
        motion = [*given["prescribed"], 0, 0, 0][: 3 * len(system.prescribed)]
        further["prescribed"] = np.array(motion, float).reshape(3, -1)
    numeric = {name: value for name, value in given.items() if name != "prescribed"}
    close(found, kg.linearize(system, **numeric, **further))


@pytest.mark.parametrize(
    "kind", [pytest.param(k, marks=[pytest.mark.slow] * (k != "quaternions")) for k in KINDS]
)
def test_random_trees(kind: str) -> None:
    system = tree_of_kind(kind, 1)
    rng = np.random.default_rng(7)
    x = rng.uniform(-1, 1, len(system.coordinates)).round(3)
    y, tau = rng.normal(size=(2, len(system.freedoms))).round(3)
    found = kg.derive(system).linearize(x, y, tau).numeric()
    close(found, kg.linearize(system, x, y, tau), 1e-10)  # [A] has condition 1000


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_everything_together(seed: int) -> None:
    """Every kind of joint, force element, motor and coupling in one tree, with its numbers."""
    system = everything(seed, bodies=2).map_numbers(value_of)
    rng = np.random.default_rng(seed)
    x = rng.uniform(0.1, 1, len(system.coordinates)).round(3)
    y = rng.normal(size=len(system.freedoms)).round(3)
    outputs = ["kinetic_energy", "potential_energy", "point_positions", "point_velocities"]
    found = kg.derive(system).linearize(x, y, outputs=outputs)
    at = {symbol.name: 0.4 for symbol in found.symbols}  # the time, where anything depends on it
    expected = kg.linearize(system, x, y, outputs=outputs, t=0.4)
    close(found.numeric(at), expected, 1e-10)  # [A] has condition 1000


def test_symbols_of_the_state_stay() -> None:
    """A pendulum that a torque holds at any angle: the stiffness is m g l cos(q) by hand."""
    body = kg.Body(
        "bob",
        0,
        kg.Parameter("m", 2.0),
        np.zeros((3, 3)),
        (kg.Parameter("l", 0.7), 0, 0),
        kg.Joint(name="q", free=(False, False, True, False, False, False)),
    )
    system = kg.System("pendulum", (body,), (kg.Parameter("g", 9.81), 0, 0))
    m, length, g, q = symbols("m l g q")
    model = kg.derive(system).linearize([q], tau=[m * g * length * sympy.sin(q)])
    assert model.is_equilibrium
    assert model.A[1, 0] == -g * sympy.cos(q) / length
    assert model.B[1, 0] == 1 / (m * length**2)
    assert [symbol.name for symbol in model.symbols] == ["g", "l", "m", "q"]
    with pytest.raises(kg.OptionError, match="q needs a value"):
        model.numeric()
    numeric = model.numeric({"q": 0.5, "l": 0.2})
    assert numeric.A[1, 0] == pytest.approx(-9.81 * math.cos(0.5) / 0.2, rel=1e-15)
    with pytest.raises(kg.OptionError, match="there is no 'k'"):
        model.numeric({"k": 1})


@pytest.mark.parametrize("name", ["double_pendulum", "gantry_crane", "spinning_top", "furuta_pendulum"])
def test_energies_and_momenta(name: str) -> None:
    """T and V against C, and p = [A]{y} as the derivatives of T, in numbers of 40 digits."""
    system = model_system(name)
    equations = kg.derive(system)
    rng = np.random.default_rng(3)
    x, y = rng.uniform(-1, 1, (2, len(equations.y)))
    at = {symbol: sympy.Float(value, 40) for symbol, value in zip(equations.x, x, strict=True)}
    at |= {symbol: sympy.Float(value, 40) for symbol, value in zip(equations.y, y, strict=True)}
    at |= {parameter(one): sympy.Float(one.value, 40) for one in system.parameters}
    for momentum, speed in zip(equations.generalized_momenta, equations.y, strict=True):
        slope = sympy.diff(equations.kinetic_energy, speed)
        assert abs((slope - momentum).xreplace(at).evalf(40)) < 1e-25
    library = kg.build(system, ("kinetic_energy", "potential_energy"))
    for energy, found in (
        (equations.kinetic_energy, library.kinetic_energy(x, y)),
        (equations.potential_energy, library.potential_energy(x)),
    ):
        assert float(energy.xreplace(at).evalf(30)) == pytest.approx(float(found), rel=1e-13)


def test_formats() -> None:
    model = kg.derive(model_system("cart_pole")).linearize(inputs="cart_position", outputs="x.pole")
    text = render_linear_model(model)
    assert "B[y.cart_position, tau.cart_position] = 4/(4*cart_mass + pole_mass)" in text
    assert "C[x.pole, x.pole] = 1" in text
    latex, markdown = (render_linear_model(model, form) for form in ("latex", "markdown"))
    assert re.findall(r"\\begin{bmatrix}.*?\\end{bmatrix}", latex, re.DOTALL) == re.findall(
        r"\\begin{bmatrix}.*?\\end{bmatrix}", markdown, re.DOTALL
    )
    assert "- inputs: tau.cart_position" in markdown
    space: dict[str, Any] = {}
    exec(render_linear_model(model, "python"), space)
    found = space["matrices"](*(model.parameters[symbol] for symbol in model.symbols))
    assert all(
        one == pytest.approx(getattr(model.numeric(), name), rel=1e-14)
        for one, name in zip(found, "ABCD", strict=True)
    )
    assert model._repr_latex_().startswith("$$\n\\begin{aligned}\n[A] &= ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"x": {"pol": 0}}, "x: there is no 'pol'. Did you mean 'pole'?"),
        ({"x": [1, 2, 3]}, "expected 2 values in the order pole, cart_position"),
        ({"outputs": "point_accelerations"}, "a symbolic linear model has no output 'point_accelerations'"),
        ({"inputs": ["cart"]}, "inputs: there is no freedom 'cart'"),
        ({"inputs": 5}, "inputs: expected names, got 5."),
        ({"outputs": 5}, "outputs: expected names, got 5."),
        ({"x": {"pole": "__import__('os').abort()"}}, "there is no function"),
        ({"x": {"pole": "sin(q"}}, "sin(q"),
        ({"x": {"pole": None}}, "x: None is neither a number nor an expression."),
        ({"y": {"pole": math.nan}}, "y: 'nan' is no finite number."),
    ],
)
def test_what_is_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(kg.KanegenError) as found:
        kg.derive(model_system("cart_pole")).linearize(**arguments)
    assert message in str(found.value)


def test_states_without_accelerations_are_refused() -> None:
    ball = kg.Joint(sequence="3-1-3", free=(True, True, True, False, False, False))
    top = kg.Body("top", 0, 1.0, np.eye(3), joint=ball)
    with pytest.raises(kg.SingularError, match="singular in this state"):
        kg.derive(kg.System("top", (top,))).linearize()


def test_jumps_have_no_derivative() -> None:
    """The effort of the potential c |q| is -c sign(q): constant beside q = 0, where it has no derivative."""
    slider = kg.Joint(name="q", free=(False, False, False, True, False, False))
    body = kg.Body("cart", 0, 2.0, np.eye(3).tolist(), (0.0, 0.0, 0.0), slider)
    jumping = kg.System("cart", (body,), force_elements=(kg.Potential("20*abs(x.q)"),))
    equations = kg.derive(jumping)
    beside = sympy.Matrix([[0, 1], [0, 0]])
    assert beside == equations.linearize({"q": 0.3}).A
    assert beside == equations.linearize({"q": sympy.Symbol("q0")}).A
    with pytest.raises(kg.OptionError, match="linearize: a force jumps in this state"):
        equations.linearize({"q": 0})
    smooth = kg.System("cart", (body,), force_elements=(kg.Potential("x.q**2*abs(x.q)"),))
    assert beside == kg.derive(smooth).linearize({"q": 0}).A
    assert sympy.Matrix([[0, 1], [sympy.Rational(-3, 2), 0]]) == kg.derive(smooth).linearize({"q": -0.5}).A
