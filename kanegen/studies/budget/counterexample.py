"""A search for the state of a region in which a variant has its largest error.

The search begins with the worst states of a sample and, the first time, with states where arithmetic is hard
(`tradeoff.hard_states`): next to gimbal lock, folded or straight, where [A] is nearly singular, near
equilibrium, and in equilibrium but for the rounding of {tau}, also at corners of the domain. From the worst
of all it climbs to larger errors, and from equilibria along equilibria. A search can refute a claim but never
prove one.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kanegen.measure.truth.measurement import ExactState
from kanegen.model.arrays import Floats
from kanegen.studies.budget.evaluator import SearchResult
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.request import SOLUTION
from kanegen.studies.budget.sampling import in_region, state_table
from kanegen.studies.tradeoff.domain import Sample, joined
from kanegen.studies.tradeoff.exact_results import ExactResults
from kanegen.studies.tradeoff.hard_states import HARD_KINDS, climb, hard_states

CLIMBS = 4
"""Number of states from which a search climbs."""

_HARD_SHARE = 3
"""One of so many evaluations of a search is spent on hard states."""

_NOTABLE_RATIO = 10.0
"""Ratio to the usual value from which on a condition number explains a large error."""

_REMEDIES = {
    "chi": (
        "There accelerations cancel, chi = {0:.1e}: exclude it by exclude.cancellation in the domain, or ask "
        "for an error relative to the terms."
    ),
    "kappa_s": (
        "There [A] is nearly singular, kappa_s = {0:.1e}: exclude it by narrower ranges in the domain "
        "or, near gimbal lock, by exclude.clearance."
    ),
    "formation": "There terms of [A] or {{f}} cancel, {0:.1e}: exclude it by narrower ranges in the domain.",
}
"""Sentence on why a state is hard and how to exclude it, by the condition number that is large there."""


def search_counterexample(
    region: Region,
    exact: ExactResults,
    error: Callable[[Sample], Floats],
    sample: Sample,
    evaluations: int,
    seed: int,
    hard: bool,
    relative_to: str,
) -> SearchResult:
    """Search a region for the state with the largest error.

    Args:
        region: The states to search.
        exact: Exact results of the system of the region, which hold how hard a state is.
        error: Function that returns the (B,) errors of a variant in a sample of B states.
        sample: States from whose worst ones the search climbs.
        evaluations: Number of states that may be tried.
        seed: Seed of the search.
        hard: Whether hard states are tried as well.
        relative_to: The yardstick of the error, one of `request.METRICS`.
    """
    inside = _error_inside(region, exact, error)
    starts = _with_hard_states(region, exact, sample, evaluations // _HARD_SHARE if hard else 0, seed)
    errors = error(starts)
    tried = len(starts) - len(sample)
    order = np.argsort(-errors, kind="stable")[:CLIMBS]
    each = max(1, (evaluations - tried) // len(order))
    found = [
        climb(region.domain, starts[k : k + 1], inside, each, seed + rank) for rank, k in enumerate(order)
    ]
    worst, largest = max(found, key=lambda pair: pair[1])
    explanation = explain_difficulty(exact, worst, sample, relative_to)
    return SearchResult(largest, tried + each * len(order), state_table(worst), explanation)


def explain_difficulty(exact: ExactResults, worst: Sample, ordinary: Sample, relative_to: str) -> str:
    """Return a sentence on why a state is harder than ordinary states and how to exclude it.

    Cancellation explains no error that is relative to the terms that cancel.

    Args:
        exact: Exact results of the system.
        worst: The state, as a sample of one state.
        ordinary: States to compare it with.
        relative_to: The yardstick of the error, one of `request.METRICS`.
    """
    (state,) = exact.states(worst)
    usual = exact.states(ordinary)
    ratios = {
        name: _condition_number(state, name) / float(np.median([_condition_number(s, name) for s in usual]))
        for name in _REMEDIES
        if name != "chi" or relative_to == SOLUTION
    }
    hardest = max(ratios, key=ratios.__getitem__)
    if not ratios[hardest] > _NOTABLE_RATIO:
        return "Nothing about the state is unusual."
    return _REMEDIES[hardest].format(_condition_number(state, hardest))


def conditioning_ranges(exact: ExactResults, sample: Sample) -> dict[str, list[float]]:
    """Return the least and the largest kappa_s, chi and formation over the states of a sample, by name."""
    states = exact.states(sample)
    values = {name: [_condition_number(state, name) for state in states] for name in _REMEDIES}
    return {name: [min(numbers), max(numbers)] for name, numbers in values.items()}


def _condition_number(state: ExactState, name: str) -> float:
    """Return kappa_s, chi or formation of a state, at most 1e300 so that ratios stay finite."""
    value: float = getattr(state.conditioning, name)
    return min(value, 1e300)


def _with_hard_states(
    region: Region, exact: ExactResults, sample: Sample, evaluations: int, seed: int
) -> Sample:
    """Return a sample together with about `evaluations` hard states, those that lie in the region."""
    count = evaluations // len(HARD_KINDS)
    hard = hard_states(region.domain, count, seed) if count else None
    if hard is None:
        return sample
    kept = [hard[k : k + 1] for k, inside in enumerate(in_region(region, exact, hard)) if inside]
    return joined([sample, *kept])


def _error_inside(
    region: Region, exact: ExactResults, error: Callable[[Sample], Floats]
) -> Callable[[Sample], Floats]:
    """Return `error` changed to be zero in states outside a region."""

    def limited(sample: Sample) -> Floats:
        return np.where(in_region(region, exact, sample), error(sample), 0.0)

    return limited
