"""What a sample without, or with few, exceedances proves about the states that were not drawn.

A budget is kept in a share of a domain that nobody can count, so it is estimated: of n independent states k
exceeded the budget. The upper limit on the probability to exceed it is that of Clopper and Pearson (1934),
exact for every n and k; for k = 0 it is 1 - alpha^(1/n), the rule of Wilks (1941).

A candidate that fails is replaced by another one with a new sample. So that luck does not pile up, the number
of attempts is fixed beforehand and each has its part of alpha (Bonferroni): whichever attempt ends the
search, a wrong claim has at most the probability alpha.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv

from kanegen.errors import OptionError
from kanegen.model.arrays import Floats


def exceedance_limit(exceeded: int, count: int, alpha: float) -> float:
    """The upper confidence limit, at 1 - alpha, of the probability to exceed.

    Args:
        exceeded: How many of the states did.
        count: How many independent states there were.
        alpha: Probability that the limit is too low.
    """
    if exceeded >= count:
        return 1.0
    return float(betaincinv(exceeded + 1, count - exceeded, 1 - alpha))


def exceedance_floor(exceeded: int, count: int, alpha: float) -> float:
    """The lower confidence limit, at 1 - alpha, of the probability to exceed; arguments as there."""
    return 1 - exceedance_limit(count - exceeded, count, alpha)


def draws_needed(share: float, alpha: float) -> int:
    """The fewest states that, without an exceedance, put the probability to exceed at or below `share`."""
    count = math.ceil(math.log(alpha) / math.log1p(-share))
    while exceedance_limit(0, count, alpha) > share:  # the quotient above may be rounded down
        count += 1
    return count


def corrected(alpha: float, attempts: int) -> float:
    """Each attempt's part of `alpha`."""
    return alpha / attempts


def quantile_level(quantile: float | str) -> float:
    """A quantile as asked for: a number strictly between 0 and 1, or 1.0 for "max".

    Raises:
        OptionError: If it is neither.
    """
    if isinstance(quantile, str) and quantile.strip().lower() == "max":
        return 1.0
    return probability(quantile, "quantile", ' or "max"')


def probability(value: float | str, what: str, alternative: str = "") -> float:
    """A number strictly between 0 and 1.

    Raises:
        OptionError: If it is not.
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not 0 < number < 1:
        raise OptionError(
            f"{what} is {value!r}; it must be a number between 0 and 1, both excluded{alternative}."
        )
    return number


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
