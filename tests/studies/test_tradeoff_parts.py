"""The parts of a trade-off study, each compared with code that shares nothing with it."""

from __future__ import annotations

import itertools
from dataclasses import fields, replace

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.measure.timing import BATCH, OBJECTIVES
from kanegen.model.coordinates import FREEDOMS
from kanegen.options import Variant
from kanegen.reference.equations import forcing, mass_matrix
from kanegen.studies.tradeoff import variants
from kanegen.studies.tradeoff.domain import UNIFORM, Domain, Sample, default_domain, joined, rounded
from kanegen.studies.tradeoff.evaluator import convert_sample
from kanegen.studies.tradeoff.exact_results import OUTPUT, ExactResults, compute_accelerations
from kanegen.studies.tradeoff.hard_states import (
    BALANCED,
    EQUILIBRIUM,
    GIMBAL_LOCK,
    NEARLY_SINGULAR,
    STRAIGHT,
    climb,
    hard_states,
)
from kanegen.studies.tradeoff.pareto_front import TIE, Point, pareto_front, rank_correlation, verdict
from tests.support import systems
from tests.support.high_precision import true_values

HINGES = systems.chain(2, ["theta3"])
FREE = systems.chain(1, FREEDOMS)


def library(system: kg.System, precision: str = "double") -> kg.Library:
    return kg.build(system, (OUTPUT,), precision=precision)


def test_the_table_has_at_least_forty_variants_that_differ() -> None:
    found, refused = variants.candidates()
    assert len(found) + len(refused) >= 40
    assert len({candidate.label for candidate in found}) == len(found)
    assert len(set(found)) == len(found)


def test_every_field_of_a_variant_is_in_the_table() -> None:
    levels = [level for choice in variants.CROSSED for level in choice]
    varied = {name for level in (*levels, *variants.SINGLE_CHANGES) for name in level}
    assert varied == {field.name for field in fields(Variant)} | set(variants.SYSTEM_CHOICES)


def test_impossible_combinations_are_refused_with_the_reason() -> None:
    found, refused = variants.candidates([{"precision": "float"}, {"precision": "quad", "optimisation": 3}])
    assert [candidate.variant.precision for candidate in found] == ["float"]
    assert [refusal.label for refusal in refused] == ["quad, -O3"]
    assert "unknown precision 'quad'" in refused[0].reason


@pytest.mark.parametrize("seed", range(20))
def test_the_pareto_front_is_that_of_brute_force(seed: int) -> None:
    rng = np.random.default_rng(seed)
    times, errors = rng.integers(100, 140, 30) / 100, rng.integers(1, 30, 30) / 1.0
    points = [Point(k, float(t), float(e)) for k, (t, e) in enumerate(zip(times, errors, strict=True))]
    points += [Point(-1, 0.5, np.inf), Point(-2, np.nan, 0.5)]
    finite = points[:30]
    free = [
        p
        for p in finite
        if not any(
            q.time <= p.time and q.error <= p.error and (q.time, q.error) != (p.time, p.error) for q in finite
        )
    ]
    found = pareto_front(points)
    assert found == sorted(found, key=lambda p: p.time)
    assert all(any((p.time, p.error) == (q.time, q.error) for q in free) for p in found)
    assert all(b.time > a.time * (1 + TIE) and b.error < a.error for a, b in itertools.pairwise(found))
    for p in free:
        assert any(q.error <= p.error and q.time <= p.time * (1 + TIE) for q in found)


def test_verdicts_in_words() -> None:
    fast, exact = Point("fast", 10.0, 1e-7), Point("exact", 20.0, 1e-16)
    assert (
        "fast is 2 times as fast as exact, with 1e+09 times the error. "
        "The Pareto front: fast 10 ns, 1.0e-07; exact" in verdict([fast, exact], str, [fast, exact])
    )
    flat = replace(fast, error=1.5e-16)
    assert "There is no trade-off: from exact to fast the error grows only 1.50" in verdict(
        [flat, exact], str, []
    )
    alone = verdict([fast], str, [fast, exact])
    assert "There is no trade-off: fast is both the fastest (10 ns)" in alone
    assert "2.00 times as long" in alone
    assert "nothing to choose" in verdict([], str, [fast])


def test_rank_correlation_sees_order_alone() -> None:
    assert rank_correlation([1, 2, 3, 4], [10, 20, 1000, 1001]) == pytest.approx(1)
    assert rank_correlation([1, 2, 3, 4], [4, 3, 2, 1]) == pytest.approx(-1)
    assert np.isnan(rank_correlation([1, 1, 1], [1, 2, 3]))


def test_samples_are_reproducible_disjoint_and_inside_the_box() -> None:
    domain = default_domain(FREE)
    one, same, other = (domain.sample(50, (0, k)) for k in (1, 1, 2))
    assert one.bits() == same.bits()
    assert not set(one.bits()) & set(other.bits())
    assert domain.contains(joined([one, other]))
    for values in (one.x, one.y, one.tau, domain.low, domain.high):
        assert np.array_equal(values, values.astype(np.float32))
    outside = replace(one, tau=10 * domain.high[12:18] * np.ones((50, 1)))
    assert not domain.contains(outside)


def test_where_nothing_acts_tau_still_does() -> None:
    rail = kg.System.from_arrays(
        [0], [2.0], [np.eye(3)], [[0, 0, 0]], [[0, 0, 0]], free=systems.flags(1, ["s1"]), gravity=(0, 0, 0)
    )
    assert np.abs(default_domain(rail).sample(10, 0).tau).min() > 0


def test_rounding_is_that_of_single_precision_at_every_size() -> None:
    values = np.random.default_rng(0).standard_normal(1000) * 10.0 ** np.arange(-30, 20).repeat(20)
    assert np.array_equal(rounded(values), values.astype(np.float32))
    assert np.array_equal(rounded(values * 2.0**600), rounded(values) * 2.0**600)
    assert rounded(np.zeros(2)).tolist() == [0, 0]


def test_a_clearance_is_kept() -> None:
    domain = default_domain(FREE, clearance=0.5)
    assert np.abs(np.cos(domain.sample(500, 0).x[:, 1])).min() >= 0.5
    assert np.abs(np.cos(default_domain(FREE).sample(500, 0).x[:, 1])).min() < 0.1
    narrow = np.where(np.arange(18) == 1, 1e-3, domain.high)
    middle = np.where(np.arange(18) == 1, np.pi / 2, 0.0)
    with pytest.raises(kg.OptionError, match=r"at clearance 0\.5 nothing of the box is left"):
        Domain(FREE, middle - narrow, middle + narrow, 0.5).sample(1, 0)


def test_loads_are_part_of_the_domain() -> None:
    system = systems.chain(2, ["theta3"], loads=True)
    domain = default_domain(system)
    sample = domain.sample(4, 0)
    assert sample.force is not None
    assert np.abs(sample.force).min() > 0
    assert domain.contains(sample)
    assert set(domain.as_dict()["force"]) == {"body1", "body2"}
    assert np.array_equal(joined([sample, sample]).flat()[4:], sample.flat())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"low": np.zeros(3)}, "low must hold 18 finite numbers"),
        ({"high": np.full(18, np.nan)}, "high must hold 18 finite numbers"),
        ({"high": np.full(18, -100.0)}, "low exceeds high at number"),
        ({"clearance": 1.0}, r"the clearance is 1\.0; it must lie in \[0, 1\)"),
    ],
)
def test_domains_that_cannot_be(changes: dict[str, object], message: str) -> None:
    with pytest.raises(kg.OptionError, match=message):
        replace(default_domain(FREE), **changes)


def scaled_eigenvalues(sample: Sample) -> np.ndarray:
    """Return the eigenvalues (B, n) of [A] after scaling to a diagonal of ones."""
    matrix = mass_matrix(FREE, sample.x)
    scale = 1 / np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
    return np.linalg.eigvalsh(matrix * scale[:, :, None] * scale[:, None, :])


def test_hard_states_are_what_they_are_called() -> None:
    domain = default_domain(FREE)
    hard = hard_states(domain, 20, 0)
    assert hard is not None
    assert domain.contains(hard)
    assert dict.fromkeys(hard.kinds) == dict.fromkeys(
        [GIMBAL_LOCK, STRAIGHT, EQUILIBRIUM, BALANCED, NEARLY_SINGULAR]
    )
    states = hard
    assert np.abs(np.cos(states.x[hard.rows_of(GIMBAL_LOCK), 1])).max() < 0.11
    assert np.abs(np.sin(states.x[hard.rows_of(STRAIGHT), :3])).max() < 0.4
    left = forcing(FREE, states.x, states.y) + hard.tau
    size = np.abs(hard.tau).max(axis=1)
    assert (np.abs(left).max(axis=1) / size)[hard.rows_of(EQUILIBRIUM)].max() < 0.2
    inside = np.abs(hard.tau) < domain.high[domain.first["tau"] :][: hard.tau.shape[1]]
    balanced = (np.abs(left) / np.maximum(np.abs(hard.tau), 1e-6))[hard.rows_of(BALANCED)]
    assert balanced[inside[hard.rows_of(BALANCED)]].max() < 2.0**-23
    ordinary = np.median(scaled_eigenvalues(domain.sample(200, 0))[:, 0])
    assert scaled_eigenvalues(hard)[hard.rows_of(NEARLY_SINGULAR), 0].max() < 0.1 * ordinary
    assert hard_states(default_domain(HINGES), 5, 0).rows_of(GIMBAL_LOCK) == []  # type: ignore[union-attr]


def test_a_search_climbs_by_evaluations_and_stays_inside() -> None:
    domain, counts = default_domain(FREE), []

    def height(sample: Sample) -> np.ndarray:
        counts.append(len(sample))
        assert domain.contains(sample)
        return sample.flat()[:, 4] + sample.tau[:, 2]

    start = domain.sample(1, 0)
    found, top = climb(domain, start, height, 83, 1)
    assert sum(counts) == 84
    assert top == height(found)[0] > height(start)[0]
    again, _ = climb(domain, start, height, 83, 1)
    assert again.bits() == found.bits()


@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_errors_are_those_of_forty_digits(precision: str, objective: str) -> None:
    """Two hinges on parallel axes: both accelerations have one unit, so the norm needs no scaling."""
    sample = default_domain(HINGES).sample(5, 3)
    built = library(HINGES, precision)
    errors = ExactResults(HINGES).errors(built, sample, objective)
    exact = true_values(HINGES.values(), sample)
    values = compute_accelerations(built, sample, objective)
    for row in range(len(sample)):
        with mpmath.workdps(40):
            a, f = mpmath.matrix(exact["mass_matrix"][row]), mpmath.matrix(exact["forcing"][row])
            truth = mpmath.lu_solve(a, f + mpmath.matrix(sample.tau[row]))
            lost = mpmath.norm(mpmath.matrix(values[row].tolist()) - truth) / mpmath.norm(truth)
        assert errors.normwise[row] == pytest.approx(float(lost), rel=1e-6)
    assert not errors.wrong.any()
    assert errors.bound_share < 4


def test_the_gate_tells_wrong_from_inaccurate() -> None:
    domain = default_domain(FREE)
    sample = joined([domain.sample(8, 0), hard_states(domain, 8, 0) or domain.sample(1, 1)])
    exact = ExactResults(FREE)
    for precision in ("double", "float"):
        built = library(FREE, precision)
        right = compute_accelerations(built, sample, BATCH)
        roundoff = np.finfo(right.dtype).eps / 2
        assert not exact.measure(right, sample, roundoff).wrong.any()
        off = right * right.dtype.type(1 + 1e5 * roundoff)
        assert exact.measure(off, sample, roundoff).wrong[sample.rows_of(UNIFORM)].all()
        flipped = right * np.where(np.arange(6) == 4, -1, 1).astype(right.dtype)
        assert exact.measure(flipped, sample, roundoff).wrong[sample.rows_of(UNIFORM)].all()
        lost = exact.measure(np.where(np.arange(6) == 2, np.nan, right), sample, roundoff)
        assert lost.failed.all()
        assert not lost.wrong.any()
        assert lost.median == np.inf


def test_other_speeds_are_the_same_physical_state() -> None:
    """The power of tau and the kinetic energy do not depend on what the speeds are."""
    sample = default_domain(FREE).sample(20, 0)
    spinning = FREE.with_speeds("angular_velocity")
    other = convert_sample(sample, FREE, spinning)
    assert not np.array_equal(other.y, sample.y)
    power, same = (np.sum(s.tau * s.y, axis=1) for s in (sample, other))
    assert same == pytest.approx(power, rel=1e-4, abs=1e-4 * np.abs(sample.tau).max())
    assert convert_sample(sample, FREE, FREE) is sample
    a, y = mass_matrix(FREE, sample.x), sample.y
    rotation = other.y[:, :3]
    inertia = np.array(FREE.values().inertia[0]) + _about_origin(FREE)
    turning = np.einsum("bi,ij,bj->b", rotation, inertia, rotation)
    angles = np.einsum("bi,bij,bj->b", y[:, :3], a[:, :3, :3], y[:, :3])
    assert turning == pytest.approx(angles, rel=1e-5)


def _about_origin(system: kg.System) -> np.ndarray:
    """Return the part of the inertia about the origin that comes from the distance of the mass center."""
    arrays = system.values()
    r, m = arrays.mass_center[0], arrays.mass[0]
    return m * (r @ r * np.eye(3) - np.outer(r, r))
