"""The steps of closed forms: coefficients, factors and collected sums keep their values and read well."""

from __future__ import annotations

from fractions import Fraction
from functools import reduce

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import Expr, Float, Integer, Rational, Symbol

from kanegen.symbolic.closed.coefficients import constant, content, digits, expression, fraction
from kanegen.symbolic.closed.collecting import Collector
from kanegen.symbolic.closed.directions import square_root
from kanegen.symbolic.closed.expanding import Expander
from kanegen.symbolic.closed.factoring import factored
from kanegen.symbolic.closed.polynomials import Polynomial, multiply, without_common_monomial
from kanegen.symbolic.printers import text
from kanegen.symbolic.symbols import real

SYMBOLS = tuple(real(name) for name in "a b c r s".split())
NUMBERS = [Rational(number) for number in ("1", "-1", "2", "1.6", "-9.81", "0.25", "1/3", "17.5")]


def polynomial(expr: Expr) -> Polynomial:
    return Expander({}, lambda inner: inner).polynomial(expr)


def parsed(formula: str) -> Expr:
    return sympy.sympify(formula, locals={str(symbol): symbol for symbol in SYMBOLS}, rational=True)


@pytest.mark.parametrize(
    ("number", "count"),
    [
        ("1", 1),
        ("18000", 2),
        ("9.81", 3),
        ("0.0015", 2),
        ("1e-20", 1),
        ("15.696", 5),
        ("1/3", 2),
        ("7/12", 3),
    ],
)
def test_digits(number: str, count: int) -> None:
    assert digits(Fraction(number)) == count


def test_numbers_are_those_of_the_author() -> None:
    assert text(expression(fraction(Float(1.1)) * fraction(Float(9.81)))) == "10.791"
    assert text(expression(Fraction("0.1") + Fraction("0.2"))) == "0.3"
    assert expression(Fraction(1, 12)) == Rational(1, 12)
    assert expression(Fraction("0.5")) == Rational(1, 2)
    assert constant(Fraction("0.5")) == Float(0.5)
    assert constant(Fraction(-7)) == Integer(-7)
    assert constant(Fraction(1, 3)) == Rational(1, 3)
    assert expression(Fraction(10**16 + 1, 3 * 10**16)) == Float((10**16 + 1) / (3 * 10**16))


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_of_the_model_prints_as_it_was_read(value: float) -> None:
    assert float(expression(fraction(Float(value, precision=53)))) == value


@pytest.mark.parametrize(
    ("values", "in_product", "factor"),
    [
        ("9.81 15.696", False, "9.81"),
        ("2 3.2", False, "1"),
        ("2 3.2", True, "2"),
        ("-2 -2", False, "-2"),
        ("5 5 2", False, "5"),
        ("4 6", False, "1"),
        ("2 6.4 5.12 2000", True, "2"),
        ("0.24 0.506", True, "1"),
        ("2 0.6 0.02", True, "2"),
    ],
)
def test_factors_in_front_of_sums(values: str, in_product: bool, factor: str) -> None:
    numbers = [Fraction(value) for value in values.split()]
    assert content(numbers, in_product=in_product) == Fraction(factor)


@pytest.mark.parametrize(
    "formula",
    [
        "(a + b)*(r + s)**2",
        "a*(s + 1.6)**2 + 1000.5",
        "(s + 1.6)**2",
        "9.81*a*(s + 1.6)",
        "-a*(b + c)",
        "c*(r - s) + 160000*(a - b)",
        "a*b**2*(2*r + s)",
        "(a - b)*(a + b + c)",
        "-9.81*(a + 1.1)",
        "a*r**2 + b*s**2 + c",
    ],
)
def test_sums_come_out_as_written(formula: str) -> None:
    assert text(Collector().collected(polynomial(parsed(formula)))) == formula


def test_terms_are_grouped_by_motion_or_angle() -> None:
    a, b, c, r, s = SYMBOLS
    by_angle = (a + b) * sympy.cos(r) + (a - c) * sympy.sin(r)
    assert Collector().collected(polynomial(by_angle)) == by_angle
    by_motion = s * (a * sympy.cos(r) + b * sympy.sin(r)) + c
    assert Collector({s}).collected(polynomial(by_motion)) == by_motion


def test_roots_and_quotients_stay_factors() -> None:
    a, b, _, r, s = SYMBOLS
    length = sympy.sqrt(r**2 + s**2)
    expr = polynomial(a * r - a * b * r / length)
    assert Collector().collected(expr) == a * r * (1 - b / length)
    assert Collector().collected(polynomial(a / s + b / s + r / s**2)) == (s * (a + b) + r) / s**2


sums = st.lists(
    st.tuples(st.sampled_from(NUMBERS), st.sampled_from([Integer(1), *SYMBOLS])), min_size=2, max_size=3
).map(lambda terms: sympy.Add(*(number * symbol for number, symbol in terms)))
products = st.lists(sums, min_size=1, max_size=3)


@settings(max_examples=60)
@given(products)
def test_products_of_sums_keep_their_values(parts: list[Expr]) -> None:
    """Exact factors have an exact product; a collected form has the value of what was multiplied out."""
    whole = sympy.Mul(*parts)
    expanded = polynomial(whole)
    if not expanded:
        return
    _, rest = without_common_monomial(expanded)
    found = factored(rest)
    if found is not None:
        size, factors = found
        powers = (factor for factor, power in factors for _ in range(power))
        assert reduce(multiply, powers, {(): size}) == rest
    values: dict[Symbol, Rational] = dict(
        zip(SYMBOLS, map(Rational, ("1.3", "0.7", "2.9", "1.9", "0.4")), strict=True)
    )
    expected = whole.xreplace(values)
    scale = sum(abs(value) for value in expanded.values()) * 3**3  # no symbol is above 3
    assert abs(Collector().collected(expanded).xreplace(values) - expected) <= 1e-14 * scale


@settings(max_examples=40)
@given(sums)
def test_squares_have_roots(part: Expr) -> None:
    found = square_root(polynomial(part**2))
    if part == 0:
        assert found is None
        return
    assert found is not None
    size, root = found
    plain = sympy.Add(*(Rational(v) * sympy.Mul(*(f**p for f, p in term)) for term, v in root.items()))
    assert ((size * plain) ** 2 - part**2).expand() == 0


def test_a_number_may_be_the_square_of_a_root() -> None:
    size, root = square_root(polynomial(parsed("2*s**2 + 4*s + 2"))) or (None, {})
    assert size == sympy.sqrt(2)
    assert root == polynomial(parsed("s + 1"))


@pytest.mark.parametrize("formula", ["s**2 + 1", "a*s**2", "-s**2", "s**2 + 2*s", "r**2 + s**2"])
def test_other_polynomials_have_none(formula: str) -> None:
    assert square_root(polynomial(parsed(formula))) is None
