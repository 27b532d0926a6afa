"""Coefficients of polynomials: exact fractions, read from a model and printed as its author writes."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from fractions import Fraction
from functools import cache

from sympy import Expr, Float, Rational

READABLE_DIGITS = 12
"""Number of digits of a decimal number that replaces a coefficient within rounding of it."""

LARGEST_DENOMINATOR = 4
"""Denominator up to which a number is printed as a fraction, beyond as a decimal number if it is one."""

LARGEST_NUMERATOR = 9
"""Numerator up to which a number is printed as a fraction, beyond as a decimal number if it is one."""

LONGEST_FRACTION = 8
"""Number of digits of numerator and denominator together up to which a fraction that is no decimal number,
such as 1/12, is printed as a fraction."""

DIGITS_OF_A_MULTIPLE = 3
"""Number of digits up to which a multiple of another coefficient is easy to read."""


def fraction(number: Expr) -> Fraction:
    """Return a number as an exact fraction, a float as the shortest decimal number that reads back to it."""
    if isinstance(number, Float):
        return Fraction(repr(float(number)))
    return Fraction(int(number.p), int(number.q))


def readable(value: Fraction) -> Fraction:
    """Return the short decimal number within rounding of `value`, such as 0.5, or else `value` itself."""
    short = Fraction(f"{float(value):.{READABLE_DIGITS}g}")
    return short if abs(short - value) <= 4 * Fraction(math.ulp(float(value))) else value


def expression(value: Fraction) -> Expr:
    """Return a coefficient in SymPy: a short fraction, or the nearest binary floating-point number."""
    n, d = abs(value.numerator), value.denominator
    short = d <= LARGEST_DENOMINATOR and n <= LARGEST_NUMERATOR
    if d == 1 or short or (not _is_decimal(d) and len(f"{n}{d}") <= LONGEST_FRACTION):
        return Rational(value.numerator, d)
    return _float(value)


def _float(value: Fraction) -> Expr:
    """Return the nearest floating-point number."""
    return Float(float(value), precision=53)


def constant(value: Fraction) -> Expr:
    """Return a term of a sum that is a number: a whole number, or the nearest floating-point number."""
    return (
        expression(value) if value.denominator == 1 or not _is_decimal(value.denominator) else _float(value)
    )


def is_short(value: Fraction) -> bool:
    """Return whether a coefficient is a number that somebody may have written: it has few digits."""
    return digits(value) <= READABLE_DIGITS


@cache
def digits(value: Fraction) -> int:
    """Return the number of digits of a coefficient, without zeros at the end of whole numbers."""
    n, d = abs(value.numerator), value.denominator
    if not _is_decimal(d):
        return len(f"{n}{d}")
    while d % 10 == 0:
        d //= 10
    scaled = n * 10 ** max(_power(d, 2), _power(d, 5)) // d
    return len(str(scaled).rstrip("0"))


def content(values: Collection[Fraction], *, in_product: bool) -> Fraction:
    """Return the factor of coefficients that is best written in front of their sum; 1 where none is.

    It leaves fewer coefficients to multiply by, such as 2 for 2 and 2, or fewer digits, such as 9.81 for 9.81
    and 15.696, which leaves 1 and 1.6. It is negative where all coefficients are.

    Args:
        values: The coefficients.
        in_product: Whether the sum is multiplied anyway, so that as many digits will do: 2 (s + 1.6) for
            2 s + 3.2.
    """
    sizes = [abs(value) for value in values]
    scales = [
        scale for scale in dict.fromkeys(sizes) if all(_is_shorter(size / scale, size) for size in sizes)
    ]
    candidates = [*scales, Fraction(1)] if in_product else [Fraction(1), *scales]
    best = min(candidates, key=lambda scale: _weight(scale, sizes))
    return -best if all(value < 0 for value in values) else best


def _is_shorter(multiple: Fraction, size: Fraction) -> bool:
    """Return whether a multiple is easy to read and has no more digits than the coefficient itself."""
    return digits(multiple) <= min(digits(size), DIGITS_OF_A_MULTIPLE)


def _weight(scale: Fraction, sizes: Iterable[Fraction]) -> tuple[int, int]:
    """Return the number of coefficients to multiply by, and of their characters, with a factor in front."""
    others = [size / scale for size in sizes if size != scale]
    others += [scale] if scale != 1 else []
    return len(others), sum(map(_width, others))


def _width(value: Fraction) -> int:
    """Return the number of characters of a positive coefficient, such as 3 for 100 and for 0.02."""
    n, d = value.numerator, value.denominator
    if not _is_decimal(d):
        return len(f"{n}/{d}")
    places = max(_power(d, 2), _power(d, 5))
    return (len(str(n // d)) if n >= d else 0) + (places + 1 if places else 0)


def _is_decimal(denominator: int) -> bool:
    """Return whether a fraction is a decimal number: its denominator has no prime factor but 2 and 5."""
    return math.gcd(10 ** _power(denominator, 2) * 10 ** _power(denominator, 5), denominator) == denominator


def _power(number: int, prime: int) -> int:
    """Return the power of a prime number in a positive number."""
    power = 0
    while number % prime == 0:
        number //= prime
        power += 1
    return power
