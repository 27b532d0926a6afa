"""A comparison as text: head and rows of its tables, notes, and the programs that were left out."""

from __future__ import annotations

import math

from kanegen.errors import counted
from kanegen.measure.timing import (
    CONFIDENCE,
    CONFIDENCE_OF_CHANGES,
    LEAST_FOR_INTERVAL,
    SEEN,
    speedup,
)
from kanegen.studies.bench.against import Row, Verdict
from kanegen.studies.bench.comparison import Comparison, Entry
from kanegen.studies.bench.results import (
    BY_DIFFERENCES,
    DERIVATIVES,
    DYNAMICS,
    EQUATIONS,
    INVERSE_DERIVATIVES,
    LOWER,
    QUANTITIES,
    of_peers,
)
from kanegen.studies.bench.settings import MEANINGS

TITLES = {
    EQUATIONS: "A + f",
    LOWER: "A (lower) + f",
    DYNAMICS: "forward dynamics",
    DERIVATIVES: "derivatives of forward dynamics",
    INVERSE_DERIVATIVES: "derivatives of inverse dynamics",
}
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
    """Format the median ratio of the rounds of `part` to those of `whole`, with its confidence interval.

    A ratio r below 1 becomes 1/(1/r) and the interval that of 1/r, as in "1/8.0 (7.8-8.1)". With too few
    rounds for an interval there is none.
    """
    if part is None or whole is None:
        return "-"
    found = speedup(whole.times, part.times)
    if found.median > 1:
        text, low, high, digits = f"1/{found.median:.1f}", found.low, found.high, 1
    else:
        text, digits = f"{1 / found.median:.2f}", 2
        low, high = 1 / found.high, 1 / found.low if found.low else math.inf
    return f"{text} ({low:.{digits}f}-{high:.{digits}f})" if math.isfinite(high) else text


def heads_of_changes() -> list[str]:
    """Return the heads of the columns of a table of changes."""
    return ["model", "quantity", "method", "compiler", "compared", "before", "now", "now/before", ""]


def words_of_changes(verdict: Verdict) -> list[str]:
    """Return lines that say what the columns of a table of changes are, and how many tasks changed."""
    number = counted(len(verdict.rows), "task")
    lines = [
        "before, now: medians of the rounds, of ns or of ratios to the peer in the same round; now/before: "
        f"the ratio of the two, with its {100 * CONFIDENCE_OF_CHANGES:g} % confidence interval.",
        f"Of {number} {len(verdict.slower)} became slower, {len(verdict.faster)} became faster; undecided: "
        f"{len(verdict.undecided)}.",
    ]
    if verdict.undecided:
        lines.append(
            f"Undecided: the interval reaches above {SEEN:g}, so these times do not rule out that the task "
            f"became {100 * (SEEN - 1):.0f} % slower. Take more rounds or a quieter machine."
        )
    return lines


def legend(comparison: Comparison, rounds: int) -> list[str]:
    """Return lines that say what the columns of the tables of times are."""
    standard = comparison.standard
    lines = [
        f"over {standard}: median ratio of the rounds to its fastest row of one state a call, which has 1.00"
        + (f", with its {100 * CONFIDENCE:g} % confidence interval." if rounds >= LEAST_FOR_INTERVAL else ".")
    ]
    if rounds < LEAST_FOR_INTERVAL:
        lines.append(f"There are no confidence intervals: they need at least {LEAST_FOR_INTERVAL} rounds.")
    settings = {entry.setting.words: entry.setting for entry in comparison.entries}
    for words, setting in settings.items():
        flags = f" ({' '.join(setting.flags)})" if setting.flags else ""
        lines.append(f"compiler {words}{flags}: {MEANINGS.get(setting.name, 'a setting of its own')}.")
    return lines


def row_of_change(row: Row) -> list[str]:
    """Return the row of one task in two runs."""
    entry, found = row.entry, row.change
    known = math.isfinite(found.high)
    named = (("slower", found.is_slower), ("faster", found.is_faster), ("undecided", found.is_undecided))
    word = next((name for name, holds in named if holds), "")
    return [
        row.model,
        TITLES.get(entry.task.quantity, entry.task.quantity),
        _method(entry),
        f"{entry.participant}, {entry.setting.words}",
        f"over {row.peer}" if row.peer else "ns",
        *(f"{value:.4g}" if value < 1000 else ns(value) for value in (row.before, row.now)),
        f"{found.ratio:.3f} ({found.low:.3f}-{found.high:.3f})" if known else f"{found.ratio:.3f}",
        word,
    ]


def _method(entry: Entry) -> str:
    """Return how a task computes: in batches, by differences, by which algorithm, on how many cores."""
    parts = [_METHODS.get(entry.task.name, "")]
    parts += ["batch"] * entry.task.batch
    parts += ["differences"] * (entry.task.tolerance >= BY_DIFFERENCES)
    parts += [f"{entry.cores} cores"] * (entry.cores > 1)
    return ", ".join(filter(None, parts))


def _row(comparison: Comparison, entry: Entry) -> list[str]:
    """Return the row of one task."""
    task = entry.task
    row = [entry.participant, _method(entry), entry.setting.words]
    if not entry.times.rounds:
        return [*row, "not timed", "", "", f"{entry.error:.0e}"]
    spread = f"{ns(entry.times.least)}-{ns(entry.times.largest)}"
    share = ratio(entry, comparison.best(comparison.standard, of_peers(task.quantity), cores=entry.cores))
    return [*row, ns(entry.median), spread, share, f"{entry.error:.0e}"]
