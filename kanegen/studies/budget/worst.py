"""A single state in the words of a certificate, and why it is a hard one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from kanegen.errors import CertificateError
from kanegen.model.arrays import Floats
from kanegen.studies.tradeoff.domain import Domain
from kanegen.studies.tradeoff.judge import Exact, Judge
from kanegen.studies.tradeoff.samples import Sample


def state(sample: Sample) -> dict[str, Any]:
    """One state, its numbers in hexadecimal: exactly, and the same on every machine."""
    (row,) = sample.flat()
    m, n = sample.states.x.shape[1], sample.tau.shape[1]
    loads = (len(row) - m - 2 * n) // 2
    ends = np.cumsum([m, n, n, loads, loads])
    names = ("x", "y", "tau", "force", "torque")
    parts = zip(names, np.split(row, ends)[: len(names)], strict=True)
    return {name: [float(value).hex() for value in values] for name, values in parts if len(values)}


def sample_of(domain: Domain, words: Mapping[str, Any]) -> Sample:
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


def cause(judge: Judge, worst: Sample, ordinary: Sample) -> str:
    """A sentence that says what makes a state hard, beside ordinary ones, and how to exclude it."""
    (exact,) = judge.truths(worst)
    usual = judge.truths(ordinary)
    factors = {what: _of(exact, what) / float(np.median([_of(e, what) for e in usual])) for what in _REMEDIES}
    hardest = max(factors, key=factors.__getitem__)
    if not factors[hardest] > _NOTABLE:
        return "Nothing about the state is unusual."
    return _REMEDIES[hardest].format(_of(exact, hardest))


_NOTABLE = 10.0
"""Times the usual value, at which it is named."""

_REMEDIES = {
    "chi": "There accelerations cancel, chi = {0:.1e}: exclude it by exclude.cancellation in the domain.",
    "kappa_s": (
        "There [A] is nearly singular, kappa_s = {0:.1e}: exclude it by narrower ranges in the domain "
        "or, near gimbal lock, by exclude.clearance."
    ),
    "formation": "There terms of [A] or {{f}} cancel, {0:.1e}: exclude it by narrower ranges in the domain.",
}


def _of(exact: Exact, what: str) -> float:
    value: float = getattr(exact.conditioning, what)
    return min(value, 1e300)


def ranges(judge: Judge, sample: Sample) -> dict[str, list[float]]:
    """The least and the largest kappa_s, chi and formation over a sample."""
    exacts = judge.truths(sample)
    values: dict[str, Floats] = {what: np.array([_of(e, what) for e in exacts]) for what in _REMEDIES}
    return {what: [float(v.min()), float(v.max())] for what, v in values.items()}
