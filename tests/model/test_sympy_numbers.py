"""Expressions of SymPy in the place of numbers: conversion both ways, defaults of symbols, errors."""

from __future__ import annotations

import pickle
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, reject
from hypothesis import strategies as st

import kanegen as kg
from kanegen.model.numbers import exact_value_of, number, toml_number, value_of
from kanegen.symbolic.symbols import expression

m, length, alpha = sympy.symbols("m l alpha", positive=True)
M, L, ALPHA = kg.Parameter("m", 1.7), kg.Parameter("l", 0.3), kg.Parameter("alpha", 0.4)
VALUES = {"m": 1.7, "l": 0.3, "alpha": 0.4}
KNOWN = {m: 1.7, length: 0.3, alpha: 0.4}
DEFAULTS = {"m": M, "l": L, "alpha": ALPHA}


def rod(mass: Any, inertia: Any, center: Any, **more: Any) -> kg.System:
    hinge = kg.Joint(free=(True, False, False, False, False, False))
    body = kg.Body("rod", 0, mass, np.diag([inertia, inertia, 0]), (0, 0, center), hinge)
    return kg.System("rod", (body,), **more)


@st.composite
def formulas(draw: st.DrawFn, depth: int = 3) -> sympy.Expr:
    """Return a real expression of SymPy in three symbols, finite at their values."""
    kind = draw(st.sampled_from(["leaf", "+", "*", "/", "-", "**", "f"])) if depth else "leaf"
    if kind == "leaf":
        numbers = st.sampled_from([sympy.Integer(-3), sympy.Rational(2, 7), sympy.Float(0.37), sympy.pi])
        return draw(st.one_of(st.sampled_from([m, length, alpha]), numbers))
    a = draw(formulas(depth - 1))
    if kind == "f":
        function = draw(st.sampled_from([sympy.sin, sympy.cos, sympy.tanh, sympy.Abs]))
        return function(a)
    if kind == "**":
        return (a**2 + 1) ** draw(st.sampled_from([2, 3, -1, sympy.Rational(1, 2), sympy.Rational(-3, 2)]))
    b = draw(formulas(depth - 1))
    return {"+": a + b, "*": a * b, "/": a / (b**2 + 1), "-": a - b}[kind]


def test_matrices_of_sympy_are_tables_of_numbers() -> None:
    inertia = sympy.diag(m, m, length)
    for matrix in (inertia, sympy.ImmutableMatrix(inertia)):
        found = kg.Body("rod", 0, m, matrix, sympy.Matrix([0, 0, -length / 2]))
        assert found == kg.Body("rod", 0, m, inertia.tolist(), (0, 0, -length / 2))
    with pytest.raises(kg.ModelError, match="inertia: expected 3 x 3 table of numbers, got 2 entries"):
        kg.Body("rod", 0, m, sympy.eye(2))


@given(formulas())
def test_values_and_texts_of_formulas(formula: sympy.Expr) -> None:
    expected = float(formula.evalf(40, subs=KNOWN))

    def with_default(one: float | kg.Parameter) -> float | kg.Parameter:
        return DEFAULTS[one.name] if isinstance(one, kg.Parameter) else one

    try:
        found = kg.Expression.of(formula).map_numbers(with_default)
    except kg.ModelError as error:
        assert "huge power" in str(error)
        reject()
    # SymPy adds and multiplies floats as soon as they meet, each time with a rounding error.
    assert found.value == pytest.approx(expected, rel=1e-9, abs=1e-9)
    again = kg.parse(str(found), [M, L, ALPHA])
    assert again.value == pytest.approx(found.value, rel=1e-14, abs=1e-14)


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        (m * length**2 / 12, "l**2 * m / 12"),
        (-length / 2, "-(l / 2)"),
        (length * sympy.cos(alpha) - m, "-m + l * cos(alpha)"),
        (sympy.sqrt(2) * m, "sqrt(2) * m"),
        (m / (2 * length), "m / (2 * l)"),
        (sympy.exp(-alpha) + sympy.Max(m, length), "exp(-alpha) + max(l, m)"),
        (1 / sympy.sqrt(m), "1 / sqrt(m)"),
        (m ** sympy.Rational(3, 2), "sqrt(m)**3"),
        (sympy.atan2(m, length), "atan2(m / l, 1)"),
    ],
)
def test_texts(formula: sympy.Expr, text: str) -> None:
    found = str(kg.Expression.of(formula))
    assert sorted(found) == sorted(text), found


def test_symbols_become_parameters_with_the_defaults_of_the_system() -> None:
    system = rod(m, m * length**2 / 12, -length / 2, defaults={"m": 1.7, "l": 0.3})
    assert system == rod(
        system.bodies[0].mass, *(system.bodies[0].inertia[0][0], system.bodies[0].mass_center[2])
    )
    assert {one.name: one.value for one in system.parameters} == {"m": 1.7, "l": 0.3}
    assert value_of(system.bodies[0].inertia[0][0]) == pytest.approx(1.7 * 0.09 / 12, rel=1e-15)
    assert pickle.loads(pickle.dumps(system)) == system
    plain = rod(1.7, 1.7 * 0.09 / 12, -0.15)
    x = [0.7]
    built, fixed = (kg.build(one, ("mass_matrix", "forcing")) for one in (system, plain))
    assert built.forcing(x, [1.0]) == pytest.approx(fixed.forcing(x, [1.0]), rel=1e-15)
    assert built.mass_matrix(x) == pytest.approx(fixed.mass_matrix(x), rel=1e-15)


def test_a_parameter_of_the_same_name_gives_the_default() -> None:
    system = rod(M, m * L**2 / 12, -L * sympy.Rational(1, 2))
    assert {one.name: one.value for one in system.parameters} == {"m": 1.7, "l": 0.3}
    assert rod(kg.Parameter("m"), 1.0, 0, defaults={"m": 2.0}).parameters == (kg.Parameter("m", 2.0),)


def test_arrays_of_symbols() -> None:
    turn = sympy.Matrix([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    inertia = turn * sympy.diag(m, 2 * m, 3 * m / 2) * turn.T
    system = kg.System.from_arrays(
        [0], [m], [inertia.tolist()], [[0, 0, length]], [[0, 0, 0]], defaults={"m": 2.0, "l": 0.5}
    )
    assert system.values().inertia[0] == pytest.approx(np.diag([4.0, 2.0, 3.0]))
    assert [toml_number(system.bodies[0].inertia[i][i]) for i in range(3)] == ["2 * m", "m", "3 * m / 2"]


def test_parameters_enter_formulas_as_real_symbols() -> None:
    real = sympy.Symbol("m", real=True)
    assert sympy.sympify(M) == real == expression(M)
    assert sympy.sympify(M * L**2 / 12) == real * sympy.Symbol("l", real=True) ** 2 / 12
    assert sympy.cos(ALPHA) == sympy.cos(sympy.Symbol("alpha", real=True))
    x = sympy.Symbol("x")
    assert M * x == x * M == real * x
    assert x / M - M == x / real - real
    equations = kg.derive(rod(M, M * L**2 / 12, -L / 2))
    assert equations.A[0, 0].subs(M, 3) == equations.A[0, 0].subs(real, 3)


def test_numbers_of_sympy_keep_expressions_of_parameters() -> None:
    for made in (sympy.Rational(1, 12) * M, M * sympy.Rational(1, 12), M / sympy.Integer(12)):
        assert isinstance(made, kg.Expression)
        assert made.value == pytest.approx(1.7 / 12, rel=1e-15)
    assert number(sympy.Rational(1, 12), "n") == number(kg.parse("1/12"), "n")
    assert number(sympy.pi / 2, "n").value == np.pi / 2
    assert number(sympy.Float(0.1), "n") == 0.1
    assert number(sympy.Rational(3, 4), "n") == 0.75
    long = number(sympy.Rational(10**40 + 1, 3**50), "n")
    assert exact_value_of(long) == Fraction(10**40 + 1, 3**50)


EXPONENT = "an exponent is a whole number, or a multiple of 1/2"


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (
            lambda: rod(m, 1.0, 0),
            r"no default value of m\. Pass defaults=\{.m.: 1\.0\}",
        ),
        (lambda: rod(m, 1.0, 0, defaults={"n": 1}), r"defaults: 'n' is no parameter of the system"),
        (lambda: rod(M, 1.0, 0, defaults={"m": 1}), r"defaults: 'm' has a default value already"),
        (lambda: rod(m, 1.0, 0, defaults={"m": "2"}), r"default of 'm': '2' is not a number"),
        (lambda: rod(m, 1.0, 0, defaults={"m": -2.0}), r"body 'rod': mass m = -2.0 kg is negative"),
        (lambda: rod(sympy.Symbol("m", negative=True), 1.0, 0), r"mass m is negative by the assumptions"),
        (lambda: rod(-m, 1.0, 0, defaults={"m": 1.0}), r"mass -m is negative by the assumptions"),
        (lambda: rod(1.0, -m, 0, defaults={"m": 1.0}), r"inertia: the moment -m is negative by the assumpt"),
        (lambda: rod(sympy.I * m, 1.0, 0), r"mass: SymPy's 'I\*m' is no real number"),
        (lambda: rod(sympy.Symbol("a", imaginary=True), 1.0, 0), r"mass: SymPy's 'a' is no real number"),
        (lambda: rod(sympy.oo, 1.0, 0), r"mass: SymPy's 'oo'"),
        (lambda: rod(sympy.nan, 1.0, 0), r"mass: SymPy's 'nan'"),
        (
            lambda: rod(sympy.gamma(m), 1.0, 0),
            r"mass: .* cannot contain gamma of SymPy",
        ),
        (
            lambda: rod(m ** sympy.Rational(1, 3), 1.0, 0),
            EXPONENT,
        ),
        (lambda: rod(m**length, 1.0, 0), EXPONENT),
        (lambda: rod(sympy.Symbol("m_{1}"), 1.0, 0), r"mass: parameter name: 'm_\{1\}' cannot be used"),
        (lambda: rod(sympy.Function("f")(m), 1.0, 0), r"cannot contain f of SymPy"),
        (lambda: rod(m > 2, 1.0, 0), r"mass: .* is not a number"),
        (lambda: rod(1.0, 1.0, 1 / (m - m)), r"mass centre\[2\]: SymPy's 'zoo'"),
        (lambda: rod(m, 1 / (length - 1), 0, defaults={"m": 1, "l": 1}), r"divides by zero at the default"),
        (lambda: kg.Parameter("m", float("nan")), r"nan is not finite"),
    ],
)
def test_wrong_formulas(wrong: Any, message: str) -> None:
    with pytest.raises(kg.ModelError, match=message) as caught:
        wrong()
    assert "\n" not in str(caught.value)
