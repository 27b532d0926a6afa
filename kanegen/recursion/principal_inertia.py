"""Bounds of the principal inertias of a body: proven, next to the values, and the same on every machine.

The principal inertias are the roots of the characteristic polynomial of the inertia matrix. Newton's method
approaches the largest root of a polynomial with real roots from above, and the smallest from below, without
ever passing it. Its steps are exact; their results are rounded outward.
"""

from __future__ import annotations

import math
from fractions import Fraction

from sympy import Expr, Matrix, Rational, S

from kanegen.model.body import Body
from kanegen.recursion.constants import exact

NEWTON_STEPS = 8


def largest_inertia(body: Body) -> Expr:
    """Return an upper bound of the largest principal inertia (kg m^2).

    It is the largest entry where the inertia is diagonal, and the trace where it depends on parameters.
    """
    inertia = _matrix(body)
    trace = inertia.trace()
    if trace == 0 or inertia.free_symbols:
        return trace
    return max(inertia.diagonal()) if inertia.is_diagonal() else _outer_root(inertia, trace, math.inf)


def least_inertia(body: Body) -> Expr:
    """Return a lower bound of the smallest principal inertia (kg m^2), zero where parameters may change it.

    It is the smallest entry where the inertia is diagonal.
    """
    inertia = _matrix(body)
    if inertia.trace() == 0 or inertia.free_symbols:
        return S.Zero
    return min(inertia.diagonal()) if inertia.is_diagonal() else _outer_root(inertia, S.Zero, -math.inf)


def _matrix(body: Body) -> Matrix:
    """Return the inertia of a body about its mass centre as a matrix of exact numbers."""
    return Matrix(3, 3, lambda i, j: exact(body.inertia[i][j]))


def _outer_root(inertia: Matrix, start: Expr, outward: float) -> Expr:
    """Return a bound of the largest or the smallest eigenvalue of a symmetric matrix.

    Args:
        inertia: The matrix, of fractions.
        start: A bound of the eigenvalue.
        outward: The infinity on the side of the bound.
    """
    pairs = [(0, 1), (0, 2), (1, 2)]
    minors = sum((inertia[i, i] * inertia[j, j] - inertia[i, j] ** 2 for i, j in pairs), S.Zero)
    trace, second, last = (Fraction(c.p, c.q) for c in (inertia.trace(), minors, inertia.det()))
    root = Fraction(start.p, start.q)
    for _ in range(NEWTON_STEPS):
        slope = (3 * root - 2 * trace) * root + second
        if slope <= 0:
            break  # a multiple root has been reached
        value = ((root - trace) * root + second) * root - last
        if value == 0:
            break
        rounded = Fraction(math.nextafter(float(root - value / slope), outward))
        root = min(root, rounded) if outward > 0 else max(root, rounded)
    return Rational(root.numerator, root.denominator)
