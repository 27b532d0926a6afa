"""Polynomials as short expressions: common factors are taken out, terms with a common factor are grouped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable
from fractions import Fraction
from math import gcd, lcm

import sympy
from sympy import Add, Expr, Mul, Pow, S

from kanegen.symbolic.closed.polynomials import (
    LARGEST_DENOMINATOR,
    Monomial,
    Polynomial,
    expression,
    factor_key,
    monomial,
)

FEWEST_TERMS_OF_A_PRODUCT = 4
"""Number of terms from which a polynomial may be a product of two sums."""

MOST_TERMS_TO_FACTOR = 16
"""Number of terms up to which a polynomial is factored: factoring longer ones is slow and seldom succeeds."""

LARGEST_MULTIPLE = 4
"""Ratio of decimal coefficients up to which their common factor is taken out."""

WORTH_NESTING = 0.6
"""Ratio of operations below which a nested form, which is harder to read, is preferred."""


def collected(polynomial: Polynomial, motion: Collection[Expr] = ()) -> Expr:
    """Return a polynomial as an expression: the shortest of three ways to collect terms.

    Args:
        polynomial: The polynomial.
        motion: Speeds, loads and prescribed motion, by whose products terms may be grouped.
    """
    if not polynomial:
        return S.Zero
    content, common, rest = _without_common(polynomial)
    by_angle = _by_angle(rest)
    by_motion = _grouped(rest, lambda factor: factor in motion, _coefficient)
    by_factor = _by_commonest_factor(rest)
    best = min((by_angle, by_motion), key=_operations)
    nested_is_worth_it = _operations(by_factor) < WORTH_NESTING * _operations(best)
    return _product(content, common, by_factor if nested_is_worth_it else best)


def _operations(expr: Expr) -> int:
    """Return the number of operations of an expression."""
    return int(expr.count_ops())


def _by_angle(polynomial: Polynomial) -> Expr:
    """Group terms by their product of sines and cosines."""
    return _grouped(polynomial, lambda factor: not factor.is_Symbol, _factored)


def _coefficient(polynomial: Polynomial) -> Expr:
    """Write the coefficient of a product of speeds or loads, grouped by sines and cosines."""
    content, common, rest = _without_common(polynomial)
    return _product(content, common, _by_angle(rest))


def _grouped(
    polynomial: Polynomial, leads: Callable[[Expr], bool], inner: Callable[[Polynomial], Expr]
) -> Expr:
    """Group terms by the product of their leading factors.

    Args:
        polynomial: The polynomial.
        leads: Whether a factor is a leading one.
        inner: Writes the coefficient of a product of leading factors.
    """
    groups: dict[Monomial, dict[Monomial, Fraction]] = {}
    for term, coefficient in polynomial.items():
        part = tuple((factor, power) for factor, power in term if leads(factor))
        other = tuple((factor, power) for factor, power in term if not leads(factor))
        groups.setdefault(part, {})[other] = coefficient
    return Add(*(Mul(_powers(part), inner(group)) for part, group in groups.items()))


def _factored(polynomial: Polynomial) -> Expr:
    """Collect the terms of a polynomial, or write it as a product of sums where that is shorter."""
    plain = _collect(polynomial)
    short = all(value.denominator <= LARGEST_DENOMINATOR for value in polynomial.values())
    if not short or not FEWEST_TERMS_OF_A_PRODUCT <= len(polynomial) <= MOST_TERMS_TO_FACTOR:
        return plain
    product = sympy.factor(plain)
    return min(plain, product, key=_operations)


def _collect(polynomial: Polynomial) -> Expr:
    """Take out the common factors of all terms, then nest by the commonest factor."""
    content, common, rest = _without_common(polynomial)
    return _product(content, common, _by_commonest_factor(rest))


def _by_commonest_factor(polynomial: Polynomial) -> Expr:
    """Nest a polynomial without a common factor: split it repeatedly by the factor that most terms have."""
    count = Counter(factor for term in polynomial for factor, _ in term)
    shared = [factor for factor, terms in count.items() if terms > 1]
    if not shared:
        return Add(*(_product(value, term, S.One) for term, value in polynomial.items()))
    chosen = min(shared, key=lambda factor: (-count[factor], factor_key(factor)))
    inside = {term: value for term, value in polynomial.items() if chosen in dict(term)}
    outside = {term: value for term, value in polynomial.items() if term not in inside}
    return Add(_collect(inside), _collect(outside)) if outside else _collect(inside)


def _without_common(polynomial: Polynomial) -> tuple[Fraction, Monomial, Polynomial]:
    """Return rational content, common monomial and remaining polynomial, whose product is the polynomial."""
    terms = iter(polynomial)
    lowest = dict(next(terms))
    for term in terms:
        powers = dict(term)
        lowest = {f: min(power, powers[f]) for f, power in lowest.items() if f in powers}
    common = monomial(lowest.items())
    content = _content(polynomial.values())
    if not common and content.denominator > LARGEST_DENOMINATOR:
        content = Fraction(1)  # SymPy would multiply it into a sum at once, and round
    inverse = [(factor, -power) for factor, power in common]
    rest = {monomial([*term, *inverse]): value / content for term, value in polynomial.items()}
    return content, common, rest


def _content(values: Iterable[Fraction]) -> Fraction:
    """Return a common factor of coefficients, 1 where none makes them easier to read.

    Of short fractions it is the greatest common divisor, such as 2 for 4 and 6. Of decimal numbers it must
    leave small multiples, such as 0.0015 for 0.003 and 0.0045.
    """
    fractions = list(values)
    smallest = min(abs(value) for value in fractions)
    size = Fraction(1)
    if all(value.denominator <= LARGEST_DENOMINATOR for value in fractions):
        size = _divisor(fractions)
    elif all(_is_small(value / smallest) for value in fractions):
        size = smallest * _divisor([value / smallest for value in fractions])
    return -size if all(value < 0 for value in fractions) else size


def _divisor(values: list[Fraction]) -> Fraction:
    """Return the greatest common divisor of fractions."""
    return Fraction(gcd(*(v.numerator for v in values)), lcm(*(v.denominator for v in values)))


def _is_small(multiple: Fraction) -> bool:
    """Return whether a multiple is a short fraction that is easy to read."""
    return abs(multiple.numerator) <= LARGEST_MULTIPLE and multiple.denominator <= LARGEST_DENOMINATOR


def _product(content: Fraction, common: Monomial, rest: Expr) -> Expr:
    """Return the product of a coefficient, a monomial and an expression."""
    return Mul(expression(content), _powers(common), rest)


def _powers(term: Monomial) -> Expr:
    """Return a monomial as an expression."""
    return Mul(*(Pow(factor, power) for factor, power in term))
