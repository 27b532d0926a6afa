"""The tables of a study, cell by cell as text."""

from __future__ import annotations

import math

from kanegen.measure.timing import BATCH, LATENCY
from kanegen.measure.truth.measurement import Measurement
from kanegen.studies.tradeoff.outcome import ConfirmedVariant, Study, VariantResult

REFORMULATED = "with other coordinates or speeds, whose arrays hold other numbers"
"""What stands apart from the other variants, in words."""

TITLES = {LATENCY: "one state a call", BATCH: "batches"}
"""The objectives in words."""

SHORT = ["variant", "ns", "median", "max", "hard states", "failed", ""]
"""Heads of the columns of `short_rows`."""

FRESH = ["variant", "ns", "least", "median", "99 %", "max", "found", "proven", "stays"]
"""Heads of the columns of `fresh_rows`."""

SIMULATION = ["error below", "variant", "method", "setting", "evaluations", "ms", "error"]
"""Heads of the columns of `simulation_rows`."""

SIMULATION_TEXT_COLUMNS = 4
"""Number of columns of `simulation_rows` that hold text; the columns after them hold numbers."""

LEVELS = tuple(10.0**-k for k in range(1, 14, 2))
"""Errors for which the table of simulations names the least work."""

_SIMULATION_METHOD = """
A free motion of {study.duration:.3g} s from one state was integrated with the default variant and with the
variants on the Pareto front for one state a call whose generalized speeds are rates of coordinates. *ms* is
the time of all evaluations of forward dynamics together, without what an integrator does beside them.
*error* is the error of the coordinates at the end, relative to 1 rad or 1 m plus their size, compared with
a reference in long double with much smaller steps. Each row names the least work with which an error is
reached; {failed} of {count} simulations failed.
"""


def head(study: Study) -> list[str]:
    """Return the heads of the columns of `rows`."""
    return [*"variant|ns|least|ops|median|99 %|max".split("|"), *hard_kinds(study), "of bound", "failed", ""]


def hard_kinds(study: Study) -> list[str]:
    """Return the names of the kinds of hard states of a study."""
    return list(study.results[0].hard) if study.results else []


def rows(study: Study, objective: str, *, reformulated: bool = False) -> list[list[str]]:
    """Return a row for each variant, the fastest first and those that are not timed last.

    Args:
        study: The study.
        objective: The way to call the library.
        reformulated: Whether to return the variants with other coordinates or speeds, or those with the
            coordinates and speeds of the model.
    """
    return [_row(study, result, objective) for result in _by_time(study, objective, reformulated)]


def short_rows(study: Study, objective: str, *, reformulated: bool = False) -> list[list[str]]:
    """Return the rows of `rows` with the columns `SHORT` only, for a terminal."""
    return [_short_row(study, result, objective) for result in _by_time(study, objective, reformulated)]


def fresh_rows(study: Study, objective: str) -> list[list[str]]:
    """Return a row for each variant on the Pareto front, with the figures that were measured again."""
    return [_fresh_row(confirmed, objective) for confirmed in study.pareto_fronts[objective]]


def simulation_rows(study: Study) -> list[list[str]]:
    """Return a row for each error in `LEVELS` that a simulation reaches, with the one of the least work."""
    rows = []
    for level in LEVELS:
        enough = [run for run in study.runs if run.error <= level]
        if enough:
            best = min(enough, key=lambda run: run.work)
            figures = [str(best.evaluations), f"{1e3 * best.work:.3g}", f"{best.error:.1e}"]
            rows.append([f"{level:.0e}", best.variant, best.method, best.setting, *figures])
    return rows


def simulation_method(study: Study) -> str:
    """Return the paragraph that explains the table of simulations."""
    failed = sum(not math.isfinite(run.error) for run in study.runs)
    return " ".join(_SIMULATION_METHOD.format(study=study, failed=failed, count=len(study.runs)).split())


def two_digits(value: float) -> str:
    """Return the text of a number of order one; "-" for NaN."""
    return "-" if math.isnan(value) else f"{value:.2g}"


def _by_time(study: Study, objective: str, reformulated: bool) -> list[VariantResult]:
    """Return results of a study, the fastest first and those that are not timed last."""

    def time(result: VariantResult) -> float:
        return math.inf if result.times is None else result.times[objective].median

    chosen = [one for one in study.results if one.candidate.changes_system is reformulated]
    return sorted(chosen, key=time)


def _row(study: Study, result: VariantResult, objective: str) -> list[str]:
    """Return the row of one variant in the table of an objective."""
    errors, times = result.errors[objective], result.times
    speed = [_ns(times[objective].median), _ns(times[objective].least)] if times else ["wrong", ""]
    hardest = [_error(found[objective].max) for found in result.hard.values()]
    figures = [*_quantiles(errors), *hardest, two_digits(errors.bound_share), _failed(result, objective)]
    return [result.label, *speed, str(result.operations), *figures, _remark(study, result, objective)]


def _short_row(study: Study, result: VariantResult, objective: str) -> list[str]:
    """Return the row of one variant with the columns `SHORT`."""
    errors = result.errors[objective]
    time = "wrong" if result.times is None else _ns(result.times[objective].median)
    hardest = max((found[objective].max for found in result.hard.values()), default=math.nan)
    figures = [_error(errors.median), _error(errors.max), _error(hardest), _failed(result, objective)]
    return [result.label, time, *figures, _remark(study, result, objective)]


def _fresh_row(confirmed: ConfirmedVariant, objective: str) -> list[str]:
    """Return the row of one variant on a Pareto front."""
    times = confirmed.times[objective]
    speed = [_ns(times.median), _ns(times.least)]
    found, stays = _error(confirmed.found), "yes" if confirmed.stays else "no"
    proven = _error(confirmed.proven)
    return [confirmed.result.label, *speed, *_quantiles(confirmed.errors), found, proven, stays]


def _remark(study: Study, result: VariantResult, objective: str) -> str:
    """Return whether a variant is on the Pareto front or shares its program with another one."""
    if any(confirmed.result.label == result.label for confirmed in study.pareto_fronts[objective]):
        return "front"
    return "same program" if result.same_as else ""


def _failed(result: VariantResult, objective: str) -> str:
    """Return the number of states without a finite result; nothing for 0."""
    return str(result.failed(objective) or "")


def _quantiles(errors: Measurement) -> list[str]:
    """Return the median, the 99 % quantile and the maximum of the errors."""
    return [_error(errors.median), _error(errors.p99), _error(errors.max)]


def _ns(value: float) -> str:
    """Return the text of a time in nanoseconds."""
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}"


def _error(value: float) -> str:
    """Return the text of an error; "none" where there is no finite result."""
    return f"{value:.1e}" if math.isfinite(value) else "none"
