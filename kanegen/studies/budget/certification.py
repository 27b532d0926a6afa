"""From a request to C with its certificate: the search for the variant, and the record of its result."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from kanegen import __version__
from kanegen.artifacts import with_artifacts
from kanegen.artifacts.certificate import SUFFIX
from kanegen.c import Source
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, quiet
from kanegen.studies.budget.budget_evaluator import BudgetEvaluator, allowed_candidates
from kanegen.studies.budget.certificate import FORMAT, KIND, Certificate, built_with, model_text
from kanegen.studies.budget.region import Region, require_no_gimbal_lock
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.selection import Choice, choose
from kanegen.studies.budget.statements import statements
from kanegen.studies.budget.times import times_table
from kanegen.studies.tradeoff.compilation import generate_variant
from kanegen.studies.tradeoff.variants import Candidate


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
    return {*generate_variant(model, Candidate(STRICT)).files, f"{model.identifier}{SUFFIX}"}


def _certified_source(
    model: System, evaluator: BudgetEvaluator, request: Request, choice: Choice[Candidate], seed: int
) -> CertifiedSource:
    """Return the C of the chosen variant with its certificate."""
    source = evaluator.library(choice.candidate).source
    content = {
        "kind": KIND,
        "format": FORMAT,
        "generator": __version__,
        **statements(model_text(model), evaluator, request, choice, seed),
        "built_with": built_with(),
        "times": times_table(request, choice),
        "candidates": choice.verdicts,
    }
    certificate = Certificate(content)
    source = with_artifacts(replace(source, certificate=content), ["certificate"])
    return CertifiedSource(source, certificate, request, choice)
