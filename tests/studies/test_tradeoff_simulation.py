"""Simulations of a trade-off study, and variants of every precision against certified truth."""

from __future__ import annotations

import itertools
import json
import xml.etree.ElementTree
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kanegen as kg
from kanegen.measure.timing import OBJECTIVES
from kanegen.measure.truth.errors import LARGEST_BACKWARD_ERROR
from kanegen.model.coordinates import FREEDOMS
from kanegen.options import STRICT, Variant
from kanegen.reference import equations as reference
from kanegen.studies.bench.states import without_loads_and_parameters
from kanegen.studies.tradeoff import evaluator, simulation
from kanegen.studies.tradeoff.compilation import compile_variants
from kanegen.studies.tradeoff.domain import default_domain, joined
from kanegen.studies.tradeoff.evaluator import accelerations_of_driver
from kanegen.studies.tradeoff.exact_results import OUTPUT, ExactResults, compute_accelerations, unit_roundoff
from kanegen.studies.tradeoff.hard_states import hard_states
from kanegen.studies.tradeoff.outcome import SimulationRun, Study, StudyOptions
from kanegen.studies.tradeoff.plot import simulation_svg
from kanegen.studies.tradeoff.report import json_record, markdown
from kanegen.studies.tradeoff.simulation import with_simulations
from kanegen.studies.tradeoff.study import study
from kanegen.studies.tradeoff.tables import simulation_rows
from kanegen.studies.tradeoff.variants import Candidate
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.tradeoff_times import ignore_stage, times_from_operations

HINGES = systems.chain(2, ["theta3"])
PRECISIONS = [
    Variant(precision="long double"),
    Variant(precision="long double", storage="double"),
    Variant(precision="double-double"),
    Variant(precision="double-double", storage="double-double"),
    Variant(storage="float"),
    Variant(sincos="polynomial-5"),
    Variant(precision="float", sincos="polynomial-9"),
]


@pytest.fixture(scope="module")
def outcome() -> Study:
    patch = pytest.MonkeyPatch()
    patch.setattr(evaluator, "time_variants", times_from_operations)
    patch.setattr(simulation, "STEPS", (16, 32, 64))
    patch.setattr(simulation, "REFERENCE_STEPS", 1024)
    wanted = [Candidate(STRICT), Candidate(Variant(precision="float"))]
    terms = StudyOptions(states=3, hard=1, search=0, rounds=1, seconds=0.0)
    found = with_simulations(HINGES, study(HINGES, terms, ignore_stage, variants=wanted), ignore_stage)
    patch.undo()
    return found


def errors_of(found: Study, variant: str, method: str) -> list[float]:
    return [run.error for run in found.runs if (run.variant, run.method) == (variant, method)]


def test_errors_fall_by_the_order_of_the_method(outcome: Study) -> None:
    euler = errors_of(outcome, "default", "semi-implicit Euler")
    assert [a / b for a, b in itertools.pairwise(euler)] == pytest.approx([2, 2], rel=0.4)
    coarse, middle, fine = errors_of(outcome, "default", "RK4")
    assert coarse > 8 * middle > 64 * fine
    assert errors_of(outcome, "default", "DOP853")[-1] < 1e-10
    single = errors_of(outcome, "float, cheapest, refined as needed", "RK4, compensated")
    assert single[-1] > 1e-9
    assert not errors_of(outcome, "float, cheapest, refined as needed", "DOP853")


def test_the_end_is_that_of_the_reference_in_numpy(outcome: Study) -> None:
    """The reference integrates with SciPy and accelerations from NumPy; no generated C takes part."""
    model, _ = without_loads_and_parameters(HINGES)
    start = outcome.domain.sample(1, (outcome.options.seed, simulation.START))
    x, y, n = start.x[0], 0.5 * start.y[0], 2

    def rates(time: float, state: np.ndarray) -> np.ndarray:
        a = reference.mass_matrix(model, state[:n])
        return np.concatenate([state[n:], np.linalg.solve(a, reference.forcing(model, *state.reshape(2, n)))])

    span = (0.0, outcome.duration)
    end = solve_ivp(rates, span, np.concatenate([x, y]), "DOP853", rtol=1e-12, atol=1e-12).y[:n, -1]
    built = kg.build(model, (OUTPUT,))
    for way in simulation.integrations(built, x, y, outcome.duration):
        error, evaluations = simulation.run_integration(way, built, way.motion(built))
        assert error == 0
        assert evaluations > 0
    finest = simulation.fixed_step(x, y, outcome.duration, "RK4", 1024, True).motion(built)
    assert finest.x[-1] == pytest.approx(end, abs=1e-9)


def test_the_table_names_the_least_work_for_every_error(outcome: Study) -> None:
    rows = simulation_rows(outcome)
    assert rows
    for level, variant, method, setting, *_ in rows:
        (own,) = [r for r in outcome.runs if (r.variant, r.method, r.setting) == (variant, method, setting)]
        assert own.error <= float(level)
        assert all(r.work >= own.work for r in outcome.runs if r.error <= float(level))
    assert SimulationRun("a", "RK4", "1 step", 4, 250.0, 0.0).work == pytest.approx(1e-6)


def test_simulations_in_the_documents(outcome: Study) -> None:
    text, facts = markdown(outcome), json.loads(json_record(outcome))
    assert "## Simulation" in text
    assert "tradeoff-simulation.svg" in text
    assert len(facts["simulation"]["runs"]) == len(outcome.runs)
    xml.etree.ElementTree.fromstring(simulation_svg(outcome))


def test_a_simulation_that_fails_has_an_infinite_error() -> None:
    def fails(library: kg.Library) -> Any:
        raise kg.StatusError("nothing")

    way = simulation.Integration("RK4", "1 step", fails)
    assert simulation.run_integration(way, kg.build(HINGES, (OUTPUT,)), None) == (np.inf, 0)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "variant",
    slow_except(PRECISIONS, *PRECISIONS[1::2]),
    ids=lambda v: f"{v.precision} {v.storage} {v.sincos}",
)
def test_every_precision_is_measured_and_timed(variant: Variant) -> None:
    """The measured error is about u, down to 1e-30, and the timing driver computes the same numbers."""
    system = systems.chain(1, FREEDOMS)
    domain = default_domain(system)
    sample = joined([domain.sample(6, 0), hard_states(domain, 4, 0) or domain.sample(1, 1)])
    (built,), _ = compile_variants(system, [Candidate(variant)], ignore_stage)
    driven = accelerations_of_driver(built, sample)
    for objective in OBJECTIVES:
        errors = ExactResults(system).errors(built.library, sample, objective)
        assert not errors.wrong.any()
        assert errors.backward.max() < LARGEST_BACKWARD_ERROR / 2
        assert 1e-3 < errors.median / unit_roundoff(variant) < 50
        values = compute_accelerations(built.library, sample, objective)
        nearest = values[..., 0] if values.ndim > 2 else values.astype(np.float64)
        assert np.array_equal(driven[objective], nearest)
