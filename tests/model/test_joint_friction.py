"""Coulomb friction that is smoothed about standstill."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from tests.support import systems
from tests.support.programs import values


def slider(**friction: Any) -> kg.System:
    """Return a slide of mass 2 without gravity."""
    free = (False, False, False, True, False, False)
    body = kg.Body("box", 0, 2.0, np.eye(3).tolist(), joint=kg.Joint(free=free, name="q"))
    system = kg.System("slider", (body,), gravity=(0, 0, 0))
    return system.with_force_elements(kg.JointFriction("q", **friction))


@pytest.mark.parametrize("rate", [0.0, 1e-9, 0.003, -0.01, 0.5, -1e3])
def test_the_effort_in_every_derivation(rate: float) -> None:
    system = slider(friction=0.4, smoothing=0.01)
    expected = pytest.approx([-0.4 * np.tanh(rate / 0.01)], rel=1e-14, abs=1e-300)
    assert reference.forcing(system, [0.0], [rate]) == expected
    assert values(system, ("forcing",), {"x": [0.0], "y": [rate]})["f"] == expected
    assert derive(system).lambdify().forcing([0.0], [rate]) == expected


def test_about_standstill_it_is_viscous_and_far_from_it_whole() -> None:
    """The slope at rest is friction / smoothing, and 99.5 % are reached at three times the smoothing."""
    system = slider(friction=0.4, smoothing=0.01)
    slopes = values(system, ("forcing_derivatives",), {"x": [0.0], "y": [0.0]})["forcing_derivatives"]
    assert slopes.tolist() == pytest.approx([0.0, -40.0])
    assert reference.forcing(system, [0.0], [0.03])[0] == pytest.approx(-0.4 * 0.99505, rel=1e-5)


def test_it_takes_the_energy_that_a_motion_loses() -> None:
    """From 1 m/s a box of 2 kg comes to rest after mass speed / friction = 0.5 s."""
    library = kg.build(slider(friction=4.0, smoothing=1e-3), ("forward_dynamics", "kinetic_energy"))
    trajectory = kg.simulate(library, [0.0], [1.0], np.linspace(0, 0.4, 5), step=1e-4)
    assert trajectory.y[:, 0] == pytest.approx(1 - 2 * trajectory.times, abs=1e-9)


def test_parameters_files_and_locking(tmp_path: Path) -> None:
    friction = kg.JointFriction("body2.theta3", kg.Parameter("c", 1.5), kg.Parameter("e", 0.02))
    system = systems.chain(2, ["theta3"]).with_force_elements(friction)
    assert friction.summary == "joint_friction: freedom = body2.theta3, friction = c, smoothing = e"
    assert [parameter.name for parameter in system.parameters] == ["c", "e"]
    system.save(tmp_path / "again.toml")
    assert kg.load(tmp_path / "again.toml") == system
    still = system.with_locked({"body2.theta3": 0.3})
    x, y = [0.2], [0.7]
    bare = systems.chain(2, ["theta3"]).with_locked({"body2.theta3": 0.3})
    assert reference.forcing(still, x, y) == pytest.approx(reference.forcing(bare, x, y), rel=1e-14)


def test_components_of_an_angular_velocity_and_coupled_freedoms_have_friction() -> None:
    ball = systems.chain(1, ["theta1", "theta2", "theta3"]).with_coordinates("quaternion")
    rough = ball.with_force_elements(kg.JointFriction("body1.omega2", 0.3, 0.1))
    x, y = [0.9, 0.1, -0.3, 0.2], [0.2, 0.05, -0.4]
    change = reference.forcing(rough, x, y) - reference.forcing(ball, x, y)
    assert change == pytest.approx([0, -0.3 * np.tanh(0.5), 0], abs=1e-14)
    gear = systems.chain(2, ["theta3"]).with_couplings(kg.Coupling("body2.theta3", {"body1.theta3": -3.0}))
    rough = gear.with_force_elements(kg.JointFriction("body2.theta3", 0.3, 0.1))
    found = values(rough, ("forcing",), {"x": [0.4], "y": [0.02]})["f"]
    bare = values(gear, ("forcing",), {"x": [0.4], "y": [0.02]})["f"]
    assert found - bare == pytest.approx([-3 * 0.3 * np.tanh(0.6)], rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("q", -1.0, 0.01), r"joint_friction: the friction -1\.0 is negative"),
        (("q", 1.0, 0.0), r"joint_friction: the smoothing 0\.0 is not positive\. Give a rate"),
        (("q", "much", 0.1), "joint_friction friction: 'much' is not a number"),
        ((3, 1.0, 0.1), "joint_friction freedom: 3 is not a name"),
    ],
)
def test_what_is_refused(arguments: Any, message: str) -> None:
    with pytest.raises(kg.ModelError, match=message):
        kg.JointFriction(*arguments)
