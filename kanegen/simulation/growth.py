"""How a small change of the first state grows along a motion, and until when errors stay small."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats as Doubles

SATURATED = 0.05
"""Size of a difference, in units of the motion itself, beyond which it grows no longer like a small one."""

_LEAST = 20.0
"""Factor by which a difference must have grown, so that its growth can be told from that of other motions."""


@dataclass(frozen=True)
class Growth:
    """The size of a difference between two motions over the time, over its size at the start.

    Attributes:
        times: (T,) times, s.
        factors: (T,) largest factor up to each time; beyond saturation it is continued with `rate`.
        rate: Rate of exponential growth, 1/s, the estimate of the largest Lyapunov exponent; 0 where the
            growth is that of a motion that is not chaotic, a power of the time.
    """

    times: Doubles
    factors: Doubles
    rate: float

    @property
    def is_chaotic(self) -> bool:
        """Whether differences grow exponentially."""
        return self.rate > 0

    @property
    def lyapunov_time(self) -> float:
        """Time in which differences grow by a factor of e, s; infinite for a motion that is not chaotic."""
        return 1 / self.rate if self.rate > 0 else np.inf

    def kept_until(self, first: float, allowed: float) -> float:
        """Return the time (s) until which a first difference stays below a limit; the last time at most."""
        return prefix_end(self.times, first * self.factors, allowed)

    def horizon(self, first: float, allowed: float) -> float:
        """Return the time (s) until which a first difference stays small, also beyond the last time.

        Returns infinity for a motion that is not chaotic.
        """
        if not self.is_chaotic:
            return np.inf
        end = self.times[-1] + np.log(allowed / (first * self.factors[-1])) / self.rate
        return float(end) if end > self.times[-1] else self.kept_until(first, allowed)


def growth_of(times: Doubles, differences: Doubles, first: float) -> Growth:
    """Return the growth of differences between a motion and its neighbours.

    Args:
        times: (T,) times, s.
        differences: (T,) largest difference at each time, in units of the motion.
        first: Difference at the first time.
    """
    largest = np.maximum.accumulate(np.maximum(differences, first))
    small = largest < SATURATED
    count = len(times) if small.all() else int(np.argmin(small))
    factors = largest / first
    rate = _rate(times[:count], factors[:count])
    if count < len(times) and rate > 0:
        start = max(count - 1, 0)
        factors = factors.copy()
        factors[start:] = factors[start] * np.exp(np.minimum(rate * (times[start:] - times[start]), 600.0))
    return Growth(times, factors, rate)


def _rate(times: Doubles, factors: Doubles) -> float:
    """Return the rate of exponential growth (1/s), 0 where a power of the time describes it as well.

    Of ln f = a + r t and ln f = a + p ln t, over the later half of the times, that with the smaller residual
    is taken.
    """
    if len(times) < 8 or factors[-1] < _LEAST:
        return 0.0
    late = slice(len(times) // 4, None)
    t, values = times[late] - times[0], np.log(factors[late])
    fits = [np.polyfit(shape, values, 1, full=True) for shape in (t, np.log(t))]
    exponential, power = (float(fit[1][0]) if len(fit[1]) else 0.0 for fit in fits)
    rate = float(fits[0][0][0])
    return rate if exponential < power and rate * (times[-1] - times[0]) > np.log(_LEAST) else 0.0


def prefix_end(times: Doubles, values: Doubles, allowed: float) -> float:
    """Return the last time (s) up to which all values are at most `allowed`; the first time at least."""
    beyond = ~(values <= allowed)
    return float(times[max(int(np.argmax(beyond)) - 1, 0)] if beyond.any() else times[-1])
