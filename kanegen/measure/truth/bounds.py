"""Bounds on the normwise errors of generated code, and their fit to measured errors.

With u the unit roundoff, N bodies, and chi, kappa_s and the formation from `conditioning`:

- forward dynamics: 4 u chi formation (4 N + kappa_s). Rounding grows at most linearly along the tree, and a
  solution multiplies it by the condition number. The formation says how much larger than [A] and {f} the
  terms are that were rounded. The bound holds while formation kappa_s u < 0.01; beyond, nothing is
  promised.
- outputs that are sums: 4 u chi 4 N, where chi is the cancellation of their own terms.

The form of the bounds is derived, their factor is calibrated: 4 stands well above the largest ratio of an
error to the rest of its bound that was found in double and single precision, over trees with ordinary
numbers, masses that grow a hundredfold a link, straight chains, and right-hand sides that cancel. A `Fit`
says whether the factor covers other measurements, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from kanegen.errors import OptionError

FACTOR = 4.0
"""Calibrated factor of every bound."""

PER_BODY = 4.0
"""Number of roundings of a body and its joint that add up."""

LARGEST_LOSS = 0.01
"""Limit of formation kappa_s u, below which the bound on a solution holds."""


def bound(
    unit_roundoff: float, bodies: int, chi: float, kappa_s: float = 0.0, formation: float = 1.0
) -> float:
    """Return the bound on a normwise error; infinity where nothing is promised.

    Args:
        unit_roundoff: Unit roundoff u of the program.
        bodies: Number of bodies N.
        chi: Cancellation of the right-hand side or, for an output that is a sum, of its own terms.
        kappa_s: Scaled condition number of [A]; 0 for outputs that need no solution.
        formation: Cancellation inside [A] and {f}; 1 for outputs that need no solution.

    Example:
        >>> truth.bound(2.0**-53, bodies=2, chi=1.0, kappa_s=10.0)
        7.993605777301127e-15
    """
    if not formation * kappa_s * unit_roundoff < LARGEST_LOSS:
        return math.inf
    return FACTOR * unit_roundoff * chi * formation * (PER_BODY * bodies + kappa_s)


@dataclass(frozen=True)
class Fit:
    """The ratios of errors to bounds without their factor, over many states; `FACTOR` has to cover them.

    Attributes:
        count: Number of states in which the bound holds.
        outside: Number of states in which it promises nothing; they do not count for the ratios.
        median: Median ratio.
        high: 99th percentile of the ratios.
        largest: Largest ratio.
    """

    count: int
    outside: int
    median: float
    high: float
    largest: float

    def __str__(self) -> str:
        """Return the fit in one line."""
        beyond = f", {self.outside} beyond the bound's reach" if self.outside else ""
        return (
            f"{self.count} states{beyond}: median {self.median:.2g}, 99 % below {self.high:.2g}, "
            f"largest {self.largest:.2g} of {FACTOR:g}"
        )

    @property
    def holds(self) -> bool:
        """Whether `FACTOR` covers every state."""
        return self.largest <= FACTOR


def fit(errors: Iterable[float], bounds: Iterable[float]) -> Fit:
    """Return the fit of bounds to measured errors.

    Args:
        errors: Normwise errors, one for each state.
        bounds: Values of `bound` in the same states.

    Raises:
        OptionError: If the bound promises nothing in any of the states.

    Example:
        >>> print(truth.fit(measured.normwise, measured.bound))
    """
    pairs = list(zip(errors, bounds, strict=True))
    ratios = [FACTOR * error / limit for error, limit in pairs if math.isfinite(limit)]
    if not ratios:
        raise OptionError("there is no state in which the bound promises anything: nothing to fit.")
    median, high = np.quantile(ratios, [0.5, 0.99])
    return Fit(len(ratios), len(pairs) - len(ratios), float(median), float(high), float(max(ratios)))
