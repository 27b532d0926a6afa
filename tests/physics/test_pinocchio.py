"""The reference compared with Pinocchio's `crba` and `rnea`: different code and a different formulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

import kanegen as kg
from kanegen.measure.comparison import compare
from kanegen.model.coordinates import SEQUENCES
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states
from tests.support import systems
from tests.support.pinocchio_tree import PinocchioTree

EXAMPLES = settings(max_examples=60, deadline=None, derandomize=True)


def differences(system: kg.System, count: int = 20) -> tuple[float, float]:
    """Return the largest differences in [A] and {f}, relative to their largest entries."""
    other, states = PinocchioTree(system), random_states(system, count)
    a = reference.mass_matrix(system, states.x)
    f = reference.forcing(system, states.x, states.y, states.force, states.torque)
    return (
        float(np.abs(a - other.mass_matrix(states.x)).max() / np.abs(a).max()),
        float(
            np.abs(f - other.forcing(states.x, states.y, states.force, states.torque)).max() / np.abs(f).max()
        ),
    )


def test_eight_body_tree() -> None:
    a, f = differences(systems.eight_body())
    assert a < 5e-15
    assert f < 5e-15


@EXAMPLES
@given(systems.systems())
def test_any_tree(system: kg.System) -> None:
    """Topology, free and locked freedoms, joint orientations, loads and gravity are all random."""
    report = compare(system, PinocchioTree(system), states=10)
    assert report.passed, str(report)


@pytest.mark.parametrize("seed", range(12))
def test_any_sequences(seed: int) -> None:
    """Each body has a random sequence of axes, and some angles are locked."""
    rng = np.random.default_rng(seed)
    arrays = systems.random_system(rng, 6).values()
    sequences = rng.permutation(list(SEQUENCES))[:6]
    system = systems.from_values(replace(arrays, sequence=tuple(str(name) for name in sequences)))
    report = compare(system, PinocchioTree(system), states=10)
    assert report.passed, str(report)


@pytest.mark.parametrize(
    "freedoms", [("theta3",), pytest.param(("theta1", "theta2", "theta3"), marks=pytest.mark.slow)]
)
def test_long_chains(freedoms: tuple[str, ...]) -> None:
    report = compare(system := systems.chain(64, freedoms), PinocchioTree(system), states=3)
    assert report.passed, str(report)
    assert report.max_error < 1e-13


def test_the_bound_is_not_too_wide() -> None:
    """Differences between two correct programs in float64 come within a factor of 20 of the bound."""
    rng, shares = np.random.default_rng(4), []
    for bodies in (1, 1, 2, 3, 6, 12):
        system = systems.random_system(rng, bodies)
        report = compare(system, PinocchioTree(system), states=200)
        shares.append(max(accuracy.componentwise / accuracy.bound for accuracy in report.accuracies))
    assert 0.05 < max(shares) < 1
