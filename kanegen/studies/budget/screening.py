"""Who keeps a budget on the sample by which a variant is chosen, and how fast they are."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic

from kanegen.errors import BudgetError
from kanegen.measure.errors import quantile
from kanegen.measure.timing import TIE, Times, tied
from kanegen.studies.budget.evaluator import SELECT, C, Draw, Laboratory
from kanegen.studies.budget.request import SAFETY, Request

FINALISTS = 6
"""Candidates that are timed once more before one of them is chosen."""

SAME_ACCURACY = 2.0
"""Ratio of errors up to which two candidates count as equally accurate."""


@dataclass
class Screening(Generic[C]):
    """What is known of the candidates so far.

    Attributes:
        laboratory: That measures.
        request: What is asked for.
        programs: The first candidate of every program.
        found: Errors on the sample, at the quantile.
        times: Of all whose time matters.
        finals: Of the finalists and the reference, once more; a choice is between these.
        verdicts: What became of every candidate, in words, in the order of the field.
        spared: Candidates with more digits than the sample needs; not built unless nobody else holds.
    """

    laboratory: Laboratory[C]
    request: Request
    programs: dict[Hashable, C] = field(default_factory=dict)
    found: dict[C, float] = field(default_factory=dict)
    times: dict[C, Times] = field(default_factory=dict)
    finals: dict[C, Times] = field(default_factory=dict)
    verdicts: dict[str, str] = field(default_factory=dict)
    spared: list[C] = field(default_factory=list)

    @property
    def sample(self) -> Draw:
        """The states by which candidates are chosen."""
        return Draw(SELECT, 0, self.request.effort.select)

    @property
    def _limit(self) -> float:
        """Of the time; infinite where the error has the budget."""
        return math.inf if self.request.time is None else self.request.time

    @property
    def budget(self) -> float:
        """Of the error; infinite where time has the budget."""
        return math.inf if self.request.error is None else self.request.error

    def affordable(self) -> list[C]:
        """Who keeps the budget so far, measured and timed.

        Raises:
            BudgetError: If nobody does.
        """
        self._measure()
        accurate = self._accurate(self.found)
        if not accurate:
            raise BudgetError(self._best_error())
        rivals = [c for c in self.found if c in accurate or self._is_reference(c)]
        self.times = dict(self.laboratory.times(rivals))
        for candidate, times in self.times.items():
            self.say(candidate, f", {times.median:.4g} ns")
        quick = [c for c in accurate if self.times[c].median <= self._limit]
        if not quick:
            raise BudgetError(self.best_time())
        return quick

    def widened(self) -> list[C]:
        """Who keeps the budget so far of those with more digits, now measured and timed; once."""
        spared, self.spared = self.spared, []
        for candidate in spared:
            self.verdicts[candidate.label] = ""
        self._measure_built(spared)
        accurate = self._accurate(spared)
        if accurate:
            self.times |= self.laboratory.times(accurate)
        for candidate in accurate:
            self.say(candidate, f", {self.times[candidate].median:.4g} ns")
        return [c for c in accurate if self.times[c].median <= self._limit]

    def _accurate(self, candidates: Iterable[C]) -> list[C]:
        """Those whose error on the sample is small enough."""
        found = {c: self.found.get(c, math.inf) for c in candidates}
        return [c for c, error in found.items() if error <= self._threshold and error < math.inf]

    def best(self, remaining: list[C]) -> C | None:
        """The next one to be judged; it goes off the list, and so does who turns out too slow.

        The finalists are timed once more, in rounds of their own: who was first among many on a machine that
        is never quiet was also lucky, and luck does not last.
        """
        while remaining:
            finalists = sorted(remaining, key=self._rank)[:FINALISTS]
            reference = self.reference(self.times)
            extra = [] if reference is None or reference in finalists else [reference]
            self.finals = dict(self.laboratory.times([*finalists, *extra]))
            quick = [c for c in finalists if self.finals[c].median <= self._limit]
            for slow in (c for c in finalists if c not in quick):
                remaining.remove(slow)
                self.say(slow, f", {self.finals[slow].median:.4g} ns in the final")
            if quick:
                first = self._first(quick)
                remaining.remove(first)
                return first
        return None

    def _rank(self, candidate: C) -> tuple[float, float]:
        """By which finalists are chosen."""
        error, time = self.found[candidate], self.times[candidate].median
        return (time, error) if self.request.time is None else (error, time)

    def _first(self, finalists: Sequence[C]) -> C:
        """The fastest or, where time has the budget, the most accurate; what is tied goes by the other."""
        if self.request.time is None:
            level = tied([self.finals[c] for c in finalists])
            return min((finalists[i] for i in level), key=lambda c: (self.found[c], self.finals[c].median))
        limit = TIE * min(self.found[c] for c in finalists)
        alike = [c for c in finalists if self.found[c] <= limit]
        return min(alike, key=lambda c: self.finals[c].median)

    def reference(self, times: Mapping[C, Times]) -> C | None:
        """The fastest, by these times, of those that are as accurate as the first of the field."""
        accurate = (candidate for candidate in times if self._is_reference(candidate))
        return min(accurate, key=lambda c: times[c].median, default=None)

    def say(self, candidate: C, words: str) -> None:
        """Add to what is known of a candidate."""
        self.verdicts[candidate.label] = self.verdicts.get(candidate.label, "") + words

    def _measure(self) -> None:
        """Errors on the sample, of whoever is worth building and can be; the first one comes first."""
        first, *others = self.laboratory.field
        self._measure_built([first])
        enough = self.request.error is not None and self.found.get(first, math.inf) <= self._threshold
        floors = {candidate: self.laboratory.floor(candidate) for candidate in self.laboratory.field}
        highest = max(self._threshold, min(floors.values()))
        worth = []
        for candidate in others:
            if floors[candidate] > highest:
                self.say(candidate, f"not built: its roundoff alone brings {floors[candidate]:.1e}")
            elif enough and self.laboratory.is_costlier(candidate):
                self.say(candidate, f"not built: {first.label} is accurate enough, and faster")
                self.spared.append(candidate)
            else:
                worth.append(candidate)
        self._measure_built(worth)

    def _measure_built(self, candidates: Sequence[C]) -> None:
        programs, refused = self.laboratory.build(candidates)
        for candidate in candidates:
            if candidate in refused:
                self.say(candidate, f"refused: {refused[candidate]}")
                continue
            twin = self.programs.setdefault(programs[candidate], candidate)
            if twin != candidate:
                self.say(candidate, f"the same program as {twin.label}")
                continue
            errors = self.laboratory.errors(candidate, self.sample)
            self.found[candidate] = quantile(errors, self.request.quantile)
            self.say(candidate, f"error {self.found[candidate]:.1e}")

    @property
    def _threshold(self) -> float:
        """What the error on the first sample may be."""
        return self.budget / SAFETY

    def _is_reference(self, candidate: C) -> bool:
        """Whether it has the accuracy of the first of the field."""
        first = self.found.get(self.laboratory.field[0], math.inf)
        return self.found[candidate] <= SAME_ACCURACY * first < math.inf

    def _best_error(self) -> str:
        """Why no candidate is accurate enough."""
        budget = f"no variant keeps an error of {self.budget:.3g} on this domain"
        finite = {c: error for c, error in self.found.items() if error < math.inf}
        if not finite:
            reasons = {words: label for label, words in reversed(self.verdicts.items())}
            return f"{budget}. {' '.join(f'{label}: {words}.' for words, label in reversed(reasons.items()))}"
        best = min(finite, key=lambda c: finite[c])
        return (
            f"{budget}. The most accurate one is {best.label!r} with {finite[best]:.1e}, which "
            f"allows for a budget of {SAFETY * finite[best]:.1e}."
        )

    def best_time(self) -> str:
        """Why no candidate is fast enough."""
        times = {**self.times, **self.finals}
        best = min(times, key=lambda c: times[c].median)
        return (
            f"no variant keeps a time of {self.request.time:.4g} ns for {self.request.objective} on "
            f"this machine. The fastest one is {best.label!r} with {times[best].median:.4g} ns and an "
            f"error of {self.found[best]:.1e}."
        )
