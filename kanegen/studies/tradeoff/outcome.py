"""What comes of a study."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from kanegen.measure.errors import QUANTILES
from kanegen.measure.timing import Times
from kanegen.measure.truth.measurement import Measurement
from kanegen.studies.tradeoff.domain import Domain
from kanegen.studies.tradeoff.pareto_front import Point, rank_correlation, verdict
from kanegen.studies.tradeoff.variants import Candidate, Refusal

RANKED_BY = ("median", "p99", "max")
"""Quantiles of its errors by which a variant may be ranked."""


@dataclass(frozen=True)
class StudyOptions:
    """How a study is held.

    Attributes:
        states: Of the sample by which variants are selected, and of the fresh one that confirms the best.
        hard: States of each stratum of hard ones.
        search: States that are tried, for every variant on a front, to find its largest error.
        rounds: Of timing, in each of which every variant has one turn.
        seconds: Of each of the two ways to call, in every turn.
        seed: Of all samples.
        quantile: The error that counts, one of `RANKED_BY`.
    """

    states: int = 256
    hard: int = 32
    search: int = 64
    rounds: int = 7
    seconds: float = 0.02
    seed: int = 0
    quantile: str = "max"


@dataclass(frozen=True)
class Entry:
    """A variant and what was measured of it.

    Attributes:
        candidate: The variant.
        operations: Of one evaluation.
        size: Bytes of the shared library.
        errors: In the uniform sample, by objective.
        hard: In the hard states, by stratum and objective.
        times: Times by objective; None where results are wrong.
        same_as: Label of the variant with which it shares its program, its errors and its times.
    """

    candidate: Candidate
    operations: int
    size: int
    errors: Mapping[str, Measurement]
    hard: Mapping[str, Mapping[str, Measurement]]
    times: Mapping[str, Times] | None
    same_as: str | None = None

    @property
    def label(self) -> str:
        """Of the variant."""
        return self.candidate.label

    @property
    def wrong(self) -> int:
        """States, of either way to call, in which the result does not solve the equations."""
        return sum(int(errors.wrong.sum()) for errors in self.errors.values())

    def failed(self, objective: str) -> int:
        """States of the uniform sample without a finite result."""
        return int(self.errors[objective].failed.sum())

    def point(self, objective: str, share: float) -> Point[Entry] | None:
        """Where it stands; None where it is not timed."""
        if self.times is None:
            return None
        return Point(self, self.times[objective].median, self.errors[objective].quantile(share))


@dataclass(frozen=True)
class Confirmed:
    """A variant on a front, measured again: in fresh states, and in other processes.

    Attributes:
        entry: As it was selected.
        errors: In the fresh states.
        times: Fresh times, by objective.
        found: The largest error that a search found, and `state`, the numbers of that state.
        state: x, y and tau.
        stays: Whether it is on the front of the fresh figures, too.
    """

    entry: Entry
    errors: Measurement
    times: Mapping[str, Times]
    found: float
    state: Mapping[str, tuple[float, ...]]
    stays: bool


@dataclass(frozen=True)
class Run:
    """One simulation.

    Attributes:
        variant: Label of the variant.
        method: Of integration.
        setting: Its step or tolerance, in words.
        evaluations: Of forward dynamics.
        nanoseconds: Of one evaluation.
        error: Of the coordinates at the end; infinite where it failed.
    """

    variant: str
    method: str
    setting: str
    evaluations: int
    nanoseconds: float
    error: float

    @property
    def work(self) -> float:
        """Seconds that the evaluations take; what an integrator does beside them does not count."""
        return 1e-9 * self.evaluations * self.nanoseconds


@dataclass(frozen=True)
class Study:
    """One model: every variant, and which are worth having.

    Attributes:
        model: Its name.
        n: Number of freedoms.
        notes: What was changed in the model so that variants can be timed.
        domain: The states.
        terms: Of the study.
        entries: Every variant that could be built.
        refusals: Every other one.
        fronts: By objective, the fastest variant first.
        runs: Simulations, if any were made.
        duration: Of the motion that was simulated, s.
    """

    model: str
    n: int
    notes: tuple[str, ...]
    domain: Domain
    terms: StudyOptions
    entries: tuple[Entry, ...]
    refusals: tuple[Refusal, ...]
    fronts: Mapping[str, tuple[Confirmed, ...]]
    runs: tuple[Run, ...] = ()
    duration: float = 0.0

    @property
    def share(self) -> float:
        """The quantile that counts."""
        return QUANTILES[self.terms.quantile]

    def points(self, objective: str) -> list[Point[Entry]]:
        """Where every timed variant stands."""
        found = (entry.point(objective, self.share) for entry in self.entries)
        return [point for point in found if point is not None]

    def verdict(self, objective: str) -> str:
        """Whether there is a trade, in words, by the fresh figures."""
        fresh = [
            Point(c.entry, c.times[objective].median, c.errors.quantile(self.share))
            for c in self.fronts[objective]
            if c.stays
        ]
        fresh.sort(key=lambda point: point.time)
        return verdict(fresh, lambda entry: entry.label, self.points(objective))

    def rank_correlation(self, objective: str) -> float:
        """Spearman's rho of operations and times, over programs that differ."""
        timed = [entry for entry in self.entries if entry.times is not None and entry.same_as is None]
        times = [entry.times[objective].median for entry in timed if entry.times is not None]
        return rank_correlation([entry.operations for entry in timed], times)
