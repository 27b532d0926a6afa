"""Expansion of the expressions of the derivation into polynomials."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce

from sympy import Expr, Pow, Rational, S, cos, sin

from kanegen.symbolic.closed.coefficients import fraction
from kanegen.symbolic.closed.polynomials import Monomial, Polynomial, add, monomial, reduced_product
from kanegen.symbolic.literal.dynamics import BodyEquations

ANGLES = 3
"""Number of angles of a joint."""

LARGEST_POWER = 3
"""Exponent up to which powers of sums are multiplied out."""


@dataclass
class Expander:
    """Expands expressions that share many parts, each part once.

    Attributes:
        sums: Sum of the angles of the parallel hinges inward of a hinge, by the angle of this hinge. Sines
            and cosines of such angles are expanded in those of sums, which keeps the number of terms small.
        inside: Simplifies the operands of functions and roots, which are further factors of polynomials.
        signs: Factors that are 1 or -1, so that their squares are 1.
        values: Values of the symbols that stand for numbers of the model, without signs their sizes.
        signed: Whether terms have their signs. Without signs none cancel, and every coefficient is the sum of
            the sizes of the terms that are added up in the coefficient with signs.
    """

    sums: Mapping[Expr, Expr]
    inside: Callable[[Expr], Expr]
    signs: Set[Expr] = frozenset()
    values: Mapping[Expr, Fraction] = field(default_factory=dict)
    signed: bool = True
    _known: dict[Expr, Polynomial] = field(default_factory=dict)

    def polynomial(self, expr: Expr) -> Polynomial:
        """Return `expr` as a polynomial without squares of sines.

        Raises:
            OptionError: If the polynomial has more than `polynomials.MOST_TERMS` terms.
        """
        found = self._known.get(expr)
        if found is None:
            found = self._known[expr] = self._expand(expr)
        return found

    def _expand(self, expr: Expr) -> Polynomial:
        """Return a sum, product, power or factor as a polynomial."""
        if expr.is_Number or expr in self.values:
            value = self.values[expr] if expr in self.values else fraction(expr)
            return {(): value if self.signed else abs(value)} if value else {}
        if expr.is_Add:
            return add(self.polynomial(argument) for argument in expr.args)
        if expr.is_Mul:
            return self._product([self.polynomial(argument) for argument in expr.args])
        if expr.is_Pow and expr.exp.is_Rational:
            return self._power(expr.base, expr.exp)
        if expr.func in (sin, cos):
            return self._of_angle(expr.func, expr.args[0])
        simple = expr.func(*map(self.inside, expr.args)) if expr.args else expr
        return _factor(simple) if simple.func is expr.func else self.polynomial(simple)

    def _of_angle(self, function: type[Expr], angle: Expr) -> Polynomial:
        """Return the sine or cosine of an angle as a polynomial."""
        if angle in self.sums:
            return self._of_difference(function, self.sums[angle] + angle, self.sums[angle])
        simple = function(self.inside(angle) if angle.free_symbols & self.values.keys() else angle)
        return _factor(simple) if simple.func is function else self.polynomial(simple)

    def _power(self, base: Expr, exponent: Rational) -> Polynomial:
        """Return a power as a polynomial: multiplied out, or with the base or its root as a factor."""
        power = int(exponent.p)
        if exponent.q == 1:
            if 0 < power <= LARGEST_POWER or (power > 0 and not base.is_Add):
                return self._product([self.polynomial(base)] * power)
            terms = self.polynomial(base)
            if len(terms) == 1:
                ((term, value),) = terms.items()
                return {monomial((factor, p * power) for factor, p in term): value**power}
        root = Pow(self.inside(base), Rational(1, exponent.q))
        if root.is_Mul:  # SymPy takes numbers out of roots
            return self._product([self.polynomial(Pow(factor, power)) for factor in root.args])
        return {((root, power),): Fraction(1)} if root.free_symbols else _factor(Pow(root, power))

    def _product(self, factors: Iterable[Polynomial]) -> Polynomial:
        """Return the product of polynomials without squares of sines and of signs."""
        product = reduce(lambda a, b: reduced_product(a, b, signed=self.signed), factors)
        if not self.signs:
            return product
        return add({self._without_squares(term): value} for term, value in product.items())

    def _without_squares(self, term: Monomial) -> Monomial:
        """Return a monomial without even powers of signs."""
        return monomial((factor, power % 2 if factor in self.signs else power) for factor, power in term)

    def _of_difference(self, function: type[Expr], a: Expr, b: Expr) -> Polynomial:
        """Expand sin(a - b) or cos(a - b) by the addition theorems."""
        other, sign = (cos, -1) if function is sin else (sin, 1)
        return {
            monomial([(function(a), 1), (cos(b), 1)]): Fraction(1),
            monomial([(other(a), 1), (sin(b), 1)]): Fraction(sign if self.signed else 1),
        }


def _factor(expr: Expr) -> Polynomial:
    """Return the polynomial of one factor, or of a number."""
    return {(): fraction(expr)} if expr.is_Number else {((expr, 1),): Fraction(1)}


def parallel_sums(bodies: tuple[BodyEquations, ...]) -> dict[Expr, Expr]:
    """Return `Expander.sums` of a tree."""
    hinges = [_hinge(body) for body in bodies]
    totals: list[Expr] = []
    sums: dict[Expr, Expr] = {}
    for body, hinge in zip(bodies, hinges, strict=True):
        total = S.Zero
        if hinge is not None:
            axis, angle = hinge
            below = None if body.lower is None else hinges[body.lower.number - 1]
            if body.lower is not None and below is not None and below[0] == axis:
                sums[angle] = totals[body.lower.number - 1]
                total = sums[angle]
            total += angle
        totals.append(total)
    return sums


def _hinge(body: BodyEquations) -> tuple[int, Expr] | None:
    """Return axis and angle of a body whose axis is the same basis vector of the body and its lower body."""
    turning = [index for index in range(ANGLES) if body.body.joint.moving[index]]
    if len(turning) != 1:
        return None
    rotation, axis = body.relative_rotation, body.body.joint.axes[turning[0]]
    unit = [int(i == axis) for i in range(ANGLES)]
    shared = list(rotation[axis, :]) == unit and list(rotation[:, axis]) == unit
    return (axis, body.coordinate(turning[0])) if shared else None
