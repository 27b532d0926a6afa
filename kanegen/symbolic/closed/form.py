"""The closed form of [A] and {f}: no intermediates, short enough to be read.

Every entry becomes a polynomial in which equal parts are identical. Its terms are grouped by their
parameters, speeds and loads; the trigonometric polynomial that multiplies each group is brought into its
shortest form; then common factors are collected.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from sympy import Add, Expr, Float, ImmutableMatrix, Symbol

from kanegen.errors import OptionError
from kanegen.symbolic import notebook
from kanegen.symbolic.closed.angle_sums import shortest, with_double_angles
from kanegen.symbolic.closed.coefficients import readable
from kanegen.symbolic.closed.collecting import Collector, operations
from kanegen.symbolic.closed.expanding import Expander, parallel_sums
from kanegen.symbolic.closed.named_numbers import NamedNumbers
from kanegen.symbolic.closed.polynomials import (
    Monomial,
    Polynomial,
    add,
    is_trigonometric,
    monomial,
    without_cancelled,
)
from kanegen.symbolic.literal.dynamics import BodyEquations

MOST_OPERATIONS = 100
"""Number of operations of force elements that may stand in an entry as they are."""


@dataclass(frozen=True)
class ClosedForm:
    """[A]{ydot} = {f} in coordinates, speeds, loads and parameters alone, without intermediates.

    Attributes:
        A: (n, n) generalized mass matrix, Eq. (43).
        f: (n, 1) right side, Eq. (44).
        conditions: Expressions that are positive where the form holds: each belongs to a spring whose ends
            stay on a line, and whose direction is the one at {x} = {0}. Empty if the form holds everywhere.
        names: LaTeX of its symbols, with which a notebook shows it.
    """

    A: ImmutableMatrix
    f: ImmutableMatrix
    conditions: tuple[Expr, ...] = ()
    names: Mapping[Symbol, str] = field(default_factory=dict, repr=False, compare=False)

    def _repr_latex_(self) -> str:
        """[A] and {f} for a notebook; what does not fit is cut, with a hint."""
        return notebook.display(self.lines("form"))

    def lines(self, owner: str) -> Iterator[str]:
        """Yield the lines of LaTeX that a notebook shows; `owner` is Python for what has `A` and `f`.

        Example:
            for line in equations.closed_form().lines("form"):
                print(line)
        """
        yield from notebook.matrix("[A]", "A", self.A, self.names, f"{owner}.A", symmetric=True)
        yield from notebook.matrix("{f}", "f", self.f, self.names, f"{owner}.f")
        yield from notebook.conditions(self.conditions, self.names)


def close(
    simplifier: Simplifier,
    A: ImmutableMatrix,
    f: ImmutableMatrix,
    element_forces: ImmutableMatrix,
    fallback: Callable[[], ImmutableMatrix],
) -> tuple[ImmutableMatrix, ImmutableMatrix]:
    """Return the closed forms of [A] and {f}.

    Args:
        simplifier: Simplifies the entries.
        A: (n, n) [A] without intermediates.
        f: (n, 1) {f} without intermediates and without force elements.
        element_forces: (n, 1) what force elements add to {f}.
        fallback: Returns the same, for entries in which it grows too long when it is multiplied out.

    Raises:
        OptionError: If an entry grows too long to be read.
    """
    for entry in (*f, *A):  # an entry that is too long is found before any is simplified
        simplifier.expand(entry)
    n = A.shape[0]
    upper = {(i, j): simplifier.simplify(A[i, j]) for i in range(n) for j in range(i, n)}
    entries = [upper[min(i, j), max(i, j)] for i in range(n) for j in range(n)]
    right = [_sum(simplifier, *entry, fallback) for entry in zip(range(n), f, element_forces, strict=True)]
    return ImmutableMatrix(n, n, entries), ImmutableMatrix(right)


def _sum(
    simplifier: Simplifier, i: int, own: Expr, added: Expr, fallback: Callable[[], ImmutableMatrix]
) -> Expr:
    """Return the closed form of entry `i` of {f}; arguments as in `close`."""
    short = simplifier.simplify(own)
    if not added:
        return short
    try:
        candidates = short + simplifier.simplify(added), simplifier.simplify(Add(own, added, evaluate=False))
    except OptionError:
        long = fallback()[i]
        if operations(long) > MOST_OPERATIONS:
            raise
        return short + long
    return min(candidates, key=operations)


def has_rounded_rotations(bodies: tuple[BodyEquations, ...]) -> bool:
    """Return whether a constant orientation holds floats like 0.7071..., by which 1 may become 1 - 2e-16."""
    return any(entry.has(Float) for body in bodies for entry in body.relative_rotation)


class Simplifier:
    """Simplifies expressions that share many parts.

    Args:
        bodies: The equations of all bodies.
        motion: Speeds, loads and prescribed motion, by whose products the terms of an entry may be grouped.
        numbers: Symbols that stand for numbers of the model.

    Attributes:
        signs: Factors that are 1 or -1.
    """

    def __init__(
        self, bodies: tuple[BodyEquations, ...], motion: Collection[Expr], numbers: NamedNumbers
    ) -> None:
        sums = parallel_sums(bodies)
        self.signs: set[Expr] = set()
        self._expander = Expander(sums, self.simplify, self.signs, numbers.values)
        self._sizes = Expander(sums, self.simplify, self.signs, numbers.sizes, signed=False)
        self._collector = Collector(frozenset(motion))
        self._rounded = has_rounded_rotations(bodies)
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
            part = tuple((factor, power) for factor, power in term if is_trigonometric(factor))
            others = tuple((factor, power) for factor, power in term if not is_trigonometric(factor))
            groups.setdefault(others, {})[part] = readable(coefficient) if self._rounded else coefficient
        short = add(self._times(others, group) for others, group in groups.items())
        forms = [short, *with_double_angles(short)]
        return min((self._collector.collected(form) for form in forms), key=operations)

    def _times(self, others: Monomial, group: Polynomial) -> Polynomial:
        """Return the product of a monomial and the shortest form of a trigonometric polynomial."""
        short = self._shortest_of(group)
        return {monomial([*others, *term]): coefficient for term, coefficient in short.items()}

    def _shortest_of(self, polynomial: Polynomial) -> Polynomial:
        """Return the shortest form of a trigonometric polynomial; multiples of one polynomial share it."""
        scale = next(iter(polynomial.values()))
        key = tuple((term, coefficient / scale) for term, coefficient in polynomial.items())
        if key not in self._shortest:
            self._shortest[key] = shortest(dict(key))
        return {term: coefficient * scale for term, coefficient in self._shortest[key].items()}
