"""Expressions of parameters in the place of numbers: arithmetic, values, texts, files, what is refused."""

from __future__ import annotations

import copy
import dataclasses
import math
import operator
import pickle
import warnings
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, reject
from hypothesis import strategies as st

import kanegen as kg
from kanegen.model.grammar import parse_number
from kanegen.model.numbers import (
    exact_value_of,
    is_fixed,
    number,
    parameters_of,
    toml_number,
    value_of,
    with_parameters_changed,
)
from kanegen.model.system_numbers import expression_summaries
from tests.support.toml_models import ROD, read_toml

M, L, ALPHA = kg.Parameter("m", 1.7), kg.Parameter("l", 0.3), kg.Parameter("alpha", 0.4)
KNOWN: dict[str, Any] = {one.name: one for one in (M, L, ALPHA)}

OPERATORS = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}


@st.composite
def calculations(draw: st.DrawFn, depth: int = 4) -> tuple[Any, Fraction]:
    """Return a calculation by Python's operators with a parameter in it, and its value in fractions."""
    kind = draw(st.sampled_from(["leaf", *OPERATORS, "negate", "power", "abs"])) if depth else "leaf"
    if kind == "leaf":
        return draw(
            st.one_of(
                st.sampled_from([M, L, ALPHA]).map(lambda one: (one, Fraction(one.value))),
                st.integers(-9, 9).map(lambda one: (one, Fraction(one))),
                st.floats(-9, 9).map(lambda one: (one, Fraction(one))),
                st.fractions(-9, 9, max_denominator=99).map(lambda one: (one, one)),
            )
        )
    value, exact = draw(calculations(depth - 1))
    if kind == "negate":
        return -value, -exact
    if kind == "abs":
        return abs(value), abs(exact)
    if kind == "power":
        exponent = draw(st.integers(0, 3))
        return (value**exponent, exact**exponent) if isinstance(value, kg.Expression) else (value, exact)
    other, other_exact = draw(calculations(depth - 1))
    if kind == "/" and not other_exact:
        return value, exact
    if not any(isinstance(one, kg.Parameter | kg.Expression) for one in (value, other)):
        return value, exact
    return OPERATORS[kind](value, other), OPERATORS[kind](exact, other_exact)


@given(calculations())
def test_arithmetic_is_exact_and_its_text_reads_back(found: tuple[Any, Fraction]) -> None:
    value, exact = found
    if isinstance(value, kg.Expression):
        try:
            assert value.exact == exact
        except kg.ModelError as error:  # a part of it, if not the whole
            assert "larger than any double" in str(error)
            reject()
        assert parse_number(str(value), KNOWN).exact == exact
        with warnings.catch_warnings(action="ignore"):  # where terms cancel
            as_number = number(value, "number")
        assert value_of(as_number) == float(exact)
        assert exact_value_of(as_number) == exact
        if not value.parameters:
            assert isinstance(as_number, float) == (Fraction(float(exact)) == exact)


def test_known_numbers_fold_exactly_and_fractions_stay() -> None:
    assert number(parse_number("2*0.5", {}), "n") == 1.0
    assert isinstance(number(parse_number("-3/4", {}), "n"), float)
    twelfth = number(parse_number("1/12", {}), "n")
    assert toml_number(twelfth) == "1 / 12"
    assert exact_value_of(twelfth) == Fraction(1, 12)
    assert value_of(twelfth) == 1 / 12
    assert number(Fraction(1, 12), "n") == twelfth
    assert number(M * 1 + 0, "n") is M
    assert value_of(number(parse_number("0.1*3 - 0.3", {}), "n")) == float(3 * Fraction(0.1) - Fraction(0.3))
    assert value_of(number(parse_number("sin(pi/6)", {}), "n")) == 0.5
    third = number(parse_number("min(1/3, 1/2) if 2 < 3 and not 3 < 2 else max(7, 1/3)", {}), "n")
    assert exact_value_of(third) == Fraction(1, 3)
    assert value_of(number(parse_number("sqrt(2) + sqrt(2) - max(1/3, -1/3)", {}), "n")) == 2.495093791412857


@pytest.mark.parametrize(
    ("made", "text", "value"),
    [
        (M * L**2 / 12, "m * l**2 / 12", 1.7 * 0.09 / 12),
        (-L, "-l", -0.3),
        (np.cos(ALPHA) * L, "cos(alpha) * l", 0.3 * math.cos(0.4)),
        (np.sqrt(L**2 + 1), "sqrt(l**2 + 1)", math.sqrt(1.09)),
        (np.arctan2(L, 2 * M), "atan2(l, 2 * m)", math.atan2(0.3, 3.4)),
        (np.float64(2.5) * M - np.int64(3), "2.5 * m - 3", 1.25),
        (
            np.tan(ALPHA) + np.tanh(L) + np.exp(L) + np.log(M),
            "tan(alpha) + tanh(l) + exp(l) + log(m)",
            2.5946,
        ),
        (Fraction(1, 3) * abs(-M), "1 / 3 * abs(-m)", 1.7 / 3),
        ((M - L) / (M + L), "(m - l) / (m + l)", 0.7),
    ],
)
def test_operators_and_functions_of_numpy_make_expressions(made: Any, text: str, value: float) -> None:
    assert isinstance(made, kg.Expression)
    assert str(made) == text
    assert made.value == pytest.approx(value, rel=1e-4)
    assert parse_number(text, KNOWN) == made
    assert copy.deepcopy(made) == pickle.loads(pickle.dumps(made)) == made


def test_arrays_of_parameters_multiply() -> None:
    turn = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    inertia = turn @ np.diag([M, L, M + L]) @ turn.T
    assert [str(inertia[i, i]) for i in range(3)] == ["l", "m", "m + l"]
    assert number(inertia[0, 1], "n") == 0.0
    assert [str(one) for one in M * np.array([1.5, 2.0])] == ["m * 1.5", "m * 2"]


def test_parameters_of_numbers() -> None:
    assert parameters_of(M * L / M) == (M, L)
    assert not is_fixed(M)
    assert is_fixed(number(Fraction(1, 3), "n"))
    doubled = with_parameters_changed(M * L, lambda one: kg.Parameter(one.name, 2 * one.value))
    assert value_of(doubled) == pytest.approx(4 * 0.51)
    assert with_parameters_changed(M * L, lambda one: 2.0) == 4.0


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: M ** kg.Parameter("n", 2.0), "is no whole number; for roots there is sqrt"),
        (lambda: M**0.5, "exponent 0.5 is no whole number"),
        (lambda: (M**9) ** 9, "a huge power"),
        (lambda: 2**M, r"exponent 'm' is no whole number; b\*\*a is written as exp\(a\*log\(b\)\)"),
        (
            lambda: max(M, L),
            r"'l' cannot be compared before run time\. Write max, min and conditions as a text",
        ),
        (lambda: 1.0 if M + 1 <= 3 else 2.0, "'m . 1' cannot be compared before run time"),
        (lambda: M * math.inf, "is not finite"),
        (lambda: number(M / (L - 0.3), "mass"), "mass: 'm / .l - 0.3.' divides by zero at the default"),
        (lambda: number(np.sqrt(-M), "mass"), "mass: 'sqrt.-m.' takes the root of a negative number"),
        (lambda: number(np.log(L - L), "mass"), "takes the logarithm of a number that is not positive"),
        (lambda: number(np.exp(1e6 * M), "mass"), "is larger than any double"),
        (
            lambda: number(M * kg.parse("tan(-3*pi/2)"), "mass"),
            r"mass: 'tan\(.*\)' is infinite at the default",
        ),
        (lambda: number((M * 1e200) * (M * 1e200), "mass"), "is larger than any double"),
        (
            lambda: number(kg.parse("1 if sin(1)**2 + cos(1)**2 > 1 else 2"), "mass"),
            r"mass: .* compares numbers that differ in no digit",
        ),
        (lambda: number(kg.parse("1/(sin(1)**2 + cos(1)**2 - 1)"), "mass"), "divides by zero at the default"),
        (lambda: number(kg.parse("2*x.arm.s1"), "mass"), "depends on 'x.arm.s1', but .* on parameters only"),
        (lambda: sum([M] * 300), "more than 200 operations inside each other"),
    ],
)
def test_wrong_arithmetic(wrong: Any, message: str) -> None:
    with pytest.raises(kg.ModelError, match=message):
        wrong()


@pytest.mark.parametrize("other", ["2", None, True, 1j, [1, 2]])
def test_what_is_no_number_has_no_arithmetic(other: Any) -> None:
    with pytest.raises(TypeError):
        M * L + other


def test_a_file_may_have_expressions_wherever_numbers_stand(tmp_path: Path) -> None:
    system = read_toml(tmp_path, ROD)
    assert [one.name for one in system.parameters] == ["g", "m", "l", "alpha"]
    moved = system.with_parameters({"l": 0.7, "m": 1.9})
    m, length, g, alpha = 1.9, 0.7, 9.81, 0.3
    rod, tip, _ = moved.bodies
    assert [value_of(one) for one in moved.gravity] == [0, 0, -g]
    assert value_of(rod.inertia[0][0]) == pytest.approx(m * length**2 / 12, rel=1e-15)
    assert value_of(rod.joint.position[1]) == pytest.approx(length * math.cos(alpha), rel=1e-15)
    assert [value_of(one) for one in rod.joint.orientation] == pytest.approx([math.pi / 6, -alpha, 0])
    assert value_of(tip.joint.locked[2]) == -alpha
    assert value_of(tip.joint.armature[0]) == pytest.approx(m * length**2 / 12, rel=1e-15)
    assert moved.rotors[0].ratio == -3.0
    assert moved.rotors[0].axis == (0, -1 / 3, 0)
    file = tmp_path / "again.toml"
    system.save(file)
    assert kg.load(file) == system
    assert kg.load(file).as_table()["body"] == system.as_table()["body"]
    assert 'mass_center = [0.0, 0.0, "-l / 2"]' in file.read_text()


NO_STATE = r":7: .*depends on parameters, not on coordinates, speeds or the time"


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('mass = "n"', r":7: body 'rod': mass: .* there is no 'n'\. Known are"),
        (
            'mass = "2*n"',
            r":7: .*mass: expression 'n' in .*: there is no parameter of this name",
        ),
        ('mass = "m/(l - l)"', r":7: .*mass: 'm / \(l - l\)' divides by zero at the default values"),
        ('mass = "sqrt(-m)"', r":7: .*mass: 'sqrt\(-m\)' takes the root of a negative number"),
        ('mass = "-m"', r"mass -m = -2\.0 kg is negative"),
        ('mass = "m*t"', NO_STATE),
        ('mass = "m*x.rod.theta1"', NO_STATE),
        ("mass = \"__import__('os').system('ls')\"", r":7: .*mass: .*there is no function"),
        ('mass = "().__class__"', r":7: .*mass: "),
        ('mass = "m if m else 2"', r":7: .*a condition compares numbers"),
        ('mass = "m**0.5"', r":7: .*an exponent is a whole number; for roots there is sqrt"),
        ('mass = "m m"', r":7: .*no expression"),
        ('mass = ""', r":7: .*no expression"),
        ('mass = "1e999"', r":7: .*inf is not finite"),
        ('mass = "exp(1000*m)"', r":7: .*is larger than any double"),
        ('mass = "m"\nlabel = "m"', r"unknown key 'label'"),
        ('mass = "m"\nmass_center = [0, "m*(", 0]', r":8: .*mass_center: expression"),
    ],
)
def test_wrong_expressions_in_a_file(tmp_path: Path, line: str, message: str) -> None:
    head = '[parameters]\nm = 2.0\nl = 0.5\n\n[[body]]\nname = "rod"\n'
    with pytest.raises(kg.ReadError, match=message) as caught:
        read_toml(tmp_path, f'{head}{line}\nconnection = "ground"\n')
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (
            'a = "2*b"\nb = "a/2"',
            r"model.toml:\d: parameters: '.', which needs '.', which needs '.': a circle",
        ),
        ('a = "a + 1"', r"model.toml:2: parameters: 'a', which needs 'a': a circle\. Give one of them"),
        (
            'a = "2*c"',
            r"model.toml:2: parameter 'a': expression 'c' in .* there is no parameter",
        ),
        ('if = "2"', r"'if'"),
        (
            "\n".join(f'a{k + 1} = "a{k}*a{k}"' for k in range(30)) + "\na0 = 1.0",
            r"more than 2000 operations",
        ),
    ],
)
def test_wrong_named_expressions(tmp_path: Path, parameters: str, message: str) -> None:
    with pytest.raises(kg.ReadError, match=message):
        read_toml(tmp_path, f'[parameters]\n{parameters}\n[[body]]\nconnection = 0\nmass = "a"\n')


def test_unused_parameters_are_found_through_names(tmp_path: Path) -> None:
    text = '[parameters]\na = "2*b"\nb = "3*c"\nc = 1.0\nd = "c"\n[[body]]\nconnection = 0\nmass = "a"\n'
    with pytest.warns(kg.KanegenWarning, match=r"unused parameters: d\."):
        system = read_toml(tmp_path, text)
    assert value_of(system.bodies[0].mass) == 6.0
    assert toml_number(system.bodies[0].mass) == "2 * (3 * c)"


def test_sums_that_cancel_are_reported() -> None:
    small = kg.Parameter("small", 1e-3)
    with pytest.warns(kg.KanegenWarning, match=r"y: 'l \* cos\(small\) - l' loses digits: .*off by 9e-11"):
        number(L * np.cos(small) - L, "y")
    stable = number(-2 * L * np.sin(small / 2) ** 2, "y")
    assert value_of(stable) == pytest.approx(-0.3 * (1 - math.cos(1e-3)), rel=1e-9)
    assert number(np.cos(kg.parse("pi/2")), "y") == 0.0
    assert number(np.tan(kg.parse("pi")), "y") == 0.0


def test_lost_digits_are_reported_once_with_the_body(tmp_path: Path) -> None:
    text = ROD.replace('mass_center = [0, 0, "', 'mass_center = ["l*cos(1e-4*alpha) - l", 0, "', 1)
    assert text != ROD
    with pytest.warns(kg.KanegenWarning, match="loses digits") as caught:
        read_toml(tmp_path, text)
    assert [str(one.message)[:28] for one in caught] == ["body 'rod': mass centre[0]: "]


def test_warnings_stand_at_the_line_of_the_caller(tmp_path: Path) -> None:
    with pytest.warns(kg.KanegenWarning) as caught:
        body = kg.Body("rod", 0, 1.0, np.diag([1.0, 1.0, 3.0]))
        dataclasses.replace(body, name="other")
        system = kg.System("rod", (dataclasses.replace(body, joint=kg.Joint(free=(True,) + (False,) * 5)),))
        system.save(tmp_path / "rod.toml")
        kg.load(tmp_path / "rod.toml")
    assert {one.filename for one in caught} == {__file__}
    assert len({one.lineno for one in caught}) == 4


def test_people_read_expressions_in_brackets(tmp_path: Path) -> None:
    system = read_toml(tmp_path, ROD)
    assert system.coupling_equations == ("follower.s3 = (l / 2) tip.s2 + -l",)
    assert "armature of tip.theta1: (m * l**2 / 12) kg m^2" in system.motor_summaries
    assert system.locked_summaries == ("tip.theta3 = (-alpha) rad",)


def test_limits_are_numbers_without_parameters(tmp_path: Path) -> None:
    head = '[parameters]\na = 1.0\n[[body]]\nconnection = 0\nmass = "a"\njoint.free = ["theta1"]\n'
    limits = 'joint.limits = {theta1 = {position = [%s, inf], speed = "2*pi"}}\n'
    (body,) = read_toml(tmp_path, head + limits % '"-pi/2"').bodies
    assert (body.joint.limits.lower[0], body.joint.limits.upper[0]) == (-math.pi / 2, math.inf)
    assert body.joint.limits.speed[0] == 2 * math.pi
    with pytest.raises(kg.ReadError, match="lower of theta1: '-a' depends on parameters"):
        read_toml(tmp_path, head + limits % '"-a"')


def test_expressions_are_listed_for_people(tmp_path: Path) -> None:
    system = read_toml(tmp_path, ROD)
    listed = expression_summaries(system)
    assert listed[0] == "gravity = (0.0, 0.0, -g)"
    assert "rod: mass_center = (0.0, 0.0, -l / 2)" in listed
    assert "hand: orientation = (alpha / 2, 0.0, pi / 2)" in listed
    readme = kg.generate(system).files["README.md"]
    assert all(f"- `{line}`" in readme for line in listed)
    assert "must not become negative" in readme
    assert "Expressions of parameters" not in kg.generate(system.map_numbers(value_of)).files["README.md"]


def test_what_is_zero_in_every_digit_is_zero() -> None:
    assert number(kg.parse("sin(1)**2 + cos(1)**2 - 1"), "n") == 0.0
    assert number(kg.parse("sign(sin(1)**2 + cos(1)**2 - 1) + max(sqrt(2), sqrt(2))*0"), "n") == 0.0


def test_signs_before_numbers_belong_to_them() -> None:
    for made in (-0.5 + M * L, M * -3, -(-M * L), 0.0 - M):
        assert parse_number(str(made), KNOWN) == made, made
    assert str(number(parse_number("-0", {}), "n")) == "0.0"
