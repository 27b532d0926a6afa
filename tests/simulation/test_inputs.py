"""Inputs by name: expressions, tables in files, prescribed motion and loads, against closed forms."""

from __future__ import annotations

import functools
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest
from scipy.integrate import solve_ivp

import kanegen as kg
from kanegen.model.force_elements.elements import Drive
from kanegen.simulation.signals import Signal
from tests.support.moving_pendulum import pendulum
from tests.support.paths import MODELS

OUTPUTS = ("forward_dynamics", "kinetic_energy", "potential_energy", "point_positions")


@functools.cache
def slider() -> kg.Library:
    """Return 2 kg that slide along axis 1, with loads on the body and on a point."""
    joint = kg.Joint(free=(False, False, False, True, False, False))
    body = kg.Body("block", 0, 2.0, np.eye(3), joint=joint, loads=True)
    system = kg.System("slider", (body,), gravity=(0, 0, 0)).with_points({"tip": ("block", (0, 0.1, 0))})
    return kg.build(system.with_loads(["tip"]), OUTPUTS)


def test_an_expression_of_the_time_is_an_effort() -> None:
    """2 kg pushed by sin(3 t) N: x = t/6 - sin(3 t)/18."""
    motion = kg.simulate(slider(), None, None, 4.0, tolerance=1e-12, inputs={"block.s1": "sin(3*t)"})
    t = motion.times
    assert np.abs(motion.x[:, 0] - (t / 6 - np.sin(3 * t) / 18)).max() < 1e-10
    assert np.abs(motion.output("tau.block.s1") - np.sin(3 * t)).max() < 1e-15
    assert np.abs(motion.work - motion.kinetic_energy).max() < 1e-10


def test_an_expression_of_the_state_is_a_control() -> None:
    """A spring and a damper: m x'' = -k x - c x'."""
    k, c, m = 8.0, 0.4, 2.0
    motion = kg.simulate(
        slider(),
        {"block.s1": 0.5},
        None,
        5.0,
        tolerance=1e-12,
        inputs={"block.s1": "-8*x.block.s1 - 0.4*y.block.s1"},
    )
    a, w = c / (2 * m), math.sqrt(k / m - (c / (2 * m)) ** 2)
    t = motion.times
    exact = 0.5 * np.exp(-a * t) * (np.cos(w * t) + a / w * np.sin(w * t))
    assert np.abs(motion.x[:, 0] - exact).max() < 1e-9


def test_states_at_once_have_their_own_values_of_an_expression() -> None:
    x = np.array([[0.5], [0.1]])
    both = kg.simulate(slider(), x, np.zeros((2, 1)), 1.0, step=0.01, inputs={"block.s1": "-8*x.block.s1"})
    for k in range(2):
        one = kg.simulate(slider(), x[k], [0.0], 1.0, step=0.01, inputs={"block.s1": "-8*x.block.s1"})
        assert np.abs(both.x[:, k] - one.x).max() < 1e-15


PUSH = "50*exp(-((t - 5.013)/0.01)**2)"


@pytest.mark.parametrize(
    "push",
    [
        PUSH,
        f"10*t + {PUSH} - 10*t",
        f"({PUSH})*cos(x.block.s1 - 0.5) if x.block.s1 < 0.6 else 0",
        "(25*sqrt(pi) if 5.003 < t else 0) if t < 5.023 else 0",
    ],
)
@pytest.mark.parametrize(
    "options",
    [
        {"tolerance": 1e-4},
        pytest.param({"error": 1e-6}, marks=pytest.mark.slow),
        {"method": "Radau", "tolerance": 1e-6},
    ],
)
def test_a_push_shorter_than_the_steps_is_not_missed(push: str, options: dict[str, Any]) -> None:
    """A push of 0.5 sqrt(pi) N s on 2 kg at rest gives 0.25 sqrt(pi) m/s, however small the tolerance."""
    motion = kg.simulate(slider(), {"block.s1": 0.5}, None, 10.0, inputs={"block.s1": push}, **options)
    speed = 0.25 * math.sqrt(math.pi)
    assert motion.y[-1, 0] == pytest.approx(speed, rel=1e-3)
    assert motion.x[-1, 0] == pytest.approx(0.5 + speed * 4.987, rel=1e-3)
    assert motion.promise is None or motion.promise.is_kept


def test_a_push_of_a_function_is_seen_if_it_is_longer_than_a_two_hundredth() -> None:
    def effort(t: float, x: np.ndarray, y: np.ndarray) -> list[float]:
        return [5 * math.exp(-(((t - 5.013) / 0.1) ** 2))]

    motion = kg.simulate(slider(), None, None, 10.0, effort=effort)
    assert motion.y[-1, 0] == pytest.approx(0.25 * math.sqrt(math.pi), rel=1e-6)


@pytest.mark.parametrize("options", [{}, {"error": 1e-6}])
def test_a_push_of_a_model_is_not_missed(options: dict[str, Any]) -> None:
    """A drive runs in C, where 200 steps and twice as many lie 6 widths beside the push."""
    system = slider().source.system
    assert system is not None
    driven = system.with_force_elements(Drive("block.s1", kg.parse("500*exp(-((t - 5.01875)/0.001)**2)")))
    motion = kg.simulate(driven, None, None, 10.0, **options)
    assert motion.y[-1, 0] == pytest.approx(0.25 * math.sqrt(math.pi), rel=1e-5)
    assert motion.promise is None or motion.promise.is_kept


@pytest.mark.parametrize("place", ["force.block.x", "point_force.tip.x"])
def test_loads_act_on_bodies_and_points(place: str) -> None:
    motion = kg.simulate(slider(), None, None, 2.0, step=0.01, inputs={place: "6*t"})
    assert np.abs(motion.x[:, 0] - motion.times**3 / 2).max() < 1e-12
    assert "drift" not in motion.caption  # the work of the load is not known


@pytest.mark.parametrize("end", [".csv", ".parquet", ".npz", ""])
@pytest.mark.parametrize("options", [{"step": 0.3}, {"tolerance": 1e-10}])
def test_a_held_table_jumps_at_its_times_whatever_the_steps(
    end: str, options: dict[str, Any], tmp_path: Path
) -> None:
    """RK4 is exact between the jumps, which lie inside of steps of 0.3 s."""
    columns = {"t": [0.0, 0.25, 0.7, 2.0], "block.s1": [2.0, -4.0, 1.0, 0.0]}
    motion = kg.simulate(
        slider(), None, None, 2.0, every=0.5, inputs=_file(columns, end, tmp_path), **options
    )
    x, v, expected = 0.0, 0.0, {}
    edges = sorted({*columns["t"], *motion.times.tolist()})
    for begin, after in zip(edges, [*edges[1:], 2.0], strict=True):
        expected[begin] = x
        a = columns["block.s1"][np.searchsorted(columns["t"], begin, "right") - 1] / 2
        h = after - begin
        x, v = x + h * v + h * h / 2 * a, v + h * a
    assert motion.x[:, 0] == pytest.approx([expected[t] for t in motion.times.tolist()], abs=1e-13)
    assert len(motion.times) == 5


def test_lines_between_the_values_of_a_table() -> None:
    """From 0 to 2 N in 1 s, then back: the speed is a quarter of the area, in kg."""
    table = {"t": [0.0, 1.0, 2.0], "block.s1": [0.0, 2.0, 0.0]}
    motion = kg.simulate(slider(), None, None, 2.0, step=0.3, inputs=table, hold="linear")
    t = motion.times
    exact = np.where(t < 1, t * t / 2, 2 * t - t * t / 2 - 1)
    assert np.abs(motion.y[:, 0] - exact).max() < 1e-13
    held = kg.simulate(slider(), None, None, 2.0, step=0.3, inputs=[table, {"force.block.x": -1.0}])
    assert held.y[-1, 0] == pytest.approx((0.0 + 2.0 - 2.0) / 2)


def _file(columns: dict[str, Any], end: str, folder: Path) -> Any:
    path = folder / f"push{end}"
    if end == ".csv":
        pandas.DataFrame(columns).to_csv(path, index=False)
    elif end == ".parquet":
        pandas.DataFrame(columns).to_parquet(path)
    elif end == ".npz":
        np.savez(path, **{name: np.array(values) for name, values in columns.items()})
    else:
        return columns
    return path


def test_a_saved_motion_is_a_table_of_its_own_inputs(tmp_path: Path) -> None:
    first = kg.simulate(pendulum(), None, None, 1.0, step=0.01, inputs={"body1.theta3": "sin(7*t)"})
    first.save(tmp_path / "first.csv")
    again = kg.simulate(pendulum(), None, None, 1.0, step=0.01, inputs=tmp_path / "first.csv", hold="linear")
    assert np.abs(again.x - first.x).max() < 1e-4  # lines of 5 ms through a sine of 7 rad/s


def test_a_prescribed_freedom_follows_an_expression_with_its_derivatives() -> None:
    """A block on a spring in a box that is shaken: its acceleration in the box is -k x / m - h''."""
    along = (False, False, False, True, False, False)
    none = (False,) * 6
    box = kg.Body("box", 0, 1.0, np.eye(3), joint=kg.Joint(free=none, prescribed=along))
    block = kg.Body("block", 1, 2.0, np.eye(3), joint=kg.Joint(free=along))
    spring = kg.JointSpring("block.s1", stiffness=50.0)
    system = kg.System("shaken", (box, block), gravity=(0, 0, 0), force_elements=(spring,))
    motion = kg.simulate(system, None, None, 2.0, tolerance=1e-12, inputs={"box.s1": "0.05*sin(9*t)**2"})
    exact = solve_ivp(
        lambda t, state: [state[1], -25.0 * state[0] - 8.1 * math.cos(18 * t)],
        (0, 2),
        [0, 0],
        "DOP853",
        rtol=1e-12,
        atol=1e-13,
        t_eval=motion.times,
    )
    assert np.abs(np.concatenate([motion.x, motion.y], axis=1) - exact.y.T).max() < 1e-9
    t = motion.times[-1]
    expected = [0.05 * math.sin(9 * t) ** 2, 0.45 * math.sin(18 * t), 8.1 * math.cos(18 * t)]
    assert motion.inputs["prescribed"][-1, :, 0] == pytest.approx(expected, abs=1e-13)
    assert motion.energy_drift.largest < 1e-9  # the work of what shakes the box is known


@pytest.mark.parametrize(
    ("text", "slopes"),
    [
        ("sin(3*t)**2", lambda t: (math.sin(3 * t) ** 2, 3 * math.sin(6 * t), 18 * math.cos(6 * t))),
        ("tanh(t)", lambda t: (math.tanh(t), 1 / math.cosh(t) ** 2, -2 * math.tanh(t) / math.cosh(t) ** 2)),
        ("sqrt(1 + t*t)", lambda t: (math.hypot(1, t), t / math.hypot(1, t), math.hypot(1, t) ** -3)),
        ("abs(t - 2)*t", lambda t: ((2 - t) * t, 2 - 2 * t, -2.0)),
        ("sign(t - 2)*t*t", lambda t: (-t * t, -2 * t, -2.0)),
        ("t if t < 1 else t**3", lambda t: (t**3, 3 * t * t, 6 * t)),
        ("0.25", lambda t: (0.25, 0.0, 0.0)),
    ],
)
def test_derivatives_of_a_signal_are_exact(text: str, slopes: Any) -> None:
    signal = Signal.of("input", text, pendulum())
    assert signal.with_rates(1.3) == pytest.approx(slopes(1.3), rel=1e-14, abs=1e-14)


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"blok.s1": 1.0}, "inputs: there is no 'blok.s1'. Did you mean 'block.s1'?"),
        ({"block.s1": "sin(t"}, "input block.s1: expression 'sin(t': no expression"),
        ({"block.s1": "x.tip"}, "there is no such variable. Known are 'x.block.s1'."),
        ({"block.s1": "kinetic_energy"}, "cannot depend on the output 'kinetic_energy'"),
        ([{"block.s1": "t"}, {"tau.block.s1": "t"}], "input block.s1: it is given twice"),
        ({"block.s1": math.nan}, "input block.s1: expression: nan is not finite"),
        ([3], "inputs: 3 is no table by name, and not the name of a file"),
        ({"t": [0, 1], "block.s2": [1, 2]}, "inputs: there is no input 'block.s2'"),
        ({"t": [0, 1, 1], "block.s1": [1, 2, 3]}, "the times must be two or more, finite, and increase"),
        ({"t": [0, 1], "block.s1": [1, 2, 3]}, "column 'block.s1' has 3 values, the column of times 2"),
        ({"t": [0, 1], "block.s1": [1, math.inf]}, "block.s1 at t = 1 s is inf, no finite number"),
        ({"t": [0, 1], "block.s1": ["a", "b"]}, "column 'block.s1' has no real numbers in one row"),
        ({"t": [0.0, 1.0], "x.block.s1": [1, 2]}, "inputs: no column is an input. There are block.s1"),
        (
            {"t": [0.0, 0.5, 1.0], "block.s1": [1, 2, 2]},
            "end at t = 1.5 s, before the simulation does",
        ),
        ({"t": [0.5, 2.0], "block.s1": [1, 2]}, "begin at t = 0.5 s, the simulation at 0 s"),
    ],
)
def test_what_is_refused(inputs: Any, message: str) -> None:
    with pytest.raises(kg.KanegenError) as error:
        kg.simulate(slider(), None, None, 2.0, step=0.1, inputs=inputs)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.csv", b"t,block.s1\n0,1\n1,two\n", "a.csv:3: 'two' in column 'block.s1' is no number."),
        ("a.csv", b"t,block.s1\n0,1_0\n", "a.csv:2: '1_0' in column 'block.s1' is no number."),
        ("b.csv", b"t,block.s1\n0,1,3\n", "b.csv:2: 3 values for 2 columns."),
        ("c.csv", b"\xff\xfe\x00", "c.csv: it is no CSV file"),
        ("d.csv", b"", "d.csv: there is no column 't', the time in s. Add it."),
        ("e.csv", b"t,t\n0,1\n", "e.csv:1: two columns have the same name"),
        ("f.parquet", b"PAR1", "f.parquet: it is no Parquet file"),
        ("g.npz", b"PK", "g.npz: it is no NPZ file of numbers"),
        ("h.txt", b"", "h.txt: there is no format '.txt'. Known are '.csv', '.parquet', '.npz'."),
    ],
)
def test_files_that_cannot_be_read(name: str, content: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(kg.KanegenError) as error:
        kg.simulate(slider(), None, None, 2.0, step=0.1, inputs=tmp_path / name)
    assert message in str(error.value)
    with pytest.raises(kg.ReadError, match=r"missing.csv: cannot be read: No such file"):
        kg.simulate(slider(), None, None, 2.0, step=0.1, inputs=tmp_path / "missing.csv")


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"t": np.array(5.0), "names": np.array(["t", "block.s1"])}, "there is no column 't'"),
        ({"t": np.arange(3.0), "names": np.array(5)}, "no column is an input"),
        ({"t": np.arange(3.0), "names": np.array(["t", "block.s1"]), "z": np.array(5.0)}, "no column is an"),
        (None, "motion.npz: it is no NPZ file of numbers: one array without a name"),
    ],
)
def test_arrays_of_other_shapes_are_refused(arrays: Any, message: str, tmp_path: Path) -> None:
    path = tmp_path / "motion.npz"
    with path.open("wb") as file:
        np.save(file, np.arange(3.0)) if arrays is None else np.savez(file, **arrays)
    with pytest.raises(kg.KanegenError, match=message):
        kg.simulate(slider(), None, None, 2.0, step=0.1, inputs=path)


def test_prescribed_motion_is_an_expression_of_the_time_alone() -> None:
    library = kg.build(kg.load(MODELS / "quarter_car.toml"), ("forward_dynamics",), flags="-O0")
    for inputs, message in (
        (
            None,
            r"has prescribed freedoms \(height\)\. Say how they move, each by an expression of t: --input",
        ),
        ({"height": "x.hub"}, "input height: a prescribed motion is an expression of t alone"),
        ({"t": [0, 1], "height": [0, 1]}, "a table gives no rates and accelerations"),
    ):
        with pytest.raises(kg.OptionError, match=message):
            kg.simulate(library, None, None, 1.0, step=0.1, inputs=inputs)  # type: ignore[arg-type]
    with pytest.raises(kg.OptionError, match="Give it once"):
        kg.simulate(
            library, None, None, 1.0, step=0.1, inputs={"height": 0}, prescribed=lambda t: np.zeros((3, 1))
        )
    with pytest.raises(
        kg.OptionError, match="prescribed: at t = 0 s it returned a number that is not finite"
    ):
        kg.simulate(library, None, None, 1.0, step=0.1, prescribed=lambda t: np.full((3, 1), np.nan))
    with pytest.raises(kg.OptionError, match=r"prescribed: the function takes \(t, x\); expected \(t\)\."):
        kg.simulate(library, None, None, 1.0, step=0.1, prescribed=lambda t, x: np.zeros((3, 1)))  # type: ignore


def _failing(time: float, *state: np.ndarray) -> Any:
    """Return zeros before 0.25 s, and fail from there on."""
    if time >= 0.25:
        raise ValueError("no contact\nfound")
    return state[1] * 0.0 if state else 0.0


@pytest.mark.parametrize(
    ("given", "label"),
    [
        ({"inputs": {"block.s1": _failing}}, "input block.s1"),
        ({"effort": _failing}, "effort"),
        ({"inputs": {"block.s1": lambda t: [[1.0], [1.0, 2.0]]}}, "input block.s1"),
    ],
)
def test_functions_that_fail_are_named(given: dict[str, Any], label: str) -> None:
    with pytest.raises(kg.OptionError) as error:
        kg.simulate(slider(), None, None, 1.0, step=0.1, **given)
    assert re.match(rf"{label}: at t = [\d.]+ s the function failed with ValueError: ", str(error.value))
    assert isinstance(error.value.__cause__, ValueError) and "\n" not in str(error.value)


@pytest.mark.parametrize("method", ["RK4", "leapfrog", "DOP853"])
def test_expressions_that_are_not_finite_are_named(method: str) -> None:
    step = None if method == "DOP853" else 0.125
    for inputs, message in (
        ({"block.s1": "sqrt(1 - t)"}, r"at t = [\d.]+ s: input block.s1: sqrt\(1 - t\) is nan\."),
        ({"force.block.x": "sqrt(1 - x.block.s1)"}, r"input force.block.x: sqrt\(1 - x.block.s1\) is nan\."),
    ):
        with pytest.raises(kg.StatusError, match=message) as error:
            kg.simulate(slider(), None, [1.0], 8.0, method=method, step=step, inputs=inputs)
        assert (error.value.trajectory.times < 8.0).all()


def test_rates_of_prescribed_motion_that_are_not_finite_are_named() -> None:
    library = kg.build(
        kg.load(MODELS / "quarter_car.toml"), ("forward_dynamics", "rollout_euler"), flags="-O0"
    )
    for method in ("leapfrog", "euler"):
        with pytest.raises(kg.StatusError, match=r"input height: sqrt\(1 - t\) has the rate -inf\."):
            kg.simulate(library, times=2.0, step=0.125, method=method, inputs={"height": "sqrt(1 - t)"})


def test_errors_of_kanegen_in_functions_keep_their_class() -> None:
    def effort(t: float, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        raise kg.StatusError("the controller has no solution")

    with pytest.raises(kg.StatusError, match="effort: at t = 0 s the function failed with Status"):
        kg.simulate(slider(), None, None, 1.0, step=0.1, effort=effort)
