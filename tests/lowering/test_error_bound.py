"""The output `error_bound` is never below an error: in random and hard states, corners, and searches."""

from __future__ import annotations

import functools
import warnings
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import kanegen as kg
from kanegen.errors import KanegenWarning, OptionError, SingularError
from kanegen.measure import truth
from kanegen.program.precision import precision_named
from kanegen.studies.tradeoff.domain import Domain, Sample, default_domain, joined
from kanegen.studies.tradeoff.exact_results import ExactResults
from kanegen.studies.tradeoff.hard_states import BALANCED, NEARLY_SINGULAR, climb, hard_states
from tests.support import systems
from tests.support.cases import slow_among, slow_except
from tests.support.paths import MODELS

Floats = NDArray[np.float64]
NAMES = ("double_pendulum", "cart_pole", "gantry_crane", "scara")


@functools.cache
def model(name: str) -> kg.System:
    return kg.load(MODELS / f"{name}.toml")


@functools.cache
def bounding(system: kg.System, precision: str = "double") -> kg.Library:
    return kg.build(system, ("forward_dynamics", "error_bound"), precision=precision)


@functools.cache
def results(system: kg.System) -> ExactResults:
    return ExactResults(system)


def loads_of(sample: Sample) -> list[Floats]:
    return [load for load in (sample.force, sample.torque) if load is not None]


def errors_and_bounds(system: kg.System, sample: Sample, precision: str = "double") -> tuple[Floats, Floats]:
    """Return the (B, n) errors of {ydot} against certified truth, and their bounds."""
    library = bounding(system, precision)
    arguments = [
        precision_named(precision).from_doubles(array)
        for array in (sample.x, sample.y, sample.tau, *loads_of(sample))
    ]
    x, y, tau, *loads = arguments
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        ydot = library.forward_dynamics(x, y, tau, *loads)
        bounds = library.error_bound(x, y, ydot, tau, *loads)
    exact = results(system).states(sample)
    errors = [one.outputs["forward_dynamics"].distance(v) for one, v in zip(exact, ydot, strict=True)]
    return np.array(errors), bounds.astype(np.float64)


def corners(domain: Domain, count: int) -> Sample:
    """Return states at corners of a domain."""
    low = np.random.default_rng(2).random((count, domain.size)) < 0.5
    return domain.states(np.where(low, domain.low, domain.high))


@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("name", slow_among(NAMES, "scara", "gantry_crane"))
def test_no_error_exceeds_its_bound(name: str, precision: str) -> None:
    domain = default_domain(model(name))
    still = domain.sample(4, 5)
    still = replace(still, y=np.zeros_like(still.y))
    hard = hard_states(domain, 4, 1)
    assert hard is not None
    sample = joined([domain.sample(8, 0), corners(domain, 8), still, hard])
    errors, bounds = errors_and_bounds(model(name), sample, precision)
    assert (errors <= bounds).all(), (errors / bounds).max()
    ordinary = np.linalg.norm(bounds[:8], axis=1) / np.linalg.norm(errors[:8], axis=1)
    assert np.median(ordinary) < 300  # 8 to 120 in these models


@pytest.mark.parametrize("kind", [None, BALANCED, NEARLY_SINGULAR])
@pytest.mark.parametrize("name", slow_except(("double_pendulum", "cart_pole"), "cart_pole"))
def test_a_search_for_an_error_above_its_bound(name: str, kind: str | None) -> None:
    """It climbs on the ratio of error and bound, from random states, equilibria, and where [A] is worst."""
    system = model(name)
    domain = default_domain(system)

    def ratio(sample: Sample) -> Floats:
        errors, bounds = errors_and_bounds(system, sample)
        found: Floats = (errors / bounds).max(axis=1)
        return found

    sample = domain.sample(6, 3)
    if kind is not None:
        hard = hard_states(domain, 6, 3)
        assert hard is not None
        rows = hard.rows_of(kind)
        sample = joined([hard[k : k + 1] for k in rows])
    start = int(ratio(sample).argmax())
    _, largest = climb(domain, sample[start : start + 1], ratio, 150, 4)
    assert 1e-3 < largest < 1


def test_the_bound_holds_for_accelerations_from_any_source() -> None:
    """Accelerations that are off by a known amount have a bound that is hardly larger than this amount."""
    system = model("double_pendulum")
    sample = default_domain(system).sample(6, 1)
    library = bounding(system)
    ydot = library.forward_dynamics(sample.x, sample.y, sample.tau)
    off = np.random.default_rng(0).normal(size=ydot.shape)
    for size in (1e-9, 1e-3, 1.0):
        bounds = library.error_bound(sample.x, sample.y, ydot + size * off, sample.tau)
        assert (bounds >= size * np.abs(off)).all()
        assert np.median(np.linalg.norm(bounds, axis=1) / np.linalg.norm(size * off, axis=1)) < 10


@pytest.mark.parametrize("speeds", ["angle_rates", "angular_velocity"])
def test_next_to_gimbal_lock_the_bound_grows_or_is_refused(speeds: str) -> None:
    body = model("free_body").with_speeds(speeds)
    domain = default_domain(body)
    for distance in (1e-2, 1e-5, 1e-9):
        sample = domain.sample(3, 2)
        x = sample.x.copy()
        x[:, 1] = np.float32(np.pi / 2 - distance)
        errors, bounds = errors_and_bounds(body, replace(sample, x=x))
        known = np.isfinite(bounds)
        assert known.all() or (speeds == "angle_rates" and distance < 1e-5)
        assert (errors[known] <= bounds[known]).all()


def test_where_the_mass_matrix_may_be_singular_there_is_no_bound() -> None:
    body = model("free_body")
    library = kg.build(body, ("error_bound",))
    x, y = np.zeros(6), np.zeros(6)
    x[1] = np.pi / 2
    with pytest.raises(SingularError, match="no bound is proven"):
        library.error_bound(x, y, y)
    with pytest.warns(KanegenWarning, match="pivot of"):
        assert np.isnan(library.error_bound(np.array([x, 0 * x]), [y, y], [y, y])[0]).all()


def test_parameters_that_are_prepared_are_covered() -> None:
    system = model("double_pendulum")
    sample = default_domain(system).sample(4, 1)
    changed = {parameter.name: 1.37 * parameter.value for parameter in system.parameters}
    assert changed
    library = bounding(system).with_parameters(changed)
    for x, y, tau in zip(sample.x, sample.y, sample.tau, strict=True):
        ydot = library.forward_dynamics(x, y, tau)
        exact = truth.truth(system, x, y, tau, parameters=changed, outputs=("forward_dynamics",))
        assert (exact["forward_dynamics"].distance(ydot) <= library.error_bound(x, y, ydot, tau)).all()


@pytest.mark.parametrize("seed", slow_except(range(4), 3))
def test_random_trees(seed: int) -> None:
    """Trees of three bodies with random joints, turned joint frames, and masses of 1e-3 to 1e3 kg."""
    rng = np.random.default_rng(seed)
    system = systems.random_system(rng, 3)
    sample = default_domain(system, clearance=0.05).sample(6, seed)
    errors, bounds = errors_and_bounds(system, sample)
    assert (errors <= bounds).all()


def test_batches_and_all_outputs_together_have_the_same_bits() -> None:
    system = model("double_pendulum")
    sample = default_domain(system).sample(7, 1)
    library, alone = bounding(system), kg.build(system, ("error_bound",))
    ydot = library.forward_dynamics(sample.x, sample.y, sample.tau)
    bounds = library.error_bound(sample.x, sample.y, ydot, sample.tau)
    rows = zip(sample.x, sample.y, ydot, sample.tau, strict=True)
    assert (np.array([library.error_bound(*row) for row in rows]) == bounds).all()
    assert (alone.error_bound(sample.x, sample.y, ydot, sample.tau) == bounds).all()
    accelerations, together = library.evaluate(x=sample.x, y=sample.y, ydot=ydot, tau=sample.tau)
    assert (together == bounds).all()
    assert (accelerations == ydot).all()


def test_the_bounds_do_not_change_other_functions() -> None:
    """[A] and {f} of a model without parameters have the same instructions with and without the bounds."""
    system = model("scara")
    plain = kg.generate(system, ("mass_matrix", "forcing"), functions=("mass_matrix", "forcing"))
    more = kg.generate(
        system, ("mass_matrix", "forcing", "error_bound"), functions=("mass_matrix", "forcing")
    )
    name = f"{system.name}.c"
    bodies = [text.files[name].partition(f"int {system.name}_mass_matrix")[2] for text in (plain, more)]
    assert bodies[0]
    assert bodies[0] == bodies[1]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"precision": "double-double"}, "take double or float"),
        ({"precision": "long double"}, "take double or float"),
        ({"storage": "float"}, "in which states are rounded"),
        ({"sincos": "polynomial-7"}, "take shared or libm"),
        ({"semantics": ("associative",)}, "Take strict semantics"),
        ({"semantics": ("flush-to-zero",)}, "Take strict semantics"),
    ],
)
def test_what_cannot_be_proven_is_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        kg.generate(model("double_pendulum"), ("error_bound",), tier=kg.Variant(**changes))


@pytest.mark.slow
def test_the_panda_arm() -> None:
    """The bound is proven in every state, and its median is at most a thousand times the error."""
    system = model("panda_arm")
    domain = default_domain(system)
    hard = hard_states(domain, 20, 1)
    assert hard is not None
    ordinary = domain.sample(200, 0)
    errors, bounds = errors_and_bounds(system, joined([ordinary, corners(domain, 40), hard]))
    assert (errors <= bounds).all()
    ratios = np.linalg.norm(bounds[:200], axis=1) / np.linalg.norm(errors[:200], axis=1)
    assert np.median(ratios) <= 1000
