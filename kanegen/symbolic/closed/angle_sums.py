"""Shorter forms of trigonometric polynomials, by sums of angles and by a choice between sin^2 and cos^2."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations, permutations, product

from sympy import Expr, cos, sin

from kanegen.symbolic.closed.polynomials import (
    Monomial,
    Polynomial,
    add,
    eliminate,
    factor_key,
    monomial,
    substitute,
)

MOST_CHOICES = 4
"""Number of angles with squares for which sin^2 and cos^2 are both tried, in 2 to this power combinations."""


def shortest(polynomial: Polynomial) -> Polynomial:
    """Return an equal polynomial in sines and cosines of sums of angles, with as few terms as are found.

    Args:
        polynomial: A polynomial in sines and cosines only, without squares of sines.
    """
    starts = (polynomial, _merged(polynomial))
    candidates = [contract(form) for start in starts for form in _forms(start)]
    return min(candidates, key=_size)  # of several shortest ones the first


def with_double_angles(polynomial: Polynomial) -> Iterator[Polynomial]:
    """Yield the polynomial with sin 2a / 2 for sin a cos a, if it has such products twice."""
    changed: dict[Monomial, Fraction] = {}
    for term, value in polynomial.items():
        powers = dict(term)
        angles = (f.args[0] for f in powers if f.func is sin and powers[f] > 0)
        angle = next((a for a in angles if powers.get(cos(a), 0) > 0), None)
        if angle is None:
            changed[term] = value
            continue
        rest = monomial([*term, (sin(angle), -1), (cos(angle), -1), (sin(2 * angle), 1)])
        changed[rest] = changed.get(rest, Fraction(0)) + value / 2
    if any(changed.get(term) != value and value.numerator % 2 == 0 for term, value in polynomial.items()):
        yield changed


def _merged(polynomial: Polynomial) -> Polynomial:
    """Replace angles by sums and differences of two angles, as long as that leaves fewer terms."""
    angles = sorted({f.args[0] for term in polynomial for f, _ in term}, key=str)
    trials = [_replaced(polynomial, a, b, sign) for a, b in permutations(angles, 2) for sign in (1, -1)]
    best = min(trials, key=len, default=polynomial)
    return _merged(best) if len(best) < len(polynomial) else polynomial


def _replaced(polynomial: Polynomial, a: Expr, b: Expr, sign: int) -> Polynomial:
    """Replace angle b by sign (c - a), where c = a + sign b is a new angle."""
    c = a + sign * b
    with_sine, with_cosine = ((sin(a), 1),), ((cos(a), 1),)
    plus, minus = Fraction(sign), Fraction(-sign)
    sine = add([_times(sin(c), with_cosine, plus), _times(cos(c), with_sine, minus)])
    cosine = add([_times(cos(c), with_cosine, Fraction(1)), _times(sin(c), with_sine, Fraction(1))])
    return substitute(polynomial, {sin(b): sine, cos(b): cosine})


def _size(polynomial: Polynomial) -> tuple[int, int]:
    """Return the number of terms, and the sum of all powers."""
    return len(polynomial), sum(power for term in polynomial for _, power in term)


def _forms(polynomial: Polynomial) -> Iterator[Polynomial]:
    """Yield the polynomial with squares of sines or of cosines, in all combinations of its angles."""
    squared = {f.args[0] for term in polynomial for f, power in term if power > 1}
    angles = sorted(squared, key=str)[:MOST_CHOICES]
    for choice in product((False, True), repeat=len(angles)):
        form = polynomial
        for angle, use_sine in zip(angles, choice, strict=True):
            if use_sine:
                form = eliminate(form, cos, sin, angle)
        yield form


def contract(polynomial: Polynomial) -> Polynomial:
    """Join pairs of terms by the addition theorems until no pair is left."""
    current, shorter = polynomial, _contract_once(polynomial)
    while len(shorter) < len(current):
        current, shorter = shorter, _contract_once(shorter)
    return current


def _contract_once(polynomial: Polynomial) -> Polynomial:
    """Join every present pair of terms; the new angles may make new pairs."""
    angles = sorted({f.args[0] for term in polynomial for f, _ in term}, key=str)
    result = dict(polynomial)
    for term in sorted(polynomial, key=_term_key):
        for angle in angles:
            _replace(result, _double_angle(result, term, angle))
        for a, b in combinations(angles, 2):
            _replace(result, _addition(result, term, a, b))
    return result


def _replace(polynomial: dict[Monomial, Fraction], change: Polynomial) -> None:
    """Add `change` to a polynomial in place."""
    for term, value in change.items():
        total = polynomial.pop(term, Fraction(0)) + value
        if total:
            polynomial[term] = total


def _addition(polynomial: Polynomial, term: Monomial, a: Expr, b: Expr) -> Polynomial:
    """Return the change that joins `term` with another by an addition theorem, empty without another.

    cos a cos b +- sin a sin b = cos(a -+ b), and sin a cos b +- cos a sin b = sin(a +- b).
    """
    for function, other in ((cos, sin), (sin, cos)):
        rest = _without(term, (function(a), 1), (cos(b), 1))
        if rest is None or term not in polynomial:
            continue
        partner = monomial([*rest, (other(a), 1), (sin(b), 1)])
        value, second = polynomial[term], polynomial.get(partner, Fraction(0))
        if abs(second) == abs(value):
            is_sum = (second == value) == (function is sin)
            joined = _times(function(a + b if is_sum else a - b), rest, value)
            return {term: -value, partner: -second} | joined
    return {}


def _double_angle(polynomial: Polynomial, term: Monomial, a: Expr) -> Polynomial:
    """Return the change that joins `term` with another by 2 cos^2 a - 1 = cos 2a, empty without another."""
    rest = _without(term, (cos(a), 2))
    value = polynomial.get(term)
    if rest is None or value is None or polynomial.get(rest) != -value / 2:
        return {}
    return {term: -value, rest: value / 2, monomial([*rest, (cos(2 * a), 1)]): value / 2}


def _times(factor: Expr, rest: Monomial, coefficient: Fraction) -> dict[Monomial, Fraction]:
    """Return the polynomial of one term, the product of the arguments."""
    if factor.is_Mul:  # in its order of symbols, SymPy may write sin(a - b) as -sin(b - a)
        return {monomial([*rest, (-factor, 1)]): -coefficient}
    return {monomial([*rest, (factor, 1)]): coefficient}


def _without(term: Monomial, *factors: tuple[Expr, int]) -> Monomial | None:
    """Return `term` divided by factors with their powers, or None if it lacks one."""
    powers = dict(term)
    if any(powers.get(factor, 0) < power for factor, power in factors):
        return None
    return monomial([*term, *((factor, -power) for factor, power in factors)])


def _term_key(term: Monomial) -> list[tuple[tuple[int, str], int]]:
    """Return a key by which terms are sorted."""
    return [(factor_key(factor), power) for factor, power in term]
