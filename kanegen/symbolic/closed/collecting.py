"""Polynomials as short expressions: common factors are taken out, sums become products, terms are grouped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection
from fractions import Fraction
from functools import cache

from sympy import Add, Expr, Mul, Pow, S

from kanegen.symbolic.closed.coefficients import constant, content, expression
from kanegen.symbolic.closed.factoring import factored
from kanegen.symbolic.closed.polynomials import (
    Monomial,
    Polynomial,
    factor_key,
    is_trigonometric,
    without_common_monomial,
)

MOST_CHOICES = 3
"""Number of commonest factors that are tried."""

WORTH_NESTING = 0.6
"""Ratio of operations below which a nested form, which is harder to read, is preferred."""


class Collector:
    """Writes polynomials as expressions; equal parts of several polynomials are worked out once.

    Args:
        motion: Speeds, loads and prescribed motion, by whose products terms may be grouped.
    """

    def __init__(self, motion: Collection[Expr] = ()) -> None:
        self._motion = motion
        self._nested: dict[frozenset[tuple[Monomial, Fraction]], Expr] = {}

    def collected(self, polynomial: Polynomial) -> Expr:
        """Return a polynomial as an expression: the shortest of several ways to collect its terms."""
        return self._collect(polynomial, self._sum)

    def _collect(self, polynomial: Polynomial, inner: Callable[[Polynomial], Expr]) -> Expr:
        """Take the common factor of all terms out, and write the rest by `inner`."""
        if not polynomial:
            return S.Zero
        common, rest = without_common_monomial(polynomial)
        size = content(rest.values(), in_product=bool(common))
        return _product(size, common, inner({term: value / size for term, value in rest.items()}))

    def _sum(self, polynomial: Polynomial) -> Expr:
        """Write a polynomial without common factor: as a product, or grouped by angles, motion or nested."""
        if len(polynomial) == 1:
            return _plain(polynomial)
        by_angle = self._by_angle(polynomial)
        by_motion = self._grouped(polynomial, lambda factor: factor in self._motion, self._by_angle)
        best = min((by_angle, by_motion, *self._as_product(polynomial, self._sum)), key=operations)
        nested = self._nest(polynomial)
        return nested if operations(nested) < WORTH_NESTING * operations(best) else best

    def _by_angle(self, polynomial: Polynomial) -> Expr:
        """Group terms by their product of sines and cosines."""
        return self._grouped(polynomial, is_trigonometric, self._nest)

    def _grouped(
        self, polynomial: Polynomial, leads: Callable[[Expr], bool], inner: Callable[[Polynomial], Expr]
    ) -> Expr:
        """Group terms by the product of their leading factors.

        Args:
            polynomial: The polynomial.
            leads: Whether a factor is a leading one.
            inner: Writes the coefficient of a product of leading factors, without its common factor.
        """
        groups: dict[Monomial, dict[Monomial, Fraction]] = {}
        for term, coefficient in polynomial.items():
            part = tuple((factor, power) for factor, power in term if leads(factor))
            other = tuple((factor, power) for factor, power in term if not leads(factor))
            groups.setdefault(part, {})[other] = coefficient
        return Add(
            *(_product(Fraction(1), part, self._collect(group, inner)) for part, group in groups.items())
        )

    def _nest(self, polynomial: Polynomial) -> Expr:
        """Nest a polynomial without common factor, or write it as a product where that is as short."""
        key = frozenset(polynomial.items())
        if key not in self._nested:
            nested = self._by_commonest_factor(polynomial)
            self._nested[key] = min((*self._as_product(polynomial, self._nest), nested), key=operations)
        return self._nested[key]

    def _by_commonest_factor(self, polynomial: Polynomial) -> Expr:
        """Split a polynomial by the factor that most terms have, and write both parts without it.

        A number that several terms have counts as a factor. Of several commonest factors, the one is taken
        that gives the shortest expression.
        """
        count: Counter[Expr | Fraction] = Counter(factor for term in polynomial for factor, _ in term)
        count.update(abs(value) for value in polynomial.values() if abs(value) != 1)
        most = max(count.values(), default=1)
        if most == 1:
            return _plain(polynomial)
        commonest = sorted((key for key, terms in count.items() if terms == most), key=_order)[:MOST_CHOICES]
        return min((self._split(polynomial, chosen) for chosen in commonest), key=operations)

    def _split(self, polynomial: Polynomial, chosen: Expr | Fraction) -> Expr:
        """Write the terms with a factor or a number, and the others, each without its common factor."""
        inside = {t: v for t, v in polynomial.items() if abs(v) == chosen or chosen in dict(t)}
        outside = {term: value for term, value in polynomial.items() if term not in inside}
        return Add(self._collect(inside, self._nest), self._collect(outside, self._nest))

    def _as_product(self, polynomial: Polynomial, inner: Callable[[Polynomial], Expr]) -> list[Expr]:
        """Return a polynomial as a product of sums, each written by `inner`; empty where it is none."""
        found = factored(polynomial)
        if found is None:
            return []
        size, factors = found
        return [_scaled(size, Mul(*(Pow(inner(factor), power) for factor, power in factors)))]


def _order(key: Expr | Fraction) -> tuple[int, str]:
    """Return a key that sorts factors, numbers first."""
    return (-1, str(key)) if isinstance(key, Fraction) else factor_key(key)


@cache
def operations(expr: Expr) -> int:
    """Return the number of operations of an expression, by SymPy's count."""
    return int(expr.count_ops())


def _plain(polynomial: Polynomial) -> Expr:
    """Write a polynomial as the sum of its terms."""
    return Add(*(_product(value, term, S.One) for term, value in polynomial.items()))


def _product(size: Fraction, common: Monomial, rest: Expr) -> Expr:
    """Return the product of a coefficient, a monomial and an expression."""
    if not common and rest is S.One:
        return constant(size)
    return _scaled(size, Mul(*(Pow(factor, power) for factor, power in common), rest))


def _scaled(size: Fraction, expr: Expr) -> Expr:
    """Return a multiple of an expression; SymPy would multiply a number into a sum at once."""
    is_multiple_of_sum = expr.is_Add and abs(size) != 1
    return Mul(expression(size), expr, evaluate=False) if is_multiple_of_sum else Mul(expression(size), expr)
