"""Candidates with planted errors and times, among which the choice of a variant is known."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kanegen.measure.timing import Times
from kanegen.studies.budget.evaluator import SELECT, VALIDATE, SampleSpec, SearchResult
from kanegen.studies.budget.request import Effort

Floats = NDArray[np.float64]
SMALL = Effort(select=50, search=10)
"""Few samples for quick choices."""


@dataclass(frozen=True)
class Planted:
    """A candidate of a known error and time (ns)."""

    label: str
    error: float
    time: float
    least_error: float = 0.0
    refused: str = ""
    program: str = ""
    is_long: bool = False


def spread(candidate: Planted, sample: SampleSpec, rng: np.random.Generator) -> Floats:
    """Return errors between half the error of the candidate and this error."""
    return candidate.error * rng.uniform(0.5, 1.0, sample.count)


@dataclass
class PlantedEvaluator:
    """An evaluator of planted candidates that records which samples and times it was asked for.

    Attributes:
        candidates: The candidates to choose from.
        sampled: Function that returns the errors of a candidate in a sample.
        found: Largest error that a search finds, by label; by default the error of the candidate.
        noise: Largest relative increase of the time of a round.
        seed: Seed of errors and times.
        samples: Label and sample of every call of `errors`.
        timed: Result of every call of `times`.
    """

    candidates: Sequence[Planted]
    sampled: Callable[[Planted, SampleSpec, np.random.Generator], Floats] = spread
    found: Mapping[str, float] = field(default_factory=dict)
    noise: float = 0.0
    seed: int = 0
    samples: list[tuple[str, SampleSpec]] = field(default_factory=list)
    timed: list[dict[Planted, Times]] = field(default_factory=list)

    def least_error(self, candidate: Planted) -> float:
        return candidate.least_error

    def is_costlier(self, candidate: Planted) -> bool:
        return candidate.is_long

    def build(self, candidates: Sequence[Planted]) -> tuple[dict[Planted, str], dict[Planted, str]]:
        refused = {c: c.refused for c in candidates if c.refused}
        return {c: c.program or c.label for c in candidates if not c.refused}, refused

    def errors(self, candidate: Planted, sample: SampleSpec) -> Floats:
        self.samples.append((candidate.label, sample))
        place = [SELECT, VALIDATE].index(sample.purpose)
        return self.sampled(candidate, sample, np.random.default_rng([self.seed, place, sample.number]))

    def times(self, candidates: Sequence[Planted]) -> dict[Planted, Times]:
        rng = np.random.default_rng([self.seed, len(self.timed)])
        rounds = 1 + self.noise * rng.random((len(candidates), 9))
        self.timed.append({c: Times(tuple(c.time * row)) for c, row in zip(candidates, rounds, strict=True)})
        return self.timed[-1]

    def search(self, candidate: Planted, sample: SampleSpec, number: int) -> SearchResult:
        error = self.found.get(candidate.label, candidate.error)
        return SearchResult(error, 10, {"x": ["0x1p+0"]}, "Exclude something.")


STRICT = Planted("strict", 1e-15, 100.0)


ROUGH = Planted("rough", 1e-5, 50.0)


SINGLE = Planted("single", 1e-7, 60.0)


FAST = Planted("fast", 2e-15, 80.0)


CANDIDATES = (STRICT, ROUGH, SINGLE, FAST)
