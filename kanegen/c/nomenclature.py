"""The list of names at the head of the generated code: exactly the names that occur, with their meanings."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass

from kanegen.c.functions import PrintedFunction
from kanegen.c.layout import WIDTH, columns
from kanegen.recursion.legend import legend

_NUMBERED = re.compile(r"t\d+_*")
_DECLARATION = re.compile(r"^ {4}(?:const )?(?:long double|double|float|int) .*;$", flags=re.MULTILINE)

SINES = ("sines, cosines", "sines and cosines of several coordinates, computed at once")
"""Names of sines and cosines that one call computes, for one state or in the lanes of a batch."""

PRINTED = (
    ("w", "numbers that one part of a function leaves for later parts"),
    ("failed", "place in x, from 1, of the first freedom whose condition fails"),
    ("inaccurate", "minus the place of the freedom with the least margin, where that is not positive"),
    ("least_margin", "least margin so far"),
    ("before", "mode of the arithmetic of the caller"),
    ("status", "what the function returns"),
)
"""Names that the printer adds to those of the derivation, and their meanings."""

OF_STEPS = (
    ("state", "coordinates, then speeds"),
    ("change", "change of the state in a step"),
    ("inputs", "inputs from outside at the start, the middle and the end of a step"),
    ("lost", "what rounding took from earlier sums"),
    ("square_1, factor_1, ...", "squared length of a quaternion, and what makes it as long as before"),
    ("half, sixth", "half of the step, and a sixth of it"),
    ("part", "the step times 1 - 1/sqrt(2)"),
    ("stage", "state within a step, from the rates found so far"),
    ("rates", "rates of a state"),
    ("first", "rates of the first stage"),
    ("last", "rates of the stage before"),
    ("middle", "state in the middle of a step, or its rates"),
    ("speeds", "speeds within a step"),
    ("faster", "state with the speeds after a step"),
    ("slopes", "derivatives of {ydot} or of generalized forces"),
    ("turns", "derivatives of {xdot}"),
    ("coordinate_rates_derivatives", "derivatives of {xdot}"),
    ("moved", "derivatives of a stage"),
    ("product", "derivatives of the rates of a stage"),
    ("mass", "[A]"),
    ("matrix", "[A], [C], [A]^-1, or the matrix of a step"),
    ("momentum", "[A]{y}"),
    ("pushed", "inputs with the generalized forces of an iteration"),
    ("active", "whether the iteration goes on"),
    ("finite", "1 where all new values are finite numbers"),
    ("previous", "largest change in the iteration before"),
)
"""Names in functions that follow a motion in steps, and their meanings."""


@dataclass(frozen=True)
class Nomenclature:
    """Lines of the head of the code.

    Attributes:
        names: Lines about names.
        places: Lines about the values of the placeholder P in names.
        freedoms: Lines about the values of the placeholder L in names.
    """

    names: list[str]
    places: list[str]
    freedoms: list[str]


def nomenclature(functions: Collection[PrintedFunction], steps: str = "") -> Nomenclature:
    """Return the names of all functions, one state and SIMD, and their meanings.

    Args:
        functions: The functions.
        steps: Text of what follows a motion in steps, for one state.
    """
    names = {name for f in functions for one in (f.code, f.simd_code) for name in one.locals}
    numbered = {name for name in names if _NUMBERED.fullmatch(name)}
    found = legend(names - numbered)
    further = [("t1, t2, ...", "parts of longer expressions")] if numbered else []
    at_once = any(code.vector_sincos for f in functions for code in (f.code, f.simd_code))
    further += [SINES] if at_once else []
    lines = "\n".join([*(line for f in functions for line in _scalar_lines(f)), steps])
    further += [(name, meaning) for name, meaning in PRINTED if _declares(lines, name)]
    further += [(name, meaning) for name, meaning in OF_STEPS if _occurs(steps, name)]
    return Nomenclature(_table([*found.names, *further]), _table(found.places), _table(found.freedoms))


def _scalar_lines(function: PrintedFunction) -> Iterable[str]:
    """Yield the lines of all bodies of the form for one state."""
    yield from function.code.body
    for _, body in function.code.parts:
        yield from body


def _declares(lines: str, name: str) -> bool:
    """Return whether the printer's own name occurs; of several names, the first."""
    first = name.partition(",")[0]
    if f"{first}[" not in lines and f"{first} = " not in lines:  # much sooner said than by the expression
        return False
    return re.search(rf"^ +[\w ,=]*\b{first}(\[| = )", lines, flags=re.MULTILINE) is not None


def _occurs(text: str, name: str) -> bool:
    """Return whether a local of a name, or of the first of several, is declared in a text."""
    declared = "\n".join(_DECLARATION.findall(text))
    return re.search(rf"[ *]{name.partition(',')[0]}(\[|,|;| =|$)", declared) is not None


def _table(rows: Iterable[tuple[str, str]]) -> list[str]:
    """Return two aligned columns as lines of a block comment."""
    return columns(list(rows), width=WIDTH - len(" *     "))
