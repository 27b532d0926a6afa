"""A search for a state of the region in which a variant errs most.

It begins with the worst states of a sample and, the first time, with states where arithmetic is hard
(`study.strata`); from the worst of all it climbs (`study.search`). It can refute a claim, never prove one.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kanegen.measure.truth.measurement import ExactState
from kanegen.model.arrays import Floats
from kanegen.studies.budget.evaluator import Attack
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.sampling import state_table, within
from kanegen.studies.tradeoff.hard_states import climb, hard_states
from kanegen.studies.tradeoff.judge import Judge
from kanegen.studies.tradeoff.samples import Sample, joined

CLIMBS = 4
"""States from which it is climbed."""

_STRATA = 3
"""Of all evaluations one in so many goes to the states of the strata."""


def attacked(
    region: Region,
    judge: Judge,
    error: Callable[[Sample], Floats],
    sample: Sample,
    evaluations: int,
    seed: int,
    hard: bool,
) -> Attack:
    """The outcome of a search.

    Args:
        region: Not to be left.
        judge: Of its system.
        error: (B,) of a sample.
        sample: Where to begin.
        evaluations: States that may be tried.
        seed: Of the search.
        hard: Whether the strata are tried as well.
    """
    inside = _only_inside(region, judge, error)
    begun = _beginnings(region, judge, sample, evaluations // _STRATA if hard else 0, seed)
    heights = error(begun)
    tried = len(begun) - len(sample)
    order = np.argsort(-heights, kind="stable")[:CLIMBS]
    each = max(1, (evaluations - tried) // len(order))
    found = [
        climb(region.domain, begun[k : k + 1], inside, each, seed + rank) for rank, k in enumerate(order)
    ]
    worst, height = max(found, key=lambda pair: pair[1])
    return Attack(
        height, tried + each * len(order), state_table(worst), explain_difficulty(judge, worst, sample)
    )


def _beginnings(region: Region, judge: Judge, sample: Sample, evaluations: int, seed: int) -> Sample:
    """The sample, and hard states of about so many evaluations that lie in the region."""
    hard = hard_states(region.domain, evaluations // 3, seed) if evaluations >= 3 else None
    if hard is None:
        return sample
    kept = [hard[k : k + 1] for k, fits in enumerate(within(region, judge, hard)) if fits]
    return joined([sample, *kept])


def _only_inside(
    region: Region, judge: Judge, error: Callable[[Sample], Floats]
) -> Callable[[Sample], Floats]:
    """The error, zero where a state is not part of the region."""

    def limited(sample: Sample) -> Floats:
        return np.where(within(region, judge, sample), error(sample), 0.0)

    return limited


def explain_difficulty(judge: Judge, worst: Sample, ordinary: Sample) -> str:
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


def _of(exact: ExactState, what: str) -> float:
    value: float = getattr(exact.conditioning, what)
    return min(value, 1e300)


def conditioning_ranges(judge: Judge, sample: Sample) -> dict[str, list[float]]:
    """The least and the largest kappa_s, chi and formation over a sample."""
    exacts = judge.truths(sample)
    values: dict[str, Floats] = {what: np.array([_of(e, what) for e in exacts]) for what in _REMEDIES}
    return {what: [float(v.min()), float(v.max())] for what, v in values.items()}
