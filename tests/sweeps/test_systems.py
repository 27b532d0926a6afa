"""Sweeps of systems with quaternions, loads, limits, forces that depend on the time, and accelerations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from tests.support.oscillator import oscillator
from tests.support.paths import MODELS

OUTPUTS = ("forward_dynamics", "rollout_rk4")


def test_a_free_body_with_a_quaternion_and_loads() -> None:
    """Rows have the bits of single rollouts; without a load nothing moves."""
    system = kg.load(MODELS / "satellite.toml").with_coordinates("quaternion")
    body = next(one.name for one in system.bodies if one.loads)
    spin = system.speed_names[0]
    job = kg.RolloutJob(1.0, 0.05, results=("end.x", "end.y", "drift.kinetic_energy"), every=5)
    axes = {f"torque.{body}.x": [0.0, 0.3], f"y.{spin}": [0.0, 0.5]}
    found = kg.sweep(system, axes, job)
    library = kg.build(system, OUTPUTS)
    for _, row in found.table.iterrows():
        x, y = np.array(system.neutral_coordinates), np.zeros(library.n)
        y[0] = row[f"y.{spin}"]
        torque = np.zeros((len(system.bodies), 3))
        torque[[one.name for one in system.bodies].index(body), 0] = row[f"torque.{body}.x"]
        path = library.rollout(x, y, torque=torque, steps=20, step=0.05)
        names = [f"end.x.{name}" for name in system.coordinate_names]
        assert row[names].tolist() == path.x[-1].tolist()
    assert found.column("drift.kinetic_energy")[0] == 0
    assert found.column("drift.kinetic_energy")[2] > 0


def test_rows_that_begin_outside_the_limits_give_a_warning() -> None:
    system = kg.load(MODELS / "cart_pole.toml")
    cart = system.freedom_names[0]
    limited = system.with_limits({cart: {"position": (-1.0, 1.0), "speed": 2.0}})
    job = kg.RolloutJob(0.1, 0.05, results=f"end.x.{cart}")
    axes = {f"x.{cart}": [0.0, -3.0], f"y.{cart}": [0.0, 2.5, -2.5]}
    message = f"outside of limits of the model: x.{cart} in 3 rows, y.{cart} in 4 rows."
    with pytest.warns(kg.KanegenWarning, match=message.replace(".", r"\.")):
        kg.sweep(limited, axes, job)


def test_a_force_that_depends_on_the_time() -> None:
    """A mass on a rail with the force 2 sin(3 t): the motion is known, also over several blocks of times."""
    body = kg.Body(
        "cart",
        0,
        kg.Parameter("m", 1.0),
        np.eye(3),
        (0, 0, 0),
        kg.Joint(name="rail", free=(False, False, False, True, False, False)),
    )
    rail = kg.System("rail", (body,), (0, 0, 0)).with_force_elements(kg.Drive("rail", kg.parse("2*sin(3*t)")))
    job = kg.RolloutJob(2.0, 0.01, results=("path.x.rail", "max.forward_dynamics"))
    found = kg.sweep(rail, {"m": [0.5, 2.0]}, job)
    t = np.arange(201) * 0.01
    for mass, path, largest in zip(
        (0.5, 2.0), found.column("path.x.rail"), found.column("max.forward_dynamics.rail"), strict=True
    ):
        exact = 2 / mass * (t / 3 - np.sin(3 * t) / 9)
        assert np.abs(path - exact).max() < 2 / mass * (3 * 0.01) ** 4 / 100
        assert largest == pytest.approx(2 / mass * np.sin(3 * t).max(), rel=1e-15)


def test_methods_are_an_axis() -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    axes = {"x.q1": 1.0, "method": ["rk4", "euler", "implicit_midpoint"]}
    job = kg.RolloutJob(1.0, 0.01, results="drift.energy")
    drifts = kg.sweep(system, axes, job).column("drift.energy")
    assert drifts[0] < 1e-6 < drifts[2] < 1e-3 < drifts[1]


def test_a_singular_state_is_a_reason() -> None:
    """A point mass at distance 0 from its hinge has no acceleration; the reason names the freedom."""
    hinge = kg.Joint(name="hinge", free=(False, False, True, False, False, False))
    rod = kg.Body("rod", 0, 1.0, np.zeros((3, 3)), (kg.Parameter("l", 1.0), 0, 0), hinge)
    job = kg.RolloutJob(0.1, 0.05, results="end.x.hinge")
    found = kg.sweep(kg.System("rod", (rod,)), {"l": [1.0, 0.0]}, job)
    assert list(found.reasons) == [1]
    start = "in the step from t = 0 s, x.hinge = 0, y.hinge = 0: forward_dynamics: "
    assert found.reasons[1].startswith(start)
    assert "at freedom 'hinge' of body 'rod'" in found.reasons[1]


def test_an_iteration_that_does_not_converge_is_a_reason() -> None:
    """On a spring of 1 N/m and 1 kg, steps of implicit methods that are longer than 2 s do not converge."""
    job = kg.RolloutJob(7.5, 1.25, method="implicit_midpoint", results="end.x")
    found = kg.sweep(oscillator(), {"x.slider.s1": [0.0, 0.3], "step": [1.25, 2.5]}, job)
    start = (
        "in the step from t = 0 s, x.slider.s1 = 0.3, y.slider.s1 = 0: the iteration for the step does not"
    )
    assert list(found.reasons) == [3]
    assert found.reasons[3].startswith(start)


def test_prescribed_motion_is_an_axis() -> None:
    """What slides freely on a base at m sin 5 t keeps its first speed: x = 5 m t - m sin 5 t.

    The base, of mass m, needs the effort -25 m^2 sin 5 t, since the block does not push it.
    """
    along = (False, False, False, True, False, False)
    base = kg.Body("base", 0, kg.Parameter("m", 1.0), np.eye(3), joint=kg.Joint(free=along))
    block = kg.Body("block", 1, 2.0, np.eye(3), joint=kg.Joint(free=along))
    shaken = kg.System("shaken", (base, block), gravity=(0, 0, 0)).with_prescribed("base.s1")
    job = kg.RolloutJob(2.0, 0.01, results=("path.x.block.s1", "max.prescribed_efforts"), every=10)
    found = kg.sweep(shaken, {"m": [0.1, 0.3], "prescribed.base.s1": "m*sin(5*t)"}, job)
    t = np.arange(21) * 0.1
    for row, m in enumerate((0.1, 0.3)):
        path = found.column("path.x.block.s1")[row]
        assert np.abs(path - m * (5 * t - np.sin(5 * t))).max() < 1e-6
        effort = found.column("max.prescribed_efforts.base.s1")[row]
        assert effort == pytest.approx((-25 * m * m * np.sin(5 * t)).max(), rel=1e-14)
    with pytest.raises(kg.OptionError, match=r"prescribed freedoms is missing: prescribed\.base\.s1"):
        kg.sweep(shaken, {"m": 0.1}, job)
    job = kg.RolloutJob(0.1, 0.01, results="end.x")
    assert kg.sweep(shaken, {"prescribed.base.s1": 1.0}, job).column("end.x.block.s1").tolist() == [0.0]


def test_lists_of_expressions_are_combined_with_other_axes() -> None:
    """A mass of a kg has the speed 0.5 m/s after 1 s under a t N, and (1 + a)/a m/s under 1 + a N."""
    texts = ["a*t", "1 + a"]
    body = replace(oscillator(0.0).bodies[0], mass=kg.Parameter("a", 1.0))
    system = replace(oscillator(0.0), bodies=(body,))
    job = kg.RolloutJob(1.0, 0.125, results="end.y")
    found = kg.sweep(system, {"a": [1.0, 2.0], "tau.slider.s1": [*texts, 3]}, job)
    assert found.column("tau.slider.s1").tolist() == [text for text in [*texts, "3.0"] for _ in range(2)]
    assert found.column("end.y.slider.s1").tolist() == pytest.approx([0.5, 0.5, 2.0, 1.5, 3.0, 1.5])
    assert found.to_xarray()["end.y.slider.s1"].sel({"tau.slider.s1": "a*t", "a": 2.0}) == pytest.approx(0.5)
    with pytest.raises(
        kg.OptionError,
        match=r"axes: x\.slider\.s1: 'a' is not a number\. Lists of expressions are for inputs",
    ):
        kg.sweep(system, {"x.slider.s1": ["a", "2*a"]}, job)
    with pytest.raises(kg.OptionError, match=r"axes: tau\.slider\.s1: expression 'b'"):
        kg.sweep(system, {"tau.slider.s1": ["a", "b"]}, job)


def test_compensated_steps_keep_more_digits_of_single_precision() -> None:
    """A block that moves by 1e-4 m in each of 20000 steps from x = 1 m."""
    axes = {"x.slider.s1": 1.0, "y.slider.s1": 0.1, "precision": "float"}
    jobs = [kg.RolloutJob(20.0, 1e-3, compensated=one) for one in (False, True)]
    ends = [kg.sweep(oscillator(0.0), axes, job).column("end.x.slider.s1")[0] for job in jobs]
    assert abs(ends[1] - 3) < 1e-6 and abs(ends[0] - 3) > 1e-5


def test_inputs_of_the_time_are_right_within_steps() -> None:
    """An input 2 sin(3 t) is evaluated at the stages of RK4, so that the error has order 4."""
    system = kg.load(MODELS / "cart_pole.toml")
    cart = system.freedom_names[0]

    def end(step: float) -> float:
        job = kg.RolloutJob(1.0, step, results=f"end.x.{cart}")
        return float(kg.sweep(system, {f"tau.{cart}": "2*sin(3*t)"}, job).column(f"end.x.{cart}")[0])

    errors = [abs(end(1 / count) - end(1 / 640)) for count in (20, 40)]
    assert 3.6 < math.log2(errors[0] / errors[1]) < 4.4
