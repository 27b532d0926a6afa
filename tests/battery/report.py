"""The report of the battery, docs/extremes.md."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kanegen.library.native.compilers import find
from kanegen.measure.machine import Machine
from tests.battery.compilers import compilers
from tests.battery.experiments import EXPERIMENTS, Row

Results = Mapping[str, Sequence[Row]]

_INTRODUCTION = """\
Written by `make extremes` (`python -m tests.battery`); do not edit it by hand. The tests run a smaller size
of every experiment.

Each row of a table is a measurement that must meet a limit. *figure* is the error that comes nearest to its
limit, or the number of cases that failed; *limit* is the limit of that case; *rule* is the limit as a
formula.

Errors are normwise and relative to certified truth (`kanegen.measure.truth`): two algorithms in ball
arithmetic whose enclosures overlap and are at most 2^-20 u wide. u is the unit roundoff, N the number of
bodies, chi the cancellation of the right-hand side, kappa_s the scaled condition number of [A], and
formation the cancellation inside [A] and {f}. T(u) = 4 u chi formation (4 N + kappa_s) is the bound that
`kanegen.measure.truth.bound` gives; there is no bound where formation kappa_s u exceeds 0.01. The limit 16
N u chi is stricter, since it has no condition number.

![Errors over the length of a chain, the mass ratio, the distance to gimbal lock and time](extremes.svg)"""


def report(results: Results) -> str:
    """Return the Markdown: a summary with the missed rows, then every row, then the machine and compilers."""
    rows = [(number, row) for number, several in results.items() for row in several]
    missed = [(number, row) for number, row in rows if not row.holds]
    parts = ["# The battery of extremes", _INTRODUCTION, "## Summary"]
    parts += [f"{len(rows) - len(missed)} of {len(rows)} rows hold, in {len(results)} experiments."]
    if missed:
        lines = [
            f"- {number}, {row.case}: {_figure(row.figure)} where {_figure(row.limit)} is allowed. "
            f"{_sentence(row.cause)}"
            for number, row in missed
        ]
        parts += ["Missed:", "\n".join(lines)]
    for number, several in results.items():
        experiment = EXPERIMENTS[number]
        parts += [f"## {number} {experiment.title}", _about(experiment.rows.__doc__), _table(several)]
    parts += ["## Machine and compilers", _machine()]
    return "\n\n".join(parts) + "\n"


def _about(doc: str | None) -> str:
    """Return a docstring as paragraphs of one line each."""
    paragraphs = (doc or "").split("\n\n")
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)


def _table(rows: Sequence[Row]) -> str:
    lines = ["| case | figure | limit | | rule | over |", "| --- | ---: | ---: | --- | --- | --- |"]
    for row in rows:
        verdict = "holds" if row.holds else "**missed**"
        cells = [row.case, _figure(row.figure), _figure(row.limit), verdict, row.rule, row.over]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _figure(value: float) -> str:
    return str(int(value)) if abs(value) < 1e6 and value == int(value) else f"{value:.1e}"


def _sentence(cause: str) -> str:
    return f"{cause[:1].upper()}{cause[1:]}." if cause else "The cause is unknown."


def _machine() -> str:
    versions = [find(name).version for name in compilers()]
    machine = Machine.here()
    lines = [f"{machine.system}, {machine.libc}", *versions, f"Figures of errors: {machine.compiler}"]
    return "\n".join(f"- {line}" for line in lines)
