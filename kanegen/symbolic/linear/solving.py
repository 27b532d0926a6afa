"""Linear equations whose numbers are rational functions of symbols, and short forms of their solutions.

The solution is the adjugate of [A] times the right side, over the determinant (Cramer's rule), so that all
entries have one denominator, as on paper. Where the numbers are short, equal factors are cancelled; where
they are long, such as the sine of 0.3, polynomials have no common factors that could be found.
"""

from __future__ import annotations

from collections.abc import Callable
from math import prod

import sympy
from sympy import Expr, ImmutableMatrix, S
from sympy.polys.matrices import DomainMatrix
from sympy.polys.matrices.exceptions import DMNonInvertibleMatrixError

from kanegen.errors import OptionError, SingularError
from kanegen.symbolic.linear.exact_numbers import DIGITS, DUST, short

Simplify = Callable[[Expr], Expr]
"""Function that returns an equal, shorter form of a polynomial of sines, cosines and symbols."""

LONG = 10**12
"""Size of numerator or denominator beyond which a number is not one that an author writes."""

MOST_PRODUCTS = 100_000
"""Largest number of products in a determinant that contains symbols."""


def solve(A: ImmutableMatrix, right: ImmutableMatrix) -> tuple[ImmutableMatrix, Expr]:
    """Return the solution of [A][X] = [right] as a matrix of numerators and their common denominator.

    Raises:
        SingularError: If [A] is singular for all values of the symbols.
        OptionError: If the determinant of [A] is too long.
    """
    if A.free_symbols:
        A = A.applyfunc(sympy.expand)
        _require_short(A)
    left, other = (DomainMatrix.from_Matrix(sympy.Matrix(one)) for one in (A, right))
    left, other = left.unify(other)
    try:
        if not left.domain.is_Composite:
            return ImmutableMatrix(left.to_field().lu_solve(other.to_field()).to_Matrix()), S.One
        numerators, denominator = left.solve_den(other, method="charpoly")
    except DMNonInvertibleMatrixError:
        raise SingularError(
            "linearize: [A] is singular in this state, so that accelerations do not exist."
        ) from None
    return ImmutableMatrix(numerators.to_Matrix()), left.domain.to_sympy(denominator)


def _require_short(A: ImmutableMatrix) -> None:
    """Make sure that the determinant of a matrix of polynomials is short enough.

    Raises:
        OptionError: If it has too many products.
    """
    products = prod(sum(len(sympy.Add.make_args(one)) for one in A.row(i) if one) for i in range(A.shape[0]))
    if products > MOST_PRODUCTS:
        raise OptionError(
            f"linearize: with {len(A.free_symbols)} symbols in [A] and {A.shape[0]} freedoms the entries are "
            "too long to be read. Give parameters their values, or take numbers from kg.linearize."
        )


def readable(numerator: Expr, denominator: Expr, simplify: Simplify) -> Expr:
    """Return a rational function in factors, without rounding errors and with short numbers."""
    if numerator.is_Rational and denominator.is_Rational:
        value = numerator / denominator
        return S.Zero if abs(value) < DUST else short(value)
    is_long = _has_long_numbers(numerator) or _has_long_numbers(denominator)
    if not is_long:
        numerator, denominator = sympy.fraction(sympy.cancel(numerator / denominator))
    elif not numerator.is_polynomial():
        numerator, denominator = sympy.fraction(sympy.together(numerator / denominator))
    above, below = _terms(numerator), _terms(denominator)
    if not above:
        return S.Zero
    if is_long:
        scale = max(map(abs, below.values()))
        return _with_floats(above, scale) / _with_floats(below, scale)
    numerator, denominator = (sympy.Add(*(n * one for one, n in terms.items())) for terms in (above, below))
    if not (numerator.has(sympy.sin, sympy.cos) or denominator.has(sympy.sin, sympy.cos)):
        return short(sympy.factor(numerator / denominator))
    numerator, denominator = simplify(numerator), simplify(denominator)
    scale, denominator = denominator.as_content_primitive()
    return short(sympy.factor_terms(numerator / scale) / sympy.factor_terms(denominator))


def _has_long_numbers(value: Expr) -> bool:
    """Return whether an expression has numbers that no author writes."""
    return any(abs(one.p) > LONG or one.q > LONG for one in value.atoms(sympy.Rational))


def _terms(value: Expr) -> dict[Expr, Expr]:
    """Return the number of each term of a polynomial, without those that are rounding errors of others."""
    numbers: dict[Expr, list[Expr]] = {}
    for term in sympy.Add.make_args(sympy.expand(value)):
        number, symbolic = term.as_independent(*value.free_symbols, as_Add=False)
        numbers.setdefault(symbolic, []).append(number)
    sums = {symbolic: sympy.Add(*parts) for symbolic, parts in numbers.items()}
    sizes = {symbolic: abs(number.evalf(DIGITS)) for symbolic, number in sums.items()}
    largest = max(sizes.values(), default=S.Zero)
    return {one: sums[one] for one, size in sizes.items() if size > DUST * largest}


def _with_floats(terms: dict[Expr, Expr], scale: Expr) -> Expr:
    """Return a polynomial over a number, with floats; a common factor of its terms stands before the sum."""
    found = {one: sympy.Float((n / scale).evalf(DIGITS), precision=53) for one, n in terms.items()}
    return sympy.factor_terms(sympy.Add(*(short(n) * one for one, n in found.items())))
