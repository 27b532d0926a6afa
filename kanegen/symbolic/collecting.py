"""Polynomials as short expressions: common factors outside, terms that share a factor together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from fractions import Fraction
from math import gcd, lcm

from sympy import Add, Expr, Mul, Pow, S

from kanegen.symbolic.polynomials import (
    LARGEST_DENOMINATOR,
    Monomial,
    Polynomial,
    expression,
    factor_key,
    monomial,
)


def collected(polynomial: Polynomial) -> Expr:
    """The shorter of two ways to collect: by products of sines and cosines, or by the commonest factors."""
    if not polynomial:
        return S.Zero
    content, common, rest = _without_common(polynomial)
    forms = (_by_trigonometric_part(rest), _by_commonest_factor(rest))
    return _product(content, common, min(forms, key=lambda form: int(form.count_ops())))


def _by_trigonometric_part(polynomial: Polynomial) -> Expr:
    groups: dict[Monomial, dict[Monomial, Fraction]] = {}
    for term, coefficient in polynomial.items():
        part = tuple((factor, power) for factor, power in term if not factor.is_Symbol)
        symbols = tuple((factor, power) for factor, power in term if factor.is_Symbol)
        groups.setdefault(part, {})[symbols] = coefficient
    return Add(*(Mul(_powers(part), _collect(group)) for part, group in groups.items()))


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
    inverse = [(factor, -power) for factor, power in common]
    rest = {monomial([*term, *inverse]): value / content for term, value in polynomial.items()}
    return content, common, rest


def _content(values: Iterable[Fraction]) -> Fraction:
    """A factor of all coefficients: where they are short fractions, their greatest common divisor."""
    fractions = list(values)
    sizes = {abs(value) for value in fractions}
    if len(sizes) == 1:
        size = sizes.pop()
    elif max(value.denominator for value in fractions) <= LARGEST_DENOMINATOR:
        size = Fraction(gcd(*(v.numerator for v in fractions)), lcm(*(v.denominator for v in fractions)))
    else:
        size = Fraction(1)
    return -size if all(value < 0 for value in fractions) else size


def _product(content: Fraction, common: Monomial, rest: Expr) -> Expr:
    return Mul(expression(content), _powers(common), rest)


def _powers(term: Monomial) -> Expr:
    return Mul(*(Pow(factor, power) for factor, power in term))
