"""A comparison as text: head and rows of its tables, notes, and the programs that were left out."""

from __future__ import annotations

from kanegen.studies.bench.comparison import Comparison, Entry
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS, QUANTITIES

TITLES = {EQUATIONS: "A + f", DYNAMICS: "forward dynamics", DERIVATIVES: "its derivatives"}
"""Titles of the tables by quantity; an output of kanegen has its name as title."""

_METHODS = {"aba": "aba", "cholesky": "Cholesky"}
"""Names of methods by name of the task, where a driver has several methods for a quantity."""

TEXT_COLUMNS = 3
"""Number of the first columns, which hold text; the others hold numbers."""


def head(comparison: Comparison, quantity: str) -> list[str]:
    """Return the heads of the columns of a table."""
    return [
        TITLES.get(quantity, quantity),
        "method",
        "compiler",
        "ns",
        "range",
        f"over {comparison.standard}",
        "differs by",
    ]


def rows(comparison: Comparison, quantity: str) -> list[list[str]]:
    """Return one row for each task that computes a quantity."""
    return [_row(comparison, entry) for entry in comparison.entries if entry.task.quantity == quantity]


def notes(comparison: Comparison) -> list[str]:
    """Return one line for each change to the model."""
    return [f"Note: {note}." for note in comparison.notes]


def left_out(comparison: Comparison) -> list[str]:
    """Return one line for each reason for which programs were left out."""
    names: dict[str, list[str]] = {}
    for absence in comparison.absences:
        names.setdefault(absence.reason, []).append(absence.name)
    return [f"Left out: {' and '.join(those)}: {reason}." for reason, those in names.items()]


def overheads(comparison: Comparison) -> dict[str, float]:
    """Return the time (ns) by which a call from Python exceeds one from C, by title of the quantity."""
    values = {TITLES[quantity]: comparison.overhead(quantity) for quantity in QUANTITIES}
    return {title: value for title, value in values.items() if value is not None}


def ns(value: float | None) -> str:
    """Format nanoseconds with at least three digits; None becomes a dash."""
    if value is None:
        return "-"
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}"


def ratio(part: Entry | None, whole: Entry | None) -> str:
    """Format the time of `part` over that of `whole`; a ratio r below 1 becomes 1/(1/r), such as 1/8.0."""
    if part is None or whole is None:
        return "-"
    if whole.median > part.median:
        return f"1/{whole.median / part.median:.1f}"
    return f"{part.median / whole.median:.2f}"


def _row(comparison: Comparison, entry: Entry) -> list[str]:
    """Return the row of one task."""
    task = entry.task
    method = "batch" if task.batch else _METHODS.get(task.name, "")
    row = [entry.participant, method, entry.setting.name]
    if not entry.times.rounds:
        return [*row, "not timed", "", "", f"{entry.error:.0e}"]
    spread = f"{ns(entry.times.least)}-{ns(entry.times.largest)}"
    share = ratio(entry, comparison.best(comparison.standard, task.quantity))
    return [*row, ns(entry.median), spread, share, f"{entry.error:.0e}"]
