"""Inputs that depend on the time alone, in steps in C: values within steps, jumps, work, and functions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.simulation.compiled_steps import CompiledSteps
from tests.support.oscillator import oscillator

FREEDOM = "slider.s1"
IRREGULAR = [0.0, 0.313, 0.55, 0.5501, 0.9]


@cache
def shaken() -> tuple[kg.Library, kg.Library]:
    """Two links on a slide whose motion is prescribed: a library with rollouts, and one without."""
    slide = kg.Joint(free=(False, False, False, True, False, False))
    hinge = kg.Joint(position=(0.5, 0.0, 0.1), free=(False, False, True, False, False, False))
    bodies = [
        kg.Body("base", 0, 1.0, np.eye(3), joint=slide),
        kg.Body("one", 1, 0.7, 0.1 * np.eye(3), mass_center=(0.3, 0.1, 0.0), joint=hinge, loads=True),
        kg.Body("two", 2, 0.4, 0.1 * np.eye(3), mass_center=(0.2, 0.0, 0.1), joint=hinge),
    ]
    system = kg.System("shaken", tuple(bodies), gravity=(0.0, -9.81, 0.0)).with_prescribed("base.s1")
    outputs = ("forward_dynamics", "prescribed_efforts", "kinetic_energy", "potential_energy")
    flags = "-O0 -ffp-contract=off"
    return kg.build(system, (*outputs, "rollout_rk4"), flags=flags), kg.build(system, outputs, flags=flags)


MOVED = {"base.s1": "0.1*sin(5*t)"}
HELD = {"t": IRREGULAR, "one.theta3": [1.0, -2.0, 0.5, 3.0, 0.0], "force.one.x": [0.0, 1.0, 2.0, -1.0, 0.0]}
CASES: Mapping[str, dict[str, Any]] = {
    "expressions": {"inputs": {**MOVED, "two.theta3": "cos(7*t)", "torque.one.z": "t**2"}},
    "functions": {
        "inputs": {
            "base.s1": lambda t: (0.1 * np.sin(5 * t), 0.5 * np.cos(5 * t), -2.5 * np.sin(5 * t)),
            "two.theta3": lambda t: np.exp(-t),
        }
    },
    "held and moving": {"inputs": [MOVED, HELD]},
    "held": {"inputs": HELD, "prescribed": lambda t: np.zeros((3, 1))},
    "lines": {"inputs": [MOVED, HELD], "hold": "linear"},
    "several states": {"inputs": [MOVED, HELD], "x": np.array([[0.1, 0.2], [0.3, -0.4], [0.0, 1.0]])},
}


@pytest.mark.parametrize("case", CASES)
def test_states_and_work_are_those_of_the_steps_in_numpy(case: str) -> None:
    """States differ by rounding, works by the errors of two rules of order 4, which are below 1e-6 J here."""
    options = {"x": [0.2, -0.3], **CASES[case]}
    found, expected = (kg.simulate(library, times=0.9, step=0.01, **options) for library in shaken())
    assert np.array_equal(found.times, expected.times) and found.evaluations == expected.evaluations
    assert np.abs(found.x - expected.x).max() < 1e-13
    assert np.abs(found.y - expected.y).max() < 1e-12
    assert np.abs(expected.work).max() > 0.1 and np.abs(found.work - expected.work).max() < 1e-6
    for name, values in expected.inputs.items():
        assert np.array_equal(found.inputs[name], values)


def test_events_are_those_of_the_steps_in_numpy() -> None:
    events = ["y.one.theta3", "x.two.theta3 > 0.4 + 0.01*t"]
    found, expected = (
        kg.simulate(library, [0.2, -0.3], times=1.5, step=0.01, events=events, inputs=MOVED)
        for library in shaken()
    )
    assert len(found.events) == len(expected.events) > 1
    for one, other in zip(found.events, expected.events, strict=True):
        assert (one.condition, one.direction) == (other.condition, other.direction)
        assert abs(one.time - other.time) < 1e-11 and np.abs(one.x - other.x).max() < 1e-11


def test_the_work_has_order_four_and_balances_the_energy() -> None:
    """What prescribed motion and efforts do is the change of the energy of a system without other inputs."""
    drifts, inputs = [], CASES["functions"]["inputs"]
    for step in (0.02, 0.01):
        found = kg.simulate(shaken()[0], [0.2, -0.3], times=2.0, step=step, inputs=inputs)
        energy = found.kinetic_energy + found.potential_energy
        drifts.append(np.abs(energy - energy[0] - found.work).max())
    assert drifts[1] < 1e-6 and drifts[0] / drifts[1] > 10


def test_a_force_that_jumps_between_steps_has_its_exact_motion() -> None:
    """1 kg, pushed by constant forces: parabolas, which steps of any length follow but for rounding."""
    library = kg.build(oscillator(0.0), ("forward_dynamics", "rollout_rk4"))
    forces = np.array([2.0, -1.0, 4.0, -8.0, 0.0])
    found = kg.simulate(library, None, None, IRREGULAR, step=0.25, inputs={"t": IRREGULAR, FREEDOM: forces})
    x = y = 0.0
    for k, length in enumerate(np.diff(IRREGULAR)):
        x, y = x + y * length + forces[k] * length**2 / 2, y + forces[k] * length
        assert (found.x[k + 1, 0], found.y[k + 1, 0]) == pytest.approx((x, y), rel=1e-13, abs=1e-14)
    assert found.work[-1] == pytest.approx(y**2 / 2, rel=1e-13)


def test_rollouts_are_long_where_nothing_jumps(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []
    rollout = CompiledSteps._rollout
    monkeypatch.setattr(
        CompiledSteps, "_rollout", lambda self, *rest: calls.append(rest[2]) or rollout(self, *rest)
    )
    table = {"t": np.arange(0, 101) * 0.01, FREEDOM: np.ones(101)}
    for inputs, hold, expected in (
        ({FREEDOM: "sin(t)"}, "zero", [100]),
        (table, "zero", [100]),
        (table, "linear", [100]),
    ):
        calls.clear()
        kg.simulate(oscillator(), None, None, 1.0, step=0.01, inputs=inputs, hold=hold)
        assert calls == expected


def test_a_push_of_a_function_of_the_time_is_not_missed() -> None:
    """A push of 1 N for 10 ms at rest, in a motion of 10 s, gives 1 kg a speed of 0.01 m/s."""
    push = {FREEDOM: lambda t: float(5.01 <= t < 5.02)}
    found = kg.simulate(oscillator(0.0), None, None, 10.0, tolerance=1e-8, inputs=push)
    assert found.y[-1, 0] == pytest.approx(0.01, rel=0.25)
    assert found.output(f"tau.{FREEDOM}").max() == 0.0  # at none of the 201 times that are stored


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        (
            {FREEDOM: lambda t: [1.0, 2.0]},
            r"input slider\.s1: at t = 0 s the function returned float64 of",
        ),
        ({FREEDOM: lambda t: "a"}, r"input slider\.s1: at t = 0 s .* expected a real number"),
        ({FREEDOM: lambda t: math.nan}, r"input slider\.s1: at t = 0 s the function returned nan; expected"),
        ({FREEDOM: lambda t, x: 1.0}, r"input slider\.s1: the function takes \(t, x\); expected \(t\)\."),
    ],
)
def test_functions_that_return_something_else_are_refused(inputs: Any, message: str) -> None:
    with pytest.raises(kg.OptionError, match=message):
        kg.simulate(oscillator(), None, None, 1.0, step=0.1, inputs=inputs)


def test_a_function_may_return_the_same_array_at_every_time() -> None:
    """Numbers are copied when it returns, because the next call overwrites them."""
    library, _ = shaken()
    buffer = np.zeros((3, 1))

    def motion(t: float) -> np.ndarray:
        buffer[:, 0] = 0.1 * np.sin(5 * t), 0.5 * np.cos(5 * t), -2.5 * np.sin(5 * t)
        return buffer

    reused, fresh = (
        kg.simulate(library, [0.1, 0.2], [0.0, 0.0], 0.5, prescribed=function, step=0.05).x
        for function in (motion, lambda t: motion(t).copy())
    )
    assert (reused == fresh).all() and np.ptp(fresh) > 0.1
