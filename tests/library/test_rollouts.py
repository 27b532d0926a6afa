"""Steps and rollouts in C: orders, equality of all their forms, inputs over time, invariants, and reports."""

from __future__ import annotations

import warnings
from functools import cache

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import ArrayError, KanegenWarning, OptionError, StatusError
from kanegen.recursion.outputs import METHODS
from kanegen.reference.states import random_states
from tests.support.oscillator import oscillator
from tests.support.paths import MODELS
from tests.support.random_trees import everything

IN_PYTHON = ("rk4", "semi_implicit_euler", "implicit_midpoint")
"""Methods that `kg.simulate` has, too, written in NumPy."""

IN_RATES = [name for name in METHODS if METHODS[name].needs_further is not None]


@cache
def library(name: str, *outputs: str, **options: object) -> kg.Library:
    """Return a compiled model of the repository with all methods that it has, or with some outputs."""
    system = kg.load(MODELS / f"{name}.toml")
    methods = METHODS if system.speeds_are_rates else IN_RATES
    every = [function for method in methods for function in METHODS[method].functions]
    return kg.build(system, outputs or every, on_status="raise", **options)


def states(compiled: kg.Library, count: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    x = 0.3 * rng.normal(size=(count, len(compiled.coordinate_names)))
    return x, rng.normal(size=(count, compiled.n))


def unit(compiled: kg.Library, x: np.ndarray) -> np.ndarray:
    """Return coordinates whose quaternions have length 1."""
    x = np.array(x)
    for places in compiled.source.model.homogeneous:
        x[..., list(places)] /= np.linalg.norm(x[..., list(places)], axis=-1, keepdims=True)
    return x


@pytest.mark.parametrize("name", ["double_pendulum", "satellite"])
def test_orders_by_halving_the_step(name: str) -> None:
    """The errors against DOP853, which shares no code with the C, fall as the orders promise."""
    compiled = library(name)
    x, y = states(compiled, 1)
    exact = kg.simulate(compiled, x[0], y[0], [0.0, 1.0], method="DOP853", tolerance=1e-13)
    for method in compiled.methods:
        errors = []
        for steps in (50, 100, 200):
            found = compiled.rollout(x[0], y[0], steps=steps, step=1.0 / steps, every=steps, method=method)
            change = unit(compiled, found.x[-1]) - unit(compiled, exact.x[-1]), found.y[-1] - exact.y[-1]
            errors.append(max(np.abs(one).max() for one in change))
        orders = np.log2(np.array(errors[:-1]) / errors[1:])
        # The order shows up to terms of the next order, about step times the rates, here up to a few tenths.
        assert orders == pytest.approx(METHODS[method].order, abs=0.15), method


@pytest.mark.parametrize(
    ("name", "precision"),
    [
        ("double_pendulum", "double"),
        ("double_pendulum", "float"),
        ("satellite", "double"),
        pytest.param("satellite", "float", marks=pytest.mark.slow),
    ],
)
def test_batches_single_rollouts_and_steps_have_the_same_bits(name: str, precision: str) -> None:
    compiled = library(name, precision=precision)
    count, steps = 11, 7
    x, y = states(compiled, count)
    tau = np.random.default_rng(2).normal(size=(count, steps, compiled.n))
    for method in compiled.methods:
        batch = compiled.rollout(x, y, tau, steps=steps, step=0.01, every=2, method=method)
        assert batch.x.shape == (count, 4, x.shape[1]) and batch.x.dtype == np.dtype(
            {"double": np.float64, "float": np.float32}[precision]
        )
        for b in (0, 5, count - 1):
            one = compiled.rollout(x[b], y[b], tau[b], steps=steps, step=0.01, every=2, method=method)
            assert np.array_equal(one.x, batch.x[b]) and np.array_equal(one.y, batch.y[b]), method
        before = (x.astype(batch.x.dtype), y.astype(batch.x.dtype))
        for s in range(6):
            before = compiled.step(*before, tau[:, s], step=0.01, method=method)
            if s % 2:
                assert np.array_equal(before[0], batch.x[:, s // 2 + 1]), method
                assert np.array_equal(before[1], batch.y[:, s // 2 + 1]), method


@pytest.mark.parametrize("name", ["double_pendulum", "satellite"])
@pytest.mark.parametrize("method", IN_PYTHON)
def test_the_same_formulas_in_numpy(name: str, method: str) -> None:
    """Additions in another order, and lengths of quaternions, change a few units of roundoff a step."""
    compiled = library(name)
    x, y = states(compiled, 3)
    found = compiled.rollout(x, y, steps=40, step=0.005, every=40, method=method)
    python = kg.simulate(compiled, x, y, [0.0, 0.2], method=method, step=0.005)
    assert unit(compiled, found.x[:, -1]) == pytest.approx(unit(compiled, python.x[-1]), rel=1e-13, abs=1e-13)
    assert found.y[:, -1] == pytest.approx(python.y[-1], rel=1e-13, abs=1e-13)


def test_trees_of_every_kind() -> None:
    """Quaternions, couplings, force elements and the time: batches, single states and NumPy agree."""
    system = everything(5).with_contacts([])
    if system.prescribed:
        system = system.with_prescribed([])
    compiled = kg.build(system, ("rollout_rk4",), on_status="ignore")
    sample = random_states(system, 5, 0)
    inputs = {"t": 0.2} if "t" in compiled.further_inputs else {}
    found = compiled.rollout(sample.x, sample.y, steps=8, step=1e-4, **inputs)
    for b in range(5):
        one = compiled.rollout(sample.x[b], sample.y[b], steps=8, step=1e-4, **inputs)
        assert np.array_equal(one.x, found.x[b]) and np.array_equal(one.y, found.y[b])
    python = kg.simulate(
        compiled, sample.x, sample.y, [inputs.get("t", 0.0), inputs.get("t", 0.0) + 8e-4], step=1e-4
    )
    size = np.abs(python.y[-1]).max(axis=-1, keepdims=True)
    assert np.abs(found.y[:, -1] - python.y[-1]) / size == pytest.approx(0.0, abs=1e-12)


def test_inputs_over_time() -> None:
    """Rows that are constant over steps, on lines, and at start, middle and end, against functions of t."""
    compiled = library("cart_pole", "rollout_rk4")
    x, y = np.array([0.1, 0.3]), np.array([0.0, 0.5])
    steps, step = 20, 0.02
    ends = np.linspace(0.0, steps * step, steps + 1)
    halves = np.linspace(0.0, steps * step, 2 * steps + 1)

    def smooth(time: float) -> np.ndarray:
        return np.array([np.sin(3 * time), 0.2 * np.cos(5 * time)])

    rows = np.array([smooth(time) for time in ends])
    lines = kg.simulate(
        compiled,
        x,
        y,
        ends,
        step=step,
        effort=lambda t, *_: np.array([np.interp(t, ends, rows[:, 0]), np.interp(t, ends, rows[:, 1])]),
    )
    found = compiled.rollout(x, y, rows, steps=steps, step=step, hold="linear")
    assert found.y == pytest.approx(lines.y, rel=1e-12, abs=1e-13)
    exact = kg.simulate(compiled, x, y, ends, step=step, effort=lambda t, *_: smooth(t))
    found = compiled.rollout(
        x, y, np.array([smooth(time) for time in halves]), steps=steps, step=step, hold="quadratic"
    )
    assert found.times == pytest.approx(ends)
    assert found.y == pytest.approx(exact.y, rel=1e-12, abs=1e-13)
    stairs = compiled.rollout(x, y, rows[:-1], steps=steps, step=step)
    before = x, y
    for s in range(steps):
        before = kg.simulate(compiled, *before, [0.0, step], step=step, effort=lambda *_, s=s: rows[s])
        before = before.x[-1], before.y[-1]
    assert stairs.y[-1] == pytest.approx(before[1], rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("method", ["rk4", "implicit_midpoint"])
def test_prescribed_motion_has_rows_within_steps(method: str) -> None:
    """A car on a road that rises and falls, against the same method in NumPy with the road as a function."""
    compiled = library("quarter_car", "rollout_rk4", "rollout_implicit_midpoint")

    def road(time: float) -> np.ndarray:
        return 0.05 * np.array([[np.sin(9 * time)], [9 * np.cos(9 * time)], [-81 * np.sin(9 * time)]])

    steps, step = 30, 0.005
    rows = np.array([road(time) for time in np.linspace(0.0, steps * step, 2 * steps + 1)])
    x, y = 0.02 * np.ones((2, 2, compiled.n))
    found = compiled.rollout(x, y, prescribed=rows, steps=steps, step=step, method=method, hold="quadratic")
    times = np.linspace(0.0, steps * step, steps + 1)
    python = kg.simulate(compiled, x, y, times, prescribed=road, method=method, step=step)
    assert found.y.swapaxes(0, 1) == pytest.approx(python.y, rel=1e-11, abs=1e-12)
    still = compiled.rollout(x, y, prescribed=np.zeros((3, 1)), steps=2, step=step, method=method)
    assert np.isfinite(still.y).all()
    with pytest.raises(ArrayError, match='Give hold="quadratic"'):
        compiled.rollout(x, y, prescribed=rows[:steps], steps=steps, step=step, method=method)
    with pytest.raises(ArrayError, match="prescribed: missing, but the result depends on this input"):
        compiled.rollout(x, y, steps=steps, step=step, method=method)


def test_shapes_of_inputs_in_a_batch() -> None:
    compiled = library("cart_pole", "rollout_rk4")
    x, y = states(compiled, 3)
    rows = np.random.default_rng(4).normal(size=(3, 5, 2))
    whole = compiled.rollout(x, y, rows, steps=5, step=0.01).y
    same = compiled.rollout(x, y, rows[0], steps=5, step=0.01).y
    assert np.array_equal(same[0], whole[0])
    constant = compiled.rollout(x, y, rows[:, 0], steps=5, step=0.01).y
    assert np.array_equal(constant, compiled.rollout(x, y, rows[:, :1], steps=5, step=0.01).y)
    common = compiled.rollout(x, y, rows[0, 0], steps=5, step=0.01).y
    assert np.array_equal(common[0], constant[0])
    force = np.zeros((5, 2, 3))
    force[:, 0] = rows[0, :, :1]
    pushed = compiled.rollout(x, y, force=force, steps=5, step=0.01).y
    # The coordinate of the cart, which comes last, is along its axis 1, so a force along it is its effort.
    tau = np.stack([np.zeros(5), rows[0, :, 0]], axis=-1)
    assert pushed == pytest.approx(compiled.rollout(x, y, tau, steps=5, step=0.01).y, rel=1e-13, abs=1e-15)
    with pytest.raises(ArrayError, match=r"may mean a row for each state or one for each step"):
        compiled.rollout(x, y, rows[:, 0], steps=3, step=0.01)
    with pytest.raises(ArrayError, match=r"tau: expected \(2,\) for a constant or \(5, 2\) for zero hold"):
        compiled.rollout(x, y, rows[:, :4], steps=5, step=0.01)
    with pytest.raises(ArrayError, match="takes no loads"):
        compiled.rollout(x, y, force=np.ones((2, 3)), steps=5, step=0.01)


def drift(values: np.ndarray) -> float:
    return float(np.abs(values - values[0]).max() / np.abs(values).max())


def momentum_and_energy(steps: int, method: str) -> tuple[float, float, float]:
    """Return drifts of a cart with a pole: momentum along the rail, energy, and its trend over the motion."""
    compiled = library("cart_pole", "mass_matrix", "kinetic_energy", "potential_energy", f"rollout_{method}")
    found = compiled.rollout([0.0, 2.5], [0.3, 1.0], steps=steps, step=0.02, every=max(1, steps // 1000))
    momentum = np.einsum("tij,tj->ti", compiled.mass_matrix(found.x), found.y)[:, 1]
    energy = compiled.kinetic_energy(found.x, found.y) + compiled.potential_energy(found.x)
    scale = np.ptp(compiled.potential_energy(found.x))
    trend = np.polyfit(found.times / found.times[-1], energy, 1)[0]
    return drift(momentum), float(np.ptp(energy) / scale), float(abs(trend) / scale)


def test_the_variational_rule_keeps_momentum_to_rounding_and_energy_in_bounds() -> None:
    steps = 5_000
    momentum, energy, trend = momentum_and_energy(steps, "variational_midpoint")
    # Each step changes the momentum by roundings alone, which add up like a random walk.
    assert momentum < 50 * np.sqrt(steps) * 2.0**-53
    assert energy < 0.01 and trend < 0.05 * energy
    assert momentum_and_energy(steps, "implicit_midpoint")[0] > 1e6 * momentum
    assert momentum_and_energy(steps, "semi_implicit_euler")[1] > 3 * energy


@pytest.mark.slow
def test_the_energy_of_the_variational_rule_stays_in_bounds_over_a_million_steps() -> None:
    momentum, energy, trend = momentum_and_energy(1_000_000, "variational_midpoint")
    assert momentum < 50 * np.sqrt(1e6) * 2.0**-53
    assert energy < 0.01 and trend < 0.05 * energy


def test_a_stiff_damper_takes_long_steps_of_the_linearly_implicit_method() -> None:
    """A damper with a time of 1e-6 s, in steps of 1e-2 s: the explicit method fails, this one decays."""
    system = kg.load(MODELS / "double_pendulum.toml")
    stiff = system.with_force_elements(kg.JointSpring(system.freedom_names[1], 1e4, damping=1e5))
    compiled = kg.build(stiff, ("rollout_linearly_implicit", "rollout_rk4"), on_status="ignore")
    x, y = np.array([0.4, 0.1]), np.array([0.0, 3.0])
    assert np.isnan(compiled.rollout(x, y, steps=100, step=1e-2, method="rk4").y[-1]).all()
    exact = kg.simulate(compiled, x, y, [0.0, 1.0], method="Radau", tolerance=1e-10)
    errors = [
        np.abs(
            compiled.rollout(x, y, steps=steps, step=1 / steps, every=steps, method="linearly_implicit").x[-1]
            - exact.x[-1]
        ).max()
        for steps in (100, 200, 400)
    ]
    assert errors[0] < 1e-2 and np.log2(errors[0] / errors[2]) > 3.0


ITERATED = ("implicit_midpoint", "variational_midpoint")


@cache
def spring() -> kg.Library:
    """Return 1 kg on a spring of 1 N/m with iterative methods."""
    names = [name for method in ITERATED for name in METHODS[method].functions]
    return kg.build(oscillator(), (*names, "step_implicit_midpoint_derivatives"))


@pytest.mark.parametrize("method", ITERATED)
def test_an_iteration_that_does_not_converge_has_a_status_of_its_own(method: str) -> None:
    """On a spring with frequency w the iteration gains h w/2, or its square, each time: h w < 2 converges."""
    compiled = spring()
    x, y = np.array([0.3]), np.array([0.1])
    compiled.with_on_status("raise").step(x, y, step=1.2, method=method)
    with pytest.raises(StatusError, match=rf"^step_{method}: the iteration for the step does not converge"):
        compiled.step(x, y, step=2.5, method=method)
    with pytest.warns(
        KanegenWarning, match=r"after 0 of 3 steps, at t = 0 s, the iteration for the step does"
    ):
        found = compiled.rollout(x, y, steps=3, step=2.5, method=method)
    assert found.made == 0 and np.isnan(found.x[1:]).all()
    several = np.zeros((9, 1))
    several[4] = 0.3  # at rest everywhere else, where nothing has to converge
    with pytest.warns(
        KanegenWarning, match=r"in 1 of 9 states, first in state 4, after 0 of 3 .* not converge"
    ):
        found = compiled.rollout(several, np.zeros((9, 1)), steps=3, step=2.5, method=method)
    assert found.made.tolist() == [3, 3, 3, 3, 0, 3, 3, 3, 3]
    with pytest.warns(KanegenWarning, match=r"in 1 of 9 states .* in state 4 the iteration for the step"):
        compiled.step(several, np.zeros((9, 1)), step=2.5, method=method)
    with pytest.raises(StatusError, match=r"x\[0\] is nan"):
        compiled.with_on_status("raise").step([np.nan], y, step=2.5, method=method)


def test_newtons_method_converges_on_a_spring_whatever_the_step() -> None:
    """The equations are linear: x and y turn by 2 atan(h w/2)."""
    found = spring().step_derivatives([0.3], [0.1], step=50.0, method="implicit_midpoint")
    angle = 2 * np.arctan(25.0)
    turned = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    assert np.allclose(found.A, turned, rtol=0, atol=1e-13)
    assert np.allclose([found.x[0], found.y[0]], np.dot(turned, [0.3, 0.1]), rtol=0, atol=1e-13)


def test_the_status_of_an_iteration_is_declared_where_a_method_has_one() -> None:
    source = spring().source
    assert f"SLIDER_NOT_CONVERGED = {source.model.not_converged}" in source.files["slider.h"].replace(
        "  ", ""
    )
    assert "NOT_CONVERGED" not in library("double_pendulum", "rollout_rk4").source.files["double_pendulum.h"]


def test_compensated_sums_keep_more_digits() -> None:
    rough = library("double_pendulum", "rollout_rk4", precision="float")
    exact = library("double_pendulum", "rollout_rk4").rollout(
        [0.5, 0.2], [0.0, 0.0], steps=4000, step=2.0**-11
    )
    plain, kept = (
        rough.rollout([0.5, 0.2], [0.0, 0.0], steps=4000, step=2.0**-11, compensated=compensated)
        for compensated in (False, True)
    )
    errors = [np.abs(one.x - exact.x).max() for one in (plain, kept)]
    assert errors[1] < 0.2 * errors[0]
    batch = rough.rollout(
        np.tile([0.5, 0.2], (3, 1)), np.zeros((3, 2)), steps=4000, step=2.0**-11, compensated=True
    )
    assert np.array_equal(batch.x[1], kept.x)
    fast = library("double_pendulum", "rollout_rk4", tier=kg.Variant(semantics=("associative",)))
    with pytest.raises(OptionError, match="may reorder sums"):
        fast.rollout([0.5, 0.2], [0.0, 0.0], steps=1, step=0.1, compensated=True)


def test_parameters_that_differ_from_state_to_state() -> None:
    compiled = library("double_pendulum", "rollout_rk4", parameters_by_state=True)
    x, y = states(compiled, 6)
    masses = np.linspace(0.5, 2.0, 6)
    found = compiled.rollout(x, y, steps=10, step=0.01, parameters={"m2": masses})
    for b in range(6):
        one = compiled.with_parameters({"m2": masses[b]}).rollout(x[b], y[b], steps=10, step=0.01)
        assert np.array_equal(one.y, found.y[b])


def test_states_that_end_are_reported_with_their_step() -> None:
    compiled = library("double_pendulum", "rollout_euler").with_on_status("warn")
    x, y = np.array([[0.1, 0.2], [0.1, 0.2], [0.1, 0.2]]), np.array([[0.0, 0.0], [1e154, -1e154], [0.0, 0.0]])
    with pytest.warns(
        KanegenWarning, match=r"rollout_euler: in 1 of 3 states, first in state 1, after \d+ of"
    ):
        found = compiled.rollout(x, y, steps=9, step=0.1)
    made = int(found.made[1])
    assert made < 9 and found.made[0] == found.made[2] == 9
    assert np.isfinite(found.x[1, : made + 1]).all() and np.isnan(found.x[1, made + 1 :]).all()
    assert np.isnan(found.y[1, made + 1 :]).all() and np.isfinite(found.y[[0, 2]]).all()
    with pytest.warns(KanegenWarning, match=rf"after {made} of 9 steps, at t = {made * 0.1:.9g} s, the next"):
        one = compiled.rollout(x[1], y[1], steps=9, step=0.1)
    assert np.array_equal(one.y, found.y[1], equal_nan=True) and one.made == made
    with pytest.warns(KanegenWarning, match=r"because tau\[0, 1\] is nan"):
        compiled.rollout(x[0], y[0], [0.0, np.nan], steps=2, step=0.1)
    with pytest.raises(StatusError, match="after 0 of 2 steps"):
        compiled.with_on_status("raise").rollout(x[0], y[0], [0.0, np.inf], steps=2, step=0.1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        compiled.with_on_status("ignore").rollout(x, y, steps=9, step=0.1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"steps": -1}, "steps: -1 is no whole number from 0 on"),
        ({"steps": 2.5}, "steps: 2.5 is no whole number"),
        ({"every": 0}, "every: 0 is no whole number from 1 on"),
        ({"step": 0.0}, "step: a step needs a length"),
        ({"step": float("nan")}, "step"),
        ({"hold": "cubic"}, "unknown hold 'cubic'"),
        ({"steps": 2**70}, r"steps: '?1180591620717411303424'? is more than 2\^53"),
        ({"every": 2**62}, r"every: '?4611686018427387904'? is more than 2\^53"),
        ({"steps": 2**53}, "steps: memory cannot hold 9007199254740993 states, 2.9e[+]17 bytes"),
        ({"method": "rk5"}, "unknown method 'rk5'"),
        ({"method": "euler"}, "was built without the output 'rollout_euler'"),
    ],
)
def test_options_that_do_not_fit(change: dict[str, object], message: str) -> None:
    compiled = library("cart_pole", "rollout_rk4")
    with pytest.raises(OptionError, match=message):
        compiled.rollout([0.0, 0.0], [0.0, 0.0], **{"steps": 1, "step": 0.1, **change})


def test_systems_without_steps() -> None:
    quarter_car = kg.load(MODELS / "quarter_car.toml")
    with pytest.raises(OptionError, match="has prescribed freedoms, whose motion within a step"):
        kg.generate(quarter_car, ("step_rk4",))
    with pytest.raises(OptionError, match="whose momenta its method does not know"):
        kg.generate(quarter_car, ("rollout_variational_midpoint",))
    satellite = kg.load(MODELS / "satellite.toml")
    with pytest.raises(OptionError, match="is for speeds that are rates of coordinates"):
        kg.generate(satellite, ("step_variational_midpoint",))
    contact = kg.load(MODELS / "cart_pole.toml").with_contacts(["rod"])
    with pytest.raises(OptionError, match="has contacts, which steps do not hold"):
        kg.generate(contact, ("rollout_rk4",))
    with pytest.raises(OptionError, match="no steps of double-double states"):
        kg.generate(
            satellite, ("step_rk4",), tier=kg.Variant(precision="double-double", storage="double-double")
        )


def test_a_rollout_of_no_steps_is_its_start() -> None:
    compiled = library("cart_pole", "rollout_rk4")
    found = compiled.rollout([0.1, 0.2], [0.3, 0.4], steps=0, step=0.1)
    assert found.x.tolist() == [[0.1, 0.2]] and found.y.tolist() == [[0.3, 0.4]] and found.made == 0
    empty = compiled.rollout(np.zeros((0, 2)), np.zeros((0, 2)), steps=3, step=0.1)
    assert empty.x.shape == (0, 4, 2)


def test_functions_bring_what_they_call() -> None:
    names = [name for method in list(METHODS.values())[:3] for name in method.functions]
    source = kg.generate(kg.load(MODELS / "satellite.toml"), names, functions=["rollout_rk4"])
    assert [function.name for function in source.functions] == ["evaluate"]
    assert source.integrators == ("rollout_rk4",)


def test_times_are_one_product_and_the_end_is_stored_only_where_every_divides_the_steps() -> None:
    compiled = kg.build(kg.load(MODELS / "planar_pendulum.toml"), outputs=("rollout_rk4",))
    all_of_them = compiled.rollout([0.3, 0.0], [0.0, 0.0], steps=1000, step=1e-3)
    found = compiled.rollout([0.3, 0.0], [0.0, 0.0], steps=1000, step=1e-3, every=300)
    assert (
        found.times.tolist() == [0.0, 1e-3 * 300, 1e-3 * 600, 1e-3 * 900] == all_of_them.times[::300].tolist()
    )
    assert found.x.tolist() == all_of_them.x[::300].tolist()
    assert compiled.rollout([0.3, 0.0], [0.0, 0.0], steps=1000, step=1e-3, every=100).times[9] == 0.9
