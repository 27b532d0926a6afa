"""Right sides and Jacobians for solvers of SciPy: values, motions, inputs, and what is refused."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from scipy.integrate import odeint, solve_ivp

import kanegen as kg
from kanegen.errors import ArrayError, KanegenWarning, OptionError, StatusError
from kanegen.library.right_side import RightSide
from kanegen.options import Variant
from kanegen.reference.states import random_states
from tests.support.pages import blocks
from tests.support.paths import MODELS, ROOT
from tests.support.random_trees import everything

QUICK = "-O1 -ffp-contract=off"
RATES = ("forward_dynamics", "coordinate_rates")
SLOPES = tuple(f"{name}_derivatives" for name in RATES)


def built(model: str, outputs: Any = (*RATES, *SLOPES)) -> kg.Library:
    return kg.build(kg.load(MODELS / f"{model}.toml"), outputs, flags=QUICK)


@pytest.fixture(scope="module")
def pendulum() -> kg.Library:
    return built("double_pendulum", ("forward_dynamics", "forward_dynamics_derivatives"))


@pytest.fixture(scope="module")
def satellite() -> kg.Library:
    return built("satellite")


def differences(rhs: RightSide, t: float, state: Any) -> Any:
    """Return the Jacobian by central differences, whose error is about 1e-9 for numbers of order 1."""
    step = 2.0**-17
    changes = np.eye(len(state)) * step
    return np.stack([(rhs(t, state + one) - rhs(t, state - one)) / (2 * step) for one in changes], axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_random_trees(seed: int) -> None:
    """Rates are those of the methods, and the Jacobian is that of the rates, with all inputs there are."""
    system = everything(seed, 2).with_contacts([])
    library = kg.build(system, (*RATES, *SLOPES), flags=QUICK, on_status="ignore")
    states = random_states(system, 2, seed)
    loads = {} if states.force is None else {"force": states.force[0], "torque": states.torque[0]}
    named = {name: value[0] for name, value in states.inputs.items() if name != "t"}
    at = {"t": 0.7} if "t" in library.further_inputs else {}
    rhs = library.rhs(tau=np.linspace(-1, 1, library.n), **loads, **named)
    state = rhs.state(states.x[0], states.y[0])
    x, y = rhs.parts(state)
    expected = library.forward_dynamics(x, y, np.linspace(-1, 1, library.n), **loads, **named, **at)
    inputs = {name: {**named, **at}[name] for name in library.further_inputs}
    rates = library.coordinate_rates(x, y, **inputs)
    assert rhs(0.7, state).tolist() == [*rates.tolist(), *expected.tolist()]
    size = np.abs(rhs.jac(0.7, state)).max()
    assert np.abs(rhs.jac(0.7, state) - differences(rhs, 0.7, state)).max() <= 1e-7 * size


def test_a_motion_is_that_of_simulate(satellite: kg.Library) -> None:
    rhs = satellite.rhs(tau=lambda t, x, y: -0.05 * y)
    y0 = np.linspace(0.2, -0.1, satellite.n)
    solution = solve_ivp(rhs, (0.0, 2.0), rhs.state(y=y0), "DOP853", rtol=1e-10, atol=1e-12)
    x, y = rhs.parts(solution.y)
    other = kg.simulate(satellite, None, y0, [0.0, 2.0], effort=lambda t, x, y: -0.05 * y, tolerance=1e-11)
    assert x.shape == (len(solution.t), len(satellite.coordinate_names))
    assert np.abs(y[-1] - other.y[-1]).max() <= 1e-8
    assert np.abs(x[-1] - other.x[-1]).max() <= 1e-8
    middle = solution.y[:, len(solution.t) // 2]
    assert np.abs(satellite.rhs().jac(0.0, middle) - differences(satellite.rhs(), 0.0, middle)).max() <= 1e-7


def test_a_stiff_motion_takes_fewer_evaluations_with_the_jacobian() -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    stiff = system.with_force_elements(kg.JointSpring("q2", stiffness=1e5, damping=1e3))
    library = kg.build(stiff, ("forward_dynamics", "forward_dynamics_derivatives"), flags=QUICK)
    start, end = library.rhs().state([0.5, 0.0]), {}
    count = {}
    for method in ("Radau", "BDF", "LSODA", "DOP853"):
        for is_given in (False, True):
            rhs = library.rhs()
            jac = {"jac": rhs.jac} if is_given and method != "DOP853" else {}
            found = solve_ivp(rhs, (0.0, 1.0), start, method, rtol=1e-7, atol=1e-9, **jac)
            assert found.success
            end[method, is_given], count[method, is_given] = found.y[:, -1], rhs.evaluations
            assert rhs.jacobians == (found.njev if jac else 0)
    for method in ("Radau", "BDF", "LSODA"):
        assert np.abs(end[method, True] - end["DOP853", False]).max() <= 1e-4
        assert count[method, True] < count[method, False] < count["DOP853", False]


def test_other_interfaces(pendulum: kg.Library) -> None:
    """`odeint` with the time first, and states in columns."""
    rhs = pendulum.rhs()
    start = rhs.state([0.3, -0.2], [0.1, 0.0])
    times = np.linspace(0.0, 1.0, 5)
    by_lsoda = odeint(rhs, start, times, tfirst=True, Dfun=rhs.jac, rtol=1e-10, atol=1e-10)
    columns = solve_ivp(rhs, (0.0, 1.0), start, "Radau", vectorized=True, rtol=1e-8, atol=1e-10, t_eval=times)
    assert np.abs(by_lsoda.T - columns.y).max() <= 1e-6
    assert rhs(0.0, np.stack([start, start], axis=1)).tolist() == [[one, one] for one in rhs(0.0, start)]


def test_feedback_has_its_own_derivatives(pendulum: kg.Library) -> None:
    gains = np.array([[-3.0, 0.5, -1.0, 0.0], [0.0, -2.0, 0.0, -0.3]])

    def tau(t: float, x: Any, y: Any) -> Any:
        return gains @ np.concatenate([x, y]) + np.sin(t)

    for slopes in (gains, lambda t, x, y: gains):
        rhs = pendulum.rhs(tau, tau_jac=slopes)
        state = rhs.state([0.3, -0.2], [0.1, 0.4])
        assert np.abs(rhs.jac(0.2, state) - differences(rhs, 0.2, state)).max() <= 1e-7
    over_time = pendulum.rhs(lambda t, x, y: [np.sin(t), 0.0], tau_jac=0)
    constant = pendulum.rhs([np.sin(0.2), 0.0])
    assert np.array_equal(over_time.jac(0.2, state), constant.jac(0.2, state))
    with pytest.raises(OptionError, match="tau: it is a function, whose derivatives jac needs"):
        _ = pendulum.rhs(tau).jac
    with pytest.raises(ArrayError, match=r"tau_jac: expected shape \(2, 4\), got \(2, 2\)"):
        pendulum.rhs(tau, tau_jac=np.eye(2)).jac(0.0, state)


def test_loads_and_motions_over_time(satellite: kg.Library) -> None:
    rhs = satellite.rhs(force=lambda t: np.full((3, 3), t) * np.array([[s] for s in loaded(satellite)]))
    state = rhs.state(y=np.full(satellite.n, 0.1))
    x, y = rhs.parts(state)
    force = np.full((3, 3), 0.4) * np.array([[s] for s in loaded(satellite)])
    assert rhs(0.4, state)[9:].tolist() == satellite.forward_dynamics(x, y, force=force).tolist()
    car = built("quarter_car", ("forward_dynamics", "forward_dynamics_derivatives"))
    road = car.rhs(prescribed=lambda t: [[0.1 * np.sin(t)], [0.1 * np.cos(t)], [-0.1 * np.sin(t)]])
    expected = car.forward_dynamics([0, 0], [0, 0], prescribed=[[0.0], [0.1], [0.0]])
    assert road(0.0, road.state())[2:].tolist() == expected.tolist()
    with pytest.raises(ArrayError, match="prescribed: missing, but the motion depends on it"):
        car.rhs()


def loaded(library: kg.Library) -> list[float]:
    return [float(takes) for takes in library.source.model.loaded]


def test_parameters(pendulum: kg.Library) -> None:
    state = pendulum.rhs().state([0.3, 0.2], [0.1, 0.1])
    heavy = pendulum.with_parameters({"m2": 2.0})
    expected = heavy.rhs()(0.0, state).tolist()
    assert pendulum.rhs(parameters={"m2": 2.0})(0.0, state).tolist() == expected
    assert pendulum.rhs(parameters=list(heavy.parameters.values()))(0.0, state).tolist() == expected


def test_functions_may_compute_in_place_and_use_the_right_side(pendulum: kg.Library) -> None:
    """What a function does to its arguments, or with the right side meanwhile, changes no state."""

    def in_place(t: float, x: Any, y: Any) -> Any:
        x[:] = 0.0
        y *= -0.1
        return y

    def nested(t: float, x: Any, y: Any) -> Any:
        return rhs(0.0, rhs.state([0.7, 0.1], y))[2:] if t else np.zeros(2)

    def nested_slopes(t: float, x: Any, y: Any) -> Any:
        return rhs.jac(0.0, rhs.state([0.7, 0.1], y))[2:] * [0.0, 0.0, 1.0, 1.0] if t else np.zeros((2, 4))

    start = np.array([0.3, -0.2, 0.1, 0.4])
    expected = pendulum.rhs(-0.1 * start[2:])(0.0, start)
    rates = pendulum.rhs(in_place)(0.0, start)
    assert rates.tolist() == expected.tolist() and start.tolist() == [0.3, -0.2, 0.1, 0.4]
    rhs = pendulum.rhs(nested, tau_jac=nested_slopes)
    inner = pendulum.rhs()(0.0, [0.7, 0.1, *start[2:]])[2:]
    assert rhs(1.0, start).tolist() == pendulum.rhs(inner)(0.0, start).tolist()
    assert np.abs(rhs.jac(1.0, start) - differences(rhs, 1.0, start)).max() <= 1e-7
    forces = kg.simulate(pendulum, start[:2], start[2:], 0.5, effort=in_place)
    expected = kg.simulate(pendulum, start[:2], start[2:], 0.5, effort=lambda t, x, y: -0.1 * y)
    assert forces.x.tolist() == expected.x.tolist() and forces.y.tolist() == expected.y.tolist()


def test_constants_that_change_later_change_nothing(pendulum: kg.Library) -> None:
    """The Jacobian, which is bound later, is that of the same system as the rates."""
    tau, parameters, state = np.array([1.0, 2.0]), {"m2": 2.0}, np.array([0.3, -0.2, 0.1, 0.4])
    rhs, other = (pendulum.rhs(tau, parameters=parameters) for _ in range(2))
    expected = other.jac(0.0, state).tolist(), other(0.0, state).tolist()
    tau[:], parameters["m2"] = 9.0, 9.0
    for one in (rhs, pickle.loads(pickle.dumps(rhs))):
        assert (one.jac(0.0, state).tolist(), one(0.0, state).tolist()) == expected


def test_what_does_not_fit_says_so(pendulum: kg.Library) -> None:
    with pytest.raises(OptionError, match="without the output 'forward_dynamics_derivatives'"):
        _ = built("double_pendulum", ("forward_dynamics",)).rhs().jac
    with pytest.raises(OptionError, match="without the output 'coordinate_rates'"):
        built("satellite", ("forward_dynamics",)).rhs()
    with pytest.raises(OptionError, match=r"arrays of system .* are 'float'\. Build it with storage"):
        kg.build(kg.load(MODELS / "double_pendulum.toml"), RATES[:1], tier=Variant("float")).rhs()
    with pytest.raises(ArrayError, match="force: no body of system 'double_pendulum' takes loads"):
        pendulum.rhs(force=np.zeros((2, 3)))
    with pytest.raises(ArrayError, match="prescribed: no output of system"):
        pendulum.rhs(prescribed=np.zeros((3, 1)))
    with pytest.raises(ArrayError, match=r"state: expected shape \(4,\), 2 coordinates then 2 speeds"):
        pendulum.rhs()(0.0, np.zeros(3))
    for wrong in ("abc", [0.0, 0.0, 0.0, 1j], [[0.0, 0.0], [0.0]]):
        with pytest.raises(ArrayError, match="state: "):
            pendulum.rhs()(0.0, wrong)
    with pytest.raises(
        OptionError, match=r"tau: at t = 0\.5 s the function failed with IndexError: index 2 is out"
    ):
        pendulum.rhs(lambda t, x, y: -y[2])(0.5, np.zeros(4))
    with pytest.raises(ArrayError, match=r"tau: expected shape \(2,\), got \(3,\)"):
        pendulum.rhs(lambda t, x, y: np.zeros(3))(0.0, np.zeros(4))


def test_another_process_gets_it_by_pickle(satellite: kg.Library) -> None:
    rhs = satellite.rhs(tau=np.linspace(-1, 1, satellite.n))
    state = rhs.state(y=np.full(satellite.n, 0.1))
    again = pickle.loads(pickle.dumps(rhs))
    assert again(0.0, state).tolist() == rhs(0.0, state).tolist()
    assert (again.evaluations, rhs.evaluations) == (1, 1)


def test_statuses_name_the_time(pendulum: kg.Library) -> None:
    bad = [np.nan, 0.0, 0.0, 0.0]
    rhs = pendulum.rhs()
    with pytest.warns(KanegenWarning, match=r"at t = 0\.5 s: forward_dynamics: .*x\[0\] is nan") as warned:
        rhs(0.5, bad)
        rhs(0.6, bad)
    assert len(warned) == 1
    with pytest.raises(StatusError, match=r"at t = 0\.5 s: forward_dynamics"):
        pendulum.with_on_status("raise").rhs()(0.5, bad)
    assert np.isnan(pendulum.with_on_status("ignore").rhs()(0.5, bad)[2:]).any()


def test_the_page(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    namespace: dict[str, Any] = {}
    for block in blocks("embedding/scipy", "python"):
        exec(block, namespace)
    printed = capsys.readouterr().out.splitlines()
    shown = [line for block in blocks("embedding/scipy", "text") for line in block.splitlines()]
    assert printed == shown
