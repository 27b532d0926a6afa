"""The size of a solution {ydot} and of its first correction, by freedom.

Angles and translations are compared through a length, whose square is the mean pivot of the angles over the
mean pivot of the translations, so that the measure does not depend on the units of the model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from sympy import Expr, Rational, S

from kanegen.recursion.tree import Tree

SHARE = Rational(1, 128)
"""Share of the size of the whole solution with which a correction is compared where its entry of {ydot} is
smaller. Entries have to be compared one by one: errors of small entries enter large ones at the next step."""


@dataclass(frozen=True, eq=False)
class CorrectionSize:
    """Squares of a solution and of its correction, in one unit.

    Attributes:
        tree: The tree.
        pivots: Divisors of a solver by freedom.
        solution: Free components of the solution by freedom.
        correction: Free components of its first correction by freedom.
    """

    tree: Tree
    pivots: Sequence[Expr]
    solution: Sequence[Expr]
    correction: Sequence[Expr]

    @cached_property
    def whole(self) -> Expr:
        """Square of the size of the solution."""
        return self._define("yy", sum(self._parts, S.Zero))

    @cached_property
    def errors(self) -> list[Expr]:
        """Squares of the correction by freedom."""
        return self._squares(self.correction, "dd")

    def margins(self, limit: float, floor: Sequence[float]) -> list[Expr]:
        """Return margins by freedom, positive where the correction is within its limit; NaN on overflow.

        Args:
            limit: Largest ratio of correction and solution.
            floor: Acceleration by freedom that is added to the size of the solution; empty for zeros.
        """
        define, square = self._define, Rational(limit) ** 2
        pairs = zip(self._weights, floor or (0.0,) * len(self.solution), strict=True)
        least = sum((weight * Rational(a) ** 2 for weight, a in pairs), S.Zero)
        size = define("yy_all", self.whole + define("yy_least", least))
        one = define("yy_one", size * define("yy_i", 1 / size))
        share = define("dm", square * SHARE**2 * size * one)
        pairs = zip(self._parts, self.errors, strict=True)
        return [
            define(f"dm_{i}", define(f"dr_{i}", share - error) + square * own)
            for i, (own, error) in enumerate(pairs)
        ]

    @cached_property
    def _parts(self) -> list[Expr]:
        """Squares of the solution by freedom."""
        return self._squares(self.solution, "yy")

    def _squares(self, values: Sequence[Expr], name: str) -> list[Expr]:
        """Return weighted squares of values by freedom."""
        self.tree.definitions.about("size of the solution and of its first correction")
        squares = [self._define(f"{name}_{i}", value * value) for i, value in enumerate(values)]
        pairs = zip(self._weights, squares, strict=True)
        return [self._define(f"{name}w_{i}", weight * square) for i, (weight, square) in enumerate(pairs)]

    @cached_property
    def _weights(self) -> list[Expr]:
        """Factors by freedom that give squares of accelerations one unit."""
        angles = [freedom.is_angle for freedom in self.tree.system.freedoms]
        rotational, translational = (
            [pivot for pivot, is_angle in zip(self.pivots, angles, strict=True) if is_angle == wanted]
            for wanted in (True, False)
        )
        if not rotational or not translational:
            return [S.One for _ in angles]
        share = Rational(len(rotational), len(translational))
        whole = self._define("pm", share * self._define("ps", sum(translational, S.Zero)))
        square = self._define("ll", self._define("pa", sum(rotational, S.Zero)) / whole)
        return [square if is_angle else S.One for is_angle in angles]

    def _define(self, name: str, value: Expr) -> Expr:
        """Return a symbol for a value."""
        return self.tree.definitions.define(name, value)
