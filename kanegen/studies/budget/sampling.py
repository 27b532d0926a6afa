"""Samples of a region, each from a stream of random numbers of its own."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from kanegen.errors import CertificateError, OptionError
from kanegen.studies.budget.region import Region
from kanegen.studies.tradeoff.domain import Domain
from kanegen.studies.tradeoff.judge import Judge
from kanegen.studies.tradeoff.samples import Sample, joined

STREAMS = ("select", "validate", "verify", "attack", "bits", "time")
"""What samples are drawn for; no two of them share a stream."""

_LEAST_SHARE = 0.01
"""Of a box that must be left after what is excluded, so that drawing from it comes to an end."""


def stream(seed: int, purpose: str, number: int) -> np.random.Generator:
    """The random numbers of one sample."""
    return np.random.default_rng([seed, STREAMS.index(purpose), number])


def drawn(region: Region, judge: Judge, count: int, rng: np.random.Generator) -> Sample:
    """`count` states, uniform over the region.

    Raises:
        OptionError: If next to nothing of the box cancels as little as is allowed.
    """
    if region.cancellation == math.inf:
        return region.domain.states(region.domain.uniform(count, rng))
    kept: list[Sample] = []
    tried = 0
    while len(kept) < count:
        sample = region.domain.states(region.domain.uniform(count, rng))
        kept += [sample[k : k + 1] for k, fits in enumerate(within(region, judge, sample)) if fits]
        tried += count
        if len(kept) < _LEAST_SHARE * tried:
            raise OptionError(
                f"domain: of {tried} states of the box {len(kept)} cancel less than {region.cancellation:g}. "
                "Raise exclude.cancellation."
            )
    return joined(kept[:count])


def within(region: Region, judge: Judge, sample: Sample) -> list[bool]:
    """For every state of a sample whether it is part of the region."""
    if region.cancellation == math.inf:
        return [region.domain.contains(sample[k : k + 1]) for k in range(len(sample))]
    return [
        region.domain.contains(sample[k : k + 1]) and exact.conditioning.chi <= region.cancellation
        for k, exact in enumerate(judge.truths(sample))
    ]


def state_table(sample: Sample) -> dict[str, Any]:
    """One state, its numbers in hexadecimal: exactly, and the same on every machine."""
    (row,) = sample.flat()
    m, n = sample.states.x.shape[1], sample.tau.shape[1]
    loads = (len(row) - m - 2 * n) // 2
    ends = np.cumsum([m, n, n, loads, loads])
    names = ("x", "y", "tau", "force", "torque")
    parts = zip(names, np.split(row, ends)[: len(names)], strict=True)
    return {name: [float(value).hex() for value in values] for name, values in parts if len(values)}


def sample_from_table(domain: Domain, words: Mapping[str, Any]) -> Sample:
    """The state that `state` put into words.

    Raises:
        CertificateError: If it is none of this domain's system.
    """
    try:
        row = [float.fromhex(value) for name in words for value in words[name]]
    except (TypeError, ValueError, OverflowError):
        row = []
    if len(row) != domain.size:
        raise CertificateError("its worst state is none of this model.")
    return domain.states(np.array([row]))
