"""Values and derivatives of definitions in one state, in forward mode (Griewank and Walther 2008, chapter 3).

A definition is a short expression in earlier symbols. Its derivatives are those of the short expression times
the derivatives of these symbols. Since every value is taken in the state at once, most of them are numbers,
and no expression grows as it would if the equations were written out and differentiated.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import sympy
from sympy import Add, Expr, ImmutableMatrix, S, Symbol

from kanegen.errors import OptionError
from kanegen.symbolic.definitions import Definition
from kanegen.symbolic.linear.exact_numbers import exact

Slopes = dict[int, Expr]
"""Derivatives by place of the variable; what is zero is absent."""


class Tangents:
    """The values of symbols in a state, and their derivatives by variables.

    Args:
        at: Value of each variable and of each symbol that stands for a number.
        by: The variables by which is differentiated.
        definitions: Definitions in order of evaluation.
    """

    def __init__(
        self, at: Mapping[Symbol, Expr], by: Sequence[Symbol], definitions: Iterable[Definition]
    ) -> None:
        self._values: dict[Expr, Expr] = dict(at)
        self._slopes: dict[Expr, Slopes] = {symbol: {place: S.One} for place, symbol in enumerate(by)}
        self._count = len(by)
        for definition in definitions:
            value, slopes = self.of(definition.value)
            self._values[definition.symbol], self._slopes[definition.symbol] = value, slopes

    def of(self, value: Expr) -> tuple[Expr, Slopes]:
        """Return the value of an expression in the state, and its derivatives.

        Raises:
            OptionError: If the expression or a derivative of it is undefined in the state.
        """
        terms: dict[int, list[Expr]] = {}
        for symbol in sorted(value.free_symbols & self._slopes.keys(), key=str):
            if not self._slopes[symbol]:
                continue
            slope = self._slope_at(value.diff(symbol))
            if slope != 0:
                for place, inner in self._slopes[symbol].items():
                    terms.setdefault(place, []).append(slope * inner)
        slopes = {place: Add(*products) for place, products in terms.items()}
        return self._at(value), {place: one for place, one in slopes.items() if one != 0}

    def of_matrix(self, matrix: ImmutableMatrix) -> tuple[ImmutableMatrix, list[ImmutableMatrix]]:
        """Return the value of a matrix in the state, and its derivative by each variable."""
        found = [self.of(entry) for entry in matrix.flat()]
        values = ImmutableMatrix(*matrix.shape, [value for value, _ in found])
        return values, [
            ImmutableMatrix(*matrix.shape, [slopes.get(place, S.Zero) for _, slopes in found])
            for place in range(self._count)
        ]

    def _slope_at(self, slope: Expr) -> Expr:
        """Return a derivative in the state; where the state has symbols, it counts as beside kinks.

        Raises:
            OptionError: If it is undefined there, or infinite because the expression jumps.
        """
        found = self._at(slope)
        jumps = found.atoms(sympy.DiracDelta)
        if any(jump.is_number for jump in jumps):
            raise OptionError(
                "linearize: a force jumps in this state, such as the slope of abs(u) in a potential at 0: "
                "it has no derivative. Take a state beside the jump."
            )
        return found.xreplace(dict.fromkeys(jumps, S.Zero))

    def _at(self, value: Expr) -> Expr:
        """Return an expression in the state.

        Raises:
            OptionError: If it is undefined there.
        """
        found = exact(value.xreplace(self._values))
        if found.has(sympy.zoo, sympy.nan, sympy.oo, S.NegativeInfinity):
            raise OptionError(
                "linearize: a quantity or its derivative is undefined in this state, such as the direction "
                "of a spring without length, or a joint in gimbal lock. Take another state."
            )
        return found
