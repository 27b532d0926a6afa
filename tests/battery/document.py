"""All of docs/extremes.md."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kanegen.library.native.compilers import find
from tests.battery.reproducibility import compilers, machine
from tests.battery.rows import SUBJECTS, Row

Results = Mapping[str, Sequence[Row]]

_INTRODUCTION = """\
Written by `make extremes` (`python -m tests.battery`); nobody edits it by hand. A smaller size of every
row is part of `make test`.

Errors are normwise, against certified truth (`kanegen.measure.truth`): two algorithms in ball arithmetic
whose enclosures overlap and are 2^-20 u wide. u is the unit roundoff, N the number of bodies, chi the
cancellation of the right-hand side, kappa_s the scaled condition number of [A], and formation the
cancellation inside [A] and {f}. T(u) = 4 u chi formation (4 N + kappa_s) is what
`kanegen.measure.truth.bound` promises; the promise ends where formation kappa_s u reaches 0.01. 16 N u chi
is stricter: no condition number appears in it.
*figure* is the error that comes nearest to its limit, or how many cases failed; *limit* is the limit there.

![Errors over the length of a chain, the mass ratio, the distance to gimbal lock and time](extremes.svg)"""


def document(results: Results) -> str:
    """Markdown: what is missed first, then every row, then what is not tried yet."""
    rows = [(number, row) for number, several in results.items() for row in several]
    missed = [(number, row) for number, row in rows if not row.holds]
    parts = ["# The battery of extremes", _INTRODUCTION, "## Summary"]
    parts += [f"{len(rows) - len(missed)} of {len(rows)} rows hold, in {len(results)} subjects."]
    if missed:
        lines = [
            f"- {number}, {row.case}: {_figure(row.figure)} where {_figure(row.limit)} is allowed. "
            f"{_sentence(row.cause)}"
            for number, row in missed
        ]
        parts += ["Missed:", "\n".join(lines)]
    for number, several in results.items():
        subject = SUBJECTS[number]
        parts += [f"## {number} {subject.title}", _about(subject.rows.__doc__), _table(several)]
    parts += ["## Where", _where()]
    return "\n\n".join(parts) + "\n"


def _about(doc: str | None) -> str:
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


def _where() -> str:
    versions = [find(name).version for name in compilers()]
    lines = [machine(), *versions, f"Figures of errors: {find().version}"]
    return "\n".join(f"- {line}" for line in lines)
