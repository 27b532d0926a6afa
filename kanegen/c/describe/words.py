"""What is said of costs, arithmetic and force elements."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping

from kanegen.c.formats import Formats, uniform
from kanegen.c.interface import PREPARE, ModelFacts
from kanegen.c.layout import WIDTH
from kanegen.c.sincos import Sincos
from kanegen.program.precision import DOUBLE, DOUBLE_DOUBLE, FLOAT, LONG_DOUBLE, Precision

OPERATIONS = {
    "add": "additions and subtractions",
    "multiply": "multiplications",
    "divide": "divisions",
    "sqrt": "square roots",
    "sincos": "sines and cosines",
    "prepare": "operations of the parameter-only step",
}
"""What the counts of `Source.operations` count."""

_NAMES = (
    "The functions have the names of those in double precision, so a program can use only one of the two."
)

_ARITHMETICS = {
    DOUBLE: "All is computed in double precision.",
    FLOAT: "All is computed in single precision.",
    LONG_DOUBLE: "All is computed in long double, which has 64 bits or more; platforms where it is no wider "
    "than double are refused.",
    DOUBLE_DOUBLE: "All is computed in pairs of doubles, about 32 digits (kanegen_pairs.h); what is stored "
    "as double is rounded once. Angles beyond 1e6 rad give NaN, and so does what overflows.",
}


def operations(counts: Mapping[str, int]) -> list[tuple[str, int]]:
    """Operation counts in words."""
    return [(OPERATIONS[kind], number) for kind, number in counts.items() if number or kind != PREPARE]


def force_elements(model: ModelFacts) -> list[str]:
    """Lines of a comment that say what they are."""
    width = WIDTH - len(" *     ")
    lines = [textwrap.wrap(words, width, subsequent_indent="    ") for words in model.force_elements]
    return [line for wrapped in lines for line in wrapped]


def arithmetic(formats: Formats, has_parameters: bool) -> str:
    """What a user has to know of the precisions; nothing where all is double."""
    if formats == uniform(FLOAT):
        prepared = ", by _prepare too" if has_parameters else ""
        return (
            "Single precision: all numbers are of type float. Constants are computed in double and rounded "
            f"once{prepared}; below 1.2e-38 they lose digits or become 0. {_NAMES}"
        )
    if formats == uniform(DOUBLE):
        return ""
    kinds = f"States, loads and results are of type {formats.storage.c_type}"
    kinds += f", parameters of type {formats.parameters.c_type}." if has_parameters else "."
    return f"{_ARITHMETICS[formats.arithmetic]} {kinds} {_NAMES}"


def sines(sincos: Sincos | None, arithmetic: Precision) -> str:
    """What is said of sine and cosine."""
    if sincos is None:
        where = "kanegen_pairs.h" if arithmetic is DOUBLE_DOUBLE else "the C library"
        return f"Sine and cosine are those of {where}, for one state and in batches."
    if sincos.plain:
        degrees = f"{sincos.degree} and {sincos.degree + 1}"
        return (
            f"Sine and cosine are polynomials of degree {degrees} ({sincos.header}.h), for angles of every "
            f"size. Their largest errors are {sincos.error}."
        )
    return (
        f"Sine and cosine are kanegen's own ({sincos.header}.h), for angles of every size, and off by at "
        f"most {sincos.error}. Compiled with -ffp-contract=off and without -ffast-math they have the same "
        "bits everywhere, whatever the C library."
    )
