"""Trajectories against elliptic functions, orders of methods, conserved quantities, and error messages."""

from __future__ import annotations

import functools
import importlib.util
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import kanegen as kg
from kanegen.simulation import Trajectory, libraries, mescd, simulate
from kanegen.simulation.accuracy import drift
from kanegen.simulation.methods import FIXED, chosen_method
from tests.support.moving_pendulum import GRAVITY, OUTPUTS, pendulum
from tests.support.paths import MODELS

TIMES = np.linspace(0.0, 10.0, 41)


@functools.cache
def spinner(
    speeds: str = "angle_rates",
    outputs: tuple[str, ...] = ("coordinate_rates", *OUTPUTS),
    sequence: str = "1-2-3",
) -> kg.Library:
    """Return a free rigid body without gravity."""
    system = kg.System.from_arrays(
        connection=[0], mass=[1.0], inertia=[np.diag([1.0, 2.0, 2.5])], mass_center=[[0.1, 0.2, 0.3]],
        joint_position=[[0.0, 0.0, 0.0]], gravity=(0.0, 0.0, 0.0), name="spinner", sequence=sequence,
    )  # fmt: skip
    return kg.build(system.with_speeds(speeds), outputs)


def angle(times: np.ndarray) -> np.ndarray:
    """Return theta3 of the pendulum that starts level and at rest.

    With phi from the lowest position, sin(phi/2) = k cd(t sqrt(g) | k^2) and k^2 = 1/2.
    """
    quarter = ellipk(0.5)
    phi = 2 * np.arcsin(math.sqrt(0.5) * ellipj(math.sqrt(GRAVITY) * times + quarter, 0.5)[0])
    return np.asarray(phi - math.pi / 2)


def error(path: Trajectory) -> float:
    return float(np.abs(path.x[:, 0] - angle(path.times)).max())


def run(method: str, library: kg.Library | None = None, **options: Any) -> Trajectory:
    return simulate(library or pendulum(), [0.0], [0.0], TIMES, method, **options)


@pytest.mark.parametrize(("method", "order"), [("RK4", 4), ("semi_implicit_euler", 1), ("leapfrog", 2)])
def test_fixed_steps_have_their_order(method: str, order: int) -> None:
    coarse, fine = (error(run(method, step=step)) for step in (1 / 160, 1 / 320))
    assert order - 0.2 < math.log2(coarse / fine) < order + 0.2


def test_adaptive_methods_meet_their_tolerance() -> None:
    """Errors of steps add up and grow, so a hundred tolerances are allowed in ten seconds."""
    for method, tolerance in (("DOP853", 1e-12), ("Radau", 1e-7)):
        path = run(method, tolerance=tolerance)
        assert 0 < error(path) < 100 * tolerance
        assert path.evaluations > len(TIMES)


def test_leapfrog_follows_speeds_that_accelerations_depend_on() -> None:
    """With damping the order stays two."""

    def damped(step: float) -> float:
        path = run("leapfrog", step=step, effort=lambda t, x, y: -0.5 * y)
        exact = run("DOP853", tolerance=1e-12, effort=lambda t, x, y: -0.5 * y)
        return float(np.abs(path.x - exact.x).max())

    assert 3.4 < damped(1 / 50) / damped(1 / 100) < 4.6


def test_compensated_sums_keep_what_small_steps_lose() -> None:
    """In single precision the 8 000 roundings of the state are most of the error."""
    plain, kept = (error(run("RK4", pendulum("float"), step=1 / 800, compensated=on)) for on in (False, True))
    assert kept < plain / 5
    assert run("RK4", pendulum("float"), step=0.1).x.dtype == np.float32


def test_a_batch_is_its_states() -> None:
    x, y = np.array([[0.0], [1.0], [2.0]]), np.array([[0.0], [-1.0], [0.5]])
    for method in FIXED:
        path = simulate(pendulum(), x, y, [0.0, 1.0], method, step=0.01, effort=lambda t, x, y: 0.1 * y)
        assert path.x.shape == (2, 3, 1)
        assert path.work.shape == (2, 3)
        for b in range(3):
            alone = simulate(
                pendulum(), x[b], y[b], [0.0, 1.0], method, step=0.01, effort=lambda t, x, y: 0.1 * y
            )
            assert np.abs(alone.x - path.x[:, b]).max() < 1e-13
            assert np.abs(alone.work - path.work[:, b]).max() < 1e-13


def test_the_energy_changes_by_the_work_of_the_efforts() -> None:
    path = run("DOP853", tolerance=1e-12, effort=lambda t, x, y: [math.sin(3 * t)])
    assert np.ptp(path.work) > 0.1
    assert path.energy_drift.largest < 1e-10
    assert path.energy_drift.scale == max(np.ptp(path.kinetic_energy), np.ptp(path.potential_energy))


def test_symplectic_steps_oscillate_and_others_drift() -> None:
    times = np.linspace(0.0, 100.0, 401)
    leapfrog = simulate(pendulum(), [0.0], [0.0], times, "leapfrog", step=0.02).energy_drift
    rk4 = simulate(pendulum(), [0.0], [0.0], times, step=0.02).energy_drift
    assert abs(leapfrog.slope) * 100 < leapfrog.oscillation / 10
    assert abs(rk4.slope) * 100 > 3 * rk4.oscillation


def test_momentum_of_a_free_body() -> None:
    y = [0.3, -0.2, 0.4, 1.0, 2.0, 3.0]
    path = simulate(spinner(), np.zeros(6), y, [0.0, 1.0, 2.0], "DOP853", tolerance=1e-12)
    linear, angular = path.momentum_drift()
    assert linear.largest < 1e-11 and angular.largest < 1e-11
    assert path.momentum.shape == (3, 6)
    assert path.momentum_drift(linear=2.0)[0].scale == 2.0


def test_drift_of_a_line_and_an_oscillation() -> None:
    times = np.linspace(0.0, 100.0, 10_001)
    found = drift(times, 7.0 + 4.0 * (0.01 * times + 0.5 * np.sin(2 * math.pi * times)), 4.0)
    assert found.slope == pytest.approx(0.01, rel=1e-2)
    assert found.oscillation == pytest.approx(0.5, rel=0.05)
    assert found.largest == pytest.approx(1.4925, rel=1e-3)


def test_speeds_that_are_no_rates() -> None:
    """A spinning body moves the same with angle rates as with its angular velocity as speeds."""
    x, rates, omega = [0.2, 0.3, -0.1, 0, 0, 0], [0.5, -0.4, 0.3, 0, 0, 0], np.zeros(6)
    omega[:3] = rate_matrix(x) @ rates[:3]
    plain = simulate(spinner(), x, rates, [0.0, 1.0, 2.0], step=0.01)
    other = simulate(spinner("angular_velocity"), x, omega, [0.0, 1.0, 2.0], step=0.01)
    assert np.abs(plain.x - other.x).max() < 1e-8
    assert np.abs(rate_matrix(plain.x[-1]) @ plain.y[-1, :3] - other.y[-1, :3]).max() < 1e-8
    coarse = simulate(spinner("angular_velocity"), x, omega, [0.0, 2.0], "semi_implicit_euler", step=1e-3)
    assert np.abs(plain.x[-1] - coarse.x[-1]).max() < 1e-2
    with pytest.raises(kg.OptionError, match="'leapfrog' is for speeds that are rates"):
        simulate(spinner("angular_velocity"), x, omega, [0.0, 1.0], "leapfrog", step=0.1)
    with pytest.raises(kg.OptionError, match="built without the output 'coordinate_rates'"):
        simulate(spinner("angular_velocity", OUTPUTS), x, omega, [0.0, 1.0], step=0.1)
    with pytest.raises(kg.SingularError, match=r"^at t = 0 s: coordinate_rates: .* in this state\.$"):
        simulate(spinner("angular_velocity", sequence="3-1-3"), np.zeros(6), omega, [0.0, 1.0], step=0.1)


def rate_matrix(x: Sequence[float]) -> np.ndarray:
    """Return (3, 3) [P] of 1-2-3 angles, Eq. (8): from their rates to the angular velocity."""
    (s2, c2), (s3, c3) = ((math.sin(angle), math.cos(angle)) for angle in x[1:3])
    return np.array([[c2 * c3, s3, 0.0], [-c2 * s3, c3, 0.0], [s2, 0.0, 1.0]])


def test_mescd() -> None:
    assert mescd([1.0 + 2e-6, 1e3], [1.0, 1e3]) == pytest.approx(6.0)
    assert mescd([1.0, 2e-6], [1.0, 1e-6], floor=0.0) == pytest.approx(0.0)
    assert mescd([1.0], [1.0]) == math.inf
    assert math.isnan(mescd([math.nan], [1.0]))
    exact = run("DOP853", tolerance=1e-12)
    assert run("RK4", step=0.01).mescd(exact) == pytest.approx(6.7, abs=0.3)
    with pytest.raises(kg.ArrayError, match=r"reference: expected shape \(2,\), got \(1,\)"):
        mescd([1.0, 2.0], [1.0])
    with pytest.raises(kg.OptionError, match="floor: -1 is negative"):
        mescd([1.0], [1.0], -1)
    with pytest.raises(kg.OptionError, match="reference: it has other times"):
        exact.mescd(simulate(pendulum(), [0.0], [0.0], [0.0, 1.0], step=0.1))


@pytest.mark.parametrize(
    ("message", "options"),
    [
        (r"unknown method 'RK5'. Known are ", {"method": "RK5"}),
        (r"method 'RK4' needs a positive number of seconds, got None", {}),
        (r"got 0", {"step": 0}),
        (r"step: nan is not finite", {"step": math.nan}),
        (r"step: 1e-300 s makes more than 1e\+15 steps in ", {"step": 1e-300}),
        (r"step: 'fast' is not a number", {"step": "fast"}),
        (r"method 'RK4' has fixed steps: give a step, not a tolerance", {"step": 1.0, "tolerance": 1e-3}),
        (r"method 'DOP853' chooses its steps", {"method": "DOP853", "step": 0.1}),
        (r"method 'Radau' chooses its steps", {"method": "Radau", "compensated": True}),
        (r"tolerance: 1e-16 is not between", {"method": "DOP853", "tolerance": 1e-16}),
        (r"effort: 3 cannot be called", {"step": 0.1, "effort": 3}),
        (r"effort: at t = 0 s it returned float64 of shape \(2,\); expected real numbers of shape \(1,\)",
         {"step": 0.1, "effort": lambda t, x, y: [1.0, 2.0]}),
    ],
)  # fmt: skip
def test_options_that_do_not_fit(message: str, options: dict[str, Any]) -> None:
    with pytest.raises(kg.OptionError, match=message):
        run(**({"method": "RK4"} | options))


def test_libraries_that_do_not_fit() -> None:
    with pytest.raises(kg.OptionError, match="is no system and no library"):
        simulate("pendulum", [0.0], [0.0], TIMES, step=0.1)  # type: ignore[arg-type]
    with pytest.raises(kg.OptionError, match="built without the output 'forward_dynamics'"):
        run("RK4", pendulum(outputs=("mass_matrix",)), step=0.1)
    with pytest.raises(
        kg.OptionError,
        match="computes with doubles, but the arrays of system 'pendulum' are 'float'",
    ):
        run("DOP853", pendulum("float"))
    path = run("RK4", pendulum(outputs=("forward_dynamics",)), step=0.1)
    with pytest.raises(kg.OptionError, match="built without the output 'kinetic_energy'"):
        _ = path.energy_drift


@pytest.mark.parametrize(
    ("message", "x", "y", "times"),
    [
        (r"x: expected shape \(1,\)", [0.0, 1.0], [0.0], TIMES),
        (r"y: expected shape \(1,\)", [0.0], [[0.0]], TIMES),
        (r"y: the first state is not finite", [0.0], [math.nan], TIMES),
        (r"times: expected at least two in one row, got shape \(1,\)", [0.0], [0.0], [0.0]),
        (r"times: they must be finite and increase", [0.0], [0.0], [0.0, 2.0, 1.0]),
        (r"times: they must be finite and increase", [0.0], [0.0], [0.0, math.inf]),
    ],
)
def test_arrays_that_do_not_fit(message: str, x: Any, y: Any, times: Any) -> None:
    with pytest.raises(kg.ArrayError, match=message):
        simulate(pendulum(), x, y, times, step=0.1)


def test_states_that_stop_being_finite_and_other_failures() -> None:
    def runaway(t: float, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return 1e6 * y

    with pytest.raises(kg.StatusError, match=r"at t = .* s: .*smaller step"), np.errstate(all="ignore"):
        simulate(pendulum(), [0.0], [1.0], [0.0, 500.0], step=1.0, effort=runaway)
    with pytest.raises(kg.ArrayError, match="method 'DOP853' takes one state, got 2"):
        simulate(pendulum(), [[0.0], [1.0]], [[0.0], [1.0]], TIMES, "DOP853")
    still = simulate(spinner(), np.zeros(6), np.zeros(6), [0.0, 1.0], step=0.5)
    with pytest.raises(kg.OptionError, match="nothing has moved"):
        _ = still.energy_drift
    with pytest.raises(kg.OptionError, match=r"scale of a drift: 0.0 is not a positive number"):
        still.momentum_drift()


def test_without_scipy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Methods of SciPy say what to install, before anything is built; fixed steps and errors need none."""
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    system = kg.load(MODELS / "double_pendulum.toml")
    with monkeypatch.context() as context:
        context.setattr(libraries, "build", lambda *_, **__: pytest.fail("a library is built"))
        for method in (None, "DOP853", "Radau"):
            message = (
                rf"method '{method or 'DOP853'}' is one of SciPy, which is not installed \(pip install "
                r"'kanegen\[study\]'\). A step or an error in place of it"
            )
            with pytest.raises(kg.KanegenError, match=message):
                kg.simulate(system, None, None, 3.0, method)
    assert run("RK4", step=0.125).evaluations == 320
    promise = simulate(pendulum(), [0.5], [0.0], 1.0, error=1e-6).promise
    assert promise is not None and promise.is_kept


def test_representation() -> None:
    assert repr(run("RK4", step=0.25)) == "<Trajectory of pendulum: 41 times from 0 to 10 s, 160 evaluations>"


def test_contacts_do_not_hold_and_the_user_is_told() -> None:
    system = kg.load(MODELS / "double_pendulum.toml").with_points({"tip": ("lower", (0.7, 0.0, 0.0))})
    held = system.with_contacts(kg.Contact(point="tip", directions=("force1",)))
    with pytest.warns(kg.KanegenWarning, match="is one without its contacts .*: they hold in"):
        kg.simulate(kg.build(held, ("forward_dynamics",), flags="-O0"), None, None, 0.1, step=0.05)


@pytest.mark.parametrize("name", ["implicit midpoint", "implicit-midpoint", "Implicit_Midpoint"])
def test_signs_and_capitals_of_names_of_methods_make_no_difference(name: str) -> None:
    assert chosen_method(name, 0.1, None).name == "implicit_midpoint"
    assert kg.RolloutJob(1.0, 0.1, method=name).method == "implicit_midpoint"
    with pytest.raises(kg.OptionError, match=r"unknown method 'implicit2'"):
        chosen_method("implicit2", 0.1, None)
