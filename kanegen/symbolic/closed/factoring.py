"""Polynomials as products of sums, over the rational numbers, in which decimal numbers are exact."""

from __future__ import annotations

from fractions import Fraction

from sympy import QQ, Expr
from sympy.polys.rings import PolyElement, ring

from kanegen.symbolic.closed.coefficients import digits, is_short
from kanegen.symbolic.closed.polynomials import Polynomial, factor_key, monomial

FEWEST_TERMS = 3
"""Number of terms from which a polynomial without a common factor may be a product: (a + b)^2 has three."""

MOST_TERMS = 40
"""Number of terms up to which a polynomial is factored: longer ones take long and seldom are products."""

Product = tuple[Fraction, list[tuple[Polynomial, int]]]
"""A coefficient and polynomials with their powers, whose product is a polynomial."""


def factored(polynomial: Polynomial) -> Product | None:
    """Return a polynomial without a common monomial as a product of irreducible ones; None if it is one.

    Factors have short coefficients, such as s + 1.6 rather than 5 s + 8.
    """
    if not FEWEST_TERMS <= len(polynomial) <= MOST_TERMS or _is_surely_irreducible(polynomial):
        return None
    if not all(is_short(value) for value in polynomial.values()):
        return None
    if any(power < 0 for term in polynomial for _, power in term):
        return None
    variables = sorted({factor for term in polynomial for factor, _ in term}, key=factor_key)
    coefficient, factors = _in_ring(polynomial, variables).factor_list()
    if sum(power for _, power in factors) < 2:
        return None
    content = Fraction(int(coefficient.numerator), int(coefficient.denominator))
    found: list[tuple[Polynomial, int]] = []
    for element, power in factors:
        scale, factor = _with_short_coefficients(_from_ring(element, variables))
        content *= scale**power
        found.append((factor, power))
    return content, found


def divided(polynomial: Polynomial, divisor: Polynomial) -> Polynomial:
    """Return the quotient of two polynomials; the divisor divides the other one.

    Raises:
        ExactQuotientFailed: If it does not.
    """
    variables = sorted(
        {factor for part in (polynomial, divisor) for term in part for factor, _ in term}, key=factor_key
    )
    if not variables:
        ((_, value),) = divisor.items()
        return {term: coefficient / value for term, coefficient in polynomial.items()}
    return _from_ring(_in_ring(polynomial, variables).exquo(_in_ring(divisor, variables)), variables)


def _is_surely_irreducible(polynomial: Polynomial) -> bool:
    """Return whether a variable shows that a polynomial without a common monomial is irreducible.

    In p = a v + b, where v is in neither a nor b, every factor of p without v divides both a and b. If one of
    them has a single term, only a monomial does, which is then common to all terms of p.
    """
    powers: dict[Expr, list[int]] = {}
    for term in polynomial:
        for factor, power in term:
            powers.setdefault(factor, []).append(power)
    size = len(polynomial)
    return any(max(found) == 1 and len(found) in (1, size - 1) for found in powers.values())


def _in_ring(polynomial: Polynomial, variables: list[Expr]) -> PolyElement:
    """Return a polynomial as an element of SymPy's ring of polynomials in some variables."""
    domain = ring([f"v{i}" for i in range(len(variables))], QQ)[0]
    place = {variable: i for i, variable in enumerate(variables)}
    terms: dict[tuple[int, ...], object] = {}
    for term, value in polynomial.items():
        powers = [0] * len(variables)
        for factor, power in term:
            powers[place[factor]] = power
        terms[tuple(powers)] = QQ(value.numerator, value.denominator)
    return domain.from_dict(terms)


def _from_ring(element: PolyElement, variables: list[Expr]) -> Polynomial:
    """Return an element of a ring as a polynomial."""
    return {
        monomial(zip(variables, powers, strict=True)): Fraction(int(value.numerator), int(value.denominator))
        for powers, value in element.terms()
    }


def _with_short_coefficients(polynomial: Polynomial) -> tuple[Fraction, Polynomial]:
    """Return a coefficient, and a polynomial with coefficients of few digits, with the given product."""
    values = list(polynomial.values())
    scales = [sign * abs(value) for value in values for sign in (1, -1)]
    best = min(scales, key=lambda scale: _unwieldiness([value / scale for value in values]))
    return best, {term: value / best for term, value in polynomial.items()}


def _unwieldiness(values: list[Fraction]) -> tuple[int, int, int]:
    """Return how many coefficients are not 1 or -1, how many digits they have, and how many are negative."""
    others = [abs(value) for value in values if abs(value) != 1]
    return len(others), sum(map(digits, others)), sum(value < 0 for value in values)
