"""Numbers that do not depend on the state: constant angles, and the arithmetic of folded constants.

Rational numbers of a model stay rational until they are lowered to instructions. Sines, square roots and
folded products are computed in 320 bits, and every constant is rounded once, when C is printed.
"""

from __future__ import annotations

import copyreg
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
from mpmath.libmp import to_rational

RIGHT_ANGLE_ULPS = 4
"""Units in the last place within which an angle counts as a multiple of pi/2, which no double equals."""

MOST_QUARTER_TURNS = 8
"""Multiples of pi/2 up to which angles are recognised; beyond two full turns an ulp is too coarse."""

MULTIPRECISION = mpmath.MPContext()
"""The context of mpmath in which constants are computed."""

MULTIPRECISION.prec = 320  # three times the bits of a double-double, so that cancellation leaves enough


def _restored(numerator: int, denominator: int) -> Any:
    """Return the constant that a pickled fraction stands for."""
    return MULTIPRECISION.mpf(numerator) / denominator


def _pickled(number: Any) -> tuple[Any, tuple[int, int]]:
    """Return how pickle restores a constant: from a fraction, as mpmath makes a class for every context."""
    fraction = as_fraction(number)
    return _restored, (fraction.numerator, fraction.denominator)


def as_fraction(number: Any) -> Fraction:
    """Return a number of mpmath as an exact fraction.

    Its integers are Python's, also where mpmath computes with those of gmpy2.
    """
    numerator, denominator = to_rational(number._mpf_)
    return Fraction(int(numerator), int(denominator))


copyreg.pickle(MULTIPRECISION.mpf, _pickled)


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
    """The constants of a program: numbers of 320 bits, which are rounded once, when C is printed.

    Attributes:
        are_rotations_exact: Whether a matrix of doubles stands for the rotation that is nearest to it; else
            it is taken as it is written, with its zeros and ones, which cost nothing.
    """

    are_rotations_exact: bool

    functions = MULTIPRECISION
    """Context with the functions of the numbers, such as `sin` and `sqrt`."""

    def quotient(self, numerator: int, denominator: int) -> Any:
        """Return a rational number as a constant of a program."""
        return MULTIPRECISION.mpf(numerator) / denominator


DOUBLE_CONSTANTS = Constants(are_rotations_exact=False)
"""For C in double and single precision."""

WIDE_CONSTANTS = Constants(are_rotations_exact=True)
"""For C in more than double precision."""
