"""A study as a Markdown report, as CSV and as JSON; only the times differ from run to run."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from kanegen import __version__
from kanegen.errors import counted
from kanegen.measure.machine import Machine
from kanegen.measure.timing import OBJECTIVES, Times
from kanegen.measure.truth.bounds import FACTOR
from kanegen.measure.truth.errors import LARGEST_BACKWARD_ERROR
from kanegen.measure.truth.measurement import Measurement
from kanegen.model import quoting
from kanegen.studies.markdown import markdown_table
from kanegen.studies.tradeoff import tables
from kanegen.studies.tradeoff.outcome import ConfirmedVariant, Study, VariantResult
from kanegen.studies.tradeoff.pareto_front import TIE
from kanegen.studies.tradeoff.recommendation import recommendations
from kanegen.studies.tradeoff.tables import TITLES

_RANKED_BY = {
    "max": "the largest error of the sample",
    "p99": "the error that 99 % of the states keep",
    "median": "the median error",
}
"""The error by which a study ranks variants, in words, by the name of its quantile."""

_CSV_COLUMNS = (
    *("variant", "objective", "nanoseconds", "least", "operations", "bytes"),
    *("median", "p99", "max", "componentwise", "of_bound"),
)
"""Columns of the CSV before those of hard states."""

_METHOD = """
The error is the normwise relative error of {{ydot}} after unit scaling, compared with certified truth. The
columns *median*, *99 %* and *max* hold its quantiles over {options.states} random states, which are
uniformly distributed over a box{clearance}; `tradeoff.json` lists its ranges. All numbers of a state are
rounded to single precision, so that every variant solves the same problem; variants with other generalized
speeds get the same physical states. A state without a finite result counts as an infinite error. {hard} the
largest error in {options.hard} states in which arithmetic is hard. *of bound* is the largest error over u
chi formation (4 N + kappa_s), which is promised to be at most {factor:g}. Here u is the unit roundoff or,
if that is larger, the error of the sine and cosine of the variant. A result whose backward error exceeds
{gate:g} N u is called wrong, not inaccurate.

*ns* is the median time of one evaluation over {options.rounds} rounds of {options.seconds:g} s, *least* the
time in the fastest round. In each round every variant has one turn in a process of its own, with a fresh
copy of the library whose errors were measured. *ops* is the number of operations of one evaluation. The
Pareto front compares the times with {ranked_by}; times that differ by less than {tie:g} % count as equal.
Its variants were measured again, in fresh states and other processes: *stays* says whether a variant is
still on the front. A search then tried {options.search} states to find a larger error; *found* is the
largest. *proven* is the median, over the fresh states, of the bounds that the output `error_bound` proves for
the errors of the variant. All samples have the seed {options.seed}.
"""


def statements(study: Study) -> list[str]:
    """Return the conclusions of a study, a sentence or more in each line."""
    lines = [f"{TITLES[objective].capitalize()}: {study.verdict(objective)}" for objective in OBJECTIVES]
    rho = [f"{TITLES[o]} {tables.two_digits(study.rank_correlation(o))}" for o in OBJECTIVES]
    lines.append(f"Spearman's rank correlation of operation counts and measured times: {', '.join(rho)}.")
    wrong = [result.label for result in study.results if result.wrong]
    if wrong:
        lines.append(
            f"Wrong, and not timed, because no rounding explains their backward errors: {'; '.join(wrong)}."
        )
    return lines


def markdown(study: Study) -> str:
    """Return the report of a study in Markdown."""
    parts = [
        f"# Speed against accuracy: {quoting.markdown(study.model)}",
        f"{counted(study.n, 'freedom')}, {counted(len(study.results), 'variant')}, "
        f"{len(study.refusals)} refused.",
        "\n".join(f"- {line}" for line in (*recommendations(study), *statements(study))),
        "![Work and precision](tradeoff.svg)",
        "## How",
        _method(study),
    ]
    for objective in OBJECTIVES:
        parts += [
            f"## Pareto front, {TITLES[objective]}",
            markdown_table(tables.FRESH, tables.fresh_rows(study, objective)),
            f"## All variants, {TITLES[objective]}",
            markdown_table(tables.head(study), tables.rows(study, objective)),
        ]
        if others := tables.rows(study, objective, reformulated=True):
            parts += [
                f"## Variants {tables.REFORMULATED}, {TITLES[objective]}",
                markdown_table(tables.head(study), others),
            ]
    if study.runs:
        parts += [
            "## Simulation",
            tables.simulation_method(study),
            "![Simulations](tradeoff-simulation.svg)",
            markdown_table(tables.SIMULATION, tables.simulation_rows(study), tables.SIMULATION_TEXT_COLUMNS),
        ]
    same = [result for result in study.results if result.same_as]
    if same:
        lines = [f"- {result.label}: the same program as {result.same_as}" for result in same]
        parts += ["## Equal programs", "\n".join(lines)]
    if study.refusals:
        lines = [f"- {refusal.label}: {refusal.reason}" for refusal in study.refusals]
        parts += ["## Refused", "\n".join(lines)]
    notes = [f"- Note: {note}." for note in study.notes]
    parts += ["## Where", "\n".join([*notes, *(f"- {line}" for line in Machine.here().lines())])]
    return "\n\n".join(parts) + "\n"


def comma_separated(study: Study) -> str:
    """Return a study as CSV: a line for each variant and objective, with all digits of the figures."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*_CSV_COLUMNS, *tables.hard_kinds(study), "failed", "wrong", "same_as", "front"])
    for objective in OBJECTIVES:
        on_front = [confirmed.result.label for confirmed in study.pareto_fronts[objective]]
        for result in study.results:
            errors, times = result.errors[objective], result.times
            speed = [times[objective].median, times[objective].least] if times else ["", ""]
            figures = [errors.median, errors.p99, errors.max, errors.componentwise.max(), errors.bound_share]
            hardest = [found[objective].max for found in result.hard.values()]
            ends = [result.failed(objective), result.wrong, result.same_as or "", result.label in on_front]
            start = [result.label, objective, *speed, result.operations, result.size]
            writer.writerow([*start, *figures, *hardest, *ends])
    return text.getvalue()


def json_record(study: Study) -> str:
    """Return a study as JSON: every figure, the states in hexadecimal, and a description of the machine."""
    record = {
        "kanegen": __version__,
        "machine": Machine.here().lines(),
        "model": study.model,
        "freedoms": study.n,
        "notes": list(study.notes),
        "terms": asdict(study.options),
        "domain": study.domain.as_dict(),
        "recommendations": recommendations(study),
        "statements": statements(study),
        "variants": [_variant_record(result) for result in study.results],
        "refused": [asdict(refusal) for refusal in study.refusals],
        "fronts": {
            objective: [_confirmed_record(confirmed, objective) for confirmed in front]
            for objective, front in study.pareto_fronts.items()
        },
        "simulation": {
            "seconds": study.duration,
            "runs": [{**asdict(run), "error": _finite(run.error)} for run in study.runs],
        },
    }
    return json.dumps(record, indent=2) + "\n"


def _method(study: Study) -> str:
    """Return the paragraphs that explain the figures of a study."""
    distance, kinds = study.domain.clearance, [f"*{name}*" for name in tables.hard_kinds(study)]
    columns = " and ".join(part for part in (", ".join(kinds[:-1]), *kinds[-1:]) if part)
    text = _METHOD.format(
        options=study.options,
        clearance=f" that keeps the distance {distance:g} from gimbal lock" if distance else "",
        hard=f"The columns {columns} each hold" if len(kinds) > 1 else f"The column {columns} holds",
        factor=FACTOR,
        gate=LARGEST_BACKWARD_ERROR,
        ranked_by=_RANKED_BY[study.options.quantile],
        tie=100 * TIE,
    )
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in text.split("\n\n"))


def _variant_record(result: VariantResult) -> dict[str, Any]:
    """Return the result of one variant as plain data."""
    return {
        "variant": result.label,
        "choices": dict(result.candidate.variant.choices()),
        "speeds": result.candidate.speeds,
        "coordinates": result.candidate.coordinates,
        "operations": result.operations,
        "bytes": result.size,
        "wrong": result.wrong,
        "same_as": result.same_as,
        "errors": {objective: _errors_record(errors) for objective, errors in result.errors.items()},
        "hard": {
            kind: {objective: _errors_record(errors) for objective, errors in found.items()}
            for kind, found in result.hard.items()
        },
        "nanoseconds": _times_record(result.times),
    }


def _confirmed_record(confirmed: ConfirmedVariant, objective: str) -> dict[str, Any]:
    """Return a variant on a Pareto front as plain data."""
    return {
        "variant": confirmed.result.label,
        "errors": _errors_record(confirmed.errors),
        "nanoseconds": list(confirmed.times[objective].rounds),
        "found_by_search": _finite(confirmed.found),
        "proven": _finite(confirmed.proven),
        "worst_state": {name: [number.hex() for number in row] for name, row in confirmed.state.items()},
        "stays": confirmed.stays,
    }


def _times_record(times: Mapping[str, Times] | None) -> dict[str, list[float]] | None:
    """Return the times of all rounds (ns) by objective; None if the variant is not timed."""
    return None if times is None else {objective: list(found.rounds) for objective, found in times.items()}


def _errors_record(errors: Measurement) -> dict[str, Any]:
    """Return the quantiles of the errors and the numbers of failed and wrong results."""
    figures = {
        "median": errors.median,
        "p99": errors.p99,
        "max": errors.max,
        "componentwise": float(errors.componentwise.max()),
        "of_bound": errors.bound_share,
        "backward": float(errors.backward.max()),
    }
    counts = {"states": len(errors), "failed": int(errors.failed.sum()), "wrong": int(errors.wrong.sum())}
    return {name: _finite(value) for name, value in figures.items()} | counts


def _finite(value: float) -> float | None:
    """Return a finite number as it is and any other number as None, because JSON has no infinity."""
    return value if math.isfinite(value) else None
