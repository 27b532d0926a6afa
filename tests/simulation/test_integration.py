"""Steps against closed forms: matrices of a linear oscillator, exact sums, and turns about a fixed axis."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kanegen as kg
from kanegen.library.native.status import NO_CONVERGENCE, TOO_LONG
from kanegen.simulation import simulate
from kanegen.simulation.integration import CompensatedSum, Sum
from kanegen.simulation.methods import FIXED
from tests.support.oscillator import oscillator
from tests.support.paths import MODELS

STIFFNESS = 6.0
MATRIX = np.array([[0.0, 1.0], [-STIFFNESS, 0.0]])
"""Rates of (x, y) of 1 kg on a spring, from (x, y)."""

ORDERS = {"RK4": 4, "semi_implicit_euler": 1, "leapfrog": 2, "implicit_midpoint": 2, "extrapolation": 8}


@functools.cache
def slider() -> kg.Library:
    """Return 1 kg on a spring along axis 1."""
    body = kg.Body(
        "slider", 0, 1.0, np.eye(3), joint=kg.Joint(free=(False, False, False, True, False, False))
    )
    spring = kg.JointSpring("slider.s1", stiffness=STIFFNESS)
    return kg.build(
        kg.System("slider", (body,), gravity=(0, 0, 0), force_elements=(spring,)), "forward_dynamics"
    )


def step_matrix(method: str, h: float) -> np.ndarray:
    """Return the matrix that takes (x, y) of the oscillator to the next step, as textbooks have it."""
    one, k = np.eye(2), STIFFNESS
    if method == "RK4":
        return sum((np.linalg.matrix_power(h * MATRIX, j) / math.factorial(j) for j in range(1, 5)), one)
    if method == "semi_implicit_euler":
        return np.array([[1 - h * h * k, h], [-h * k, 1.0]])
    if method == "leapfrog":
        half = 1 - h * h * k / 2
        return np.array([[half, h], [-h * k * (1 - h * h * k / 4), half]])
    if method == "extrapolation":
        return extrapolated(h)
    return np.asarray(np.linalg.solve(one - h / 2 * MATRIX, one + h / 2 * MATRIX))


def extrapolated(h: float) -> np.ndarray:
    """Return the matrix of the midpoint rule in 2, 4, 6 and 8 parts, and the polynomial in h^2 at 0."""
    counts, found = (2, 4, 6, 8), np.zeros((2, 2))
    for count in counts:
        part = h / count * MATRIX
        before, now = np.eye(2), np.eye(2) + part
        for _ in range(count - 1):
            before, now = now, before + 2 * part @ now
        found += now * math.prod(count**2 / (count**2 - other**2) for other in counts if other != count)
    return found


@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize("method", FIXED)
def test_an_oscillator_moves_as_the_matrix_of_the_method_says(method: str, compensated: bool) -> None:
    times, start = np.array([0.0, 1.0, 3.5]), np.array([0.4, -0.3])
    path = simulate(slider(), start[:1], start[1:], times, method, step=0.05, compensated=compensated)
    for i, steps in ((1, 20), (2, 70)):
        expected = np.linalg.matrix_power(step_matrix(method, 0.05), steps) @ start
        found = np.array([path.x[i, 0], path.y[i, 0]])
        assert np.abs(found - expected).max() < 70 * 2 * np.finfo(float).eps  # two roundings a step


@functools.cache
def driven_exactly() -> np.ndarray:
    """Return x, y and the work of the effort after 2 s, by SciPy and the equation written by hand."""

    def rates(t: float, state: np.ndarray) -> list[float]:
        x, y, _ = state
        return [y, -STIFFNESS * x + effort(t, y), effort(t, y) * y]

    found = solve_ivp(rates, (0.0, 2.0), [0.4, 0.2, 0.0], "DOP853", rtol=1e-13, atol=1e-13)
    return np.asarray(found.y[:, -1])


def effort(t: float, y: float) -> float:
    return 3 * math.sin(3 * t + 1) - 0.5 * y


@pytest.mark.parametrize("method", FIXED)
def test_motion_and_work_have_the_order_of_the_method(method: str) -> None:
    """An effort that depends on the time and on the speed; work is integrated with the same order."""

    def errors(step: float) -> np.ndarray:
        path = simulate(
            slider(), [0.4], [0.2], [0.0, 2.0], method, step=step, effort=lambda t, x, y: [effort(t, y[0])]
        )
        x, y, work = np.array([path.x[-1, 0], path.y[-1, 0], path.work[-1]]) - driven_exactly()
        return np.array([math.hypot(x, y), abs(work)])

    longest = 0.1 if method == "extrapolation" else 0.02  # whose errors are far above rounding
    orders = np.log2(errors(longest) / errors(longest / 2))
    assert np.abs(orders - ORDERS[method]).max() < 0.35, orders


@pytest.mark.parametrize(
    ("number", "step", "steps"), [(0.3, 0.1, 3), (0.1 + 0.2, 0.1, 3), (0.3, 0.0999999, 4)]
)
def test_rounding_of_a_quotient_adds_no_step(number: float, step: float, steps: int) -> None:
    path = simulate(slider(), [0.4], [0.2], [0.0, number], step=step)
    assert path.evaluations == 4 * steps


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_compensated_sums_round_once(dtype: type, size: float) -> None:
    """Against exact sums, where changes are smaller than the sum and where they are larger."""
    rng = np.random.default_rng(7)
    changes = (size * rng.normal(size=(3000, 4)) + size / 3).astype(dtype)
    start = rng.normal(size=4).astype(dtype)
    kept, plain = CompensatedSum(start), Sum(start)
    for change in changes:
        kept.add(change)
        plain.add(change)
    exact = np.array(
        [
            math.fsum([*column, first])
            for column, first in zip(changes.T.tolist(), start.tolist(), strict=True)
        ]
    )
    unit = np.finfo(dtype).eps / 2 * np.abs(exact)
    assert (np.abs(kept.state.astype(float) - exact) <= 2 * unit).all()
    assert np.abs(plain.state.astype(float) - exact).max() > 4 * unit.max()


def turning() -> kg.Library:
    """Return a ball with a quaternion and angular velocities, about a fixed point."""
    body = kg.Body("ball", 0, 1.0, np.eye(3), joint=kg.Joint(free=(True, True, True, False, False, False)))
    ball = kg.System("ball", (body,), gravity=(0, 0, 0)).with_coordinates("quaternion")
    return kg.build(ball, ("forward_dynamics", "coordinate_rates"))


HALF_ANGLES: dict[str, Callable[[float], float]] = {
    "semi_implicit_euler": math.atan,
    "RK4": lambda z: math.atan2(z - z**3 / 6, 1 - z**2 / 2 + z**4 / 24),
    "implicit_midpoint": lambda z: 2 * math.atan(z / 2),
}
"""Half the turn of a quaternion in one step, from half the angle: the argument of the factor 1 + i z + ..."""


@pytest.mark.parametrize("method", HALF_ANGLES)
@pytest.mark.parametrize("compensated", [False, True])
def test_lengths_of_quaternions_stay(method: str, compensated: bool) -> None:
    """A constant turn: 300 steps of 1 rad, with which lengths would change by up to 1e14."""
    omega, e = np.array([2.0, -3.0, 6.0]) / 7, np.array([3.0, 0.0, 0.0, 0.0])
    path = simulate(turning(), e, omega, [0.0, 1.0, 300.0], method, step=1.0, compensated=compensated)
    assert np.abs(np.linalg.norm(path.x, axis=1) / 3 - 1).max() < 4e-16
    for row, steps in ((1, 1), (2, 300)):
        angle = steps * HALF_ANGLES[method](0.5)
        expected = np.array([math.cos(angle), *(math.sin(angle) * omega)])
        assert abs(abs(path.x[row] @ expected) / 3 - 1) < 1e-12
        assert np.abs(path.x[row] / 3 - expected).max() < 1e-11  # 300 steps of a few roundings


def test_adaptive_methods_keep_lengths_of_quaternions() -> None:
    omega = np.array([2.0, -3.0, 6.0]) / 7
    path = simulate(turning(), [2.0, 0.0, 0.0, 0.0], omega, [0.0, 50.0], "Radau", tolerance=1e-4)
    assert np.abs(np.linalg.norm(path.x, axis=1) / 2 - 1).max() < 4e-16


def test_energies_of_long_motions() -> None:
    """[A] depends on x: only the implicit midpoint method does not drift, as its documentation says."""
    outputs = ("forward_dynamics", "kinetic_energy", "potential_energy")
    library = kg.build(kg.load(MODELS / "double_pendulum.toml"), outputs)
    last = {}
    for method in ("implicit_midpoint", "leapfrog", "semi_implicit_euler"):
        path = simulate(library, [2.5, 1.0], [0.0, 0.0], np.linspace(0, 20, 201), method, step=0.01)
        energy = path.kinetic_energy + path.potential_energy
        last[method] = abs(float((energy[-100:] - energy[0]).mean()))
    assert last["implicit_midpoint"] < 0.02
    assert last["leapfrog"] > 10 * last["implicit_midpoint"]
    assert last["semi_implicit_euler"] > 3 * last["leapfrog"]


def test_steps_too_large_for_implicit_methods_are_refused() -> None:
    """A step of the first method is found again in NumPy, one of the second in C; both say the same."""
    methods = "implicit_midpoint", "variational_midpoint"
    library = kg.build(oscillator(), ("forward_dynamics", *(f"rollout_{method}" for method in methods)))
    messages = set()
    for method in methods:
        with pytest.raises(kg.StatusError) as found:
            simulate(library, [0.4], [0.2], [0.0, 10.0], method, step=2.5)
        messages.add(str(found.value))
    assert messages == {f"at t = 0 s: {NO_CONVERGENCE}: {TOO_LONG}"}


def test_energy_of_a_turning_body_is_kept_by_the_implicit_midpoint() -> None:
    """Energy is quadratic in angular velocities; in 500 steps only roundings change it."""
    body = kg.Body("body", 0, 1.0, np.diag([1.0, 2.0, 2.5]))
    system = kg.System("body", (body,), gravity=(0, 0, 0)).with_coordinates("quaternion")
    library = kg.build(system, ("forward_dynamics", "coordinate_rates", "kinetic_energy", "potential_energy"))
    x = np.zeros(7)
    x[library.coordinate_names.index("body.e0")] = 1.0
    path = simulate(library, x, [1, 2, 3, 0, 0, 0], np.linspace(0, 25, 11), "implicit_midpoint", step=0.05)
    assert path.energy_drift.largest < 1e-13
