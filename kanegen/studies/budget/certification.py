"""From a request to C with its certificate: the search for the variant, and the record of its result."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from kanegen import __version__
from kanegen.artifacts import with_artifacts
from kanegen.artifacts.certificate import SUFFIX
from kanegen.c import Source
from kanegen.measure.errors import QUANTILES, quantile
from kanegen.model.system import System
from kanegen.options import STRICT, TIERS, Progress, quiet
from kanegen.studies.budget.budget_evaluator import BudgetEvaluator, allowed_candidates
from kanegen.studies.budget.certificate import (
    DIGEST_STATES,
    FORMAT,
    KIND,
    Certificate,
    built_with,
    model_text,
    results_digest,
    source_digests,
    variant_table,
)
from kanegen.studies.budget.counterexample import conditioning_ranges
from kanegen.studies.budget.evaluator import VALIDATE, SampleSpec
from kanegen.studies.budget.region import Region, require_no_gimbal_lock
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.sampling import state_table
from kanegen.studies.budget.selection import Choice, choose
from kanegen.studies.tradeoff.compilation import generate_variant
from kanegen.studies.tradeoff.exact_results import OUTPUT
from kanegen.studies.tradeoff.variants import Candidate

METRIC = "normwise relative error of {ydot} after unit scaling, against certified truth"
"""The error that a certificate speaks of, in words."""


@dataclass(frozen=True)
class CertifiedSource:
    """C that keeps a budget, and its certificate.

    Attributes:
        source: The C, with the certificate among its files.
        certificate: The certificate as data.
        request: The request of the user.
        choice: The chosen variant with its measurements.
    """

    source: Source
    certificate: Certificate
    request: Request
    choice: Choice[Candidate]


def certify_variant(
    model: System,
    region: Region,
    request: Request,
    candidates: Iterable[Candidate] | None = None,
    seed: int = 0,
    progress: Progress = quiet,
) -> CertifiedSource:
    """Return C for the forward dynamics of a model that keeps a budget, with a certificate.

    Args:
        model: The model, before values of run-time parameters are put in.
        region: The states of this model for which the budget is kept.
        request: The budget and its conditions.
        candidates: The variants to choose from, the default first; by default those of `tradeoff.variants`.
        seed: Seed of all samples; the same seed gives the same states.
        progress: Function that is called with the name of each stage.

    Raises:
        BudgetError: If no variant keeps the budget; the message names the nearest candidate.
        BuildError: If there is no C compiler.
        OptionError: If [A] is singular somewhere in the region; the message names the range to exclude.

    Example:
        >>> region = read_region("x.angles = [-1, 1]", system)
        >>> found = certify_variant(system, region, Request(error=1e-9))
        >>> found.source.write("build/")
    """
    require_no_gimbal_lock(region)
    allowed = tuple(candidates or allowed_candidates())
    evaluator = BudgetEvaluator(region, request, allowed, seed, progress)
    choice = choose(evaluator, request)
    progress("writing the certificate")
    return _certified_source(model, evaluator, request, choice, seed)


def certified_file_names(model: System) -> set[str]:
    """Return the names of the files that `certify_variant` makes, to check a folder before the search.

    Raises:
        ModelError, SingularError: As `kanegen.generate`.
    """
    return {*generate_variant(model, Candidate(STRICT)).files, f"{model.name}{SUFFIX}"}


def claim_sentence(request: Request, choice: Choice[Candidate]) -> str:
    """Return the claim of a certificate as a sentence."""
    validation, count = choice.validation, len(choice.validation.errors)
    tried = sum(search.evaluations for search in choice.searches)
    largest = max(search.error for search in choice.searches)
    found = "no counterexample" if largest <= validation.claim else f"an error of {largest:.3g}"
    return (
        f"error at most {validation.claim:.3g}: exceeded in {validation.exceeded} of {count} fresh states, "
        f"so in less than {100 * validation.limit:.2g} % of the domain with {100 * request.confidence:g} % "
        f"confidence; {found} found in {tried} evaluations of a search"
    )


def _certified_source(
    model: System, evaluator: BudgetEvaluator, request: Request, choice: Choice[Candidate], seed: int
) -> CertifiedSource:
    """Return the C of the chosen variant with its certificate."""
    library = evaluator.library(choice.candidate)
    source = library.source
    content = {
        "kind": KIND,
        "format": FORMAT,
        "generator": __version__,
        "claim": _claim(request, choice),
        "not_claimed": _not_claimed(choice.candidate),
        "request": _request(request, seed),
        "model": {"name": model.name, "text": model_text(model)},
        "domain": evaluator.region.as_table(),
        "output": OUTPUT,
        "variant": variant_table(source.variant),
        "source": source_digests(source),
        "built_with": built_with(source),
        "validation": _validation(evaluator, request, choice),
        "search": _search(choice),
        "times": _times(request, choice),
        "bits": {
            "states": DIGEST_STATES,
            "sha256": results_digest(evaluator.region, library, request.objective, seed),
        },
        "candidates": choice.verdicts,
    }
    certificate = Certificate(content)
    source = with_artifacts(replace(source, certificate=content), ["certificate"])
    return CertifiedSource(source, certificate, request, choice)


def _claim(request: Request, choice: Choice[Candidate]) -> dict[str, Any]:
    """Return the section "claim" of a certificate."""
    validation = choice.validation
    return {
        "error": validation.claim,
        "metric": METRIC,
        "objective": request.objective,
        "quantile": "max" if request.is_strict else request.quantile,
        "exceeded_by_less_than": validation.limit,
        "confidence": request.confidence,
        "words": claim_sentence(request, choice),
    }


def _not_claimed(candidate: Candidate) -> list[str]:
    """Return the section "not_claimed": statements that a reader must not infer from a certificate."""
    others = [name for name, variant in TIERS.items() if variant != candidate.variant]
    beyond = [
        "an upper bound on the error in every state of the domain",
        "states outside the domain, and other values of run-time parameters",
        "states whose numbers need more than single precision; all that were tried have that",
        "the error of trajectories, and of other outputs",
        "times on other machines, and with loads or run-time parameters",
    ]
    return [*beyond, *(f"the promise of the tier {name!r}" for name in others)]


def _request(request: Request, seed: int) -> dict[str, Any]:
    """Return the section "request" of a certificate; the searches have the key "attack" there."""
    table = asdict(request)
    effort = {"attack" if name == "search" else name: value for name, value in table["effort"].items()}
    return {**table, "effort": effort, "seed": seed}


def _validation(evaluator: BudgetEvaluator, request: Request, choice: Choice[Candidate]) -> dict[str, Any]:
    """Return the section "validation" of a certificate."""
    found = choice.validation
    sample = evaluator.sample(SampleSpec(VALIDATE, found.attempt, request.fresh_states))
    place = int(np.argmax(found.errors))
    return {
        "states": len(found.errors),
        "alpha": request.alpha,
        "attempts": {"made": found.attempt, "allowed": request.attempts},
        "exceeded": found.exceeded,
        "errors": {name: quantile(found.errors, share) for name, share in QUANTILES.items()},
        "worst": {"error": float(found.errors[place]), "state": state_table(sample[place : place + 1])},
        **conditioning_ranges(evaluator.exact, sample),
        "states_to_choose_by": {"states": request.effort.select, "error": choice.error},
    }


def _search(choice: Choice[Candidate]) -> dict[str, Any]:
    """Return the section "search" of a certificate."""
    worst = max(choice.searches, key=lambda search: search.error)
    return {
        "evaluations": sum(search.evaluations for search in choice.searches),
        "worst": {"error": worst.error, "state": dict(worst.state)},
        "about_it": worst.explanation,
    }


def _times(request: Request, choice: Choice[Candidate]) -> dict[str, Any]:
    """Return the section "times" of a certificate."""
    return {
        "objective": request.objective,
        "unit": "ns",
        "median": choice.times.median,
        "least": choice.times.least,
        "rounds": list(choice.times.rounds),
        "compared_with": choice.reference.label,
        "times_as_fast": None if choice.gain is None else asdict(choice.gain),
    }
