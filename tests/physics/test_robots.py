"""Compiled C of real robots compared with Pinocchio's `crba` and `nonLinearEffects`."""

from __future__ import annotations

import numpy as np
import pytest

import kanegen as kg
from tests.support.robots import (
    FIXED_ROBOTS,
    FLOATING_ROBOTS,
    dynamics,
    fixed_model,
    floating_model,
    places,
    robot_file,
)

TOLERANCE = 1e-12
"""Tolerance of the comparison; robots of this size lose less than 1e-14 on either side."""


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(
    ("name", "floating"),
    [(name, False) for name in FIXED_ROBOTS]
    + [
        pytest.param(name, True, marks=[pytest.mark.slow] * (name == "hyq_no_sensors"))
        for name in FLOATING_ROBOTS
    ],
)
def test_c_agrees_with_pinocchio(name: str, floating: bool) -> None:
    path = robot_file(name)
    system = kg.load(path, floating_base=floating)
    if floating:
        model, several = floating_model(path, system)
    else:
        model, several = fixed_model(path), {}
    order = places(system, model, several)
    states = np.random.default_rng(7).uniform(-2, 2, (2, 100, len(order)))
    library = kg.build(system)
    matrices, forcings = library.mass_matrix(states[0]), library.forcing(states[0], states[1])
    for x, y, ours_a, ours_f in zip(*states, matrices, forcings, strict=True):
        a, f = dynamics(model, order, x, y)
        assert np.abs(ours_a - a).max() <= TOLERANCE * np.abs(a).max()
        assert np.abs(ours_f - f).max() <= TOLERANCE * np.abs(f).max()
