"""The errors of one variant in many states."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Flags, Floats

GATE = 10.0
"""Roundings a body that a backward error may amount to; more is a wrong program, not an inaccurate one."""

QUANTILES = {"median": 0.5, "p99": 0.99, "max": 1.0}
"""By which of its errors a variant may be ranked."""


@dataclass(frozen=True)
class Errors:
    """The errors of {ydot}; every array is (B,).

    Attributes:
        normwise: See `check.truth.errors`; infinite where a result is not finite.
        componentwise: Likewise.
        normalised: The normwise error over u chi formation (4 N + kappa_s), the bound of `check.truth.bounds`
            without its factor; NaN where nothing is promised.
        backward: The part of the terms of [A]{ydot} - {f} - {tau} that is left of their sum, over N u.
    """

    normwise: Floats
    componentwise: Floats
    normalised: Floats
    backward: Floats

    def __len__(self) -> int:
        """B."""
        return len(self.normwise)

    def __getitem__(self, rows: slice | list[int]) -> Errors:
        """Those of some of the states."""
        return Errors(*(values[rows] for values in vars(self).values()))

    def quantile(self, share: float) -> float:
        """The normwise error that this share of the states does not exceed; it is that of one of them.

        A state without a result counts as an infinite error.
        """
        return float(np.quantile(self.normwise, share, method="inverted_cdf"))

    @property
    def median(self) -> float:
        """Of the normwise errors."""
        return self.quantile(QUANTILES["median"])

    @property
    def high(self) -> float:
        """The normwise error that 99 % of the states do not exceed."""
        return self.quantile(QUANTILES["p99"])

    @property
    def max(self) -> float:
        """The largest normwise error."""
        return self.quantile(QUANTILES["max"])

    @property
    def worst(self) -> int:
        """Place of the state with the largest normwise error."""
        return int(self.normwise.argmax())

    @property
    def bound_share(self) -> float:
        """The largest normalised error; `check.truth.bounds.FACTOR` is promised. NaN if nothing is."""
        promised = self.normalised[~np.isnan(self.normalised)]
        return float(promised.max()) if promised.size else np.nan

    @property
    def failed(self) -> Flags:
        """(B,) where there is no finite result."""
        lost: Flags = ~np.isfinite(self.normwise)
        return lost

    @property
    def wrong(self) -> Flags:
        """(B,) where a result does not solve the equations: no rounding explains its backward error."""
        beyond: Flags = ~self.failed & ~(self.backward <= GATE)
        return beyond
