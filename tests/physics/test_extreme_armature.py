"""Armature of any size: every solver keeps to a few hundred roundoffs of the truth, or reports the state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.support import systems
from tests.support.status_search import Evaluator

LARGEST = 1024.0  # unit roundoffs
SOLVERS = ("cheapest", "articulated bodies", "factorisation")


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("seed", "masses"),
    [
        (0, False),
        pytest.param(1, False, marks=pytest.mark.slow),
        pytest.param(2, True, marks=pytest.mark.slow),
        (3, True),
    ],
)
def test_extreme_armature(seed: int, masses: bool, solver: str) -> None:
    """Four hinges, armature within 1e-8 ... 1e8, the masses the same or spread over eight decades."""
    rng = np.random.default_rng(seed)
    count = 4
    arrays = systems.chain(count, ["theta3"], seed).values()
    if masses:
        arrays.mass[:] *= 10.0 ** rng.uniform(-4, 4, count)
        arrays.inertia[:] *= 10.0 ** rng.uniform(-4, 4, count)[:, None, None]
    armature = np.zeros((count, 6))
    armature[:, 2] = 10.0 ** rng.uniform(-8, 8, count)
    system = systems.from_values(replace(arrays, armature=armature))
    x, y, tau = (rng.uniform(-size, size, (20, count)) for size in (3, 2, 2))
    tried = Evaluator(system, "double", solver=solver).tried(x, y, tau)
    assert tried.silent.any()
    assert tried.unreported.max() < LARGEST
