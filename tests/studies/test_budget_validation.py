"""The validation of a chosen variant: fresh states used once, attempts paid for, claims that hold."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from kanegen.errors import BudgetError, OptionError
from kanegen.studies.budget import confidence
from kanegen.studies.budget.confidence import quantile_level, validate
from kanegen.studies.budget.confirmation import Confirmation
from kanegen.studies.budget.evaluator import SELECT, VALIDATE, SampleSpec, SearchResult
from kanegen.studies.budget.proofs import proof_words
from kanegen.studies.budget.request import Effort, Request, error_budget, time_budget
from kanegen.studies.budget.selection import choose
from tests.support.planted_candidates import CANDIDATES, SMALL, STRICT, Planted, PlantedEvaluator

Floats = NDArray[np.float64]
SLOW = Planted("slow", 1e-15, 100.0)
QUICK = Planted("quick", 1e-15, 50.0)
MIDDLE = Planted("middle", 1e-15, 70.0)


def exceeding(share: float, *labels: str):
    """Return errors that exceed 1e-9 in a share of the fresh states, for the candidates with `labels`."""

    def sampled(candidate: Planted, sample: SampleSpec, rng: np.random.Generator) -> Floats:
        rare = rng.random(sample.count) < (share if candidate.label in labels else 0.0)
        is_fresh = sample.purpose == VALIDATE
        return np.where(rare & is_fresh, 1e-6, candidate.error)

    return sampled


def test_the_numbers_of_wilks() -> None:
    assert confidence.states_needed(1e-3, 0.05) == 2995
    assert confidence.states_needed(1e-4, 0.05) == 29956
    for share, alpha in ((1e-3, 0.05), (0.1, 0.1), (0.01, 0.003)):
        n = confidence.states_needed(share, alpha)
        assert (
            confidence.exceedance_limit(0, n, alpha) <= share < confidence.exceedance_limit(0, n - 1, alpha)
        )
        assert (1 - share) ** n <= alpha < (1 - share) ** (n - 1)


@pytest.mark.parametrize(("exceeded", "count"), [(0, 2995), (1, 2995), (3, 50), (49, 50)])
def test_the_limit_is_that_of_clopper_and_pearson(exceeded: int, count: int) -> None:
    limit = confidence.exceedance_limit(exceeded, count, 0.05)
    assert limit == pytest.approx(stats.beta.ppf(0.95, exceeded + 1, count - exceeded), rel=1e-12)
    assert stats.binom.cdf(exceeded, count, limit) == pytest.approx(0.05, rel=1e-9)


@pytest.mark.parametrize(("exceeded", "count"), [(1, 2995), (3, 50), (50, 50)])
def test_the_floor_is_that_of_clopper_and_pearson(exceeded: int, count: int) -> None:
    floor = confidence.exceedance_floor(exceeded, count, 0.05)
    assert stats.binom.sf(exceeded - 1, count, floor) == pytest.approx(0.05, rel=1e-9)
    assert confidence.exceedance_floor(0, count, 0.05) == 0.0


def test_the_worst_state_of_several_searches_has_the_largest_error() -> None:
    searches = tuple(SearchResult(error, 10, {}, "") for error in (1e-12, 3e-9, math.inf, 2e-9))
    found = Confirmation(STRICT, 1e-12, validate(np.ones(3), 2.0, 0.05, 1), searches)
    assert found.worst is searches[2]
    assert replace(found, searches=searches[:2]).worst is searches[1]


def test_if_all_states_exceed_a_claim_nothing_is_shown() -> None:
    assert confidence.exceedance_limit(7, 7, 0.05) == 1.0
    assert validate(np.full(7, math.nan), 1.0, 0.05, 1).exceeded == 7


def test_the_limit_covers_the_truth_as_often_as_it_says() -> None:
    """Over 4000 samples the limit may be too low in 5 %, up to the scatter of counting (4 sigma)."""
    rng = np.random.default_rng(3)
    for share in (0.003, 0.05, 0.4):
        counts = rng.binomial(200, share, 4000)
        low = sum(confidence.exceedance_limit(k, 200, 0.05) < share for k in counts.tolist())
        assert low / 4000 <= 0.05 + 4 * math.sqrt(0.05 * 0.95 / 4000)


def test_the_fresh_sample_is_drawn_once_and_for_one_candidate() -> None:
    evaluator = PlantedEvaluator(CANDIDATES)
    choose(evaluator, Request(error=1e-9, effort=SMALL))
    fresh = [(label, sample) for label, sample in evaluator.samples if sample.purpose == VALIDATE]
    assert fresh == [("fast", SampleSpec(VALIDATE, 1, 3688))]
    assert [sample for _, sample in evaluator.samples if sample.purpose == SELECT] == [
        SampleSpec(SELECT, 0, 50)
    ] * len(CANDIDATES)


def test_every_further_attempt_has_a_sample_of_its_own_and_its_part_of_alpha() -> None:
    evaluator = PlantedEvaluator([SLOW, QUICK, MIDDLE], exceeding(0.1, "quick"))
    request = Request(error=1e-9, attempts=3, effort=SMALL)
    found = choose(evaluator, request)
    assert found.candidate is MIDDLE
    assert found.validation.attempt == 2
    assert found.verdicts["quick"].endswith("fresh states exceed 1.0e-09")
    fresh = [sample for _, sample in evaluator.samples if sample.purpose == VALIDATE]
    assert [sample.number for sample in fresh] == [1, 2]
    assert request.alpha == pytest.approx(0.05 / 3)
    assert {sample.count for sample in fresh} == {confidence.states_needed(1e-3, 0.05 / 3)}
    assert found.validation.limit <= 1e-3


def test_attempts_end() -> None:
    candidates = [SLOW, QUICK, MIDDLE]
    with pytest.raises(BudgetError, match=r"No further attempt.*quick.*failed validation 1"):
        choose(
            PlantedEvaluator(candidates, exceeding(0.1, "quick")),
            Request(error=1e-9, attempts=1, effort=SMALL),
        )
    with pytest.raises(BudgetError, match="was confirmed"):
        choose(
            PlantedEvaluator(candidates, exceeding(0.1, "slow", "quick", "middle")),
            Request(error=1e-9, attempts=9, effort=SMALL),
        )


def test_an_attempt_is_not_spent_on_a_candidate_that_a_search_refutes() -> None:
    evaluator = PlantedEvaluator([SLOW, QUICK, MIDDLE], found={"quick": 1e-6, "middle": math.inf})
    found = choose(evaluator, Request(error=1e-9, attempts=1, effort=SMALL))
    assert found.candidate is SLOW
    assert found.validation.attempt == 1
    assert "refuted in 10 evaluations: error 1.0e-06. Exclude something" in found.verdicts["quick"]
    with pytest.raises(BudgetError, match="Exclude something"):
        choose(PlantedEvaluator([SLOW], found={"slow": 1e-8}), Request(error=1e-9, effort=SMALL))


def test_more_digits_are_tried_where_all_others_are_refuted() -> None:
    long = Planted("long", 1e-18, 900.0, is_long=True)
    evaluator = PlantedEvaluator([SLOW, QUICK, long], found={"slow": 1e-8, "quick": 1e-8})
    found = choose(evaluator, Request(error=1e-9, attempts=1, effort=SMALL))
    assert found.candidate is long
    assert set(found.verdicts) == {"slow", "quick", "long"}
    assert "refuted" in found.verdicts["quick"]
    assert "not built" not in found.verdicts["long"]
    sound = PlantedEvaluator([SLOW, QUICK, long])
    assert choose(sound, Request(error=1e-9, effort=SMALL)).candidate is QUICK
    assert "long" not in [label for label, _ in sound.samples]


def test_a_failure_names_three_candidates_and_counts_the_others() -> None:
    candidates = [Planted(f"v{k}", 1e-15, 100.0 + k) for k in range(7)]
    with pytest.raises(BudgetError, match=r"v2: .* And 4 more\.$") as caught:
        choose(
            PlantedEvaluator(candidates, found={one.label: 1e-8 for one in candidates}),
            Request(error=1e-9, effort=SMALL),
        )
    assert "v3" not in str(caught.value)


def test_a_quantile_admits_a_few() -> None:
    """Of 3000 states a share of 0.3 % may exceed where 1 % may, but not where 0.1 % may."""
    evaluator = PlantedEvaluator([SLOW, QUICK], exceeding(0.003, "quick"), found={"quick": 1e-6})
    effort = replace(SMALL, validate=4000)
    found = choose(evaluator, Request(error=1e-9, quantile=0.99, effort=effort))
    assert found.candidate is QUICK
    assert found.validation.exceeded > 0
    assert found.validation.limit <= 0.01
    assert choose(evaluator, Request(error=1e-9, quantile=0.999, effort=effort)).candidate is SLOW


def test_wrong_claims_are_as_rare_as_the_confidence_says() -> None:
    """Every candidate is slightly worse than the claim, which makes a wrong claim as likely as possible.

    At 90 % and with two attempts, at most one search in ten may end with a claim, up to 4 sigma.
    """
    effort = replace(SMALL, search=1)
    request = Request(error=1e-9, quantile=0.95, confidence=0.9, effort=effort)
    wrong, searches = 0, 1500
    for seed in range(searches):
        evaluator = PlantedEvaluator(
            [SLOW, QUICK, MIDDLE], exceeding(0.0502, "slow", "quick", "middle"), seed=seed
        )
        try:
            choose(evaluator, request)
            wrong += 1
        except BudgetError:
            pass
    assert 0.05 < wrong / searches <= 0.1 + 4 * math.sqrt(0.1 * 0.9 / searches)


def test_the_claim_under_a_budget_of_time_covers_fresh_states() -> None:
    """The largest of n errors is exceeded with a probability below the limit in at least 95 % of searches."""

    def tail(candidate: Planted, sample: SampleSpec, rng: np.random.Generator) -> Floats:
        return candidate.error * rng.pareto(1.0, sample.count)

    missed = 0
    request = Request(time=200.0, quantile=0.9, attempts=1, effort=SMALL)
    for seed in range(400):
        found = choose(PlantedEvaluator([STRICT], tail, found={"strict": 0.0}, seed=seed), request)
        beyond = (1 + found.validation.claim / STRICT.error) ** -1.0
        missed += beyond > 0.1
    assert missed / 400 <= 0.05 + 4 * math.sqrt(0.05 * 0.95 / 400)


@pytest.mark.parametrize(
    ("text", "nanoseconds"), [("200ns", 200.0), ("1.5 us", 1500.0), ("2e-3 ms", 2000.0), ("3µs", 3000.0)]
)
def test_budgets_of_time(text: str, nanoseconds: float) -> None:
    assert time_budget(text) == pytest.approx(nanoseconds)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("200", "no unit"),
        ("200 parsecs", "unknown unit 'parsecs'"),
        ("fast", "write a time such as 200ns"),
        ("1.2.3ns", "is not a number"),
    ],
)
def test_texts_that_are_no_budget_of_time(text: str, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        time_budget(text)


@pytest.mark.parametrize(
    ("terms", "message"),
    [
        ({}, "one of them"),
        ({"error": 1e-9, "time": 10.0}, "not both"),
        ({"error": 0.0}, "error is 0.0"),
        ({"error": -1e-9}, "positive"),
        ({"error": math.nan}, "positive"),
        ({"error": math.inf}, "positive"),
        ({"time": time_budget("-5ns")}, "budget of time is -5.0"),
        ({"time": time_budget("nan ns")}, "budget of time is nan"),
        ({"time": time_budget("0 ns")}, "positive"),
        ({"error": 1e-9, "objective": "latencies"}, "Did you mean 'latency'"),
        ({"error": 1e-9, "confidence": 1.0}, "confidence is 1.0"),
        ({"error": 1e-9, "quantile": 0.0}, "quantile is 0.0"),
        ({"error": 1e-9, "attempts": 0}, "attempts is 0"),
        ({"error": 1e-9, "effort": Effort(validate=100)}, "3688 states are needed"),
    ],
)
def test_impossible_requests(terms: dict[str, object], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        Request(**terms)


def test_texts_that_are_no_numbers() -> None:
    assert error_budget("1e-9") == 1e-9
    with pytest.raises(OptionError, match="error is 'small'"):
        error_budget("small")
    assert quantile_level("max") == 1.0
    assert quantile_level("0.999") == 0.999
    for wrong in ("median", "1.5", "nan", "1"):
        with pytest.raises(OptionError, match='or "max"'):
            quantile_level(wrong)
    with pytest.raises(OptionError, match="select is 0"):
        Effort(select=0)
    with pytest.raises(OptionError, match="seconds is nan"):
        Effort(seconds=math.nan)


@pytest.mark.parametrize(
    ("kept", "words"),
    [
        (0, "sampled: errors were measured in the tried states, and not proven for others"),
        (7, "sampled: the output error_bound proves an error of at most this in 7 of the 22 fresh states"),
    ],
)
def test_the_words_of_a_sampled_claim(kept: int, words: str) -> None:
    proof = {"kind": "sampled", "domain": {"bound": None}, "by_state": {"states": 22, "kept": kept}}
    assert proof_words(proof) == words
