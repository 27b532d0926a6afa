"""Numbers that do not depend on the state: constant angles, and the arithmetic of folded constants.

Rational numbers of a model stay rational until they are lowered to instructions; sines, square roots and
folded products are rounded. Where C computes in double or single precision, doubles are accurate enough for
these; where C computes in more digits, they are computed in 320 bits and rounded once, when C is printed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
from mpmath.libmp import to_rational

from kanegen.errors import ModelError

RIGHT_ANGLE_ULPS = 4
"""Units in the last place within which an angle counts as a multiple of pi/2, which no double equals."""

MOST_QUARTER_TURNS = 8
"""Multiples of pi/2 up to which angles are recognised; beyond two full turns an ulp is too coarse."""

MULTIPRECISION = mpmath.MPContext()
"""The context of mpmath in which constants of more than double precision are computed."""

MULTIPRECISION.prec = 320  # three times the bits of a double-double, so that cancellation leaves enough


def as_fraction(number: Any) -> Fraction:
    """Return a number of mpmath as an exact fraction.

    Its integers are Python's, also where mpmath computes with those of gmpy2.
    """
    numerator, denominator = to_rational(number._mpf_)
    return Fraction(int(numerator), int(denominator))


def quarter_turns(angle: float) -> int:
    """Return n where `angle` (rad) means n pi/2, or 0 where it means no right angle."""
    turns = round(angle / (math.pi / 2))
    near = abs(angle - turns * (math.pi / 2)) <= RIGHT_ANGLE_ULPS * math.ulp(angle)
    return turns if abs(turns) <= MOST_QUARTER_TURNS and near else 0


def sine_cosine(angle: float, functions: Any = math) -> tuple[Any, Any]:
    """Return (sin, cos) of `angle` (rad), exactly 0 and +-1 where the angle means a multiple of pi/2.

    Args:
        angle: Constant angle (rad).
        functions: Module or context with the functions `sin` and `cos` for all other angles.
    """
    turns = quarter_turns(angle)
    if turns:
        return ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[turns % 4]
    return functions.sin(angle), functions.cos(angle)


@dataclass(frozen=True)
class Constants:
    """The arithmetic in which the constants of a program are computed.

    Attributes:
        functions: Module or context with `sin`, `cos` and `sqrt` of its numbers.
        is_wide: Whether its numbers have more digits than doubles.
    """

    functions: Any
    is_wide: bool

    def quotient(self, numerator: int, denominator: int) -> Any:
        """Return a rational number as a constant of a program.

        Raises:
            ModelError: If the number leaves the range of double precision.
        """
        try:
            if self.is_wide:
                return MULTIPRECISION.mpf(numerator) / denominator
            return numerator / denominator
        except OverflowError:
            raise ModelError(
                "a constant leaves the range of double precision; choose units nearer to 1."
            ) from None


DOUBLE_CONSTANTS = Constants(math, is_wide=False)
"""Doubles, for C in double and single precision."""

WIDE_CONSTANTS = Constants(MULTIPRECISION, is_wide=True)
"""Numbers of 320 bits, for C in more than double precision."""
