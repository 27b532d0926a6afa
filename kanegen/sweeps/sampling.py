"""Samples of several distributions at once: quasi-random sequences and Latin hypercubes of SciPy."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.choices import require_one
from kanegen.errors import OptionError, quoted, warn
from kanegen.extras import module
from kanegen.model.arrays import Floats
from kanegen.sweeps.axes import EXTRA, Distribution

MOST_SAMPLES = 100_000_000
"""Largest number of samples."""

METHODS = ("sobol", "halton", "latin_hypercube", "random")
"""Methods of sampling: two scrambled quasi-random sequences, Latin hypercubes, and independent numbers."""

_SMALLEST = 2.0**-54
"""Shares are at least this far from 0 and 1, where quantiles may be infinite."""


@dataclass(frozen=True)
class Sampling:
    """How the axes with distributions are sampled together.

    Attributes:
        count: Number of samples S; each is combined with all values of the other axes.
        method: One of `METHODS`. "sobol" and "halton" cover the space evenly, so that means converge faster
            than with "random" numbers; "latin_hypercube" covers every axis alone evenly.
        seed: Seed, with which the same samples come again.

    Raises:
        OptionError: If a value is unknown or out of range.

    Example:
        Sampling(1024, "latin_hypercube", seed=7)
    """

    count: int = 1024
    method: str = "sobol"
    seed: int = 0

    def __post_init__(self) -> None:
        """Check every value, and make whole numbers plain."""
        require_one("method of sampling", self.method, METHODS)
        for name, least, most in (("count", 1, MOST_SAMPLES), ("seed", 0, 2**63)):
            value = getattr(self, name)
            if (
                isinstance(value, bool)
                or not isinstance(value, int | np.integer)
                or not least <= value <= most
            ):
                raise OptionError(
                    f"samples: {name}: {quoted(value)} is no whole number from {least} to {most}."
                )
            object.__setattr__(self, name, int(value))

    @property
    def plain(self) -> dict[str, Any]:
        """The sampling in plain data."""
        return {"count": self.count, "method": self.method, "seed": self.seed}

    def draw(self, axes: Mapping[str, Distribution]) -> dict[str, Floats]:
        """Return (S,) values for each axis; nothing if there is none.

        Raises:
            MissingError: If SciPy is not installed.

        Warns:
            KanegenWarning: If the number of Sobol points is no power of two.
        """
        if not axes:
            return {}
        if self.method == "sobol" and self.count & (self.count - 1):
            warn(
                f"samples: {self.count} Sobol points do not cover the space evenly. Take a power of two, "
                f"such as {1 << self.count.bit_length()}."
            )
        with warnings.catch_warnings(action="ignore"):  # SciPy's warning about the same
            shares = _SHARES[self.method](self.count, len(axes), self.seed)
        inside = np.clip(shares, _SMALLEST, 1 - _SMALLEST)
        return {
            name: axis.quantiles(np.ascontiguousarray(column))
            for (name, axis), column in zip(axes.items(), inside.T, strict=True)
        }


def _quasi(engine: str) -> Callable[[int, int, int], Floats]:
    """Return the function that draws (count, axes) shares from a class of `scipy.stats.qmc`."""

    def draw(count: int, axes: int, seed: int) -> Floats:
        """Return shares between 0 and 1."""
        kind = getattr(module("scipy.stats.qmc", extra=EXTRA), engine)
        shares: Floats = kind(axes, rng=np.random.default_rng(seed)).random(count)
        return shares

    return draw


def _random(count: int, axes: int, seed: int) -> Floats:
    """Return independent shares, uniform between 0 and 1."""
    return np.random.default_rng(seed).random((count, axes))


_SHARES: Mapping[str, Callable[[int, int, int], Floats]] = {
    "sobol": _quasi("Sobol"),
    "halton": _quasi("Halton"),
    "latin_hypercube": _quasi("LatinHypercube"),
    "random": _random,
}
