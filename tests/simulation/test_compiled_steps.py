"""Motions by rollouts in C: the states of the steps in NumPy, events, and steps that fail."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import kanegen as kg
from kanegen.recursion.outputs.integrators import METHODS
from kanegen.simulation import compiled_steps
from kanegen.simulation.compiled_steps import IN_C, CompiledSteps
from tests.support.moving_pendulum import GRAVITY, pendulum
from tests.support.paths import MODELS

OUTPUTS = ("forward_dynamics", "coordinate_rates", "kinetic_energy", "potential_energy")
IRREGULAR = np.array([0.0, 0.1, 0.2, 0.25, 0.9, 1.55, 2.2, 2.5])
LATE = 1e6 + 0.02 * np.arange(20) + 4e-7 * np.array([0, 1] * 10)  # s, of unequal intervals


@pytest.fixture(scope="module")
def libraries() -> tuple[kg.Library, kg.Library]:
    """A free body with a quaternion that carries a wheel: a library with rollouts, and one without."""
    body = kg.Body("bus", 0, 2.0, np.diag([1.0, 2.0, 2.5]), mass_center=(0.1, 0.0, 0.2))
    hinge = kg.Joint(position=(0.3, 0.0, 0.1), free=(False, False, True, False, False, False))
    wheel = kg.Body("wheel", 1, 0.5, np.diag([0.1, 0.1, 0.2]), mass_center=(0.05, 0.0, 0.0), joint=hinge)
    system = kg.System("bus", (body, wheel)).with_coordinates("quaternion")
    flags = "-O0 -ffp-contract=off"
    return kg.build(system, (*OUTPUTS, "rollout_rk4"), flags=flags), kg.build(system, OUTPUTS, flags=flags)


def start(library: kg.Library, batch: tuple[int, ...] = ()) -> dict[str, Any]:
    x = np.zeros((*batch, len(library.coordinate_names)))
    x[..., 0] = 1.0
    y = np.broadcast_to(np.linspace(0.1, 0.8, library.n), (*batch, library.n)).copy()
    if batch:
        y *= np.linspace(0.5, 1.5, *batch)[:, None]
    return {"x": x, "y": y}


@pytest.mark.parametrize(("batch", "compensated"), [((), True), ((3,), False)])
@pytest.mark.parametrize("times", [IRREGULAR, LATE, [0.0, 2.0], np.linspace(0, 1, 501)])
def test_states_are_those_of_the_steps_in_numpy(
    libraries: tuple[kg.Library, kg.Library],
    batch: tuple[int, ...],
    compensated: bool,
    times: Any,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Rounding alone differs: a step adds a few roundings, which a motion of 3 s hardly grows."""
    monkeypatch.setattr(compiled_steps, "_LONGEST", 64)
    found, expected = (
        kg.simulate(library, **start(library, batch), times=times, step=0.01, compensated=compensated)
        for library in libraries
    )
    assert np.array_equal(found.times, times)
    assert found.evaluations == expected.evaluations
    assert np.abs(found.x - expected.x).max() < 1e-12
    assert np.abs(found.y - expected.y).max() < 1e-12


def test_the_rollouts_are_used_unless_something_depends_on_the_state(
    libraries: tuple[kg.Library, kg.Library], monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[int] = []
    rollout = CompiledSteps._rollout
    monkeypatch.setattr(
        CompiledSteps, "_rollout", lambda self, *rest: calls.append(1) or rollout(self, *rest)
    )
    for library in libraries:
        kg.simulate(library, **start(library), times=1.0, step=0.01)
        kg.simulate(library, **start(library), times=1.0, step=0.01, inputs={"wheel.theta3": "-y.bus.omega1"})
    assert len(calls) == 1


@pytest.mark.parametrize("length", [1e-3, 3.0, 1e5])
@pytest.mark.parametrize("batch", [(), (3,)])
def test_quaternions_of_any_length_are_those_of_the_steps_in_numpy(
    libraries: tuple[kg.Library, kg.Library],
    batch: tuple[int, ...],
    length: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Lengths have no meaning and stay: the motion is that of quaternions of length 1, up to rounding."""
    calls: list[int] = []
    rollout = CompiledSteps._rollout
    monkeypatch.setattr(
        CompiledSteps, "_rollout", lambda self, *rest: calls.append(1) or rollout(self, *rest)
    )
    scaled = start(libraries[0], batch)
    scaled["x"][..., 0] = length
    in_c, in_numpy = (kg.simulate(library, **scaled, times=2.0, step=0.01) for library in libraries)
    assert calls
    unit = kg.simulate(libraries[0], **start(libraries[0], batch), times=2.0, step=0.01)
    assert np.abs(np.linalg.norm(in_c.x[..., :4], axis=-1) / length - 1).max() < 1e-15
    for found in (in_c, in_numpy):
        x = found.x.copy()
        x[..., :4] /= length
        assert np.abs(x - unit.x).max() < 1e-12
        assert np.abs(found.y - unit.y).max() < 1e-12


def test_events_are_those_of_the_steps_in_numpy(libraries: tuple[kg.Library, kg.Library]) -> None:
    events = ["x.wheel.theta3 > 0.2", kg.Event("x.wheel.theta3 - 0.35", terminal=True)]
    found, expected = (
        kg.simulate(library, **start(library), times=3.0, step=0.01, events=events) for library in libraries
    )
    assert [one.condition for one in found.events] == [one.condition for one in expected.events]
    assert len(found.events) == 2
    for one, other in zip(found.events, expected.events, strict=True):
        assert one.time == pytest.approx(other.time, abs=1e-12)
        assert np.abs(one.x - other.x).max() < 1e-12
    assert found.times[-1] == found.events[-1].time


def test_a_quaternion_of_length_zero_is_named(libraries: tuple[kg.Library, kg.Library]) -> None:
    """With the same words where steps run in C and in NumPy."""
    found = []
    for library in libraries:
        nowhere = start(library)
        nowhere["x"][:] = 0.0
        with pytest.raises(kg.StatusError, match=r"^at t = 0 s: .* quaternion of length 0") as error:
            kg.simulate(library, **nowhere, times=1.0, step=0.01)
        found.append(str(error.value))
    assert found[0] == found[1]


@pytest.fixture(scope="module")
def with_all_methods() -> kg.Library:
    """A pendulum of 1 m with the rollouts of all methods."""
    system = pendulum().source.system
    assert system is not None
    return kg.build(system, ("forward_dynamics", *(f"rollout_{name}" for name in IN_C.values())), flags="-O0")


@pytest.mark.parametrize("method", sorted(IN_C))
def test_methods_of_c_have_their_motion(method: str, with_all_methods: kg.Library) -> None:
    """A pendulum of 1 m from level and at rest, against the elliptic function, with the promised orders."""
    errors = []
    for step in (1 / 200, 1 / 400):
        motion = kg.simulate(with_all_methods, [0.0], [0.0], 1.0, method, every=0.1, step=step)
        phi = 2 * np.arcsin(math.sqrt(0.5) * ellipj(math.sqrt(GRAVITY) * motion.times + ellipk(0.5), 0.5)[0])
        errors.append(np.abs(motion.x[:, 0] - (phi - math.pi / 2)).max())
    order = METHODS[IN_C[method]].order
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)


def test_methods_that_run_in_c_only_say_what_they_need() -> None:
    system = pendulum().source.system
    assert system is not None
    with pytest.raises(kg.OptionError, match="'euler': Build the library with the output 'rollout_euler'"):
        kg.simulate(pendulum(), [0.0], [0.0], 1.0, "Euler", step=0.1)
    (freedom,) = system.freedom_names
    with pytest.raises(kg.OptionError, match="'linearly_implicit': It runs in C, where inputs depend"):
        kg.simulate(system, None, None, 1.0, "linearly_implicit", step=0.1, inputs={freedom: f"-y.{freedom}"})


def test_the_time_reaches_forces_that_depend_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also in the later parts of an interval with many steps."""
    monkeypatch.setattr(compiled_steps, "_LONGEST", 16)
    system = kg.load(MODELS / "double_pendulum.toml")
    driven = system.with_force_elements(kg.Drive("q1", kg.parse("3*sin(5*t) - 0.1*y.q1")))
    found, expected = (
        kg.simulate(
            kg.build(driven, ("forward_dynamics", *more), flags="-O0"),
            {"q1": 0.3},
            None,
            IRREGULAR,
            step=0.01,
        )
        for more in (("rollout_rk4",), ())
    )
    assert np.abs(found.x - expected.x).max() < 1e-12


def test_a_step_that_fails_is_named_and_what_was_before_is_kept() -> None:
    """A drive that grows without end: the state overflows."""
    system = kg.load(MODELS / "double_pendulum.toml")
    driven = system.with_force_elements(kg.Drive("q1", kg.parse("exp(20*y.q1**2) + 10")))
    library = kg.build(driven, ("forward_dynamics", "rollout_rk4"), flags="-O0")
    with pytest.raises(kg.StatusError) as error:
        kg.simulate(library, {"q1": 0.3}, None, 5.0, every=0.01, step=0.01)
    assert str(error.value).startswith("at t = ")
    kept = error.value.trajectory  # type: ignore[attr-defined]
    assert len(kept.times) > 2
    assert np.isfinite(kept.x).all() and np.isfinite(kept.y).all()
    assert kept.times[-1] < 5.0
