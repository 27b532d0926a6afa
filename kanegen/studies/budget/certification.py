"""The outcome of a search as C with its certificate."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from kanegen import __version__
from kanegen.c import Source
from kanegen.compiler import Progress, quiet
from kanegen.measure.errors import QUANTILES, quantile
from kanegen.model.system import System
from kanegen.options import STRICT, TIERS
from kanegen.studies.budget.certificate import (
    BITS,
    FORMAT,
    KIND,
    SUFFIX,
    Certificate,
    bits,
    built_with,
    hashes,
    model_text,
    variant_table,
)
from kanegen.studies.budget.counterexample import conditioning_ranges
from kanegen.studies.budget.evaluator import VALIDATE, Draw
from kanegen.studies.budget.region import Region, require_clear
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.sampling import state_table
from kanegen.studies.budget.selection import Choice, choose
from kanegen.studies.budget.variant_evaluator import Workbench, field_of
from kanegen.studies.tradeoff.compilation import generate_variant
from kanegen.studies.tradeoff.judge import OUTPUT
from kanegen.studies.tradeoff.variants import Candidate

METRIC = "normwise relative error of {ydot} after unit scaling, against certified truth"


@dataclass(frozen=True)
class Certified:
    """C and its certificate.

    Attributes:
        source: The C, the certificate among its files.
        certificate: The same as data.
        request: What was asked for.
        choice: What was found.
    """

    source: Source
    certificate: Certificate
    request: Request
    choice: Choice[Candidate]


def certified(
    model: System, bench: Workbench, request: Request, choice: Choice[Candidate], seed: int
) -> Certified:
    """The C of the chosen variant, and its certificate.

    Args:
        model: The system as it was given, before values of parameters were put in.
        bench: Where the choice was made.
        request: What was asked for.
        choice: The outcome.
        seed: Of all samples.
    """
    library = bench.library(choice.candidate)
    source = library.source
    content = {
        "kind": KIND,
        "format": FORMAT,
        "generator": __version__,
        "claim": _claim(request, choice),
        "not_claimed": not_claimed(choice.candidate),
        "request": _request(request, seed),
        "model": {"name": model.name, "text": model_text(model)},
        "domain": bench.region.as_table(),
        "output": OUTPUT,
        "variant": variant_table(source.variant),
        "source": hashes(source),
        "built_with": built_with(source),
        "validation": _validation(bench, request, choice),
        "search": _search(choice),
        "times": _times(request, choice),
        "bits": {
            "states": BITS,
            "sha256": bits(bench.region, library, request.objective, seed),
        },
        "candidates": choice.verdicts,
    }
    certificate = Certificate(content)
    name = f"{model.name}{SUFFIX}"
    files = {**source.files, name: certificate.text(name)}
    return Certified(replace(source, files=files), certificate, request, choice)


def not_claimed(candidate: Candidate) -> list[str]:
    """What a reader may not take from a certificate."""
    others = [name for name, variant in TIERS.items() if variant != candidate.variant]
    beyond = [
        "an upper bound on the error in every state of the domain",
        "states outside the domain, and other values of run-time parameters",
        "states whose numbers need more than single precision; all that were tried have that",
        "the error of trajectories, and of other outputs",
        "times on other machines, and with loads or run-time parameters",
    ]
    return [*beyond, *(f"the promise of the tier {name!r}" for name in others)]


def _claim(request: Request, choice: Choice[Candidate]) -> dict[str, Any]:
    seen = choice.validation
    return {
        "error": seen.claim,
        "metric": METRIC,
        "objective": request.objective,
        "quantile": "max" if request.is_strict else request.quantile,
        "exceeded_by_less_than": seen.limit,
        "confidence": request.confidence,
        "words": words(request, choice),
    }


def words(request: Request, choice: Choice[Candidate]) -> str:
    """What is claimed, in a sentence."""
    seen, count = choice.validation, len(choice.validation.errors)
    tried = sum(attack.evaluations for attack in choice.attacks)
    largest = max(attack.error for attack in choice.attacks)
    found = "no counterexample" if largest <= seen.claim else f"an error of {largest:.3g}"
    return (
        f"error at most {seen.claim:.3g}: exceeded in {seen.exceeded} of {count} fresh states, so in less "
        f"than {100 * seen.limit:.2g} % of the domain with {100 * request.confidence:g} % confidence; "
        f"{found} found in {tried} evaluations of a search"
    )


def _request(request: Request, seed: int) -> dict[str, Any]:
    return {**asdict(request), "seed": seed}


def _validation(bench: Workbench, request: Request, choice: Choice[Candidate]) -> dict[str, Any]:
    seen = choice.validation
    sample = bench.sample(Draw(VALIDATE, seen.attempt, request.draws))
    place = int(np.argmax(seen.errors))
    return {
        "states": len(seen.errors),
        "alpha": request.alpha,
        "attempts": {"made": seen.attempt, "allowed": request.attempts},
        "exceeded": seen.exceeded,
        "errors": {name: quantile(seen.errors, share) for name, share in QUANTILES.items()},
        "worst": {"error": float(seen.errors[place]), "state": state_table(sample[place : place + 1])},
        **conditioning_ranges(bench.judge, sample),
        "states_to_choose_by": {"states": request.effort.select, "error": choice.error},
    }


def _search(choice: Choice[Candidate]) -> dict[str, Any]:
    top = max(choice.attacks, key=lambda attack: attack.error)
    return {
        "evaluations": sum(attack.evaluations for attack in choice.attacks),
        "worst": {"error": top.error, "state": dict(top.where)},
        "about_it": top.cause,
    }


def _times(request: Request, choice: Choice[Candidate]) -> dict[str, Any]:
    gain = choice.gain
    return {
        "objective": request.objective,
        "unit": "ns",
        "median": choice.times.median,
        "least": choice.times.least,
        "rounds": list(choice.times.rounds),
        "compared_with": choice.reference.label,
        "times_as_fast": None if gain is None else asdict(gain),
    }


def find(
    model: System,
    region: Region,
    request: Request,
    field: Iterable[Candidate] | None = None,
    seed: int = 0,
    progress: Progress = quiet,
) -> Certified:
    """C for the forward dynamics of a model that keeps a budget, with a certificate.

    Args:
        model: The tree.
        region: The states that count, of this model.
        request: The budget and its terms.
        field: Candidates, the default first; by default those of the study.
        seed: Of all samples; the same one gives the same states.
        progress: Told the name of each stage.

    Raises:
        BudgetError: If no variant keeps the budget; says how far one gets and with which.
        BuildError: If there is no C compiler.
        OptionError: If [A] is singular somewhere in the region; names what to exclude.
    """
    require_clear(region)
    bench = Workbench(region, request, tuple(field or field_of()), seed, progress)
    choice = choose(bench, request)
    progress("writing the certificate")
    return certified(model, bench, request, choice, seed)


def file_names(model: System) -> set[str]:
    """Names of the files that come of a search, by which a folder can be tried beforehand.

    Raises:
        ModelError, SingularError: As `kanegen.generate`.
    """
    return {*generate_variant(model, Candidate(STRICT)).files, f"{model.name}{SUFFIX}"}
