"""A study as JSON: every figure, the states in hexadecimal."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import Any

from kanegen import __version__
from kanegen.measure import machine
from kanegen.studies.tradeoff.document import statements
from kanegen.studies.tradeoff.errors import Errors
from kanegen.studies.tradeoff.outcome import Confirmed, Entry, Study


def record(study: Study) -> str:
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
        "variants": [_entry(entry) for entry in study.entries],
        "refused": [asdict(refusal) for refusal in study.refusals],
        "fronts": {
            objective: [_confirmed(confirmed, objective) for confirmed in front]
            for objective, front in study.fronts.items()
        },
        "simulation": {
            "seconds": study.duration,
            "runs": [{**asdict(run), "error": _finite(run.error)} for run in study.runs],
        },
    }
    return json.dumps(facts, indent=2) + "\n"


def _entry(entry: Entry) -> dict[str, Any]:
    return {
        "variant": entry.label,
        "choices": dict(entry.candidate.variant.described()),
        "speeds": entry.candidate.speeds,
        "coordinates": entry.candidate.coordinates,
        "operations": entry.operations,
        "bytes": entry.size,
        "wrong": entry.wrong,
        "same_as": entry.same_as,
        "errors": {objective: _errors(errors) for objective, errors in entry.errors.items()},
        "hard": {
            stratum: {objective: _errors(errors) for objective, errors in found.items()}
            for stratum, found in entry.hard.items()
        },
        "nanoseconds": None if entry.times is None else asdict(entry.times),
    }


def _confirmed(confirmed: Confirmed, objective: str) -> dict[str, Any]:
    return {
        "variant": confirmed.entry.label,
        "errors": _errors(confirmed.errors),
        "nanoseconds": list(confirmed.times.of(objective)),
        "found_by_search": _finite(confirmed.found),
        "worst_state": {name: [number.hex() for number in row] for name, row in confirmed.state.items()},
        "stays": confirmed.stays,
    }


def _errors(errors: Errors) -> dict[str, Any]:
    figures = {
        "median": errors.median,
        "p99": errors.high,
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
