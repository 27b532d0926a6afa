"""Which of many sets of parameters no model takes: the same as each set alone, with its message."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kanegen as kg
from tests.support import random_trees
from tests.support.cases import slow_except
from tests.support.paths import MODELS


def alone(system: kg.System, sets: Any) -> dict[int, str]:
    """Return the message of every set that the system refuses, one after the other."""
    names, found = [parameter.name for parameter in system.parameters], {}
    for row, values in enumerate(sets):
        try:
            system.with_parameters(dict(zip(names, map(float, values), strict=True)))
        except kg.ModelError as error:
            found[row] = str(error)
    return found


@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
@pytest.mark.parametrize("seed", slow_except(range(6), 0, 3))
def test_random_trees(seed: int) -> None:
    """Every second set has one parameter with another sign, or zero, infinite or NaN."""
    system = random_trees.everything(seed)
    if seed % 2:  # a rotor or a coupling with parameters is examined set by set
        system = kg.System(
            "plain", system.bodies, system.gravity, force_elements=system.force_elements, frames=system.frames
        )
    rng = np.random.default_rng(seed)
    usual = np.array([parameter.value for parameter in system.parameters])
    sets = usual * rng.uniform(0.95, 1.05, (24, len(usual)))
    for row in range(0, 24, 2):
        sets[row, rng.integers(len(usual))] *= rng.choice([-1.0, -30.0, 0.0, np.inf, np.nan])
    found = system.unusable_parameters(sets)
    assert found == alone(system, sets)
    assert found


@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
def test_each_condition() -> None:
    m, size, damping, friction, smooth = (
        kg.Parameter(name, value)
        for name, value in {"m": 1.0, "size": 1.0, "d": 0.1, "f": 0.2, "s": 0.3}.items()
    )
    inertia = [[2.0, size, 0.0], [size, 2.0, 0.0], [0.0, 0.0, 3.0]]
    body = kg.Body("arm", 0, m / 2, inertia, (0, 0, 1), kg.Joint(free=(True,) + (False,) * 5))
    joint = kg.Joint(free=(True,) + (False,) * 5, position=(1 / damping, 0, 0))
    other = kg.Body("hand", 1, 1.0, np.eye(3).tolist(), (0, 0, 1), joint)
    system = kg.System(
        "arms", (body, other), force_elements=(kg.JointFriction("arm.theta1", friction, smooth),)
    )
    names = [parameter.name for parameter in system.parameters]
    bad = {"m": -1.0, "size": 2.5, "d": 0.0, "f": -0.1, "s": 0.0}
    usual = [parameter.value for parameter in system.parameters]
    sets = np.tile(usual, (1 + len(bad), 1))
    for row, (name, value) in enumerate(bad.items()):
        sets[row, names.index(name)] = value
    found = system.unusable_parameters(sets)
    assert sorted(found) == [0, 1, 2, 3, 4]
    assert "mass" in found[0]
    assert "not positive semidefinite" in found[1]
    assert "divides by zero" in found[2]
    assert "friction" in found[3]
    assert "smoothing" in found[4]
    assert system.unusable_parameters({"m": [1.0, -1.0, 0.0]}) == {1: found[0]}


def test_many_usable_sets_cost_little() -> None:
    """Sets that are certainly usable are not examined one after the other."""
    system = kg.load(MODELS / "double_pendulum.toml")
    usual = np.array([parameter.value for parameter in system.parameters])
    sets = usual * np.random.default_rng(1).uniform(0.1, 3.0, (100_000, len(usual)))
    assert system.unusable_parameters(sets) == {}
    sets[77_777, 1] = -1.0
    assert list(system.unusable_parameters(sets)) == [77_777]


def test_sets_that_do_not_fit() -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    with pytest.raises(
        kg.ArrayError, match=r"^parameters: expected shape \(5,\) or \(B, 5\), got \(3, 4\)\."
    ):
        system.unusable_parameters(np.ones((3, 4)))
    with pytest.raises(kg.ModelError, match=r"^unknown parameter 'mass'"):
        system.unusable_parameters({"mass": [1.0]})
