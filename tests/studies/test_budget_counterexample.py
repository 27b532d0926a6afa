"""The search for a counterexample climbs, stays in the region, counts, and explains what it finds."""

from __future__ import annotations

from dataclasses import replace

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
    found = search_counterexample(
        region, exact, error, sample, evaluations=200, seed=1, hard=hard, relative_to="terms"
    )
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
    found = search_counterexample(
        region, exact, Hump(), sample, evaluations=100, seed=1, hard=True, relative_to="terms"
    )
    worst = sample_from_table(region.domain, found.state)
    assert worst.x[0, 0] <= 0.5
    assert exact.states(worst)[0].conditioning.chi <= 2


def test_the_same_seed_finds_the_same_state() -> None:
    region, exact, sample = start_of_search("")
    first, second, other = (
        search_counterexample(
            region, exact, Hump(), sample, evaluations=60, seed=seed, hard=True, relative_to="terms"
        )
        for seed in (1, 1, 2)
    )
    assert first == second
    assert first.state != other.state


@pytest.mark.parametrize("name", ["double_pendulum", pytest.param("panda_arm", marks=pytest.mark.slow)])
@pytest.mark.slow
def test_the_search_finds_equilibria_whatever_the_seed(name: str) -> None:
    """In equilibrium only the rounding of tau accelerates the tree, and double precision loses that.

    The comparison is with equilibria of random angles and speeds that the search does not know: {f} comes
    from the compiled C, and is rounded by NumPy.
    """
    region = read_region("exclude.clearance = 0.05", kg.load(MODELS / f"{name}.toml"))
    exact, library = ExactResults(region.system), kg.build(region.system, ("forcing", "forward_dynamics"))
    states = region.domain.sample(60, 7)
    loads = [load for load in (states.force, states.torque) if load is not None]
    tau = -library.forcing(states.x, states.y, *loads).astype(np.float32).astype(np.float64)
    still = replace(states, tau=tau)
    inside = [k for k in range(len(still)) if region.domain.contains(still[k : k + 1])]
    largest = exact.errors(library, still).normwise[inside].max()
    assert largest > 1e-9

    def error(sample: Sample) -> Floats:
        return exact.errors(library, sample).normwise

    sample = sample_region(region, exact, 12, random_stream(0, "select", 0))
    assert error(sample).max() < 1e-12
    for seed in (0, 1):
        found = search_counterexample(region, exact, error, sample, 180, seed, True, "solution")
        assert found.error > largest / 3
        assert "exclude.cancellation" in found.explanation
        bare = search_counterexample(region, exact, error, sample, 180, seed, False, "solution")
        assert bare.error < 1e-2 * found.error


def test_relative_to_the_terms_an_equilibrium_is_no_counterexample() -> None:
    region, exact, sample = start_of_search("")
    library = kg.build(region.system, ("forward_dynamics",))

    def error(sample: Sample) -> Floats:
        return exact.errors(library, sample).relative_to_terms

    found = search_counterexample(region, exact, error, sample, 180, 0, True, "terms")
    assert found.error < 1e-14


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
    almost = region.domain.states(balanced)
    assert "exclude.cancellation" in explain_difficulty(exact, almost, sample, "solution")
    assert "exclude.cancellation" not in explain_difficulty(exact, almost, sample, "terms")
    assert explain_difficulty(exact, sample[:1], sample[:1], "terms") == "Nothing about the state is unusual."

    body = read_region("exclude.clearance = 1e-4", kg.load(MODELS / "free_body.toml"))
    exact = ExactResults(body.system)
    usual = sample_region(body, exact, 5, random_stream(0, "select", 0))
    locked = usual[:1].flat().copy()
    locked[0, 1] = np.pi / 2 - 1e-3
    assert "exclude.clearance" in explain_difficulty(exact, body.domain.states(locked), usual, "terms")


def test_ranges_hold_every_state() -> None:
    _, exact, sample = start_of_search("")
    found = conditioning_ranges(exact, sample)
    chi = [state.conditioning.chi for state in exact.states(sample)]
    assert found["chi"] == [min(chi), max(chi)]
    assert set(found) == {"chi", "kappa_s", "formation"}
