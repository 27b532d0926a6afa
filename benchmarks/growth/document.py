"""All of docs/growth.md."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.growth.cases import CURVES, LARGEST
from benchmarks.growth.results import FROM, MEASURES, Measure, Point, Study, exponent, series
from kanegen.measure import machine
from kanegen.options import STRICT
from kanegen.studies.markdown import markdown_table

_INTRODUCTION = f"""\
Written by `make growth` (`python -m benchmarks.growth`); nobody edits it by hand. *chain*: hinges about
axes 1, 2, 3, 1, ... in turn. *tree*: a binary tree of bodies with six freedoms each. Every output is
generated alone.

![Every measure over the number of bodies](growth.svg)

Dotted: the file for many states at once, which is but a loop over the other where inputs,
results and what pieces leave for each other are more than 8192 numbers a state.

## Growth

The exponent p of bodies^p, fitted to the points from {FROM} bodies on: 1 is linear. The entries of [A] grow
as the square, so 2 is all that can be asked there."""

WIDTH = 110

ONCE = 0.1
"""Share of the time limit beyond which nothing is compiled a second time."""


@dataclass(frozen=True)
class GrowthOptions:
    """How carefully it was measured.

    Attributes:
        rounds: Of generation and compilation; three times as many of run times.
        seconds: Of every timing of one state.
        time_limit: Seconds that the compiler is given for one file.
    """

    rounds: int = 3
    seconds: float = 0.05
    time_limit: float = 600.0

    @property
    def turns(self) -> int:
        """Run times vary most and cost least."""
        return 3 * self.rounds


def document(study: Study, terms: GrowthOptions) -> str:
    """Markdown: growth first, then how it was done, then every number."""
    parts = ["# Growth with the number of bodies", _INTRODUCTION, _exponents(study), _method(terms)]
    if study.missing:
        parts += ["\n".join(["Left out:", "", *(f"- {reason}" for reason in study.missing)])]
    parts += ["\n".join(["The machine:", "", *(f"- {line}" for line in machine.description())])]
    parts += ["## Every number"]
    for curve in CURVES:
        points = study.curve(curve)
        if points:
            parts += [f"### {curve}", _numbers(points)]
    return "\n\n".join(parts) + "\n"


def _method(terms: GrowthOptions) -> str:
    largest = ", ".join(f"`{output}` up to {bodies} bodies" for output, bodies in LARGEST.items())
    care = (
        f"{largest}. Every case has a turn in each of {terms.rounds} rounds; medians are over rounds. What "
        f"takes the compiler more than {terms.time_limit * ONCE:g} s is compiled once; a file is given up "
        f"after {terms.time_limit:g} s, and with it all larger trees of its curve."
    )
    return f"""\
## What is measured

{textwrap.fill(care, WIDTH)}

- *operations*: of one evaluation, as `kanegen info` counts them.
- *derivation*: the recursive form in SymPy, part of *generation*: all of `kg.generate`, in a new process.
- *memory*: peak of that process beyond what it had with kanegen and the tree loaded.
- *C*, *compile*, *.text*: size of the C file, the compiler's time for it with `{" ".join(STRICT.flags)}`, and
  size of the instructions; *batch* is the same of the file for many states at once.
- *one state*: one call of the function; {terms.turns} processes of {terms.seconds:g} s each, in turns."""


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
