"""Errors that are asked for: against elliptic functions, growth that is known, and where they are refused."""

from __future__ import annotations

import functools
import json
import math
import warnings
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import kanegen as kg
from kanegen.simulation import choice
from kanegen.simulation.growth import growth_of
from tests.support.command import kanegen
from tests.support.moving_pendulum import GRAVITY, pendulum
from tests.support.oscillator import oscillator
from tests.support.paths import MODELS

UPRIGHT = math.pi / 2


@functools.cache
def system() -> kg.System:
    found = pendulum().source.system
    assert found is not None
    return found


def exact(times: np.ndarray) -> np.ndarray:
    """Return theta3 of the pendulum that starts level and at rest."""
    quarter = ellipk(0.5)
    phi = 2 * np.arcsin(math.sqrt(0.5) * ellipj(math.sqrt(GRAVITY) * times + quarter, 0.5)[0])
    return np.asarray(phi - math.pi / 2)


@pytest.mark.parametrize(
    ("is_library", "asked"),
    [
        (False, 1e-9),
        (True, 1e-3),
        pytest.param(False, 1e-3, marks=pytest.mark.slow),
        pytest.param(True, 1e-9, marks=pytest.mark.slow),
    ],
)
def test_the_error_is_kept_and_measured(asked: float, is_library: bool) -> None:
    """The library has no rollouts, so that SciPy's method is the cheaper one there."""
    motion = kg.simulate(pendulum() if is_library else system(), {}, None, 10.0, error=asked)
    promise = motion.promise
    assert promise is not None and promise.is_kept
    assert motion.method.startswith("DOP853" if is_library else "RK4")
    true = np.abs(motion.x[:, 0] - exact(motion.times)).max()
    assert true < asked
    assert true > asked * 1e-4  # it is not bought by needless work
    assert promise.error < asked
    assert promise.error > 0.5 * true
    assert not promise.growth.is_chaotic
    assert promise.next_digit == pytest.approx(10 ** (1 / (8 if is_library else 4)))
    assert f"asked for {asked:g}" in str(promise)


@pytest.mark.parametrize("scipy", [True, False])
def test_what_depends_on_the_state_is_measured_by_another_method(
    scipy: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A mass that an input pulls back as a spring does: x = cos t."""
    monkeypatch.setattr(choice, "is_installed", lambda name: scipy)
    library = kg.build(oscillator(0.0), ("forward_dynamics",))
    inputs = {"slider.s1": "-x.slider.s1"}
    motion = kg.simulate(library, [1.0], [0.0], 12.0, error=1e-7, inputs=inputs)
    promise = motion.promise
    assert promise is not None and promise.is_kept
    assert motion.method.startswith("DOP853" if scipy else "RK4")
    assert promise.measured_by.startswith("LSODA" if scipy else "extrapolation, step 0.0")
    true = max(
        np.abs(motion.x[:, 0] - np.cos(motion.times)).max(),
        np.abs(motion.y[:, 0] + np.sin(motion.times)).max(),
    )
    assert promise.error == pytest.approx(true, abs=0.1 * promise.asked)


def test_what_acts_at_known_times_runs_in_c_and_is_measured_by_scipy() -> None:
    """x'' = sin t from rest: x = t - sin t, y = 1 - cos t."""
    motion = kg.simulate(oscillator(0.0), None, None, 12.0, error=1e-7, inputs={"slider.s1": "sin(t)"})
    promise = motion.promise
    assert promise is not None and promise.is_kept
    assert motion.method == "RK4, step 0.06 s, compensated" and promise.measured_by.startswith("DOP853")
    exact = np.stack([motion.times - np.sin(motion.times), 1 - np.cos(motion.times)])
    found = np.stack([motion.x[:, 0], motion.y[:, 0]])
    true = (np.abs(found - exact).max(axis=1) / exact.max(axis=1)).max()
    assert promise.error == pytest.approx(true, rel=0.1)


def test_an_error_that_only_a_higher_precision_keeps_chooses_it() -> None:
    """Near the upright position differences grow by e^(sqrt(g) t): in 8 s by 4e10, in double to 4e-6."""
    motion = kg.simulate(system(), {"body1.theta3": UPRIGHT + 1e-11}, None, 8.0, error=1e-7)
    promise = motion.promise
    assert promise is not None and promise.is_kept
    assert promise.precision == "long double"
    assert motion.x.dtype == np.longdouble
    # differences of angle and of speed grow, by about cosh(sqrt(g) t) and a few times that
    assert promise.growth.rate == pytest.approx(math.sqrt(GRAVITY), rel=0.05)
    assert 0.3 < promise.growth.factors[-1] / math.cosh(math.sqrt(GRAVITY) * 8) < 10


@pytest.mark.slow
def test_a_chaotic_motion_is_refused_where_rounding_decides() -> None:
    double = kg.load(MODELS / "double_pendulum.toml")
    with pytest.warns(kg.KanegenWarning, match="cannot be promised after t = .* the motion is chaotic"):
        motion = kg.simulate(double, {"q1": 2.5, "q2": 1.0}, None, 25.0, error=1e-6)
    promise = motion.promise
    assert promise is not None and not promise.is_kept
    assert motion.times[-1] == 25.0
    assert 6.0 < promise.kept_until < 20.0
    assert promise.growth.is_chaotic
    assert "rounding allows 1e-06 until about" in str(promise)
    times = motion.times[motion.times <= promise.kept_until]
    other = kg.simulate(double, {"q1": 2.5, "q2": 1.0}, None, times, step=2e-5, compensated=True)
    sizes = np.abs(other.y).max()
    assert np.abs(other.x - motion.x[: len(times)]).max() < 2e-6
    assert np.abs(other.y - motion.y[: len(times)]).max() < 2e-6 * sizes


def test_many_states_with_a_loose_error_are_single() -> None:
    x = np.linspace(-1.5, 0.5, 16)[:, None]
    motion = kg.simulate(system(), x, np.zeros((16, 1)), 3.0, error=1e-3)
    assert motion.promise is not None and motion.promise.is_kept
    assert motion.promise.precision == "float"
    assert motion.x.dtype == np.float32
    exactly = kg.simulate(system(), x, np.zeros((16, 1)), 3.0, step=1e-3)
    assert np.abs(motion.x - exactly.x).max() < 1e-3


def test_growth_of_powers_and_of_exponentials() -> None:
    times = np.linspace(0.0, 20.0, 201)
    power = growth_of(times, 1e-9 * (1 + times) ** 2, 1e-9)
    assert power.rate == 0.0 and power.horizon(1e-16, 1e-6) == math.inf
    assert power.kept_until(1e-9, 1e-9 * 36.1) == pytest.approx(5.0)
    grown = growth_of(times, np.minimum(1e-9 * np.exp(1.5 * times), 1.0), 1e-9)
    assert grown.rate == pytest.approx(1.5, rel=1e-6)
    assert grown.factors[-1] == pytest.approx(math.exp(30.0), rel=1e-3)  # beyond saturation by the rate
    assert grown.kept_until(1e-16, 1e-6) == pytest.approx(math.log(1e10) / 1.5, abs=0.1)
    assert grown.horizon(1e-20, 1e-6) == pytest.approx(math.log(1e14) / 1.5, rel=1e-3)


@pytest.mark.slow
def test_stiff_motions_take_an_implicit_method() -> None:
    """A damper of 1 ms on a slow spring: steps of an explicit method stay below it, whatever the error."""
    along = (False, False, False, True, False, False)
    body = kg.Body("block", 0, 1.0, np.eye(3), joint=kg.Joint(free=along))
    spring = kg.JointSpring("block.s1", stiffness=1000.0, damping=1000.0)
    library = kg.build(kg.System("damped", (body,), force_elements=(spring,)), ("forward_dynamics",))
    motion = kg.simulate(library, [1.0], [0.0], 4.0, error=1e-4)
    assert motion.method.startswith("Radau")
    assert motion.promise is not None and motion.promise.is_kept
    slow, fast = 500 - math.sqrt(500.0**2 - 1000), 500 + math.sqrt(500.0**2 - 1000)
    expected = fast / (fast - slow) * np.exp(-slow * motion.times[1:])
    assert motion.x[1:, 0] == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"error": 1e-6, "step": 0.1}, "error: it chooses method, step and precision"),
        ({"error": 1e-6, "method": "RK4"}, "Leave the others out, or the error"),
        ({"error": 0.0}, "error: 0.0 is not between 1e-15 and 0.1"),
        ({"error": math.nan}, "error: nan is not between"),
        ({"error": "small"}, "error: 'small' is not between"),
    ],
)
def test_what_is_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(kg.OptionError) as error:
        kg.simulate(pendulum(), [0.0], [0.0], 1.0, **options)
    assert message in str(error.value)


@pytest.mark.slow
def test_the_command_refuses_by_its_status() -> None:
    arguments = ["--duration", "25", "--x", "q1=2.5", "--x", "q2=1", "--error", "1e-6", "--json"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        refused = kanegen("simulate", str(MODELS / "double_pendulum.toml"), *arguments, status=1)
    promise = json.loads(refused.stdout)["promise"]
    assert not promise["is_kept"]
    assert "error: 1e-06 cannot be promised after t = " in refused.stderr
