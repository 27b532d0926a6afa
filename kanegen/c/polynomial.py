"""Polynomials in C, as the headers of kanegen's own functions write them."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.c.layout import BREAK, wrap
from kanegen.program.precision import Precision

SHORT = 3
"""Number of terms of a polynomial up to which Horner's scheme, which loses less, is as fast as any."""


def polynomial(target: str, coefficients: Sequence[float], precision: Precision) -> list[str]:
    """Return a statement that evaluates a polynomial in z, with many terms in z and zz = z z.

    Args:
        target: What the value is assigned to.
        coefficients: Coefficients, lowest first.
        precision: Precision of the literals.
    """
    size = 2 if len(coefficients) > SHORT else 1
    text = ""
    for k in reversed(range(0, len(coefficients), size)):
        terms = _sum(coefficients[k : k + size], precision)
        text = f"{terms}{_product('z' * size, text)}" if text else terms
    return wrap(f"{target} = {text};")


def _sum(terms: Sequence[float], precision: Precision) -> str:
    """Return a constant and its multiples of powers of z as a sum."""
    literals = [f"{'-' if term < 0 else ''}{precision.literal(abs(term))}" for term in terms]
    return " + ".join([literals[0], *(f"{text}*z" for text in literals[1:])]).replace("+ -", "- ")


def _product(power: str, factor: str) -> str:
    """Return `power*factor` as a further summand."""
    if BREAK in factor or " " in factor:
        return f"{BREAK}+ {power}*({factor})"
    return f" {'-' if factor.startswith('-') else '+'} {power}*{factor.removeprefix('-')}"
