"""Bounds on the normwise errors of generated code, and how they fit what is measured.

With u the unit roundoff, N bodies, and chi, kappa_s and the formation from `conditioning`:

- forward dynamics: 4 u chi formation (4 N + kappa_s). Rounding grows at most linearly along the tree, and a
  solution multiplies it by the condition number; the formation says how much larger than [A] and {f} the
  terms are that were rounded. While formation kappa_s u < 0.01; beyond, nothing is promised.
- outputs that are sums: 4 u chi 4 N, where chi is the cancellation of their own terms.

The numbers are calibrated: the factor 4 stands well above the largest ratio of an error to the rest that has
been seen in double and single precision, over trees that have ordinary numbers, masses growing a hundredfold
a link, straight chains, and right-hand sides that cancel. `Fit` tells whether it still does.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from kanegen.errors import OptionError

FACTOR = 4.0
"""What is allowed of the rest of a bound."""

PER_BODY = 4.0
"""Roundings of a body and its joint that add up."""

LARGEST_LOSS = 0.01
"""Of formation kappa_s u, for which the bound on a solution holds."""


def bound(
    unit_roundoff: float, bodies: int, chi: float, kappa_s: float = 0.0, formation: float = 1.0
) -> float:
    """The bound on a normwise error; infinite where nothing is promised.

    Args:
        unit_roundoff: u.
        bodies: N.
        chi: Cancellation.
        kappa_s: Scaled condition number of [A]; 0 for outputs that need no solution.
        formation: Cancellation inside [A] and {f}; 1 for these.
    """
    if not formation * kappa_s * unit_roundoff < LARGEST_LOSS:
        return math.inf
    return FACTOR * unit_roundoff * chi * formation * (PER_BODY * bodies + kappa_s)


@dataclass(frozen=True)
class Fit:
    """Errors over bounds without their factor, in many states: what `FACTOR` has to cover.

    Attributes:
        count: States in which the bound holds.
        outside: States in which it promises nothing; they are left out of the rest.
        median: Of the ratios.
        high: Their 99th percentile.
        largest: The largest.
    """

    count: int
    outside: int
    median: float
    high: float
    largest: float

    def __str__(self) -> str:
        """One line."""
        beyond = f", {self.outside} beyond the bound's reach" if self.outside else ""
        return (
            f"{self.count} states{beyond}: median {self.median:.2g}, 99 % below {self.high:.2g}, "
            f"largest {self.largest:.2g} of {FACTOR:g}"
        )

    @property
    def holds(self) -> bool:
        """Whether `FACTOR` covers every state."""
        return self.largest <= FACTOR


def fit(errors: Iterable[float], allowed: Iterable[float]) -> Fit:
    """The fit of `bound` to measured errors.

    Args:
        errors: Normwise.
        allowed: `bound` in the same states.

    Raises:
        OptionError: If the bound holds in none of the states.
    """
    pairs = list(zip(errors, allowed, strict=True))
    ratios = [FACTOR * error / limit for error, limit in pairs if math.isfinite(limit)]
    if not ratios:
        raise OptionError("there is no state in which the bound promises anything: nothing to fit.")
    median, high = np.quantile(ratios, [0.5, 0.99])
    return Fit(len(ratios), len(pairs) - len(ratios), float(median), float(high), float(max(ratios)))
