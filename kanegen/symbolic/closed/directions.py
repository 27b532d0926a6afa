"""Directions of springs in closed forms: without a root where the ends stay on one line.

The squared length of a spring between ends on one line is the square of a polynomial p, and its length is
|p|. As long as the ends do not pass through each other, the sign of p is the one that it has at {x} = {0}
with the default values of parameters. The direction is a polynomial then, and p times this sign is positive:
the condition under which the closed form holds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from math import isqrt

import sympy
from sympy import Add, Expr, ImmutableMatrix, Integer, Mul, Pow, Rational, S

from kanegen.symbolic import functions
from kanegen.symbolic.closed.factoring import divided, factored
from kanegen.symbolic.closed.form import Simplifier
from kanegen.symbolic.closed.polynomials import (
    Polynomial,
    add,
    monomial,
    multiply,
    reduced_product,
    without_common_monomial,
)


@dataclass
class Directions:
    """Finds the directions of springs for one closed form.

    Attributes:
        simplifier: Simplifies what a direction is made of; it is told which factors are signs.
        start: Values of coordinates and parameters, by which the sign of a length is known; others are zero.
        everywhere: Whether the form must hold in all states, so that signs stay in it.
        conditions: What is positive where the form holds, for the springs so far.
    """

    simplifier: Simplifier
    start: Mapping[Expr, Expr]
    everywhere: bool = False
    conditions: list[Expr] = field(default_factory=list)

    def along(self, way: ImmutableMatrix) -> ImmutableMatrix:
        """Return the unit vector along the vector between the ends of a spring, (3, 1).

        Raises:
            OptionError: If a polynomial has too many terms.
        """
        components = [self.simplifier.expand(component) for component in way]
        square = add(reduced_product(component, component) for component in components)
        root = square_root(square)
        if root is None:
            return way / sympy.sqrt(self.simplifier.simplify(_plain(square)))
        scale, polynomial = root
        sign = self._sign(_plain(polynomial))
        shares = [divided(component, polynomial) for component in components]
        return ImmutableMatrix([sign * _plain(share) / scale for share in shares])

    def _sign(self, value: Expr) -> Expr:
        """Return the sign of a length up to sign: a number where it may be taken for constant."""
        at_start = value.xreplace({symbol: self.start.get(symbol, S.Zero) for symbol in value.free_symbols})
        if not value.free_symbols:
            return sympy.sign(value)
        if self.everywhere or not at_start:
            sign = functions.sign(self.simplifier.simplify(value))
            self.simplifier.signs.add(sign)
            return sign
        sign = sympy.sign(at_start)
        self.conditions.append(self.simplifier.simplify(sign * value))
        return sign


def square_root(polynomial: Polynomial) -> tuple[Expr, Polynomial] | None:
    """Return a number and a polynomial whose product has the square `polynomial`; None where there is none.

    Example:
        square_root of 2 s^2 + 4 s + 2 is (sqrt(2), s + 1)
    """
    if not polynomial:
        return None
    common, rest = without_common_monomial(polynomial)
    found = factored(rest)
    if found is None:
        found = (next(iter(rest.values())), []) if len(rest) == 1 else (Fraction(1), [(rest, 1)])
    size, factors = found
    if size < 0 or any(power % 2 for _, power in (*common, *factors)):
        return None
    root: Polynomial = {monomial((factor, power // 2) for factor, power in common): Fraction(1)}
    for factor, power in factors:
        for _ in range(power // 2):
            root = multiply(root, factor)
    return _root_of_number(size), root


def _root_of_number(value: Fraction) -> Expr:
    """Return the square root of a positive fraction."""
    n, d = isqrt(value.numerator), isqrt(value.denominator)
    if n * n == value.numerator and d * d == value.denominator:
        return Rational(n, d)
    return sympy.sqrt(Rational(value.numerator, value.denominator))


def _plain(polynomial: Polynomial) -> Expr:
    """Return a polynomial as the sum of its terms, with exact coefficients."""
    return Add(
        *(
            Mul(Rational(value.numerator, value.denominator), *(Pow(f, Integer(p)) for f, p in term))
            for term, value in polynomial.items()
        )
    )
