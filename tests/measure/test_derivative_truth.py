"""Certified derivatives: two algorithms, complex steps through the reference, and a proven remainder."""

from __future__ import annotations

import numpy as np
import pytest

import kanegen as kg
from kanegen.measure import truth
from kanegen.measure.truth import certified_derivatives as module
from kanegen.measure.truth.balls import arb
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states
from tests.support import systems
from tests.support.cases import slow_except

STEP = 1e-30


def turning(seed: int) -> kg.System:
    """Return a small random tree with loads, a joint with three angles and one that translates."""
    free = np.array([[True] * 4 + [False, True], [False, True, False, False, False, True]])
    return systems.random_system(np.random.default_rng(seed), 2, connection=(0, 1), free=free, loads=True)


def by_complex_steps(system: kg.System, output: str, given: dict[str, np.ndarray]) -> np.ndarray:
    """Return derivatives by complex steps through the reference, in double precision."""

    def value(x: np.ndarray, y: np.ndarray, tau: np.ndarray) -> np.ndarray:
        matrix = reference.mass_matrix(system, x)
        forcing = reference.forcing(system, x, y, given["force"], given["torque"])
        if output == "forcing":
            return forcing
        if output == "inverse_dynamics":
            return matrix @ given["ydot"] - forcing
        return np.linalg.solve(matrix, forcing + tau)

    columns = []
    for name in ("x", "y", "tau")[: 3 if output == "forward_dynamics" else 2]:
        for k in range(len(given[name])):
            moved = {key: given[key].astype(complex) for key in ("x", "y", "tau")}
            moved[name][k] += 1j * STEP
            columns.append(value(**moved).imag / STEP)
    return np.stack(columns, axis=1)


def state(system: kg.System, seed: int) -> dict[str, np.ndarray]:
    found = random_states(system, 1, seed)
    assert found.force is not None and found.torque is not None
    tau, ydot = np.random.default_rng(seed).normal(size=(2, len(system.freedoms)))
    arrays = {"x": found.x[0], "y": found.y[0], "tau": tau, "ydot": ydot}
    return arrays | {"force": found.force[0], "torque": found.torque[0]}


@pytest.mark.parametrize("speeds", ["angle_rates", "angular_velocity"])
@pytest.mark.parametrize("output", ["forcing", "inverse_dynamics", "forward_dynamics"])
@pytest.mark.parametrize("seed", slow_except(range(4), 0))
def test_derivatives_agree_with_complex_steps(seed: int, output: str, speeds: str) -> None:
    system = turning(seed).with_speeds(speeds)
    given = state(system, seed)
    right = by_complex_steps(system, output, given)
    found = truth.derivatives(system, output=output, **given)
    assert found.shape == right.shape
    assert found.radius.max() < 1e-20 * np.abs(right).max()
    assert np.abs(found.value - right).max() <= 1e-11 * np.abs(right).max()


@pytest.mark.parametrize("step", [2.0**-4, 2.0**-10])
def test_the_remainder_holds_for_large_steps(step: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """With steps whose truncation error is seen, the enclosures still contain the exact derivatives."""
    system = turning(1)
    given = state(system, 1)
    exact = truth.derivatives(system, output="inverse_dynamics", **given)
    monkeypatch.setattr(module, "step_size", lambda: arb(step))
    monkeypatch.setattr(module, "WIDTH", 1e300)
    wide = truth.derivatives(system, output="inverse_dynamics", **given)
    middles = np.array([float(ball.mid()) for ball in wide.balls]).reshape(wide.shape)
    assert np.abs(middles - exact.value).max() > 1e-9 * np.abs(exact.value).max()
    assert wide.overlaps(exact)


def test_what_has_no_exact_derivatives_is_refused() -> None:
    system = turning(1)
    given = state(system, 1)
    with pytest.raises(kg.OptionError, match="quaternions"):
        truth.derivatives(system.with_coordinates("quaternion"), given["x"], given["y"])
    with pytest.raises(kg.OptionError, match="Did you mean 'forcing'"):
        truth.derivatives(system, given["x"], given["y"], output="forcin")
