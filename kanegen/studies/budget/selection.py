"""How a variant is chosen, and how it is judged afterwards.

1. Who cannot keep the budget by its roundoff alone is left out unbuilt, and who has more digits than are
   needed; the others are built and measured in the states of one sample, which serves for choosing only. A
   state without a result counts as an infinite error.
2. An error must stay below the budget by a factor, a time below it, on this machine, all taking turns.
3. The best of these are timed once more, and one is chosen. It is attacked: a search for a counterexample,
   which may use what is known of the sample.
4. Who survives is validated once, in states that nobody has seen, and attacked again from the worst ones.
5. Who fails is out, and the next one gets a new sample. How often this may happen is fixed beforehand and
   paid for by the confidence of each attempt (`odds`).
6. Where all are refuted, those with more digits than the sample needed are built after all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Generic

import numpy as np

from kanegen.errors import BudgetError
from kanegen.measure.timing import Speedup, Times, speedup
from kanegen.studies.budget.confidence import Validation, judged
from kanegen.studies.budget.evaluator import VALIDATE, Attack, C, Draw, Laboratory
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.screening import Screening

SHOWN = 3
"""Candidates that are named where all fail."""


@dataclass(frozen=True)
class Choice(Generic[C]):
    """The outcome of a search.

    Attributes:
        candidate: The chosen one.
        error: Of it, on the sample by which it was chosen, at the quantile.
        times: Of it.
        validation: Of it.
        attacks: On it, before and after the validation.
        standard: The first one of the field.
        reference: The fastest candidate that is as accurate as that.
        gain: How many times as fast the chosen one is; None where this is not certain.
        verdicts: What became of every candidate, by label, in the order of the field.
    """

    candidate: C
    error: float
    times: Times
    validation: Validation
    attacks: tuple[Attack, ...]
    standard: C
    reference: C
    gain: Speedup | None
    verdicts: dict[str, str]


def choose(laboratory: Laboratory[C], request: Request) -> Choice[C]:
    """The variant that a request asks for.

    Raises:
        BudgetError: If none keeps the budget; says how far one gets and which.
    """
    return _Search(Screening(laboratory, request)).run()


@dataclass(frozen=True)
class _Search(Generic[C]):
    """One search."""

    screening: Screening[C]

    def run(self) -> Choice[C]:
        """See `choose`."""
        remaining, allowed = self.screening.affordable(), self.screening.request.attempts
        attempt = 0
        while attempt < allowed:
            best = self.screening.best(remaining)
            if best is None:
                remaining = self.screening.widened()
                if not remaining:
                    break
                continue
            first = self._attack(best, self.screening.sample, 1)
            if first is None:
                continue
            attempt += 1
            chosen = self._validated(best, first, attempt)
            if chosen is not None:
                return chosen
        raise BudgetError(self._defeat(attempt < allowed))

    def _attack(self, candidate: C, draw: Draw, number: int) -> Attack | None:
        """The outcome of an attack that the candidate survives."""
        known = self.screening
        attack = known.laboratory.attack(candidate, draw, number)
        if attack.error < math.inf and (attack.error <= known.budget or not known.request.is_strict):
            return attack
        refuted = f"; refuted in {attack.evaluations} evaluations: error {attack.error:.1e}. {attack.cause}"
        known.say(candidate, refuted.rstrip("."))
        return None

    def _validated(self, candidate: C, first: Attack, attempt: int) -> Choice[C] | None:
        """The choice, if a fresh sample and a second attack bear it out."""
        known, request = self.screening, self.screening.request
        draw = Draw(VALIDATE, attempt, request.draws)
        errors = known.laboratory.errors(candidate, draw)
        claim = float(np.max([*errors, first.error])) if request.error is None else request.error
        validation = judged(errors, claim, request.alpha, attempt)
        allowed = 0 if request.is_strict else len(errors)
        if validation.exceeded > allowed or validation.limit > request.share or claim == math.inf:
            count = f"{validation.exceeded} of {len(errors)} fresh states exceed {claim:.1e}"
            known.say(candidate, f"; failed validation {attempt}: {count}")
            return None
        second = self._attack(candidate, draw, 2)
        if second is None:
            return None
        if request.error is None:
            validation = judged(errors, max(claim, second.error), request.alpha, attempt)
        return self._choice(candidate, validation, (first, second))

    def _choice(self, candidate: C, validation: Validation, attacks: tuple[Attack, ...]) -> Choice[C]:
        known = self.screening
        known.say(candidate, "; chosen")
        reference = known.reference(known.finals) or candidate
        gain = speedup(known.finals[reference], known.finals[candidate])
        return Choice(
            candidate=candidate,
            error=known.found[candidate],
            times=known.finals[candidate],
            validation=validation,
            attacks=attacks,
            standard=known.laboratory.field[0],
            reference=reference,
            gain=gain if gain.is_real else None,
            verdicts=known.verdicts,
        )

    def _defeat(self, all_tried: bool) -> str:
        if not any(";" in words for words in self.screening.verdicts.values()):
            return self.screening.best_time()
        tried = [f"{label}: {words}." for label, words in self.screening.verdicts.items() if ";" in words]
        more = "" if all_tried else " No further attempt was allowed; see attempts."
        others = f" And {len(tried) - SHOWN} more." if len(tried) > SHOWN else ""
        return (
            f"no variant that kept the budget on the first sample was borne out.{more} "
            f"{' '.join(tried[:SHOWN])}{others}"
        )
