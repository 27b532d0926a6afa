"""The benchmark of rollouts: drivers follow the motions that libraries do, and the page has their rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from benchmarks.rollouts import participants
from benchmarks.rollouts.document import Row, document
from benchmarks.rollouts.participants import STRICT_AVX2, Entrant, Length
from kanegen.measure.machine import Machine
from kanegen.reference.states import ActuatedStates, states_away_from_gimbal_lock
from kanegen.studies.bench.peers.problem import Problem
from kanegen.studies.bench.states import write_states
from tests.support import systems

LENGTH = Length(1e-3, 15)
STATES = 11
"""No whole number of SIMD vectors."""


@pytest.fixture(scope="module")
def arm() -> kg.System:
    return systems.chain(2, ["theta2"])


@pytest.fixture(scope="module")
def states(arm: kg.System) -> ActuatedStates:
    return states_away_from_gimbal_lock(arm, STATES)


@pytest.fixture
def problem(arm: kg.System, states: ActuatedStates, tmp_path: Path) -> Problem:
    few = ActuatedStates(states.x[:4], states.y[:4], tau=states.tau[:4])
    return Problem(arm, few, write_states(few, tmp_path / "states"), tmp_path)


def ends(arm: kg.System, states: ActuatedStates) -> np.ndarray:
    """Return (4, 2, n) coordinates and speeds after the steps, from Python."""
    library = kg.build(arm, "rollout_rk4")
    found = library.rollout(states.x, states.y, states.tau, steps=LENGTH.steps, step=LENGTH.step)
    return np.stack([found.x[:4, -1], found.y[:4, -1]], axis=1)


def require_same(entrant: Entrant, expected: np.ndarray, tolerance: float) -> None:
    """Require that every task of a participant ends where `expected` does."""
    found = entrant.over(LENGTH).results(expected.shape[2])
    assert set(found) == set(entrant.methods)
    for name, values in found.items():
        assert np.abs(values - expected).max() <= tolerance * np.abs(expected).max(), name


def test_the_driver_of_kanegen(arm: kg.System, states: ActuatedStates, problem: Problem) -> None:
    many = write_states(states, problem.folder / "many")
    expected = ends(arm, states)
    for by_state in (None, True):
        require_same(participants._kanegen(problem, many, STRICT_AVX2, by_state), expected, 1e-14)


@pytest.mark.slow
def test_scipy_follows_the_same_motion(arm: kg.System, states: ActuatedStates, problem: Problem) -> None:
    """Its tolerance is 1e-9, and the error of the fixed steps is of that size at most."""
    require_same(participants._scipy(problem), ends(arm, states), 1e-7)


@pytest.mark.slow
def test_peers_follow_the_same_motion(arm: kg.System, states: ActuatedStates, problem: Problem) -> None:
    expected = ends(arm, states)
    require_same(participants._pinocchio(problem), expected, 1e-12)
    found = participants._mujoco(problem).over(LENGTH).results(2)
    assert np.abs(found["rk4"] - expected).max() <= 1e-12 * np.abs(expected).max()
    assert np.abs(found["implicitfast"] - expected).max() <= 0.05 * np.abs(expected).max()


def test_the_page(arm: kg.System) -> None:
    rows = [
        Row("Pinocchio", "RK4 with aba", "contracted", (4000.0, 4400.0, 4200.0), 0.0),
        Row("kanegen", "RK4, batch", "contracted", (100.0, 110.0, 105.0), 3e-16),
    ]
    page = document("arm", arm, LENGTH, 64, 4, rows, ["a note"], ["SciPy: absent"], Machine.here())
    assert "| Pinocchio | RK4 with aba | contracted | 4200 | 4000-4400 | 1.00 | 0e+00 |" in page
    assert "| kanegen | RK4, batch | contracted | 105 | 100-110 | 1/40.0 | 3e-16 |" in page
    assert "- a note.\n- Left out: SciPy: absent\n" in page
