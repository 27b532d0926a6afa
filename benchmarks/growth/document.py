"""The document docs/growth.md: exponents of growth, the method, and every number."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.growth.cases import CURVES, LARGEST
from benchmarks.growth.results import FROM, MEASURES, Measure, Point, Study, exponent, series
from kanegen.measure.machine import Machine
from kanegen.options import STRICT
from kanegen.studies.markdown import markdown_table

_INTRODUCTION = f"""\
Written by `make growth` (`python -m benchmarks.growth`); do not edit it by hand. It shows how operations,
times and sizes grow with the number of bodies, so that the cost of a larger tree can be estimated. *chain*
is a chain of hinges about axes 1, 2, 3, 1, ... in turn; *tree* is a binary tree of bodies with six freedoms
each. Every output is generated alone.

![Every measure over the number of bodies](growth.svg)

Dotted lines are the file for many states at once. It is a loop over the other file where inputs, results
and the values that function parts pass to each other are more than 8192 numbers a state.

## Growth

The table gives the exponent p of bodies^p, fitted to the points from {FROM} bodies on: p = 1 means linear
growth, so that twice the bodies cost twice as much. The number of entries of [A] grows with the square of
the freedoms, so p = 2 is linear in the size of [A]."""

WIDTH = 110
"""Characters of a line of text."""

ONCE = 0.1
"""Share of the time limit; a file that takes longer is compiled only once."""


@dataclass(frozen=True)
class GrowthOptions:
    """The extent of the study.

    Attributes:
        rounds: Number of rounds of generation and compilation; run times have three times as many.
        seconds: Duration of each timing of one state (s).
        time_limit: Time that the compiler has for one file (s).
    """

    rounds: int = 3
    seconds: float = 0.05
    time_limit: float = 600.0

    @property
    def turns(self) -> int:
        """The number of rounds of run times, which vary most and cost least."""
        return 3 * self.rounds


def document(study: Study, options: GrowthOptions) -> str:
    """Return the Markdown: growth first, then the method, then every number."""
    parts = ["# Growth with the number of bodies", _INTRODUCTION, _exponents(study), _method(options)]
    if study.missing:
        parts += ["\n".join(["Left out:", "", *(f"- {reason}" for reason in study.missing)])]
    parts += ["\n".join(["The machine:", "", *(f"- {line}" for line in Machine.here().lines())])]
    parts += ["## Every number"]
    for curve in CURVES:
        points = study.curve(curve)
        if points:
            parts += [f"### {curve}", _numbers(points)]
    return "\n\n".join(parts) + "\n"


def _method(options: GrowthOptions) -> str:
    largest = ", ".join(f"`{output}` up to {bodies} bodies" for output, bodies in LARGEST.items())
    care = (
        f"{largest}. Every case has one turn in each of {options.rounds} rounds; the tables give medians "
        f"of the rounds. A file that takes the compiler more than {options.time_limit * ONCE:g} s is "
        f"compiled once; after {options.time_limit:g} s it is given up, and with it all larger trees of its "
        "curve."
    )
    return f"""\
## What is measured

{textwrap.fill(care, WIDTH)}

- *operations*: operations of one evaluation, as `kanegen info` counts them.
- *generation*: time of `kg.generate` in a new process; *derivation* is its part for the recursive form.
- *memory*: peak memory of that process beyond that of kanegen and the tree.
- *C*, *compile*, *.text*: size of the C file, time to compile it with `{" ".join(STRICT.flags)}`, and size
  of the instructions; *batch* is the same for the file for many states at once.
- *one state*: time of one call, from {options.turns} processes of {options.seconds:g} s each, in turns."""


def _exponents(study: Study) -> str:
    measures = [measure for measure in MEASURES if measure.name != "freedoms"]
    rows = []
    for curve in CURVES:
        points = study.curve(curve)
        found = (exponent(series(points, measure.name)) for measure in measures)
        rows.append([str(curve), *("-" if p is None else f"{p:.2f}" for p in found)])
    titles = [measure.title.partition(", ")[0] for measure in measures]
    return markdown_table(["", *titles], rows)


def _numbers(points: Sequence[Point]) -> str:
    rows = [[str(point.case.bodies), *(_number(point, measure) for measure in MEASURES)] for point in points]
    return markdown_table(["bodies", *(measure.title for measure in MEASURES)], rows)


def _number(point: Point, measure: Measure) -> str:
    value = point.median(measure.name)
    if value is None:
        return "-"
    if float(value).is_integer() and measure.unit == 1:
        return f"{value:.0f}"
    scaled = value / measure.unit
    return f"{scaled:.0f}" if scaled >= 100 else f"{scaled:.3g}"
