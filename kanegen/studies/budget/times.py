"""The section "times" of a certificate, and whether its numbers agree with each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

from kanegen.measure.timing import Speedup, Times
from kanegen.studies.budget.differences import differences
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.selection import Choice
from kanegen.studies.tradeoff.variants import Candidate


def times_table(request: Request, choice: Choice[Candidate]) -> dict[str, Any]:
    """Return the section "times" of a certificate (ns)."""
    gain = None if choice.gain is None else asdict(choice.gain)
    return _table(request, choice.times, choice.reference.label, gain)


def inconsistency(times: Any, candidates: Any, request: Request, label: str) -> str:
    """Return why the numbers of a section "times" cannot be right, "" if they may be.

    Times cannot be derived, but the median and the least one follow from the rounds, there are as many rounds
    as were requested, and the median keeps a budget of time.

    Args:
        times: The section "times".
        candidates: The section "candidates", what became of each variant by its label.
        request: The request of the certificate.
        label: Label of the chosen variant.
    """
    try:
        rounds = Times(tuple(float(value) for value in times["rounds"]))
        compared, gain = times["compared_with"], times["times_as_fast"]
        expected = _table(request, rounds, compared, gain)
        is_known = compared in candidates and label in candidates
    except (KeyError, TypeError, ValueError, IndexError, AttributeError):
        return "it is no record of times"
    found = next(differences("times", times, expected), "")
    if found:
        return found
    if len(rounds.rounds) != request.effort.rounds or not rounds.least > 0:
        return f"times.rounds are no {request.effort.rounds} times"
    if not is_known:
        return "times.compared_with, or the variant itself, is none of the candidates"
    if gain is not None and (compared == label or set(gain) != {field.name for field in fields(Speedup)}):
        return "times.times_as_fast compares nothing"
    if request.time is not None and not rounds.median <= request.time:
        return f"times.median exceeds the budget of {request.time:.4g} ns"
    return ""


def _table(request: Request, times: Times, compared_with: str, gain: Any) -> dict[str, Any]:
    """Return the section "times" from its parts."""
    return {
        "objective": request.objective,
        "unit": "ns",
        "median": times.median,
        "least": times.least,
        "rounds": list(times.rounds),
        "compared_with": compared_with,
        "times_as_fast": dict(gain) if isinstance(gain, Mapping) else None,
    }
