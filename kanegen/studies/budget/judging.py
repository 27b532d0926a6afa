"""What errors in a sample say about a claim."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.studies.budget.confidence import exceedance_limit


@dataclass(frozen=True)
class Validation:
    """What a fresh sample says.

    Attributes:
        errors: (n,) in its states.
        claim: The error that is claimed: the budget or, where time has the budget, the largest error found.
        exceeded: How many states exceed the claim.
        limit: Upper limit on the share of the domain that does.
        attempt: Which attempt it was, from 1.
    """

    errors: Floats
    claim: float
    exceeded: int
    limit: float
    attempt: int


def judged(errors: Floats, claim: float, alpha: float, attempt: int) -> Validation:
    """The errors (n,) of a fresh sample against a claim; what is no number exceeds every claim."""
    exceeded = int(np.sum(~(errors <= claim)))
    return Validation(errors, claim, exceeded, exceedance_limit(exceeded, len(errors), alpha), attempt)


def at_quantile(errors: Floats, quantile: float) -> float:
    """The smallest of the errors (n,) that at least this share of them does not exceed."""
    ordered = np.sort(np.where(np.isnan(errors), np.inf, errors))
    return float(np.quantile(ordered, quantile, method="inverted_cdf"))
