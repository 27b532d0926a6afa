"""The options and the outcome of a study as frozen data."""

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
    """The options of a study.

    Attributes:
        states: Number of states of the sample that selects variants and of the fresh sample that confirms
            them.
        hard: Number of hard states of each kind.
        search: Number of states that are tried, for every variant on a Pareto front, to find its largest
            error.
        rounds: Number of rounds of timing, in each of which every variant has one turn.
        seconds: Duration of the timing of one objective in every turn (s).
        seed: Seed of all samples.
        quantile: Quantile of the errors that ranks variants, one of `RANKED_BY`.
    """

    states: int = 256
    hard: int = 32
    search: int = 64
    rounds: int = 7
    seconds: float = 0.02
    seed: int = 0
    quantile: str = "max"


QUICK_OPTIONS = StudyOptions(states=64, hard=8, search=0)
"""The options of a quick study, whose variants are those of `variants.QUICK`."""


@dataclass(frozen=True)
class VariantResult:
    """A variant with its measurements.

    Attributes:
        candidate: The variant.
        operations: Number of operations of one evaluation.
        size: Size of the shared library in bytes.
        errors: Errors in the uniform sample, by objective.
        hard: Errors in the hard states, by the kind of the states and by objective.
        times: Times by objective; None if results are wrong.
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
        """The choices of the variant in a few words."""
        return self.candidate.label

    @property
    def wrong(self) -> int:
        """Number of results, over all objectives, that do not solve the equations."""
        return sum(int(errors.wrong.sum()) for errors in self.errors.values())

    def failed(self, objective: str) -> int:
        """Return the number of states of the uniform sample without a finite result."""
        return int(self.errors[objective].failed.sum())

    def point(self, objective: str, share: float) -> Point[VariantResult] | None:
        """Return the median time and the error that a share of the states keeps; None if not timed."""
        if self.times is None:
            return None
        return Point(self, self.times[objective].median, self.errors[objective].quantile(share))


@dataclass(frozen=True)
class ConfirmedVariant:
    """A variant on a Pareto front, measured again in fresh states and timed again in other processes.

    Attributes:
        result: The result by which it was selected.
        errors: Errors in the fresh states.
        proven: Median of the proven bounds on the errors in the fresh states; infinite where there are none.
        times: The second times, by objective.
        found: The largest error that a search found.
        state: x, y and tau of the state of this error.
        stays: Whether the variant is on the Pareto front of the second figures as well.
    """

    result: VariantResult
    errors: Measurement
    proven: float
    times: Mapping[str, Times]
    found: float
    state: Mapping[str, tuple[float, ...]]
    stays: bool


@dataclass(frozen=True)
class SimulationRun:
    """One simulation of a motion by one variant.

    Attributes:
        variant: Label of the variant.
        method: Method of integration.
        setting: Step or tolerance of the method, in words.
        evaluations: Number of evaluations of forward dynamics.
        nanoseconds: Time of one evaluation (ns).
        error: Error of the coordinates at the end; infinite if the simulation failed.
    """

    variant: str
    method: str
    setting: str
    evaluations: int
    nanoseconds: float
    error: float

    @property
    def work(self) -> float:
        """Time of all evaluations (s), without the other operations of the integrator."""
        return 1e-9 * self.evaluations * self.nanoseconds


@dataclass(frozen=True)
class Study:
    """The outcome of a study of one model.

    Attributes:
        model: Name of the model.
        n: Number of freedoms.
        notes: Changes of the model that let variants be timed.
        domain: The states of the study.
        options: Options of the study.
        results: Results of all variants that could be built.
        refusals: The variants that could not be built, with the reasons.
        pareto_fronts: The confirmed variants on the Pareto front of each objective, the fastest first.
        runs: Simulations, if any were made.
        duration: Duration of the simulated motion (s).
    """

    model: str
    n: int
    notes: tuple[str, ...]
    domain: Domain
    options: StudyOptions
    results: tuple[VariantResult, ...]
    refusals: tuple[Refusal, ...]
    pareto_fronts: Mapping[str, tuple[ConfirmedVariant, ...]]
    runs: tuple[SimulationRun, ...] = ()
    duration: float = 0.0

    @property
    def share(self) -> float:
        """Share of the states that keep the error by which variants are ranked."""
        return QUANTILES[self.options.quantile]

    def points(self, objective: str) -> list[Point[VariantResult]]:
        """Return time and error of every timed variant with the coordinates and speeds of the model."""
        return self._points(objective, reformulated=False)

    def reformulated_points(self, objective: str) -> list[Point[VariantResult]]:
        """Return time and error of every timed variant with other coordinates or speeds."""
        return self._points(objective, reformulated=True)

    def _points(self, objective: str, *, reformulated: bool) -> list[Point[VariantResult]]:
        """Return time and error of the timed variants whose arrays are, or are not, those of the model."""
        chosen = (one for one in self.results if one.candidate.changes_system is reformulated)
        found = (result.point(objective, self.share) for result in chosen)
        return [point for point in found if point is not None]

    def verdict(self, objective: str) -> str:
        """Return in words whether there is a trade-off, by the second figures of the Pareto front."""
        fresh = [
            Point(c.result, c.times[objective].median, c.errors.quantile(self.share))
            for c in self.pareto_fronts[objective]
            if c.stays
        ]
        fresh.sort(key=lambda point: point.time)
        return verdict(fresh, lambda result: result.label, self.points(objective))

    def rank_correlation(self, objective: str) -> float:
        """Return Spearman's rho of operation counts and times, over all different programs."""
        timed = [result for result in self.results if result.times is not None and result.same_as is None]
        times = [result.times[objective].median for result in timed if result.times is not None]
        return rank_correlation([result.operations for result in timed], times)
