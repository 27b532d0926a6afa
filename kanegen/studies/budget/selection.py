"""The choice of a variant under a budget, and its validation.

1. Candidates that cannot keep the budget by their roundoff alone are not built; neither are candidates with
   more digits than are needed. The others are built and measured in the states of one sample, which serves
   for selection only. A state without a result counts as an infinite error.
2. The error of a candidate must stay below the budget by a factor, its time below a budget of time. Times are
   measured on this machine, and all candidates take turns.
3. The best candidates are timed once more, and one of them is chosen. A search for a counterexample tries to
   refute it; this search may use the errors in the sample.
4. A candidate that is not refuted is validated once, in fresh states, and searched again from the worst of
   them.
5. A candidate that fails is dropped, and the next one gets a new sample. The number of such attempts is fixed
   beforehand and paid for by the confidence of each attempt (`budget.confidence`).
6. If all candidates are refuted, those with more digits than the sample needed are built after all.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic

from kanegen.errors import BudgetError
from kanegen.measure.timing import Speedup, Times, speedup
from kanegen.studies.budget.confidence import Validation
from kanegen.studies.budget.confirmation import (
    Confirmation,
    fresh_sample,
    is_refuted,
    is_refuted_by,
    validated,
)
from kanegen.studies.budget.evaluator import C, Evaluator, SampleSpec, SearchResult
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.screening import Screening

SHOWN = 3
"""Number of candidates that an error message names if all fail."""


@dataclass(frozen=True)
class Choice(Confirmation[C]):
    """The chosen candidate with its measurements.

    Attributes:
        times: Times of the candidate, measured together with those of the other finalists.
        standard: The first of all candidates, with whose accuracy the others are compared.
        reference: The fastest candidate that is as accurate as `standard`.
        gain: How many times as fast the candidate is as `reference`; None where the difference is not
            certain.
        verdicts: Outcome for every candidate, by label, in the order of the candidates.
    """

    times: Times
    standard: C
    reference: C
    gain: Speedup | None
    verdicts: dict[str, str]


def choose(evaluator: Evaluator[C], request: Request) -> Choice[C]:
    """Return the candidate that a request asks for.

    Raises:
        BudgetError: If no candidate keeps the budget; the message names the nearest candidate.
    """
    return _Selection(Screening(evaluator, request)).run()


@dataclass(frozen=True)
class _Selection(Generic[C]):
    """One run of the selection."""

    screening: Screening[C]

    def run(self) -> Choice[C]:
        """Return the candidate that the request asks for.

        Raises:
            BudgetError: If no candidate keeps the budget.
        """
        remaining, allowed = self.screening.eligible(), self.screening.request.attempts
        attempt = 0
        while attempt < allowed:
            best = self.screening.take_best(remaining)
            if best is None:
                remaining = self.screening.eligible_deferred()
                if not remaining:
                    break
                continue
            first = self._search(best, self.screening.sample, 1)
            if first is None:
                continue
            attempt += 1
            chosen = self._validated(best, first, attempt)
            if chosen is not None:
                return chosen
        raise BudgetError(self._failure(attempt < allowed))

    def _search(self, candidate: C, sample: SampleSpec, number: int) -> SearchResult | None:
        """Return the result of a search for a counterexample; None if it refutes the candidate."""
        screening = self.screening
        found = screening.evaluator.search(candidate, sample, number)
        if not is_refuted_by(screening.request, found):
            return found
        refuted = (
            f"; refuted in {found.evaluations} evaluations: error {found.error:.1e}. {found.explanation}"
        )
        screening.note(candidate, refuted.rstrip("."))
        return None

    def _validated(self, candidate: C, first: SearchResult, attempt: int) -> Choice[C] | None:
        """Return the choice of a candidate; None if a fresh sample or a second search refutes it."""
        screening, request = self.screening, self.screening.request
        sample = fresh_sample(request, attempt)
        errors = screening.evaluator.errors(candidate, sample)
        validation = validated(request, errors, (first,), attempt)
        if is_refuted(request, validation):
            count = f"{validation.exceeded} of {len(errors)} fresh states exceed {validation.claim:.1e}"
            screening.note(candidate, f"; failed validation {attempt}: {count}")
            return None
        second = self._search(candidate, sample, 2)
        if second is None:
            return None
        both = (first, second)
        return self._choice(candidate, validated(request, errors, both, attempt), both)

    def _choice(self, candidate: C, validation: Validation, searches: tuple[SearchResult, ...]) -> Choice[C]:
        """Return the choice of a candidate that no check has refuted."""
        screening = self.screening
        screening.note(candidate, "; chosen")
        times = screening.final_times
        reference = screening.reference(times) or candidate
        gain = speedup(times[reference], times[candidate])
        return Choice(
            candidate=candidate,
            error=screening.errors[candidate],
            times=times[candidate],
            validation=validation,
            searches=searches,
            standard=screening.evaluator.candidates[0],
            reference=reference,
            gain=gain if gain.is_real else None,
            verdicts=screening.verdicts,
        )

    def _failure(self, all_tried: bool) -> str:
        """Return the message that no candidate was validated.

        Args:
            all_tried: Whether no candidate is left; otherwise the allowed attempts were used up.
        """
        if not any(";" in text for text in self.screening.verdicts.values()):
            return self.screening.time_budget_failure()
        tried = [f"{label}: {text}." for label, text in self.screening.verdicts.items() if ";" in text]
        more = "" if all_tried else " No further attempt was allowed; see attempts."
        others = f" And {len(tried) - SHOWN} more." if len(tried) > SHOWN else ""
        return (
            f"no variant that kept the budget in the first sample was confirmed.{more} "
            f"{' '.join(tried[:SHOWN])}{others}"
        )
