"""Names of parameters: none takes the place of the time, a variable, a symbol or a name in C."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.model.coordinates import COORDINATE_KINDS, SPEED_KINDS
from kanegen.symbolic import symbols

HINGE = kg.Joint(position=(0, 0, 1), free=(False, False, True, False, False, False))
SAFE = (
    "tau force torque ydot A f p c n i k s S C sin cos sqrt tan abs INFINITY NAN M_PI NULL EOF errno "
    "exp log tanh atan2 sign min max select kanegen_exp minimum maximum choice "
    "stdin batch count status parameters prepared mass w failed inaccurate least_margin before result "
    "sines cosines t1 L fe_1_3 p_m e0 xdot point_force evaluate S_1_3 Add Symbol numpy E N O Q beta zeta"
).split()
"""Names with a meaning in C, in generated code, in SymPy or in NumPy, which parameters may have."""


def system(name: str, effort: str | None = None) -> kg.System:
    """Return a body with a quaternion and an arm on it; a parameter is mass, length and stiffness."""
    number = kg.Parameter(name, 2.0)
    point = kg.Point("tip", (0, 0, 1), loads=True)
    joint = kg.Joint(coordinates="quaternion")
    body = kg.Body("a", 0, number, np.eye(3), (0.1, 0, 0.2), joint, loads=True, points=(point,))
    arm = kg.Body("b", 1, 1.0, np.eye(3), (0.1, 0, number), HINGE)
    drive = kg.Drive("b.theta3", kg.parse(effort or f"{name}*x.b.theta3", [number]))
    return kg.System("m", (body, arm), force_elements=(drive,))


@pytest.mark.parametrize("effort", ["2*t", "sin(t)*x.b.theta3", "t"])
def test_parameter_does_not_take_the_place_of_the_time(effort: str) -> None:
    with pytest.raises(kg.ModelError, match="the time, but a parameter has the same name"):
        system("t", effort)


def test_file_with_a_parameter_called_t_and_the_time(tmp_path: Path) -> None:
    file = tmp_path / "model.toml"
    file.write_text(
        "[parameters]\nt = 2.0\n[[body]]\nname = 'arm'\nconnection = 'ground'\nmass = 't'\n"
        "inertia = [1, 1, 1]\njoint.free = ['theta3']\n[[drive]]\nfreedom = 'arm.theta3'\neffort = '2*t'\n"
    )
    with pytest.raises(kg.ReadError, match=r"drive 1: expression 't' in expression '2\*t': this is the time"):
        kg.load(file)


@pytest.mark.parametrize("name", ["x", "y"])
def test_parameter_does_not_take_the_place_of_a_vector(name: str) -> None:
    with pytest.raises(kg.ModelError, match="A parameter in an expression needs another name"):
        system(name)


@pytest.mark.parametrize("name", ["lambda", "assert", "in", "is", "del"])
def test_words_that_cannot_be_names_in_expressions(name: str) -> None:
    with pytest.raises(kg.ModelError, match=f"'{name}' cannot be a name in an expression"):
        system(name)


def symbol_names(body: int) -> list[str]:
    """Return the names of all symbols of a body, and of a point with the same number."""
    kinds = range(len(COORDINATE_KINDS))
    found = [f(body, kind) for f in (symbols.coordinate, symbols.coordinate_rate) for kind in kinds]
    found += [f(body, k) for f in (symbols.speed, symbols.acceleration) for k in range(len(SPEED_KINDS))]
    loads = (symbols.force, symbols.torque, symbols.point_force, symbols.point_moment)
    found += [load(body, axis) for load in loads for axis in range(3)]
    found += [symbols.generalized_force(body, index) for index in range(6)]
    return [symbol.name for symbol in found]


def test_parameter_does_not_take_the_place_of_a_symbol() -> None:
    for name in symbol_names(1):
        with pytest.raises(kg.ModelError, match="already names a coordinate, speed or load"):
            system(name)


def test_symbols_of_bodies_that_do_not_exist_are_free() -> None:
    for name in symbol_names(3):
        assert system(name).parameters[0].name == name


def test_no_parameter_is_called_pi() -> None:
    """The text of an expression with such a parameter would read back as the number."""
    with pytest.raises(kg.ModelError, match=r"parameter name 'pi': this is the number pi\. Rename it\."):
        kg.Parameter("pi", 3.0)
    with pytest.raises(
        kg.ModelError, match="'pi' in expression 'pi\\*t': this is the number pi, but a parameter"
    ):
        kg.parse("pi*t", {"pi": 3.0})


@pytest.mark.parametrize("names", [SAFE[::2], SAFE[1::2]])
def test_parameters_with_other_names_keep_their_values(names: list[str]) -> None:
    """All parameters together, each the stiffness of a spring, against the literal derivation and by hand."""
    base = system("other", "0")
    values = {name: 1.0 + k / 8 for k, name in enumerate(names)}
    drives = [
        kg.Drive("b.theta3", kg.parse(f"{name}*x.b.theta3", [kg.Parameter(name, value)]))
        for name, value in values.items()
    ]
    all_of_them = base.with_force_elements(*drives)
    x, y = np.array([0.5, 0.5, 0.5, 0.5, 0.7, 0.1, 0.2, 0.3]), np.ones(7)
    f = kg.build(all_of_them).forcing(x, y)
    np.testing.assert_allclose(f, kg.derive(all_of_them).lambdify().forcing(x, y), rtol=1e-12, atol=1e-12)
    without = kg.build(base).forcing(x, y)
    place = all_of_them.speed_names.index("b.theta3")
    assert f[place] - without[place] == pytest.approx(0.7 * sum(values.values()), rel=1e-13)
