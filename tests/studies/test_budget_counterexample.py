"""The search for a counterexample climbs, stays in the region, counts, and explains what it finds."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import kanegen as kg
from kanegen.errors import CertificateError
from kanegen.studies.budget.counterexample import (
    conditioning_ranges,
    explain_difficulty,
    search_counterexample,
)
from kanegen.studies.budget.region import Region, read_region
from kanegen.studies.budget.sampling import random_stream, sample_from_table, sample_region, state_table
from kanegen.studies.tradeoff.domain import Sample
from kanegen.studies.tradeoff.exact_results import ExactResults
from tests.support.paths import MODELS

Floats = NDArray[np.float64]
PENDULUM = kg.load(MODELS / "double_pendulum.toml")


class Hump:
    """An error with its maximum at q1 = 0.7; `evaluations` counts the states in which it was evaluated."""

    def __init__(self) -> None:
        self.evaluations = 0

    def __call__(self, sample: Sample) -> Floats:
        self.evaluations += len(sample)
        found: Floats = 1 / (1e-6 + np.abs(sample.x[:, 0] - 0.7))
        return found


def start_of_search(domain: str) -> tuple[Region, ExactResults, Sample]:
    region = read_region(domain, PENDULUM)
    exact = ExactResults(region.system)
    return region, exact, sample_region(region, exact, 12, random_stream(0, "select", 0))


@pytest.mark.parametrize("hard", [True, False])
def test_the_search_climbs_and_counts_its_evaluations(hard: bool) -> None:
    region, exact, sample = start_of_search("x.q1 = [-1, 1]")
    error = Hump()
    found = search_counterexample(region, exact, error, sample, evaluations=200, seed=1, hard=hard)
    assert found.error > 10 * error(sample).max()
    worst = sample_from_table(region.domain, found.state)
    assert region.domain.contains(worst)
    assert error(worst)[0] == found.error
    starts = 4 + len(sample)
    assert 150 <= found.evaluations <= 200
    assert error.evaluations - len(sample) - 1 == found.evaluations + starts


def test_the_search_stays_in_the_region() -> None:
    """The maximum of the error lies outside the box, and states that cancel lie outside the region."""
    region, exact, sample = start_of_search("x.q1 = [-1, 0.5]; exclude.cancellation = 2")
    found = search_counterexample(region, exact, Hump(), sample, evaluations=100, seed=1, hard=True)
    worst = sample_from_table(region.domain, found.state)
    assert worst.x[0, 0] <= 0.5
    assert exact.states(worst)[0].conditioning.chi <= 2


def test_the_same_seed_finds_the_same_state() -> None:
    region, exact, sample = start_of_search("")
    first, second, other = (
        search_counterexample(region, exact, Hump(), sample, evaluations=60, seed=seed, hard=True)
        for seed in (1, 1, 2)
    )
    assert first == second
    assert first.state != other.state


def test_a_state_as_a_table_is_exact() -> None:
    region, _, sample = start_of_search("")
    row = sample[3:4]
    assert (sample_from_table(region.domain, state_table(row)).flat() == row.flat()).all()
    for wrong in ({}, {"x": ["0x1p0"]}, {"x": 3}, {"x": ["soft"] * 6}, {"x": ["0x1p99999"] * 6}):
        with pytest.raises(CertificateError, match="not a state of this model"):
            sample_from_table(region.domain, wrong)


def test_explanations_name_what_to_exclude() -> None:
    region, exact, sample = start_of_search("")
    balanced = sample[:1].flat().copy()
    equations = kg.build(PENDULUM)
    balanced[0, 2:4] = 0.0
    balanced[0, 4:6] = -equations.forcing(balanced[0, :2], balanced[0, 2:4]) * (1 + 1e-6)
    assert "exclude.cancellation" in explain_difficulty(exact, region.domain.states(balanced), sample)
    assert explain_difficulty(exact, sample[:1], sample[:1]) == "Nothing about the state is unusual."

    body = read_region("exclude.clearance = 1e-4", kg.load(MODELS / "free_body.toml"))
    exact = ExactResults(body.system)
    usual = sample_region(body, exact, 5, random_stream(0, "select", 0))
    locked = usual[:1].flat().copy()
    locked[0, 1] = np.pi / 2 - 1e-3
    assert "exclude.clearance" in explain_difficulty(exact, body.domain.states(locked), usual)


def test_ranges_hold_every_state() -> None:
    _, exact, sample = start_of_search("")
    found = conditioning_ranges(exact, sample)
    chi = [state.conditioning.chi for state in exact.states(sample)]
    assert found["chi"] == [min(chi), max(chi)]
    assert set(found) == {"chi", "kappa_s", "formation"}
