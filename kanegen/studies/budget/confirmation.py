"""The measurements that confirm a candidate, and the rules by which they refute it.

The selection of a variant and the verification of its certificate make the same measurements by the functions
of this module, so that a certificate can be derived again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

import numpy as np

from kanegen.measure.errors import quantile
from kanegen.model.arrays import Floats
from kanegen.studies.budget.confidence import Validation, validate
from kanegen.studies.budget.evaluator import SELECT, VALIDATE, C, Evaluator, SampleSpec, SearchResult
from kanegen.studies.budget.request import Request


@dataclass(frozen=True)
class Confirmation(Generic[C]):
    """The measurements of a candidate that no rule refutes.

    Attributes:
        candidate: The candidate.
        error: Error in the sample for selection, at the quantile of the request.
        validation: Errors in fresh states.
        searches: The searches for a counterexample before and after the validation.
    """

    candidate: C
    error: float
    validation: Validation
    searches: tuple[SearchResult, ...]

    @property
    def worst(self) -> SearchResult:
        """The state with the largest error that the searches found."""
        return max(self.searches, key=lambda search: search.error)

    @property
    def evaluations(self) -> int:
        """Number of states that the searches tried."""
        return sum(search.evaluations for search in self.searches)


def selection_sample(request: Request) -> SampleSpec:
    """Return the sample by which candidates are selected."""
    return SampleSpec(SELECT, 0, request.effort.select)


def fresh_sample(request: Request, attempt: int) -> SampleSpec:
    """Return the sample of one attempt to validate a candidate."""
    return SampleSpec(VALIDATE, attempt, request.fresh_states)


def validated(request: Request, errors: Floats, searches: Sequence[SearchResult], attempt: int) -> Validation:
    """Return the comparison of the errors (n,) in fresh states with the claim.

    The claim is the budget of error or, under a budget of time, the largest error that was found.
    """
    claim = float(np.max([*errors, *(found.error for found in searches)]))
    return validate(errors, claim if request.error is None else request.error, request.alpha, attempt)


def is_refuted_by(request: Request, found: SearchResult) -> bool:
    """Return whether the largest error that a search found refutes a candidate."""
    budget = math.inf if request.error is None else request.error
    return found.error == math.inf or (request.is_strict and found.error > budget)


def is_refuted(request: Request, validation: Validation) -> bool:
    """Return whether the errors in fresh states refute a candidate."""
    allowed = 0 if request.is_strict else len(validation.errors)
    return validation.exceeded > allowed or validation.limit > request.share or validation.claim == math.inf


def confirmation(evaluator: Evaluator[C], request: Request, candidate: C, attempt: int) -> Confirmation[C]:
    """Return the measurements of a candidate, made anew, whatever they say.

    Args:
        evaluator: The evaluator that measures the candidate, which was built.
        request: The request of the user.
        candidate: The candidate.
        attempt: Number of the attempt in which the candidate was validated, counted from 1.
    """
    selection, fresh = selection_sample(request), fresh_sample(request, attempt)
    error = quantile(evaluator.errors(candidate, selection), request.quantile)
    searches = (evaluator.search(candidate, selection, 1), evaluator.search(candidate, fresh, 2))
    errors = evaluator.errors(candidate, fresh)
    return Confirmation(candidate, error, validated(request, errors, searches, attempt), searches)
