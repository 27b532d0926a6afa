"""The closed form of [A] and {f}: no intermediates, short enough to be read.

Every entry becomes a polynomial in which equal parts are identical. Its terms are grouped by their
parameters, speeds and loads; the trigonometric polynomial that multiplies each group is brought into its
shortest form; then common factors are collected.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from fractions import Fraction

from sympy import Expr, Float, ImmutableMatrix

from kanegen.errors import OptionError
from kanegen.symbolic.closed.angle_sums import shortest
from kanegen.symbolic.closed.collecting import collected
from kanegen.symbolic.closed.expanding import Expander, parallel_sums
from kanegen.symbolic.closed.named_numbers import NamedNumbers
from kanegen.symbolic.closed.polynomials import (
    Monomial,
    Polynomial,
    add,
    monomial,
    readable,
    without_cancelled,
)
from kanegen.symbolic.literal.dynamics import BodyEquations


@dataclass(frozen=True)
class ClosedForm:
    """[A]{ydot} = {f} in coordinates, speeds, loads and parameters alone, without intermediates.

    Attributes:
        A: (n, n) generalized mass matrix, Eq. (43).
        f: (n, 1) right side, Eq. (44).
    """

    A: ImmutableMatrix
    f: ImmutableMatrix


def close(
    A: ImmutableMatrix,
    f: ImmutableMatrix,
    bodies: tuple[BodyEquations, ...],
    motion: Collection[Expr],
    numbers: NamedNumbers,
) -> ClosedForm:
    """Return the closed form of [A] and {f}.

    Args:
        A: (n, n) [A] without intermediates.
        f: (n, 1) {f} without intermediates.
        bodies: The equations of all bodies.
        motion: Speeds, loads and prescribed motion, by whose products the terms of an entry may be grouped.
        numbers: The symbols in [A] and {f} that stand for numbers of the model.

    Raises:
        OptionError: If an entry grows too long to be read.
    """
    simplifier = Simplifier(parallel_sums(bodies), frozenset(motion), has_rounded_rotations(bodies), numbers)
    for entry in (*f, *A):  # an entry that is too long is found before any is simplified
        simplifier.expand(entry)
    n = A.shape[0]
    upper = {(i, j): simplifier.simplify(A[i, j]) for i in range(n) for j in range(i, n)}
    entries = [upper[min(i, j), max(i, j)] for i in range(n) for j in range(n)]
    return ClosedForm(
        ImmutableMatrix(n, n, entries), ImmutableMatrix([simplifier.simplify(entry) for entry in f])
    )


def has_rounded_rotations(bodies: tuple[BodyEquations, ...]) -> bool:
    """Return whether a constant orientation holds floats like 0.7071..., by which 1 may become 1 - 2e-16."""
    return any(entry.has(Float) for body in bodies for entry in body.relative_rotation)


class Simplifier:
    """Simplifies expressions that share many parts.

    Args:
        sums: Sum of the angles of parallel hinges inward of a hinge, by its angle; see `Expander.sums`.
        motion: Speeds, loads and prescribed motion.
        rounded: Whether coefficients that only rounding keeps from zero are dropped, and those within
            rounding of a short decimal number are replaced by it.
        numbers: Symbols that stand for numbers of the model.
    """

    def __init__(
        self,
        sums: Mapping[Expr, Expr],
        motion: Collection[Expr],
        rounded: bool,
        numbers: NamedNumbers,
    ) -> None:
        self._expander = Expander(sums, numbers.values)
        self._sizes = Expander(sums, numbers.sizes, signed=False)
        self._motion = motion
        self._rounded = rounded
        self._shortest: dict[tuple[tuple[Monomial, Fraction], ...], Polynomial] = {}

    def expand(self, expr: Expr) -> Polynomial:
        """Return `expr` as a polynomial.

        Raises:
            OptionError: If it has too many terms.
        """
        polynomial = self._expander.polynomial(expr)
        return without_cancelled(polynomial, self._sizes_of(expr)) if self._rounded else polynomial

    def _sizes_of(self, expr: Expr) -> Polynomial:
        """Return the sizes of the terms that `expr` adds up, by monomial; none where there are too many."""
        try:
            return self._sizes.polynomial(expr)
        except OptionError:
            return {}

    def simplify(self, expr: Expr) -> Expr:
        """Return an equal expression that is short enough to read.

        Raises:
            OptionError: If it has too many terms.
        """
        groups: dict[Monomial, dict[Monomial, Fraction]] = {}
        for term, coefficient in self.expand(expr).items():
            part = tuple((factor, power) for factor, power in term if not factor.is_Symbol)
            symbols = tuple((factor, power) for factor, power in term if factor.is_Symbol)
            groups.setdefault(symbols, {})[part] = readable(coefficient) if self._rounded else coefficient
        return collected(add(self._times(symbols, group) for symbols, group in groups.items()), self._motion)

    def _times(self, symbols: Monomial, group: Polynomial) -> Polynomial:
        """Return the product of a monomial of symbols and the shortest form of a trigonometric polynomial."""
        short = self._shortest_of(group)
        return {monomial([*symbols, *term]): coefficient for term, coefficient in short.items()}

    def _shortest_of(self, polynomial: Polynomial) -> Polynomial:
        """Return the shortest form of a trigonometric polynomial; multiples of one polynomial share it."""
        scale = next(iter(polynomial.values()))
        key = tuple((term, coefficient / scale) for term, coefficient in polynomial.items())
        if key not in self._shortest:
            self._shortest[key] = shortest(dict(key))
        return {term: coefficient * scale for term, coefficient in self._shortest[key].items()}
