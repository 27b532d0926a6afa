"""`kanegen simulate`: what it prints and writes, what it refuses, and what Ctrl-C and failures leave."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas
import pytest

import kanegen as kg
from kanegen.simulation.running import Record
from tests.support.command import kanegen
from tests.support.paths import MODELS

PENDULUM = str(MODELS / "double_pendulum.toml")
SHORT = ("simulate", PENDULUM, "--duration", "1", "--x", "q1=pi/6", "--step", "0.01")


def test_a_motion_is_printed_and_written(tmp_path: Path) -> None:
    csv, npz, svg = (tmp_path / f"motion.{end}" for end in ("csv", "npz", "svg"))
    done = kanegen(*SHORT, "-o", str(csv), "-o", str(npz), "--plot", str(svg), "--every", "0.1")
    assert "double_pendulum: RK4, step 0.01 s; energy less work drifts by " in done.stdout
    assert "t (s)  x.q1 (rad)  x.q2 (rad)  y.q1 (rad/s)" in done.stdout
    assert not done.stderr
    expected = kg.simulate(kg.load(PENDULUM), {"q1": np.pi / 6}, None, 1.0, every=0.1, step=0.01)
    frame = pandas.read_csv(csv)
    assert frame["x.q1"].to_numpy() == pytest.approx(expected.x[:, 0], abs=1e-14)
    assert "kinetic_energy" in frame
    with np.load(npz) as arrays:
        assert arrays["y"] == pytest.approx(expected.y, abs=1e-14)  # pi/6 rounded once or twice
    assert "<svg" in svg.read_text()


def test_times_of_events_have_the_digits_of_the_tolerance_and_a_missing_one_is_said() -> None:
    done = kanegen(*SHORT[:-2], "--tolerance", "1e-6", "--event", "x.q1 < 0", "--until", "x.q1 > 3")
    (time,) = re.findall(r"^event at t = 0\.(\d+) s: x.q1 < 0$", done.stdout, re.MULTILINE)
    assert 4 < len(time) <= 7
    assert "no event of --until up to the end of the duration, t = 1 s" in done.stdout


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--step", "0.01", "--show", "x.q3"), "has no 'x.q3'. Known are 'x.q1', 'x.q2'."),
        (("--error", "1e-6", "--show", "momentum.linear.w"), "has no 'momentum.linear.w'. Known are"),
        (("--step", "0.01", "--show", "tau.q1"), "has no 'tau.q1'. Known are"),
        (("--step", "0.01", "--until", "y.q1 >"), "'y.q1 >': nothing after '>'"),
    ],
)
def test_names_are_looked_up_before_the_simulation(
    options: tuple[str, ...], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr("kanegen.simulation.solver.Solver.__init__")  # nothing can be simulated
    done = kanegen(*SHORT[:-2], *options, status=2)
    assert message in " ".join(done.stderr.split())


def test_events_outputs_and_inputs_have_names() -> None:
    done = kanegen(
        *SHORT,
        *(
            "--points",
            "tip=lower:0.7,0,0",
            "--show",
            "x.q1,point_positions.tip.y",
            "--input",
            "q2=0.1*sin(t)",
        ),
        *("--event", "x.q1 < 0", "--until", "point_positions.tip.y < -0.1", "--json"),
    )
    found = json.loads(done.stdout)
    assert list(found["columns"]) == ["t", "x.q1", "point_positions.tip.y"]
    assert found["units"]["point_positions.tip.y"] == "m"
    first, last = found["events"]
    assert first["direction"] == "falling"
    assert found["columns"]["t"][-1] == last["t"] < 1.0
    assert found["columns"]["point_positions.tip.y"][-1] == pytest.approx(-0.1, abs=1e-14)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--duration", "1", "--x", "q3=1"], "x: there is no 'q3'"),
        ([], "--duration: say how long to simulate, in s, such as --duration 10."),
        (["--until", "t > 1"], "The event of --until may not come"),
        (["--duration", "-1"], "duration: -1.0 is no positive number of seconds"),
        (["--duration", "1", "--every", "1e-12"], "makes more than 10000000 states"),
        (
            ["--duration", "1", "--input", "q1"],
            "--input: 'q1' is not NAME=EXPRESSION, such as pole",
        ),
        (
            ["--duration", "1", "--input", "q1=1", "--input", "q1=2"],
            "--input: 'q1' is given twice",
        ),
        (["--duration", "1", "--input", "q9=1"], "inputs: there is no 'q9'"),
        (["--duration", "1", "--error", "1e-6", "--tier", "single"], "--error chooses the precision itself"),
        (
            ["--duration", "1", "--error", "1e-6", "--step", "0.1"],
            "error: it chooses method, step and precision",
        ),
        (["--duration", "1", "--method", "RK5"], "unknown method 'RK5'"),
        (["--duration", "1", "--method", "rk4"], "method 'RK4' needs a positive number of seconds"),
        (["--duration", "1", "--show", "x.q7"], "the motion of double_pendulum has no 'x.q7'"),
        (["--duration", "1", "--show", "kinetik_energy"], "unknown output 'kinetik_energy'. Did you mean"),
        (["--duration", "1", "--event", "x.q1 = 1"], "event: expression 'x.q1 = 1': no expression"),
        (["--duration", "1", "-o", "motion.xls"], "motion.xls: there is no format '.xls'"),
        (["--duration", "1", "-o", "missing/motion.csv"], "missing/motion.csv: cannot be written"),
        (["--duration", "1", "--plot", "motion.gif"], "--plot: motion.gif does not end in .svg, .png, .pdf."),
        (["--duration", "1", "--inputs", "missing.csv"], "missing.csv: cannot be read"),
    ],
)
def test_what_is_refused(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = kanegen("simulate", PENDULUM, *arguments, status=2)
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_a_motion_that_runs_away_is_written_up_to_there(tmp_path: Path) -> None:
    file = tmp_path / "kept.csv"
    done = kanegen(
        *("simulate", PENDULUM, "--duration", "9", "--step", "0.005", "--every", "0.02"),
        *("--input", "q1=exp(2*y.q1**2)+10", "-o", str(file)),
        status=2,
    )
    assert done.stderr.startswith("error: at t = ")
    assert f"{file} holds the motion up to then." in done.stderr
    frame = pandas.read_csv(file)
    assert len(frame) > 1
    assert np.isfinite(frame.to_numpy()).all()


def test_an_interruption_keeps_what_was_computed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    add = Record.add

    def interrupted(record: Record, stretch: object) -> None:
        """Stand for Ctrl-C after half a second of the motion."""
        add(record, stretch)  # type: ignore[arg-type]
        if record.times[-1] > 0.5:
            raise KeyboardInterrupt

    monkeypatch.setattr(Record, "add", interrupted)
    file = tmp_path / "kept.csv"
    done = kanegen(*SHORT[:-2], "--tolerance", "1e-8", "-o", str(file), status=130)
    assert "the motion ends at t = 0.5" in done.stderr
    frame = pandas.read_csv(file)
    assert 0.5 < frame["t"].iloc[-1] < 0.9
    assert "RK4" not in done.stdout and "DOP853, tolerance 1e-08" in done.stdout


@pytest.mark.slow
def test_a_signal_ends_a_process_with_its_file_whole(tmp_path: Path) -> None:
    file = tmp_path / "kept.csv"
    command = [
        sys.executable,
        "-m",
        "kanegen",
        "simulate",
        PENDULUM,
        "--duration",
        "1e6",
        "--every",
        "1",
        "--x",
        "q1=0.3",
    ]
    running = subprocess.Popen([*command, "--tolerance", "1e-12", "-o", str(file)], stderr=subprocess.PIPE)
    time.sleep(15)
    os.kill(running.pid, signal.SIGINT)
    _, said = running.communicate(timeout=60)
    assert running.returncode == 130
    assert b"the motion ends at t = " in said
    assert len(pandas.read_csv(file)) > 1


def test_states_outside_of_limits_are_warned_of(tmp_path: Path) -> None:
    model = tmp_path / "limited.toml"
    system = kg.load(PENDULUM).with_limits({"q1": {"position": (-0.3, 0.3), "speed": 1.0}})
    system.save(model)
    done = kanegen("simulate", str(model), "--duration", "1", "--step", "0.01", "--x", "q1=0.4")
    assert (
        "warning: at t = 0 s coordinate 'q1' is 0.4, outside its limits -0.3 to 0.3, which are no part"
        in (done.stderr)
    )
    assert "speed 'q1'" in done.stderr
