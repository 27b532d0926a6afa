"""The statements of a certificate that can be derived again, from its request, model, domain and variant.

`certification` writes them, and `verification` derives them again and compares. Beside them a certificate
holds measurements of its machine, which `certification` adds: the compiler, the times, and what became of the
other variants.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from kanegen.errors import CertificateError, OptionError
from kanegen.measure.errors import QUANTILES, quantile
from kanegen.options import TIERS
from kanegen.studies.budget.budget_evaluator import BudgetEvaluator
from kanegen.studies.budget.certificate import (
    DIGEST_STATES,
    results_digest,
    source_digests,
    variant_table,
)
from kanegen.studies.budget.confirmation import Confirmation, fresh_sample
from kanegen.studies.budget.counterexample import conditioning_ranges
from kanegen.studies.budget.proofs import PROVEN, proof, proof_words
from kanegen.studies.budget.request import METRICS, SOLUTION, TERMS, UNITS_OF_ENTRIES, Effort, Request
from kanegen.studies.budget.sampling import state_table
from kanegen.studies.tradeoff.exact_results import OUTPUT
from kanegen.studies.tradeoff.variants import Candidate

_YARDSTICKS = {
    TERMS: "relative to the terms",
    SOLUTION: "relative to the solution",
    UNITS_OF_ENTRIES: "in rad/s^2 and m/s^2",
}
"""Yardsticks of errors in words."""


def statements(
    text: str, evaluator: BudgetEvaluator, request: Request, found: Confirmation[Candidate], seed: int
) -> dict[str, Any]:
    """Return the statements on a candidate as plain data, section by section.

    Args:
        text: Content of the model file, before values of run-time parameters are put in.
        evaluator: The evaluator that measured the candidate.
        request: The request of the user.
        found: The measurements of the candidate.
        seed: Seed of all samples.
    """
    library = evaluator.library(found.candidate)
    source, validation = library.source, found.validation
    proven = proof(evaluator, request, found)
    claim = {
        "error": validation.claim,
        "relative_to": request.relative_to,
        "metric": METRICS[request.relative_to],
        "evidence": proven["kind"],
        "objective": request.objective,
        "quantile": "max" if request.is_strict else request.quantile,
        "exceeded_by_less_than": validation.limit,
        "confidence": request.confidence,
    }
    measured = {
        "validation": _validation(evaluator, request, found),
        "search": _search(found),
        "proof": proven,
    }
    return {
        "claim": {**claim, "words": claim_words(claim, **measured)},
        "not_claimed": _not_claimed(found.candidate, proven["kind"]),
        "request": {**asdict(request), "seed": seed},
        "model": {"name": source.model.shown, "text": text},
        "domain": evaluator.region.as_table(),
        "output": OUTPUT,
        "variant": variant_table(source.variant),
        "flags": list(source.variant.flags),
        "source": source_digests(source),
        **measured,
        "bits": {
            "states": DIGEST_STATES,
            "sha256": results_digest(evaluator.region, library, request.objective, seed),
        },
    }


def claim_words(
    claim: Mapping[str, Any],
    validation: Mapping[str, Any],
    search: Mapping[str, Any],
    proof: Mapping[str, Any],
) -> str:
    """Return the claim of a certificate as a sentence, from the sections of the certificate."""
    largest, bound = search["worst"]["error"], claim["error"]
    found = "no counterexample" if largest <= bound else f"an error of {largest:.3g}"
    return (
        f"error at most {bound:.3g} {_YARDSTICKS[claim['relative_to']]}: exceeded in "
        f"{validation['exceeded']} of {validation['states']} fresh states, so in less than "
        f"{100 * claim['exceeded_by_less_than']:.2g} % of the domain with {100 * claim['confidence']:g} % "
        f"confidence; {found} found in {search['evaluations']} evaluations of a search; "
        f"{proof_words(proof)}"
    )


def request_from_table(table: Mapping[str, Any]) -> tuple[Request, int]:
    """Return the request and the seed of the section "request".

    Raises:
        CertificateError: If the section is no request.
    """
    try:
        terms = dict(table)
        seed, effort = int(terms.pop("seed")), Effort(**terms.pop("effort"))
        request = Request(**terms, effort=effort)
    except (AttributeError, KeyError, TypeError, ValueError, OverflowError, OptionError) as error:
        raise CertificateError(f"its request is none: {error}") from None
    if seed < 0:
        raise CertificateError(f"its request is none: seed is {seed}; it must not be negative.")
    return request, seed


def _not_claimed(candidate: Candidate, kind: str) -> list[str]:
    """Return the section "not_claimed": statements that a reader must not infer from a certificate.

    Args:
        candidate: The variant.
        kind: The kind of evidence of the claim; a proof covers every state of the domain.
    """
    others = [name for name, variant in TIERS.items() if variant != candidate.variant]
    untried = [
        "an upper bound on the error in every state of the domain",
        "states whose numbers need more than single precision; all that were tried have that",
    ]
    beyond = [
        *(untried if kind != PROVEN else ()),
        "states outside the domain, and other values of run-time parameters",
        "the error of trajectories, and of other outputs",
        "times on other machines, and with loads or run-time parameters",
    ]
    return [*beyond, *(f"the promise of the tier {name!r}" for name in others)]


def _validation(
    evaluator: BudgetEvaluator, request: Request, confirmed: Confirmation[Candidate]
) -> dict[str, Any]:
    """Return the section "validation" of a certificate."""
    found = confirmed.validation
    sample = evaluator.sample(fresh_sample(request, found.attempt))
    place = int(np.argmax(found.errors))
    return {
        "states": len(found.errors),
        "alpha": request.alpha,
        "attempts": {"made": found.attempt, "allowed": request.attempts},
        "exceeded": found.exceeded,
        "errors": {name: quantile(found.errors, share) for name, share in QUANTILES.items()},
        "worst": {"error": float(found.errors[place]), "state": state_table(sample[place : place + 1])},
        **conditioning_ranges(evaluator.exact, sample),
        "states_to_choose_by": {"states": request.effort.select, "error": confirmed.error},
    }


def _search(found: Confirmation[Candidate]) -> dict[str, Any]:
    """Return the section "search" of a certificate."""
    worst = found.worst
    return {
        "evaluations": found.evaluations,
        "worst": {"error": worst.error, "state": dict(worst.state)},
        "about_it": worst.explanation,
    }
