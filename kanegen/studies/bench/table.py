"""An outcome in words: the rows of its table, and who was left out."""

from __future__ import annotations

from kanegen.studies.bench.outcome import Entry, Outcome
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS, QUANTITIES

TITLES = {EQUATIONS: "A + f", DYNAMICS: "forward dynamics", DERIVATIVES: "its derivatives"}
"""Of the quantities."""

_WAYS = {"aba": "aba", "cholesky": "Cholesky"}
TEXTS = 3
"""Columns of text, before those of numbers."""


def head(outcome: Outcome, quantity: str) -> list[str]:
    """Heads of the columns."""
    return [TITLES[quantity], "way", "compiler", "ns", "range", f"over {outcome.standard}", "differs by"]


def rows(outcome: Outcome, quantity: str) -> list[list[str]]:
    """A row for each way to compute a quantity."""
    return [_row(outcome, entry) for entry in outcome.entries if entry.task.quantity == quantity]


def notes(outcome: Outcome) -> list[str]:
    """What was changed in the model, a line each."""
    return [f"Note: {note}." for note in outcome.notes]


def left_out(outcome: Outcome) -> list[str]:
    """Who was left out, a line for each reason."""
    names: dict[str, list[str]] = {}
    for absence in outcome.absences:
        names.setdefault(absence.reason, []).append(absence.name)
    return [f"Left out: {' and '.join(those)}: {reason}." for reason, those in names.items()]


def overheads(outcome: Outcome) -> dict[str, float]:
    """By title of a quantity: ns that a call from Python takes beyond the same C called from C."""
    values = {TITLES[quantity]: outcome.overhead(quantity) for quantity in QUANTITIES}
    return {title: value for title, value in values.items() if value is not None}


def ns(value: float | None) -> str:
    """Nanoseconds with three digits or more."""
    if value is None:
        return "-"
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}"


def ratio(part: Entry | None, whole: Entry | None) -> str:
    """Time of `part` over that of `whole`, as 1/r where it is shorter."""
    if part is None or whole is None:
        return "-"
    if whole.median > part.median:
        return f"1/{whole.median / part.median:.1f}"
    return f"{part.median / whole.median:.2f}"


def _row(outcome: Outcome, entry: Entry) -> list[str]:
    task = entry.task
    way = "batch" if task.batch else _WAYS.get(task.name, "")
    row = [entry.contestant, way, entry.setting.name]
    if not entry.times.rounds:
        return [*row, "not timed", "", "", f"{entry.error:.0e}"]
    spread = f"{ns(entry.times.least)}-{ns(entry.times.largest)}"
    share = ratio(entry, outcome.best(outcome.standard, task.quantity))
    return [*row, ns(entry.median), spread, share, f"{entry.error:.0e}"]
