"""A study in words and tables. Only the times differ from run to run."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from kanegen import __version__
from kanegen.measure import machine
from kanegen.measure.timing import OBJECTIVES, Times
from kanegen.measure.truth.bounds import FACTOR
from kanegen.measure.truth.errors import GATE
from kanegen.measure.truth.measurement import Measurement
from kanegen.studies.markdown import markdown_table
from kanegen.studies.tradeoff.outcome import Confirmed, Entry, Study
from kanegen.studies.tradeoff.pareto_front import TIE
from kanegen.studies.tradeoff.tables import (
    FRESH,
    SIMULATION,
    SIMULATION_TEXTS,
    TITLES,
    fresh_rows,
    head,
    plain,
    rows,
    simulation_method,
    simulation_rows,
    strata,
)

_CONCERNS = {
    "max": "the largest error of the sample counts",
    "p99": "the error that 99 % of the states do not exceed counts",
    "median": "the median error counts",
}
"""What a front is about."""

_COLUMNS = (
    *("variant", "objective", "nanoseconds", "least", "operations", "bytes"),
    *("median", "p99", "max", "componentwise", "of_bound"),
)
"""Of the CSV, before those of strata."""


def statements(study: Study) -> list[str]:
    """What is to be said beside the tables, a line each."""
    lines = [f"{TITLES[objective].capitalize()}: {study.verdict(objective)}" for objective in OBJECTIVES]
    rho = [f"{TITLES[o]} {plain(study.rank_correlation(o))}" for o in OBJECTIVES]
    lines.append(f"Spearman's rank correlation of operation counts and measured times: {', '.join(rho)}.")
    wrong = [entry.label for entry in study.entries if entry.wrong]
    if wrong:
        lines.append(
            f"Wrong, and not timed, because no rounding explains their backward errors: {'; '.join(wrong)}."
        )
    return lines


def markdown(study: Study) -> str:
    """The whole report."""
    parts = [
        f"# Speed against accuracy: {study.model}",
        f"{study.n} freedoms, {len(study.entries)} variants, {len(study.refusals)} refused.",
        "\n".join(f"- {line}" for line in statements(study)),
        "![Work and precision](tradeoff.svg)",
        "## How",
        _method(study),
    ]
    for objective in OBJECTIVES:
        parts += [
            f"## Front, {TITLES[objective]}",
            markdown_table(FRESH, fresh_rows(study, objective)),
            f"## All variants, {TITLES[objective]}",
            markdown_table(head(study), rows(study, objective)),
        ]
    if study.runs:
        picture = "![Simulations](tradeoff-simulation.svg)"
        parts += [
            "## Simulation",
            simulation_method(study),
            picture,
            markdown_table(SIMULATION, simulation_rows(study), SIMULATION_TEXTS),
        ]
    same = [entry for entry in study.entries if entry.same_as]
    if same:
        lines = [f"- {entry.label}: the same program as {entry.same_as}" for entry in same]
        parts += ["## Equal programs", "\n".join(lines)]
    if study.refusals:
        lines = [f"- {refusal.label}: {refusal.reason}" for refusal in study.refusals]
        parts += ["## Refused", "\n".join(lines)]
    notes = [f"- Note: {note}." for note in study.notes]
    parts += ["## Where", "\n".join([*notes, *(f"- {line}" for line in machine.description())])]
    return "\n\n".join(parts) + "\n"


def comma_separated(study: Study) -> str:
    """A line for each variant and objective, all figures in full."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*_COLUMNS, *strata(study), "failed", "wrong", "same_as", "front"])
    for objective in OBJECTIVES:
        on_front = [confirmed.entry.label for confirmed in study.fronts[objective]]
        for entry in study.entries:
            errors, times = entry.errors[objective], entry.times
            speed = [times[objective].median, times[objective].least] if times else ["", ""]
            figures = [errors.median, errors.p99, errors.max, errors.componentwise.max(), errors.bound_share]
            hardest = [found[objective].max for found in entry.hard.values()]
            ends = [entry.failed(objective), entry.wrong, entry.same_as or "", entry.label in on_front]
            start = [entry.label, objective, *speed, entry.operations, entry.size]
            writer.writerow([*start, *figures, *hardest, *ends])
    return text.getvalue()


_METHOD = """
Errors are those of {{ydot}}, normwise after unit scaling, against certified truth, in {terms.states} states
drawn uniformly from a box{beside}; `tradeoff.json` has its ranges. States are rounded to single precision, so
that every variant solves the same problem; with other generalized speeds they are the same physical states. A
state without a finite result counts as an infinite error. Under {hard} stand the largest errors in
{terms.hard} states each that were drawn to be hard. *of bound* is the largest error over
u chi formation (4 N + kappa_s), of which {factor:g} is promised; u is the unit roundoff or, where that is
larger, the error of the variant's sine and cosine. A result whose backward error exceeds {gate:g} N u is
wrong, not inaccurate.

*ns* are medians over {terms.rounds} rounds of {terms.seconds:g} s, *least* the fastest ones; each round gives
every variant a turn in a process of its own, with a fresh copy of the library whose errors were measured.
*ops* are operations of one evaluation. On a front {concern}, and times that differ by less than {tie:g} %
count as equal. Its variants were measured again, in fresh states and other processes: *stays* says who is
still on the front. {terms.search} states were tried to find an error larger than the fresh ones; *found* is
the largest. All samples have the seed {terms.seed}.
"""


def _method(study: Study) -> str:
    clearance = study.domain.clearance
    text = _METHOD.format(
        terms=study.terms,
        beside=f", which stays {clearance:g} clear of gimbal lock" if clearance else "",
        hard=" and ".join(f"*{name}*" for name in strata(study)),
        factor=FACTOR,
        gate=GATE,
        concern=_CONCERNS[study.terms.quantile],
        tie=100 * TIE,
    )
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in text.split("\n\n"))


def json_record(study: Study) -> str:
    """Everything as JSON, with the machine's description."""
    facts = {
        "kanegen": __version__,
        "machine": machine.description(),
        "model": study.model,
        "freedoms": study.n,
        "notes": list(study.notes),
        "terms": asdict(study.terms),
        "domain": study.domain.as_dict(),
        "statements": statements(study),
        "variants": [_entry_record(entry) for entry in study.entries],
        "refused": [asdict(refusal) for refusal in study.refusals],
        "fronts": {
            objective: [_confirmed_record(confirmed, objective) for confirmed in front]
            for objective, front in study.fronts.items()
        },
        "simulation": {
            "seconds": study.duration,
            "runs": [{**asdict(run), "error": _finite(run.error)} for run in study.runs],
        },
    }
    return json.dumps(facts, indent=2) + "\n"


def _entry_record(entry: Entry) -> dict[str, Any]:
    return {
        "variant": entry.label,
        "choices": dict(entry.candidate.variant.described()),
        "speeds": entry.candidate.speeds,
        "coordinates": entry.candidate.coordinates,
        "operations": entry.operations,
        "bytes": entry.size,
        "wrong": entry.wrong,
        "same_as": entry.same_as,
        "errors": {objective: _errors_record(errors) for objective, errors in entry.errors.items()},
        "hard": {
            stratum: {objective: _errors_record(errors) for objective, errors in found.items()}
            for stratum, found in entry.hard.items()
        },
        "nanoseconds": _nanoseconds(entry.times),
    }


def _confirmed_record(confirmed: Confirmed, objective: str) -> dict[str, Any]:
    return {
        "variant": confirmed.entry.label,
        "errors": _errors_record(confirmed.errors),
        "nanoseconds": list(confirmed.times[objective].rounds),
        "found_by_search": _finite(confirmed.found),
        "worst_state": {name: [number.hex() for number in row] for name, row in confirmed.state.items()},
        "stays": confirmed.stays,
    }


def _nanoseconds(times: Mapping[str, Times] | None) -> dict[str, list[float]] | None:
    return None if times is None else {objective: list(found.rounds) for objective, found in times.items()}


def _errors_record(errors: Measurement) -> dict[str, Any]:
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
    """JSON has no infinity."""
    return value if math.isfinite(value) else None
