"""Confidence limits: statements on a whole domain of states from the errors in a random sample.

The share of a domain in which an error exceeds a claim cannot be counted, so it is estimated: k of n
independent states exceed the claim. The upper limit on the probability of exceeding it is that of Clopper and
Pearson (1934), exact for every n and k. For k = 0 it is 1 - alpha^(1/n), the rule of Wilks (1941).

A candidate that fails is replaced by another one, which gets a new sample. So that repeated attempts do not
make a lucky result likely, the number of attempts is fixed beforehand and each attempt gets an equal part of
alpha (Bonferroni): the whole search ends with a wrong claim with a probability of at most alpha.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv

from kanegen.errors import OptionError
from kanegen.model.arrays import Floats


@dataclass(frozen=True)
class Validation:
    """The errors in a fresh sample, compared with a claim.

    Attributes:
        errors: (n,) errors in the states of the sample.
        claim: The error that is claimed: the budget or, under a budget of time, the largest error found.
        exceeded: Number of states whose error exceeds the claim.
        limit: Upper confidence limit on the share of the domain in which the error exceeds the claim.
        attempt: Number of the attempt, counted from 1.
    """

    errors: Floats
    claim: float
    exceeded: int
    limit: float
    attempt: int


def validate(errors: Floats, claim: float, alpha: float, attempt: int) -> Validation:
    """Compare the errors (n,) of a fresh sample with a claim; NaN exceeds every claim.

    Args:
        errors: (n,) errors in the states of the sample.
        claim: The error that is claimed.
        alpha: Probability with which the limit on the share may be too low.
        attempt: Number of the attempt, counted from 1.
    """
    exceeded = int(np.sum(~(errors <= claim)))
    return Validation(errors, claim, exceeded, exceedance_limit(exceeded, len(errors), alpha), attempt)


def exceedance_limit(exceeded: int, count: int, alpha: float) -> float:
    """Return the upper confidence limit, at 1 - alpha, of the probability of exceeding a claim.

    Args:
        exceeded: Number of states in which the claim is exceeded.
        count: Number of independent states.
        alpha: Probability with which the limit may be too low.
    """
    if exceeded >= count:
        return 1.0
    return float(betaincinv(exceeded + 1, count - exceeded, 1 - alpha))


def exceedance_floor(exceeded: int, count: int, alpha: float) -> float:
    """Return the lower confidence limit, at 1 - alpha, of the probability of exceeding a claim.

    The arguments are those of `exceedance_limit`.
    """
    return 1 - exceedance_limit(count - exceeded, count, alpha)


def states_needed(share: float, alpha: float) -> int:
    """Return the smallest number of states that, if none exceeds a claim, show a share of at most `share`.

    Args:
        share: Share of the domain that may exceed the claim.
        alpha: Probability with which the limit may be too low.
    """
    count = math.ceil(math.log(alpha) / math.log1p(-share))
    while exceedance_limit(0, count, alpha) > share:  # the quotient above may be rounded down
        count += 1
    return count


def alpha_of_attempt(alpha: float, attempts: int) -> float:
    """Return the part of `alpha` that each of `attempts` attempts may use (Bonferroni)."""
    return alpha / attempts


def quantile_level(quantile: float | str) -> float:
    """Return a quantile as a number strictly between 0 and 1, or 1.0 for "max".

    Raises:
        OptionError: If `quantile` is neither.
    """
    if isinstance(quantile, str) and quantile.strip().lower() == "max":
        return 1.0
    return probability(quantile, "quantile", ' or "max"')


def probability(value: float | str, name: str, alternative: str = "") -> float:
    """Return a number strictly between 0 and 1.

    Args:
        value: The number, or its text.
        name: Name of the number in the error message.
        alternative: Alternative to a number, for the error message.

    Raises:
        OptionError: If the value is no such number.
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not 0 < number < 1:
        raise OptionError(
            f"{name} is {value!r}; it must be a number between 0 and 1, both excluded{alternative}."
        )
    return number
