"""Polynomials in sines, cosines, coordinates, speeds, loads and parameters, with exact coefficients.

Every entry of [A] and {f} is such a polynomial; what force elements add may have other functions as further
factors, and negative powers. Reduction by sin^2 = 1 - cos^2 makes equal entries identical, on which
simplification rests.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import cache, reduce

import sympy
from sympy import Expr

from kanegen.errors import OptionError

Monomial = tuple[tuple[Expr, int], ...]
"""Factors with their powers, in the order of `factor_key`; empty for a constant."""

Polynomial = Mapping[Monomial, Fraction]
"""Coefficients by monomial; none is zero."""

MOST_TERMS = 500
"""Number of terms up to which a polynomial is worth writing out."""

CANCELLED = Fraction(1, 10**14)
"""Ratio of a sum to its last term, or to the sum of the sizes of its terms, below which it counts as zero:
squares of rounded rotations, such as 0.7071..., do not add up to one exactly. A term is a product of about a
dozen numbers, each rounded a few times when a file was read: fewer than 90 roundings of 2^-53, or 1e-14."""


def monomial(factors: Iterable[tuple[Expr, int]]) -> Monomial:
    """Return the monomial of some factors: sorted, with equal ones joined and powers of zero dropped."""
    powers: dict[Expr, int] = {}
    for factor, power in factors:
        powers[factor] = powers.get(factor, 0) + power
    return tuple(sorted(((f, p) for f, p in powers.items() if p), key=lambda item: factor_key(item[0])))


@cache
def factor_key(factor: Expr) -> tuple[int, str]:
    """Return a key that sorts factors: symbols by name, then cosines and sines."""
    return (int(not factor.is_Symbol), str(factor))


def is_trigonometric(factor: Expr) -> bool:
    """Return whether a factor is a sine or a cosine."""
    return factor.func in (sympy.sin, sympy.cos)


def without_common_monomial(polynomial: Polynomial) -> tuple[Monomial, Polynomial]:
    """Return the common monomial of all terms, and the rest."""
    terms = iter(polynomial)
    lowest = dict(next(terms))
    for term in terms:
        powers = dict(term)
        lowest = {f: min(power, powers[f]) for f, power in lowest.items() if f in powers}
    common = monomial(lowest.items())
    inverse = [(factor, -power) for factor, power in common]
    return common, {monomial([*term, *inverse]): value for term, value in polynomial.items()}


def add(polynomials: Iterable[Polynomial]) -> Polynomial:
    """Return the sum of polynomials."""
    result: dict[Monomial, Fraction] = {}
    for polynomial in polynomials:
        for term, coefficient in polynomial.items():
            _add_term(result, term, coefficient)
    return result


def multiply(a: Polynomial, b: Polynomial) -> Polynomial:
    """Return the product of two polynomials without reducing squares.

    Raises:
        OptionError: If the product has more than `MOST_TERMS` terms.
    """
    result: dict[Monomial, Fraction] = {}
    for term_a, u in a.items():
        for term_b, v in b.items():
            _add_term(result, monomial(term_a + term_b) if term_a and term_b else term_a or term_b, u * v)
        if len(result) > MOST_TERMS:
            raise OptionError(
                f"the closed form has more than {MOST_TERMS} terms in one entry. Print the equations with "
                "intermediates instead (closed=False), or read equations.A and equations.f."
            )
    return result


def _add_term(result: dict[Monomial, Fraction], term: Monomial, value: Fraction) -> None:
    """Add one term to a polynomial in place; a sum that cancels is dropped."""
    total = result.get(term, 0) + value
    if abs(total) > CANCELLED * abs(value):
        result[term] = total
    else:
        result.pop(term, None)


def without_cancelled(polynomial: Polynomial, sizes: Polynomial) -> Polynomial:
    """Return a polynomial without coefficients that are smaller than the rounding errors of their terms.

    Args:
        polynomial: The polynomial.
        sizes: For each monomial the sum of the sizes of the terms whose sum its coefficient is.
    """
    return {
        term: value
        for term, value in polynomial.items()
        if abs(value) > CANCELLED * sizes.get(term, Fraction(0))
    }


def eliminate(
    polynomial: Polynomial, function: type[Expr], other: type[Expr], angle: Expr, *, signed: bool = True
) -> Polynomial:
    """Replace even powers of function(angle) by function^2 = 1 - other^2, or by 1 + other^2 without signs."""
    factor, square = function(angle), ((other(angle), 2),)
    parts: list[Polynomial] = []
    for term, coefficient in polynomial.items():
        power = dict(term).get(factor, 0)
        if power < 2:
            parts.append({term: coefficient})
            continue
        rest = monomial([*((f, p) for f, p in term if f != factor), (factor, power % 2)])
        complement: Polynomial = {(): Fraction(1), square: Fraction(-1 if signed else 1)}
        parts.append(reduce(multiply, [complement] * (power // 2), {rest: coefficient}))
    return add(parts)


def reduced_product(a: Polynomial, b: Polynomial, *, signed: bool = True) -> Polynomial:
    """Return the product of two polynomials without squares of sines; `signed` as in `eliminate`."""
    result = multiply(a, b)
    angles = {f.args[0] for term in result for f, power in term if power > 1 and f.func is sympy.sin}
    for angle in sorted(angles, key=str):
        result = eliminate(result, sympy.sin, sympy.cos, angle, signed=signed)
    return result


def substitute(polynomial: Polynomial, values: Mapping[Expr, Polynomial]) -> Polynomial:
    """Replace factors by polynomials; the result has no squares of sines."""
    parts: list[Polynomial] = []
    for term, coefficient in polynomial.items():
        kept = tuple((factor, power) for factor, power in term if factor not in values)
        replaced = [values[factor] for factor, power in term if factor in values for _ in range(power)]
        parts.append(reduce(reduced_product, replaced, {kept: coefficient}))
    return add(parts)
