"""A short hill climb to the states of a domain in which an error is largest.

It counts evaluations, not seconds, so the same seed finds the same states on every machine.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.studies.tradeoff.domain import Domain
from kanegen.studies.tradeoff.samples import Sample

FOUND = "found by search"
"""The stratum of the states that come of it."""

_TOGETHER = 8
"""States that are tried at once, of which the worst is climbed from."""

_FINEST = 5.0
"""Powers of ten between the box and the smallest step."""


def climb(
    domain: Domain,
    start: Sample,
    error: Callable[[Sample], Floats],
    evaluations: int,
    seed: int | Sequence[int],
) -> tuple[Sample, float]:
    """The worst state that was found, and its error.

    Every step changes a few numbers of the worst state so far, by steps of all sizes.

    Args:
        domain: Not to be left.
        start: One state of it.
        error: (B,) of a sample; infinite where there is no result.
        evaluations: How many states are tried.
        seed: Of the generator.
    """
    rng, width = np.random.default_rng(seed), domain.high - domain.low
    worst, height = start, float(error(start)[0])
    for tried in range(0, evaluations, _TOGETHER):
        count = min(_TOGETHER, evaluations - tried)
        changed = rng.random((count, domain.size)) < rng.choice([1 / domain.size, 0.1, 1.0], (count, 1))
        step = rng.standard_normal((count, domain.size)) * 10.0 ** -rng.uniform(0.5, _FINEST, (count, 1))
        sample = domain.states(worst.flat() + width * step * changed, FOUND)
        inside = [k for k in range(count) if domain.contains(sample[k : k + 1])]
        errors = error(sample)
        best = max(inside, key=lambda k: errors[k], default=None)
        if best is not None and errors[best] > height:
            worst, height = sample[best : best + 1], float(errors[best])
    return replace(worst, strata=(FOUND,)), height
