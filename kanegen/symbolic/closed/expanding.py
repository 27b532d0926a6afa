"""Expansion of the expressions of the derivation into polynomials."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce

from sympy import Expr, S, cos, sin

from kanegen.symbolic.closed.polynomials import Polynomial, add, fraction, monomial, reduced_product
from kanegen.symbolic.literal.dynamics import BodyEquations

ANGLES = 3
"""Number of angles of a joint."""


@dataclass
class Expander:
    """Expands expressions that share many parts, each part once.

    Attributes:
        sums: Sum of the angles of the parallel hinges inward of a hinge, by the angle of this hinge. Sines
            and cosines of such angles are expanded in those of sums, which keeps the number of terms small.
        values: Values of the symbols that stand for numbers of the model, without signs their sizes.
        signed: Whether terms have their signs. Without signs none cancel, and every coefficient is the sum of
            the sizes of the terms that are added up in the coefficient with signs.
    """

    sums: Mapping[Expr, Expr]
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
        if expr.is_Pow and expr.exp.is_Integer and expr.exp > 0:
            return self._product([self.polynomial(expr.base)] * int(expr.exp))
        if expr.func in (sin, cos) and expr.args[0] in self.sums:
            return self._of_difference(
                expr.func, self.sums[expr.args[0]] + expr.args[0], self.sums[expr.args[0]]
            )
        return {((expr, 1),): Fraction(1)}

    def _product(self, factors: Iterable[Polynomial]) -> Polynomial:
        """Return the product of polynomials without squares of sines."""
        return reduce(lambda a, b: reduced_product(a, b, signed=self.signed), factors)

    def _of_difference(self, function: type[Expr], a: Expr, b: Expr) -> Polynomial:
        """Expand sin(a - b) or cos(a - b) by the addition theorems."""
        other, sign = (cos, -1) if function is sin else (sin, 1)
        return {
            monomial([(function(a), 1), (cos(b), 1)]): Fraction(1),
            monomial([(other(a), 1), (sin(b), 1)]): Fraction(sign if self.signed else 1),
        }


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
