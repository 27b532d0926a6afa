"""The tables of a study, as text cell by cell."""

from __future__ import annotations

import math

from kanegen.measure.timing import BATCH, LATENCY
from kanegen.measure.truth.measurement import Measurement
from kanegen.studies.tradeoff.outcome import Confirmed, Entry, Study

TITLES = {LATENCY: "one state a call", BATCH: "batches"}
"""Of the objectives."""

SHORT = ["variant", "ns", "median", "max", "hard states", "failed", ""]
"""Heads of the columns of `short_rows`."""

FRESH = ["variant", "ns", "least", "median", "99 %", "max", "found", "stays"]
"""Heads of the columns of `fresh_rows`."""


def head(study: Study) -> list[str]:
    """Heads of the columns of the table of an objective."""
    return [*"variant|ns|least|ops|median|99 %|max".split("|"), *strata(study), "of bound", "failed", ""]


def strata(study: Study) -> list[str]:
    """Names of the strata of hard states."""
    return list(study.entries[0].hard) if study.entries else []


def rows(study: Study, objective: str) -> list[list[str]]:
    """A row for each variant, the fastest first and those that are not timed last."""
    ordered = sorted(study.entries, key=lambda entry: _time(entry, objective))
    return [_row(study, entry, objective) for entry in ordered]


def short_rows(study: Study, objective: str) -> list[list[str]]:
    """The same with the columns `SHORT` only, for a terminal."""
    ordered = sorted(study.entries, key=lambda entry: _time(entry, objective))
    return [_short_row(study, entry, objective) for entry in ordered]


def mark(study: Study, entry: Entry, objective: str) -> str:
    """What is to be said of a variant in a word or two."""
    if any(confirmed.entry.label == entry.label for confirmed in study.fronts[objective]):
        return "front"
    return "same program" if entry.same_as else ""


def fresh_rows(study: Study, objective: str) -> list[list[str]]:
    """A row for each variant on the front, with the figures that were taken again."""
    return [_fresh_row(confirmed, objective) for confirmed in study.fronts[objective]]


def _row(study: Study, entry: Entry, objective: str) -> list[str]:
    errors, times = entry.errors[objective], entry.times
    speed = [_ns(times[objective].median), _ns(times[objective].least)] if times else ["wrong", ""]
    hardest = [_error(found[objective].max) for found in entry.hard.values()]
    lost = f"{entry.failed(objective)}" if entry.failed(objective) else ""
    figures = [*_quantiles(errors), *hardest, plain(errors.bound_share), lost]
    return [entry.label, *speed, str(entry.operations), *figures, mark(study, entry, objective)]


def _short_row(study: Study, entry: Entry, objective: str) -> list[str]:
    errors = entry.errors[objective]
    time = "wrong" if entry.times is None else _ns(entry.times[objective].median)
    hardest = max((found[objective].max for found in entry.hard.values()), default=math.nan)
    lost = f"{entry.failed(objective)}" if entry.failed(objective) else ""
    figures = [time, _error(errors.median), _error(errors.max), _error(hardest), lost]
    return [entry.label, *figures, mark(study, entry, objective)]


def _fresh_row(confirmed: Confirmed, objective: str) -> list[str]:
    times = confirmed.times
    speed = [_ns(times[objective].median), _ns(times[objective].least)]
    found = _error(confirmed.found)
    stays = "yes" if confirmed.stays else "no"
    return [confirmed.entry.label, *speed, *_quantiles(confirmed.errors), found, stays]


def _quantiles(errors: Measurement) -> list[str]:
    return [_error(errors.median), _error(errors.p99), _error(errors.max)]


def _time(entry: Entry, objective: str) -> float:
    return math.inf if entry.times is None else entry.times[objective].median


def _ns(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}"


def _error(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "none"


def plain(value: float) -> str:
    """A number of order one."""
    return "-" if math.isnan(value) else f"{value:.2g}"


LEVELS = tuple(10.0**-k for k in range(1, 14, 2))
"""Errors at which the cheapest way is told."""

SIMULATION = ["error below", "variant", "method", "setting", "evaluations", "ms", "error"]
"""Heads of the columns of `simulation_rows`."""

SIMULATION_TEXTS = 4
"""How many of them are text, before those of numbers."""

_SIMULATION_METHOD = """
A free motion of {study.duration:.3g} s from one state, by the variants on the front for one state a call
whose speeds are rates of coordinates, and by the default. *ms* is the time of all evaluations of forward
dynamics together; what an integrator does beside them does not count. *error* is that of the coordinates at
the end, relative to 1 rad or 1 m and their size, from a reference in long double with much smaller steps. The
table has the least work with which an error is reached; {failed} of {count} simulations failed.
"""


def simulation_rows(study: Study) -> list[list[str]]:
    """For every error that is reached, the way that takes the least time of evaluations."""
    rows = []
    for level in LEVELS:
        enough = [run for run in study.runs if run.error <= level]
        if enough:
            best = min(enough, key=lambda run: run.work)
            figures = [str(best.evaluations), f"{1e3 * best.work:.3g}", f"{best.error:.1e}"]
            rows.append([f"{level:.0e}", best.variant, best.method, best.setting, *figures])
    return rows


def simulation_method(study: Study) -> str:
    """What was simulated."""
    failed = sum(not math.isfinite(run.error) for run in study.runs)
    return " ".join(_SIMULATION_METHOD.format(study=study, failed=failed, count=len(study.runs)).split())
