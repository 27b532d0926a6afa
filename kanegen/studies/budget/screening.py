"""Candidates that keep a budget in the sample for selection, and their times."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic

from kanegen.errors import BudgetError
from kanegen.measure.errors import quantile
from kanegen.measure.timing import TIE, Times, tied
from kanegen.studies.budget.confirmation import selection_sample
from kanegen.studies.budget.evaluator import C, Evaluator, SampleSpec
from kanegen.studies.budget.request import SAFETY, Request

FINALISTS = 6
"""Number of candidates that are timed once more before one of them is chosen."""

SAME_ACCURACY = 2.0
"""Ratio of errors up to which two candidates count as equally accurate."""


@dataclass
class Screening(Generic[C]):
    """The measurements of candidates so far.

    Attributes:
        evaluator: The evaluator that measures the candidates.
        request: The request of the user.
        programs: The first candidate of every program.
        errors: Errors in the sample for selection, at the quantile of the request.
        times: Times of the candidates that may be chosen and of those with the accuracy of the default.
        final_times: Times of the finalists and the reference, measured once more; they decide.
        verdicts: Outcome for every candidate, in words, by label.
        deferred: Candidates with more digits than the sample needs; they are built only if all others fail.
    """

    evaluator: Evaluator[C]
    request: Request
    programs: dict[Hashable, C] = field(default_factory=dict)
    errors: dict[C, float] = field(default_factory=dict)
    times: dict[C, Times] = field(default_factory=dict)
    final_times: dict[C, Times] = field(default_factory=dict)
    verdicts: dict[str, str] = field(default_factory=dict)
    deferred: list[C] = field(default_factory=list)

    @property
    def sample(self) -> SampleSpec:
        """The sample by which candidates are selected."""
        return selection_sample(self.request)

    @property
    def time_budget(self) -> float:
        """Budget of the time (ns); infinite under a budget of error."""
        return math.inf if self.request.time is None else self.request.time

    @property
    def error_budget(self) -> float:
        """Budget of the error; infinite under a budget of time."""
        return math.inf if self.request.error is None else self.request.error

    def eligible(self) -> list[C]:
        """Build, measure and time the candidates; return those that keep the budget so far.

        Raises:
            BudgetError: If no candidate keeps the budget.
        """
        self._measure_all()
        accurate = self._accurate(self.errors)
        if not accurate:
            raise BudgetError(self._error_budget_failure())
        timed = [c for c in self.errors if c in accurate or self._is_reference(c)]
        self.times = dict(self.evaluator.times(timed))
        for candidate, times in self.times.items():
            self.note(candidate, f", {times.median:.4g} ns")
        fast = [c for c in accurate if self.times[c].median <= self.time_budget]
        if not fast:
            raise BudgetError(self.time_budget_failure())
        return fast

    def eligible_deferred(self) -> list[C]:
        """Build, measure and time the deferred candidates; return those that keep the budget so far.

        A second call returns an empty list.
        """
        deferred, self.deferred = self.deferred, []
        for candidate in deferred:
            self.verdicts[candidate.label] = ""
        self._measure(deferred)
        accurate = self._accurate(deferred)
        if accurate:
            self.times |= self.evaluator.times(accurate)
        for candidate in accurate:
            self.note(candidate, f", {self.times[candidate].median:.4g} ns")
        return [c for c in accurate if self.times[c].median <= self.time_budget]

    def take_best(self, remaining: list[C]) -> C | None:
        """Remove the best candidate from `remaining` and return it; None if none is fast enough.

        The finalists are timed once more, in separate rounds: the rank of the first of many candidates on a
        noisy machine is partly luck, which the second times do not share. Finalists that turn out too slow
        are removed as well.
        """
        while remaining:
            finalists = sorted(remaining, key=self._rank)[:FINALISTS]
            reference = self.reference(self.times)
            extra = [] if reference is None or reference in finalists else [reference]
            self.final_times = dict(self.evaluator.times([*finalists, *extra]))
            fast = [c for c in finalists if self.final_times[c].median <= self.time_budget]
            for slow in (c for c in finalists if c not in fast):
                remaining.remove(slow)
                self.note(slow, f", {self.final_times[slow].median:.4g} ns in the final")
            if fast:
                best = self._best(fast)
                remaining.remove(best)
                return best
        return None

    def reference(self, times: Mapping[C, Times]) -> C | None:
        """Return the fastest, by `times`, of the candidates that are as accurate as the first candidate."""
        accurate = (candidate for candidate in times if self._is_reference(candidate))
        return min(accurate, key=lambda c: times[c].median, default=None)

    def note(self, candidate: C, text: str) -> None:
        """Append a text to the verdict on a candidate."""
        self.verdicts[candidate.label] = self.verdicts.get(candidate.label, "") + text

    def time_budget_failure(self) -> str:
        """Return the message that no candidate is fast enough."""
        times = {**self.times, **self.final_times}
        best = min(times, key=lambda c: times[c].median)
        return (
            f"no variant keeps a time of {self.request.time:.4g} ns for {self.request.objective} on "
            f"this machine. The fastest one is {best.label!r} with {times[best].median:.4g} ns and an "
            f"error of {self.errors[best]:.1e}."
        )

    def _error_budget_failure(self) -> str:
        """Return the message that no candidate is accurate enough."""
        failure = f"no variant keeps an error of {self.error_budget:.3g} on this domain"
        finite = {c: error for c, error in self.errors.items() if error < math.inf}
        if not finite:
            reasons = {text: label for label, text in reversed(self.verdicts.items())}
            listed = (f"{label}: {text}." for text, label in reversed(reasons.items()))
            return f"{failure}. {' '.join(listed)}"
        best = min(finite, key=lambda c: finite[c])
        return (
            f"{failure}. The most accurate one is {best.label!r} with {finite[best]:.1e}, which "
            f"allows for a budget of {SAFETY * finite[best]:.1e}."
        )

    def _measure_all(self) -> None:
        """Measure the errors of the candidates that may keep the budget, the first candidate first."""
        first, *others = self.evaluator.candidates
        self._measure([first])
        is_enough = self.request.error is not None and self.errors.get(first, math.inf) <= self._largest_error
        least = {candidate: self.evaluator.least_error(candidate) for candidate in self.evaluator.candidates}
        largest = max(self._largest_error, min(least.values()))
        promising = []
        for candidate in others:
            if least[candidate] > largest:
                self.note(candidate, f"not built: its roundoff alone brings {least[candidate]:.1e}")
            elif is_enough and self.evaluator.is_costlier(candidate):
                self.note(candidate, f"not built: {first.label} is accurate enough, and faster")
                self.deferred.append(candidate)
            else:
                promising.append(candidate)
        self._measure(promising)

    def _measure(self, candidates: Sequence[C]) -> None:
        """Build candidates and measure their errors, once for each program."""
        programs, refused = self.evaluator.build(candidates)
        for candidate in candidates:
            if candidate in refused:
                self.note(candidate, f"refused: {refused[candidate]}")
                continue
            twin = self.programs.setdefault(programs[candidate], candidate)
            if twin != candidate:
                self.note(candidate, f"the same program as {twin.label}")
                continue
            errors = self.evaluator.errors(candidate, self.sample)
            self.errors[candidate] = quantile(errors, self.request.quantile)
            self.note(candidate, f"error {self.errors[candidate]:.1e}")

    def _accurate(self, candidates: Iterable[C]) -> list[C]:
        """Return the candidates whose error in the sample for selection is small enough."""
        errors = {c: self.errors.get(c, math.inf) for c in candidates}
        return [c for c, error in errors.items() if error <= self._largest_error and error < math.inf]

    @property
    def _largest_error(self) -> float:
        """The largest error in the sample for selection with which a candidate may be chosen."""
        return self.error_budget / SAFETY

    def _is_reference(self, candidate: C) -> bool:
        """Return whether a candidate is as accurate as the first candidate."""
        first = self.errors.get(self.evaluator.candidates[0], math.inf)
        return self.errors[candidate] <= SAME_ACCURACY * first < math.inf

    def _rank(self, candidate: C) -> tuple[float, float]:
        """Return the key by which finalists are sorted: the figure without a budget, then the other one."""
        error, time = self.errors[candidate], self.times[candidate].median
        return (time, error) if self.request.time is None else (error, time)

    def _best(self, finalists: Sequence[C]) -> C:
        """Return the fastest finalist or, under a budget of time, the most accurate one.

        Of finalists that are tied in this figure the one with the best other figure is returned.
        """
        if self.request.time is None:
            level = tied([self.final_times[c] for c in finalists])
            best = (finalists[i] for i in level)
            return min(best, key=lambda c: (self.errors[c], self.final_times[c].median))
        limit = TIE * min(self.errors[c] for c in finalists)
        alike = [c for c in finalists if self.errors[c] <= limit]
        return min(alike, key=lambda c: self.final_times[c].median)
