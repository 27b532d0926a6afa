"""Arithmetic of the numbers that are known before any state: how exact they are until C rounds them.

What is rational in a model stays rational until it is lowered. Sines, square roots and rotations are not, and
a program folds its numbers. Where C computes in double or single precision, doubles do for that; where it
computes in more, so must these.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import sympy
from mpmath.libmp import to_rational
from sympy import Expr, Rational

from kanegen.errors import ModelError
from kanegen.program.angles import sine_cosine

Rows = Sequence[Sequence[Expr]]

_CONTEXT = mpmath.MPContext()
_CONTEXT.prec = 320
"""Bits: three times those of a pair of doubles, so that what cancels in a model leaves enough."""

_STEPS = 4
"""Newton steps to a rotation: each doubles the bits, of which a matrix of doubles has 50 or more."""


@dataclass(frozen=True)
class Constants:
    """One such arithmetic.

    Attributes:
        functions: Has `sin`, `cos` and `sqrt` of its numbers.
        is_wide: Whether it has more digits than doubles.
    """

    functions: Any
    is_wide: bool

    def number(self, numerator: int, denominator: int) -> Any:
        """A rational number as one of a program.

        Raises:
            ModelError: If it leaves the range of double precision.
        """
        try:
            if self.is_wide:
                return _CONTEXT.mpf(numerator) / denominator
            return numerator / denominator
        except OverflowError:
            raise ModelError(
                "a constant leaves the range of double precision; choose units nearer to 1."
            ) from None

    def sine_cosine(self, angle: float) -> tuple[Expr, Expr]:
        """Sine and cosine of a constant angle (rad), exact at right angles."""
        sine, cosine = sine_cosine(angle, self.functions)
        return rational(sine), rational(cosine)

    def rotation(self, matrix: Rows) -> Rows:
        """The rotation that a matrix of doubles stands for: itself, or the nearest one.

        [C] <- [C] (3 [1] - [C]^T [C]) / 2, the Newton iteration for the polar factor (Higham, Functions of
        Matrices, section 8.3), keeps exact zeros and planar turns.
        """
        if not self.is_wide or any(entry.free_symbols for row in matrix for entry in row):
            return matrix
        turned = sympy.Matrix(matrix)
        for _ in range(_STEPS):
            turned = (turned * (3 * sympy.eye(3) - turned.T * turned) / 2).applyfunc(_rounded)
        rows: Rows = turned.tolist()
        return rows


def rational(number: Any) -> Rational:
    """A float or a number of more digits as the fraction that it is."""
    return Rational(number) if isinstance(number, float) else Rational(*to_rational(number._mpf_))


def _rounded(entry: Rational) -> Rational:
    """To the digits of wide constants; what they can say stays exact."""
    return rational(_CONTEXT.mpf(entry.p) / entry.q)


DOUBLES = Constants(math, is_wide=False)
"""For C in double and single precision."""

WIDE = Constants(_CONTEXT, is_wide=True)
"""For C in more than double precision."""
