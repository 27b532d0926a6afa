"""The document docs/validation.md: a summary, then every case with all its numbers."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal

from benchmarks.validation.case import Case, Row
from kanegen.studies.markdown import markdown_table

INTRODUCTION = """\
Written by `make validation` (`python -m benchmarks.validation`); do not edit it by hand. Cases that others
have published, computed with the C that kanegen generates. *Expected* is what the source states, digit by
digit; *allowed* is how far a right result may be from it, because digits or accuracy of the source end there.
The command fails if a difference is larger. [truth](truth/README.md) is the other way round: exact numbers of
five trees, for other programs to compare themselves with."""


def document(cases: Sequence[Case]) -> str:
    """Return the Markdown."""
    heads = ("case", "numbers", "largest difference over what is allowed", "result")
    lines = [
        [
            f"[{case.title}](#{_anchor(case.title)})",
            str(case.count),
            f"{case.share:.2g}",
            _verdict(case.holds),
        ]
        for case in cases
    ]
    parts = [
        "# Published cases",
        INTRODUCTION,
        markdown_table(heads, lines),
        *(_section(case) for case in cases),
    ]
    return "\n\n".join(parts) + "\n"


def _section(case: Case) -> str:
    """Return the section of a case."""
    model = f"benchmarks/validation/models/{case.model}.toml"
    heads = ("quantity", "unit", "expected", "found", "difference", "allowed")
    parts = [
        f"## {case.title}",
        case.source,
        f"{case.problem} The model is [{case.model}.toml](../{model}).",
        f"*Allowed.* {case.allowance}",
        markdown_table(heads, [line for row in case.rows for line in _lines(row)], left=2),
        *case.notes,
    ]
    return "\n\n".join(parts)


def _lines(row: Row) -> list[list[str]]:
    """Return the lines of a table for the numbers of a row."""
    lines = []
    for i, (expected, found, difference, limit) in enumerate(
        zip(row.expected, row.found, row.differences, row.limits, strict=True)
    ):
        cells = [row.quantity if i == 0 else "", row.unit if i == 0 else ""]
        mark = "" if difference <= limit else " **fails**"
        lines.append([*cells, expected, _number(found, limit), f"{difference:.1e}{mark}", f"{limit:.1e}"])
    return lines


def _number(value: float, limit: float) -> str:
    """Return a number with two digits more than are allowed to differ, or its size where that shows none."""
    digits = max(0, 2 - Decimal(limit).adjusted())
    text = f"{value:.{digits}f}"
    return f"{value:.1e}" if value and not float(text) else text


def _verdict(holds: bool) -> str:
    return "holds" if holds else "**fails**"


def _anchor(title: str) -> str:
    """Return the anchor that Markdown gives to a title."""
    kept = "".join(letter for letter in title.lower() if letter.isalnum() or letter in " -")
    return kept.replace(" ", "-")
