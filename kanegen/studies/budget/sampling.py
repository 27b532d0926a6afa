"""Random samples of a region, and single states as plain data.

Each sample has a separate stream of random numbers, so that no two samples share a state.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from kanegen.errors import CertificateError, OptionError
from kanegen.studies.budget.region import Region
from kanegen.studies.tradeoff.domain import Domain, Sample, joined
from kanegen.studies.tradeoff.exact_results import ExactResults

PURPOSES = ("select", "validate", "verify", "search", "bits", "time")
"""The purposes of samples; the index of a purpose is part of the seed, so no two purposes share a stream."""

_LEAST_SHARE = 0.01
"""Smallest share of a box that may be left by the exclusions, so that rejection sampling ends."""


def random_stream(seed: int, purpose: str, number: int) -> np.random.Generator:
    """Return the generator of the random numbers of one sample.

    Args:
        seed: Seed of all samples of a request.
        purpose: Purpose of the sample, one of `PURPOSES`.
        number: Number of the sample among those of its purpose.
    """
    return np.random.default_rng([seed, PURPOSES.index(purpose), number])


def sample_region(region: Region, exact: ExactResults, count: int, rng: np.random.Generator) -> Sample:
    """Return `count` random states that are uniformly distributed over a region.

    Args:
        region: The states to choose from.
        exact: Exact results of the system of the region, which hold the cancellation of a state.
        count: Number of states.
        rng: Generator of the random numbers.

    Raises:
        OptionError: If less than a hundredth of the box belongs to the region.
    """
    if region.cancellation == math.inf:
        return region.domain.states(region.domain.uniform(count, rng))
    kept: list[Sample] = []
    tried = 0
    while len(kept) < count:
        sample = region.domain.states(region.domain.uniform(count, rng))
        kept += [sample[k : k + 1] for k, inside in enumerate(in_region(region, exact, sample)) if inside]
        tried += count
        if len(kept) < _LEAST_SHARE * tried:
            raise OptionError(
                f"domain: in only {len(kept)} of {tried} states of the box accelerations cancel less than "
                f"{region.cancellation:g}. Raise exclude.cancellation."
            )
    return joined(kept[:count])


def in_region(region: Region, exact: ExactResults, sample: Sample) -> list[bool]:
    """Return for each state of a sample whether it belongs to the region."""
    if region.cancellation == math.inf:
        return [region.domain.contains(sample[k : k + 1]) for k in range(len(sample))]
    return [
        region.domain.contains(sample[k : k + 1]) and state.conditioning.chi <= region.cancellation
        for k, state in enumerate(exact.states(sample))
    ]


def state_table(sample: Sample) -> dict[str, Any]:
    """Return a sample of one state as a table of hexadecimal numbers, which are exact on every machine."""
    (row,) = sample.flat()
    m, n = sample.x.shape[1], sample.tau.shape[1]
    loads = (len(row) - m - 2 * n) // 2
    ends = np.cumsum([m, n, n, loads, loads])
    names = ("x", "y", "tau", "force", "torque")
    parts = zip(names, np.split(row, ends)[: len(names)], strict=True)
    return {name: [float(value).hex() for value in values] for name, values in parts if len(values)}


def sample_from_table(domain: Domain, table: Mapping[str, Any]) -> Sample:
    """Return the state that `state_table` wrote, as a sample of one state.

    Raises:
        CertificateError: If the table holds no state of the system of the domain.
    """
    try:
        row = [float.fromhex(value) for name in table for value in table[name]]
    except (TypeError, ValueError, OverflowError):
        row = []
    if len(row) != domain.size:
        raise CertificateError("its worst state is not a state of this model.")
    return domain.states(np.array([row]))
