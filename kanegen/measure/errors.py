"""Errors of results over many states: definitions that every measurement shares, and their statistics.

With E the difference of a result from the true one, t the true one, and S factors that take the units away:

- normwise error: ||S E|| / ||S t||, Euclidean for vectors and Frobenius for [A].
- componentwise error: the largest |E_i| over the size of entry i. `comparison` takes the magnitudes of the
  terms of the entry as its size, `truth.errors` the entry itself.

A result that is not finite has infinite errors.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from kanegen.model.arrays import Flags, Floats
from kanegen.reference.matrices import length

QUANTILES = {"median": 0.5, "p90": 0.9, "p99": 0.99, "p99.9": 0.999, "max": 1.0}
"""Shares of the states that an error is not to exceed, by name."""


@dataclass(frozen=True)
class Errors:
    """Errors of one output in B states.

    Attributes:
        normwise: (B,) normwise errors; infinite where a result is not finite.
        componentwise: (B,) componentwise errors.
    """

    normwise: Floats
    componentwise: Floats

    def __len__(self) -> int:
        """Return the number of states B."""
        return len(self.normwise)

    def __getitem__(self, rows: slice | list[int]) -> Self:
        """Return the errors in some of the states."""
        return type(self)(*(values[rows] for values in vars(self).values()))

    def quantile(self, share: float) -> float:
        """Return the normwise error that this share of the states does not exceed; see `quantile`."""
        return quantile(self.normwise, share)

    @property
    def median(self) -> float:
        """Median of the normwise errors."""
        return self.quantile(QUANTILES["median"])

    @property
    def p99(self) -> float:
        """Normwise error that 99 % of the states do not exceed."""
        return self.quantile(QUANTILES["p99"])

    @property
    def max(self) -> float:
        """Largest normwise error over all states."""
        return self.quantile(QUANTILES["max"])

    @property
    def worst(self) -> int:
        """Index of the state with the largest normwise error."""
        return int(self.normwise.argmax())

    @property
    def failed(self) -> Flags:
        """(B,) flags of the states without a finite result."""
        failed: Flags = ~np.isfinite(self.normwise)
        return failed


def quantile(errors: Floats, share: float) -> float:
    """Return the smallest of the errors (B,) that at least this share of them does not exceed.

    A NaN counts as an infinite error.
    """
    ordered = np.sort(np.where(np.isnan(errors), np.inf, errors))
    return float(np.quantile(ordered, share, method="inverted_cdf"))


def scaled_norm(values: Floats, scale: Floats) -> Floats:
    """Return the (B,) Euclidean norms of `values` times `scale`, both (B, ...)."""
    return length((values * scale).reshape(len(values), -1))


def quotient(difference: Floats, size: Floats) -> Floats:
    """Return `difference` over `size`: 0 where `difference` is 0, infinite where it is undefined."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        quotient = np.where(difference == 0, 0.0, difference / size)
    return np.where(np.isnan(quotient), np.inf, quotient)
