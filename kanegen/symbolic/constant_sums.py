"""Sums that depend on parameters alone, without the terms that cancel in them.

A model with numbers folds its constants exactly; a model with parameters computes them in floating point
where the parameters are set. In I_xx - I_yy = (J_xx + m y^2 + m z^2) - (J_yy + m x^2 + m z^2) the term m z^2
may be larger than the difference by any factor, and the rounding error of the difference would be that of
m z^2. Sums are therefore expanded into the terms of the sums that they name, with exact coefficients, and
written in these terms where some of them cancel.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from sympy import Add, Expr, S, Symbol

CANCELLATION = 8
"""Ratio between the coefficients of a term and their sum from which a sum is written in other terms."""

Terms = dict[Expr, Expr]
"""Rational coefficients by term; terms are 1, symbols and products of symbols."""


class ConstantSums:
    """The definitions that depend on parameters alone, as linear combinations of terms.

    Args:
        parameters: Symbols of the parameters.
    """

    def __init__(self, parameters: Iterable[Symbol]) -> None:
        self._terms: dict[Expr, Terms] = {symbol: {symbol: S.One} for symbol in parameters}

    def is_constant(self, value: Expr) -> bool:
        """Return whether an expression depends on at least one parameter, and on nothing else."""
        symbols = value.free_symbols if self._terms else ()
        return bool(symbols) and all(symbol in self._terms for symbol in symbols)

    def without_cancellation(self, value: Expr) -> Expr:
        """Return a constant expression, written in terms that do not cancel if it is a sum that does.

        Example:
            Where a = c + p and b = c + q are recorded, a - b becomes p - q.
        """
        if not value.is_Add:
            return value
        terms, sizes = self._expanded(value)
        if all(CANCELLATION * abs(factor) > sizes[term] for term, factor in terms.items()):
            return value
        return Add(*(factor * term for term, factor in terms.items()))

    def record(self, symbol: Symbol, value: Expr) -> None:
        """Record that `symbol` stands for a constant expression."""
        terms, _ = self._expanded(value)
        is_product = len(terms) == 1 and S.One in terms.values() and S.One not in terms
        self._terms[symbol] = {symbol: S.One} if is_product else terms

    def _expanded(self, value: Expr) -> tuple[Terms, Terms]:
        """Return the coefficients of an expression by term, and the sums of their absolute values."""
        total: Counter[Expr] = Counter()
        sizes: Counter[Expr] = Counter()
        for one in Add.make_args(value):
            coefficient, rest = one.as_coeff_Mul()
            for term, factor in self._terms.get(rest, {rest: S.One}).items():
                total[term] += coefficient * factor
                sizes[term] += abs(coefficient * factor)
        return dict(total), dict(sizes)
