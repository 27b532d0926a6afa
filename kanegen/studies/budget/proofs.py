"""Proofs beside samples: what is proven of a claim, for the whole domain or state by state.

- *proven*: `kanegen.measure.bounds` bounds the error of the very program in every state of the domain, and
  the bound keeps the claim. It speaks of entries of {ydot} in their units, and so must the claim.
- *proven by state*: the output `error_bound` bounds the error of given accelerations in one state. The claim
  counts as proven by state if this bound keeps it in every fresh state of the validation. Then a program that
  calls `error_bound` has a proof in each of its own states, or a number that says why not.
- *sampled*: neither. Errors were measured against certified truth in the tried states, and in no others.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import KanegenError
from kanegen.measure.bounds.domain import box_from_table
from kanegen.measure.bounds.source import bound_source
from kanegen.model.arrays import Floats
from kanegen.studies.budget.budget_evaluator import BudgetEvaluator
from kanegen.studies.budget.confirmation import Confirmation, fresh_sample
from kanegen.studies.budget.request import TERMS, UNITS_OF_ENTRIES, Request
from kanegen.studies.tradeoff.domain import Sample
from kanegen.studies.tradeoff.exact_results import OUTPUT, ExactResults, compute_accelerations
from kanegen.studies.tradeoff.state_bounds import entry_bounds, normwise_bounds
from kanegen.studies.tradeoff.variants import Candidate

SAMPLED, BY_STATE, PROVEN = "sampled", "proven by state", "proven"
"""The kinds of evidence of a claim."""


def proof(evaluator: BudgetEvaluator, request: Request, found: Confirmation[Candidate]) -> dict[str, Any]:
    """Return the section "proof" of a certificate.

    Args:
        evaluator: The evaluator that measured the candidate.
        request: The request of the user.
        found: The measurements of the candidate.
    """
    claim = found.validation.claim
    sample = evaluator.sample(fresh_sample(request, found.validation.attempt))
    values = compute_accelerations(evaluator.library(found.candidate), sample, request.objective)
    bounds = bounds_by_state(evaluator.exact, sample, values, request.relative_to)
    kept = int(np.sum(bounds <= claim))
    known = bounds[np.isfinite(bounds)]
    by_state = {
        "states": len(bounds),
        "kept": kept,
        "median_bound": float(np.median(known)) if known.size else None,
    }
    everywhere, reason = bound_over_domain(evaluator, request, found.candidate)
    kind = PROVEN if everywhere <= claim else BY_STATE if kept == len(bounds) else SAMPLED
    domain = {"bound": everywhere if everywhere < math.inf else None, "no_bound_because": reason}
    return {"kind": kind, "domain": domain, "by_state": by_state}


def bound_over_domain(
    evaluator: BudgetEvaluator, request: Request, candidate: Candidate
) -> tuple[float, str]:
    """Return a proven bound on the error in every state of the domain, and why there is none.

    The bound is infinite where there is none. The states that a domain excludes for their cancellation are
    covered as well.
    """
    if request.relative_to != UNITS_OF_ENTRIES:
        return math.inf, "only errors in units are bounded over a domain"
    region = evaluator.region
    table = {name: part for name, part in region.as_table().items() if part}
    table["exclude"] = {"clearance": region.domain.clearance}
    try:
        box = box_from_table(region.system, table)
        found = bound_source(evaluator.library(candidate).source, box)
    except KanegenError as error:
        return math.inf, str(error)
    return found.largest[OUTPUT], found.unbounded.get(OUTPUT, "")


def bounds_by_state(exact: ExactResults, sample: Sample, values: NDArray[Any], relative_to: str) -> Floats:
    """Return (B,) proven bounds on the errors of accelerations; infinite where there is none.

    Args:
        exact: Exact results of the system, for the yardsticks.
        sample: The B states.
        values: (B, n) accelerations {ydot} from any program.
        relative_to: The yardstick, one of `request.METRICS`.
    """
    if relative_to == UNITS_OF_ENTRIES:
        largest: Floats = entry_bounds(exact.system, sample, values).max(axis=1)
        return largest
    return normwise_bounds(exact, sample, values, relative_to == TERMS)


def proof_words(proof: Mapping[str, Any]) -> str:
    """Return the clause of a claim that names its kind of evidence, from the section "proof"."""
    by_state = proof["by_state"]
    if proof["kind"] == PROVEN:
        return f"proven: at most {proof['domain']['bound']:.3g} in every state of the domain"
    if proof["kind"] == SAMPLED:
        if not by_state["kept"]:
            return "sampled: errors were measured in the tried states, and not proven for others"
        return (
            "sampled: the output error_bound proves an error of at most this in "
            f"{by_state['kept']} of the {by_state['states']} fresh states"
        )
    return "proven by state: the output error_bound proves it in every one of these fresh states"
