"""Polynomials as short expressions: common factors outside, terms that share a factor together."""

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
"""A product of two sums has at least four terms."""

MOST_TERMS_TO_FACTOR = 16
"""Longer polynomials are not tried: factoring is slow, and seldom succeeds."""


LARGEST_MULTIPLE = 4
"""Up to this multiple of each other, decimal numbers show it by a common factor."""

WORTH_NESTING = 0.6
"""A nested form is harder to read; it must be shorter by more than this."""


def collected(polynomial: Polynomial, motion: Collection[Expr] = ()) -> Expr:
    """The shortest of three ways to collect.

    Args:
        polynomial: Any.
        motion: Speeds and loads, whose products may gather the rest in their coefficients.
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
    return int(expr.count_ops())


def _by_angle(polynomial: Polynomial) -> Expr:
    return _grouped(polynomial, lambda factor: not factor.is_Symbol, _factored)


def _coefficient(polynomial: Polynomial) -> Expr:
    content, common, rest = _without_common(polynomial)
    return _product(content, common, _by_angle(rest))


def _grouped(
    polynomial: Polynomial, leads: Callable[[Expr], bool], inner: Callable[[Polynomial], Expr]
) -> Expr:
    """Terms with the same product of leading factors together, the rest written by `inner`."""
    groups: dict[Monomial, dict[Monomial, Fraction]] = {}
    for term, coefficient in polynomial.items():
        part = tuple((factor, power) for factor, power in term if leads(factor))
        other = tuple((factor, power) for factor, power in term if not leads(factor))
        groups.setdefault(part, {})[other] = coefficient
    return Add(*(Mul(_powers(part), inner(group)) for part, group in groups.items()))


def _factored(polynomial: Polynomial) -> Expr:
    """`_collect`, or a product of sums where that is shorter."""
    plain = _collect(polynomial)
    short = all(value.denominator <= LARGEST_DENOMINATOR for value in polynomial.values())
    if not short or not FEWEST_TERMS_OF_A_PRODUCT <= len(polynomial) <= MOST_TERMS_TO_FACTOR:
        return plain
    product = sympy.factor(plain)
    return min(plain, product, key=_operations)


def _collect(polynomial: Polynomial) -> Expr:
    content, common, rest = _without_common(polynomial)
    return _product(content, common, _by_commonest_factor(rest))


def _by_commonest_factor(polynomial: Polynomial) -> Expr:
    """A polynomial without a common factor, split again and again by the factor that most terms have."""
    count = Counter(factor for term in polynomial for factor, _ in term)
    shared = [factor for factor, terms in count.items() if terms > 1]
    if not shared:
        return Add(*(_product(value, term, S.One) for term, value in polynomial.items()))
    chosen = min(shared, key=lambda factor: (-count[factor], factor_key(factor)))
    inside = {term: value for term, value in polynomial.items() if chosen in dict(term)}
    outside = {term: value for term, value in polynomial.items() if term not in inside}
    return Add(_collect(inside), _collect(outside)) if outside else _collect(inside)


def _without_common(polynomial: Polynomial) -> tuple[Fraction, Monomial, Polynomial]:
    """Rational content, common monomial, and what is left: their product is the polynomial."""
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
    """A factor of all coefficients, 1 where none makes them easier to read.

    Of short fractions it is the greatest, as 2 of 4 and 6; of others it must leave small multiples, as
    0.0015 of 0.003 and 0.0045.
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
    """Greatest common divisor."""
    return Fraction(gcd(*(v.numerator for v in values)), lcm(*(v.denominator for v in values)))


def _is_small(multiple: Fraction) -> bool:
    return abs(multiple.numerator) <= LARGEST_MULTIPLE and multiple.denominator <= LARGEST_DENOMINATOR


def _product(content: Fraction, common: Monomial, rest: Expr) -> Expr:
    return Mul(expression(content), _powers(common), rest)


def _powers(term: Monomial) -> Expr:
    return Mul(*(Pow(factor, power) for factor, power in term))
