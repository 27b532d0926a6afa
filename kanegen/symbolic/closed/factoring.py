"""Polynomials as products of sums, over the rational numbers, in which decimal numbers are exact."""

from __future__ import annotations

from fractions import Fraction
from math import gcd, lcm, prod
from typing import Any

from sympy import QQ, Expr
from sympy.polys.rings import PolyElement, ring

from kanegen.symbolic.closed.coefficients import digits, is_short
from kanegen.symbolic.closed.polynomials import Polynomial, factor_key, monomial

FEWEST_TERMS = 3
"""Number of terms from which a polynomial without a common factor may be a product: (a + b)^2 has three."""

MOST_TERMS = 40
"""Number of terms up to which a polynomial is factored: longer ones take long and seldom are products."""

FAR_OUT = 1_000_003
"""Size of the smallest coordinate of a point at which polynomials are compared."""

Product = tuple[Fraction, list[tuple[Polynomial, int]]]
"""A coefficient and polynomials with their powers, whose product is a polynomial."""


def factored(polynomial: Polynomial) -> Product | None:
    """Return a polynomial without a common monomial as a product of irreducible ones; None if it is one.

    Factors have short coefficients, such as s + 1.6 rather than 5 s + 8.
    """
    if not FEWEST_TERMS <= len(polynomial) <= MOST_TERMS or not all(map(is_short, polynomial.values())):
        return None
    if any(power < 0 for term in polynomial for _, power in term):
        return None
    variables = _variables(polynomial)
    if _is_irreducible(polynomial, variables):
        return None
    whole = _in_ring(polynomial, variables)
    factors = _irreducible_factors(whole)
    if sum(factors.values()) < 2:
        return None
    content, found = _fraction(whole.LC), []
    for element, power in factors.items():
        scale, factor = _with_short_coefficients(_from_ring(element, variables))
        content *= scale**power
        found.append((factor, power))
    return content, found


def divided(polynomial: Polynomial, divisor: Polynomial) -> Polynomial:
    """Return the quotient of two polynomials; the divisor divides the other one.

    Raises:
        ExactQuotientFailed: If it does not.
    """
    variables = _variables(polynomial, divisor)
    if not variables:
        ((_, value),) = divisor.items()
        return {term: coefficient / value for term, coefficient in polynomial.items()}
    return _from_ring(_in_ring(polynomial, variables).exquo(_in_ring(divisor, variables)), variables)


def _variables(*polynomials: Polynomial) -> list[Expr]:
    """Return the factors of the monomials of polynomials, in order."""
    found = {factor for polynomial in polynomials for term in polynomial for factor, _ in term}
    return sorted(found, key=factor_key)


def _is_irreducible(polynomial: Polynomial, variables: list[Expr]) -> bool:
    """Return whether a variable shows that a polynomial without a common monomial is irreducible.

    In p = a v + b, where v is in neither a nor b, every factor of p without v divides both a and b. At a
    point far out its value is a large common divisor of theirs; where they have none, there is no factor.
    """
    scale = lcm(*(value.denominator for value in polynomial.values()))
    point = {variable: FAR_OUT * 17**i + i for i, variable in enumerate(variables)}
    for variable in variables:
        powers = [dict(term).get(variable, 0) for term in polynomial]
        if max(powers) == 1:
            parts = [0, 0]
            for power, (term, value) in zip(powers, polynomial.items(), strict=True):
                parts[power] += int(value * scale) * prod(point[f] ** p for f, p in term if f != variable)
            return gcd(*parts) < FAR_OUT
    return False


def _irreducible_factors(element: PolyElement) -> dict[PolyElement, int]:
    """Return the irreducible factors of an element of a ring, with leading coefficients 1, and their powers.

    In p = a v + b the greatest common divisor of a and b is the product of all factors without v, so that
    one division leaves a factor that is irreducible. That is much faster than SymPy's factorisation, which is
    left with polynomials that are linear in no variable.
    """
    for i, degree in enumerate(element.degrees()):
        if degree == 1:
            parts = [element.ring.zero, element.ring.zero]
            for powers, value in element.terms():
                place = (*powers[:i], 0, *powers[i + 1 :])
                parts[powers[i]] += element.ring({place: value})
            common = parts[0].gcd(parts[1])
            factors = {} if common.is_ground else _irreducible_factors(common)
            return factors | {element.exquo(common).monic(): 1}
    return {factor.monic(): power for factor, power in element.factor_list()[1]}


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
        monomial(zip(variables, powers, strict=True)): _fraction(value) for powers, value in element.terms()
    }


def _fraction(value: Any) -> Fraction:
    """Return a number of SymPy's domain of rational numbers as a fraction."""
    return Fraction(int(value.numerator), int(value.denominator))


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
