"""The choice of a variant among planted candidates, whose errors and times are given as numbers."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from kanegen.errors import BudgetError
from kanegen.measure.timing import Times
from kanegen.studies.budget.evaluator import SampleSpec
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.selection import Choice, choose
from tests.support.planted_candidates import (
    CANDIDATES,
    FAST,
    ROUGH,
    SINGLE,
    SMALL,
    STRICT,
    Floats,
    Planted,
    PlantedEvaluator,
    spread,
)


def chosen(candidates: Sequence[Planted], **terms: object) -> str:
    return choice(candidates, **terms).candidate.label


def choice(candidates: Sequence[Planted], **terms: object) -> Choice[Planted]:
    return choose(PlantedEvaluator(candidates), Request(**{"effort": SMALL, **terms}))


@pytest.mark.parametrize(
    ("budget", "label"),
    [
        (1e-4, "rough"),
        (4.1e-5, "rough"),
        (3e-5, "single"),
        (1e-6, "single"),
        (1e-9, "fast"),
        (5e-15, "strict"),
    ],
)
def test_the_fastest_that_keeps_the_error_is_chosen(budget: float, label: str) -> None:
    assert chosen(CANDIDATES, error=budget) == label
    assert chosen(CANDIDATES[::-1], error=budget) == label


@pytest.mark.parametrize(
    ("budget", "label"), [(200.0, "strict"), (90.0, "fast"), (70.0, "single"), (55.0, "rough")]
)
def test_the_most_accurate_that_keeps_the_time_is_chosen(budget: float, label: str) -> None:
    assert chosen(CANDIDATES, time=budget) == label


def test_the_claim_under_a_budget_of_time_is_the_largest_error_seen_anywhere() -> None:
    for largest in (1e-12, 1e-20):
        evaluator = PlantedEvaluator(CANDIDATES, found={"strict": largest})
        found = choose(evaluator, Request(time=200.0, effort=SMALL))
        assert found.validation.claim == max(largest, found.validation.errors.max())
        assert found.validation.exceeded == 0
        assert found.validation.limit <= 0.001


def test_impossible_budgets_say_what_is_reachable() -> None:
    with pytest.raises(BudgetError, match=r"error of 1e-18.*'strict' with 1\.0e-15.*budget of 4\.0e-15"):
        chosen(CANDIDATES, error=1e-18)
    with pytest.raises(BudgetError, match=r"time of 10 ns.*'rough' with 50 ns and an error of 1\.0e-05"):
        chosen(CANDIDATES, time=10.0)


def test_candidates_with_too_much_roundoff_are_not_built_but_the_most_precise_one_is() -> None:
    coarse = replace(SINGLE, least_error=1e-8)
    evaluator = PlantedEvaluator([STRICT, coarse])
    found = choose(evaluator, Request(error=1e-9, effort=SMALL))
    assert {label for label, _ in evaluator.samples} == {"strict"}
    assert found.verdicts["single"].startswith("not built")
    with pytest.raises(BudgetError, match=r"'single' with 1\.0e-07"):
        choose(PlantedEvaluator([coarse]), Request(error=1e-9, effort=SMALL))


def test_a_candidate_that_cannot_be_built_is_named_and_does_not_stop_the_others() -> None:
    broken = replace(ROUGH, refused="no such flag")
    assert choice([STRICT, broken], error=1e-3).verdicts["rough"] == "refused: no such flag"
    with pytest.raises(BudgetError, match="rough: refused: no such flag"):
        chosen([broken], error=1e-3)


def test_more_digits_than_are_needed_are_not_built() -> None:
    long = Planted("long", 1e-19, 10.0, is_long=True)
    found = choice([STRICT, long], error=1e-9)
    assert found.candidate is STRICT
    assert found.verdicts["long"] == "not built: strict is accurate enough, and faster"
    assert chosen([STRICT, long], error=1e-17) == "long"
    assert chosen([STRICT, long], time=200.0) == "long"


def test_the_same_program_is_measured_once() -> None:
    evaluator = PlantedEvaluator(
        [STRICT, replace(FAST, program="p"), replace(ROUGH, error=1e-15, program="p")]
    )
    found = choose(evaluator, Request(error=1e-9, effort=SMALL))
    assert found.verdicts["rough"] == "the same program as fast"
    assert "rough" not in {label for label, _ in evaluator.samples}


def test_failures_are_counted_not_dropped() -> None:
    def with_failures(candidate: Planted, sample: SampleSpec, rng: np.random.Generator) -> Floats:
        errors = spread(candidate, sample, rng)
        errors[0] = math.nan if candidate is ROUGH else errors[0]
        return errors

    found = choose(PlantedEvaluator(CANDIDATES, with_failures), Request(error=1e-4, effort=SMALL))
    assert found.candidate is SINGLE
    assert found.verdicts["rough"] == "error inf"


def test_a_smaller_budget_never_gets_a_faster_variant() -> None:
    rng = np.random.default_rng(5)
    for _ in range(12):
        candidates = [
            Planted(f"v{k}", 10.0 ** -rng.uniform(4, 16), rng.uniform(10.0, 100.0)) for k in range(12)
        ]
        fastest = 0.0
        for budget in 10.0 ** -np.arange(2.0, 16.0, 0.5):
            try:
                time = choice(candidates, error=budget).times.median
            except BudgetError:
                break
            assert time >= fastest / 1.02
            fastest = max(time, fastest)


def test_regret_on_every_small_grid() -> None:
    errors, times = (1e-15, 1e-9, 1e-6), (100.0, 101.0, 104.0, 150.0)
    for row in itertools.combinations(itertools.product(errors, times), 3):
        candidates = [Planted(f"v{k}", *pair) for k, pair in enumerate(row)]
        feasible = [c.time for c in candidates if c.error <= 1e-8 / 4]
        if feasible:
            assert choice(candidates, error=1e-8).times.median <= 1.05 * min(feasible)


def test_the_best_candidates_are_timed_once_more_and_the_second_times_are_reported() -> None:
    many = [Planted(f"v{k}", 1e-15, 100.0 + k) for k in range(20)]
    evaluator = PlantedEvaluator(many, noise=0.5, seed=3)
    found = choose(evaluator, Request(error=1e-9, effort=SMALL))
    everybody, finalists = evaluator.timed
    assert len(everybody) == 20
    assert {c.label for c in finalists} == {
        c.label for c in sorted(many, key=lambda c: everybody[c].median)[: len(finalists)]
    }
    assert found.times == finalists[found.candidate] != everybody[found.candidate]


def test_a_candidate_that_is_too_slow_in_the_final_is_dropped() -> None:
    """The second times are half as long again, so a candidate that was just fast enough no longer is."""

    class Slower(PlantedEvaluator):
        def times(self, candidates: Sequence[Planted]) -> dict[Planted, Times]:
            factor = 1.5 if self.timed else 1.0
            return {
                c: Times(tuple(factor * t for t in v.rounds)) for c, v in super().times(candidates).items()
            }

    assert choose(Slower(CANDIDATES), Request(time=130.0, effort=SMALL)).candidate is FAST
    with pytest.raises(BudgetError, match=r"'rough' with 75 ns"):
        choose(Slower(CANDIDATES), Request(time=70.0, effort=SMALL))


def test_ties_of_time_go_to_the_more_accurate() -> None:
    near = Planted("near", 1e-9, 50.9)
    far = Planted("far", 1e-9, 51.1)
    assert chosen([STRICT, replace(ROUGH, error=1e-6), near], error=1e-3) == "near"
    assert chosen([STRICT, replace(ROUGH, error=1e-6), far], error=1e-3) == "rough"


def test_identical_variants_show_no_gain() -> None:
    twins = [Planted("one", 1e-15, 100.0), Planted("two", 1e-15, 100.0)]
    for seed in range(50):
        for both in (twins, twins[::-1]):
            found = choose(PlantedEvaluator(both, noise=0.3, seed=seed), Request(error=1e-9, effort=SMALL))
            assert found.gain is None


def test_gain_is_over_the_fastest_that_is_as_accurate_as_the_default() -> None:
    found = choice(CANDIDATES, error=1e-3)
    assert found.candidate is ROUGH
    assert found.reference is FAST
    assert found.gain is not None
    assert found.gain.median == pytest.approx(80.0 / 50.0)
    assert choice(CANDIDATES, error=1e-9).gain is None
