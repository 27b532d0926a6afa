"""The evaluator of a budget study: it builds variants of a model, measures their errors and times them."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from kanegen.c.formats import formats
from kanegen.errors import OptionError
from kanegen.library import Library
from kanegen.measure.timing import Rounds, Times
from kanegen.measure.truth.measurement import Measurement
from kanegen.model.arrays import Floats
from kanegen.options import STRICT, Progress, quiet
from kanegen.studies.budget.counterexample import search_counterexample
from kanegen.studies.budget.evaluator import SampleSpec, SearchResult
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.request import SOLUTION, TERMS, UNITS_OF_ENTRIES, Request
from kanegen.studies.budget.sampling import random_stream, sample_from_table, sample_region
from kanegen.studies.tradeoff.compilation import CompiledVariant
from kanegen.studies.tradeoff.domain import Sample
from kanegen.studies.tradeoff.evaluator import VariantEvaluator
from kanegen.studies.tradeoff.variants import Candidate, candidates

TIMED_STATES = 256
"""Number of independent states that are computed in turn while the time is measured."""

_FIELDS = {TERMS: "relative_to_terms", SOLUTION: "normwise", UNITS_OF_ENTRIES: "largest"}
"""Fields of `Measurement` by the yardstick of an error."""

LEAST_ROUNDING = 1 / 8
"""Error, in units of roundoff, that a rounded result has in at least one state of a sample."""


def allowed_candidates(
    is_allowed: Callable[[Candidate], bool] = lambda candidate: True,
) -> tuple[Candidate, ...]:
    """Return the candidates of a budget study, the default variant first.

    These are the variants of `tradeoff.variants` that keep the generalized speeds and coordinates of the
    model.

    Args:
        is_allowed: Whether a candidate may be chosen.

    Raises:
        OptionError: If no candidate may be chosen.
    """
    known = (candidate for candidate in candidates()[0] if not candidate.changes_system)
    allowed = tuple(
        candidate for candidate in dict.fromkeys([Candidate(STRICT), *known]) if is_allowed(candidate)
    )
    if not allowed:
        raise OptionError("no variant is left to choose from: ask for less, such as another precision.")
    return allowed


def is_reproducible(candidate: Candidate) -> bool:
    """Return whether a candidate has the same bits from every compiler and on every machine."""
    variant = candidate.variant
    return variant.semantics == STRICT.semantics and variant.machine == STRICT.machine


def usable_errors(measurement: Measurement, relative_to: str) -> Floats:
    """Return the (B,) errors of a measurement, relative to a yardstick of `request.METRICS`.

    The error is infinite where a result is not finite or does not solve the equations at all.
    """
    errors: Floats = getattr(measurement, _FIELDS[relative_to])
    return np.where(measurement.wrong | ~np.isfinite(errors), np.inf, errors)


class BudgetEvaluator:
    """An `Evaluator` of variants of the forward dynamics of one system.

    Args:
        region: The states for which the budget is kept.
        request: The budget and its conditions.
        candidates: The variants to choose from; the others are compared with the first.
        seed: Seed of all samples.
        progress: Function that is called with the name of each stage.

    Raises:
        BuildError: If there is no C compiler.
    """

    def __init__(
        self,
        region: Region,
        request: Request,
        candidates: Sequence[Candidate],
        seed: int = 0,
        progress: Progress = quiet,
    ) -> None:
        self.region = region
        self.candidates = candidates
        self._variants = VariantEvaluator(region.system, progress)
        self.exact = self._variants.exact
        self._request = request
        self._seed = seed
        self._progress = progress
        self._samples: dict[SampleSpec, Sample] = {}
        self._built: dict[Candidate, CompiledVariant] = {}
        self._refutations: list[SearchResult] = []

    def least_error(self, candidate: Candidate) -> float:
        """Return the error that rounding the result alone brings; 0 in units, where it has no least size."""
        if self._request.relative_to == UNITS_OF_ENTRIES:
            return 0.0
        used = formats(candidate.variant)
        return max(used.arithmetic.roundoff, used.storage.roundoff) * LEAST_ROUNDING

    def is_costlier(self, candidate: Candidate) -> bool:
        """Return whether the arithmetic of a candidate has more digits than that of the first one."""
        first = formats(self.candidates[0].variant).arithmetic.roundoff
        return formats(candidate.variant).arithmetic.roundoff < first

    def build(
        self, candidates: Sequence[Candidate]
    ) -> tuple[Mapping[Candidate, Hashable], Mapping[Candidate, str]]:
        """Compile candidates for this machine; see `Evaluator.build`."""
        built, refused = self._variants.build(candidates)
        self._built |= {one.candidate: one for one in built}
        reasons = {refusal.label: refusal.reason for refusal in refused}
        missing = (c for c in candidates if c not in self._built)
        return {one.candidate: one.fingerprint for one in built}, {c: reasons[c.label] for c in missing}

    def library(self, candidate: Candidate) -> Library:
        """Return the compiled library of a candidate that was built."""
        return self._built[candidate].library

    def sample(self, spec: SampleSpec) -> Sample:
        """Return the states of a sample; the exact results in them are computed once for all candidates."""
        if spec not in self._samples:
            rng = random_stream(self._seed, spec.purpose, spec.number)
            self._progress(f"exact results in {spec.count} states to {spec.purpose}")
            self._samples[spec] = sample_region(self.region, self.exact, spec.count, rng)
            self.exact.states(self._samples[spec])
        return self._samples[spec]

    def errors(self, candidate: Candidate, sample: SampleSpec) -> Floats:
        """Return the (count,) errors of a candidate in the states of a sample; see `usable_errors`."""
        return self.errors_in(candidate, self.sample(sample))

    def times(self, candidates: Sequence[Candidate]) -> dict[Candidate, Times]:
        """Return the times of candidates for the objective of the request; see `VariantEvaluator.times`."""
        domain, effort = self.region.domain, self._request.effort
        sample = domain.states(domain.uniform(TIMED_STATES, random_stream(self._seed, "time", 0)))
        built = [self._built[candidate] for candidate in candidates]
        found = self._variants.times(built, sample, Rounds(effort.rounds, effort.seconds))
        return {one.candidate: times[self._request.objective] for one, times in found.items()}

    def search(self, candidate: Candidate, sample: SampleSpec, number: int) -> SearchResult:
        """Search for a state with a large error; see `Evaluator.search`.

        The search begins with the states that refuted other candidates, because a state that is hard for one
        is often hard for others.
        """
        self._progress(f"searching for a counterexample: {candidate.label}")
        errors = functools.partial(self.errors_in, candidate)
        for tried, refutation in enumerate(self._refutations, start=1):
            error = float(errors(sample_from_table(self.region.domain, refutation.state))[0])
            if error > self._error_budget:
                return replace(refutation, error=error, evaluations=tried)
        found = search_counterexample(
            self.region,
            self.exact,
            errors,
            self.sample(sample),
            evaluations=self._request.effort.search,
            seed=int(random_stream(self._seed, "search", number).integers(2**31)),
            hard=number == 1,
            relative_to=self._request.relative_to,
        )
        if found.error > self._error_budget:
            self._refutations.append(found)
        return found

    @property
    def _error_budget(self) -> float:
        """The error that no tried state may exceed; infinite under a budget of time or a quantile below 1."""
        return self._request.error if self._request.error and self._request.is_strict else math.inf

    def errors_in(self, candidate: Candidate, sample: Sample) -> Floats:
        """Return the (B,) errors of a candidate in B states, relative to the requested yardstick."""
        measured = self._variants.errors(self._built[candidate], sample, self._request.objective)
        return usable_errors(measured, self._request.relative_to)
