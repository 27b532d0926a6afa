"""`kanegen sweep`: files of sweeps, what is printed, resumption, and what is refused."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas
import pytest

import kanegen as kg
from kanegen.cli.sweep import _bar
from kanegen.sweeps.running import Progress
from tests.support.command import kanegen
from tests.support.paths import MODELS

MODEL = MODELS / "double_pendulum.toml"

SWEEP = f"""
model = "{MODEL}"
chunk_rows = 8

[job]
duration = 0.4
step = 0.01
results = ["end.x", "max.y.q2", "drift.energy", "path.x.q1"]
bands = ["x.q1"]
every = 4

[samples]
count = 16

[axes]
m2 = [0.5, 1.0, -1.0]
x.q1 = {{uniform = [-2.0, 2.0]}}
x.q2 = "x.q1/2 + 0.1*l1"
tau.q2 = "0.3*m2*sin(2*t)"
"""


def written(folder: Path, text: str = SWEEP) -> str:
    (folder / "two.toml").write_text(text)
    return str(folder / "two.toml")


def test_a_sweep_and_its_continuation(tmp_path: Path) -> None:
    file, folder = written(tmp_path), tmp_path / "out"
    done = kanegen("sweep", file, "-o", str(folder), "--workers", "2")
    lines = done.stdout.splitlines()
    assert lines[0] == f"double_pendulum: 48 rows in {folder}"
    assert lines[1].split() == ["result", "unit", "least", "5", "%", "median", "95", "%", "greatest"]
    assert [line.split()[:2] for line in lines[3:7]] == [
        ["end.x.q1", "rad"],
        ["end.x.q2", "rad"],
        ["max.y.q2", "rad/s"],
        ["drift.energy", "J"],
    ]
    assert "16 rows failed or may be inaccurate:" in lines
    assert "  row 32: body 'lower': mass m2 = -1.0 kg is negative." in lines
    assert not done.stderr
    (folder / "table" / "part-0000003.parquet").unlink()
    data = json.loads(kanegen("sweep", file, "-o", str(folder), "--json").stdout)
    assert (data["rows"], data["finished"], data["with_reason"]) == (48, 48, 16)
    ends = kg.open_sweep(folder).column("end.x.q1")[:32]
    assert data["results"][0]["values"][::4] == [ends.min(), ends.max()]


def test_rows_from_files(tmp_path: Path) -> None:
    (tmp_path / "samples.csv").write_text("m2, l2, seen\n0.5, 0.7, 1\n1.0, 0.3, 2\n")
    pandas.DataFrame({"x.q1": [0.1, 0.2]}).to_parquet(tmp_path / "angles.parquet")
    text = f"""
        model = {{file = "{MODEL}"}}
        folder = "{tmp_path / "named"}"
        job = {{duration = 0.0, step = 1.0, results = ["end.energy"]}}
        [axes]
        "m2, l2" = {{file = "samples.csv"}}
        x.q1 = {{file = "angles.parquet"}}
    """
    kanegen("sweep", written(tmp_path, text))
    table = kg.open_sweep(tmp_path / "named").table
    assert table[["m2", "l2", "x.q1"]].values.tolist() == [
        [0.5, 0.7, 0.1],
        [0.5, 0.7, 0.2],
        [1.0, 0.3, 0.1],
        [1.0, 0.3, 0.2],
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("m2 =", "m3 =", "two.toml: axes: there is no 'm3'. Known are 'g', 'm1'"),
        ("duration =", "durration =", "two.toml: job: unknown key 'durration'. Did you mean 'duration'?"),
        ("duration = 0.4\n", "", "two.toml: job: the key 'duration' is missing."),
        ("[job]", "[jobs]", "two.toml: unknown key 'jobs'. Did you mean 'job'?"),
        ("count = 16", "count = 1.5", "two.toml: samples: count: 1.5 is no whole number"),
        ('"max.y.q2"', '"max.y.q3"', "two.toml: job: results: there is no quantity 'y.q3'."),
        (
            "double_pendulum.toml",
            "no_model.toml",
            "no_model.toml: there is no such file.",
        ),
        ("[0.5, 1.0, -1.0]", "[0.5, 1.0, ", "two.toml:"),
        ("[0.5, 1.0, -1.0]", "[]", "two.toml: axes: m2: there is no value. Give one at least."),
        ("[0.5, 1.0, -1.0]", '{file = "none.csv"}', "none.csv: there is no such file."),
        ("chunk_rows = 8", 'format = "csv"', "two.toml: unknown format 'csv'."),
        ("chunk_rows = 8", 'chunk_rows = "many"', "two.toml: chunk_rows: 'many' is no number of rows"),
        ('model = "', 'model = 5 # "', "two.toml: model: write the name of a model file"),
    ],
)
def test_files_that_are_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    file = written(tmp_path, SWEEP.replace(old, new, 1))
    done = kanegen("sweep", file, "-o", str(tmp_path / "out"), status=2)
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_wrong_numbers_in_a_file_of_samples(tmp_path: Path) -> None:
    text = SWEEP.replace("[0.5, 1.0, -1.0]", '{file = "m.csv"}')
    for content, message in (
        ("m2\n1.0\nheavy\n", "m.csv:3: 'heavy' is not a number."),
        ("m2\n1_0\n", "m.csv:2: '1_0' is not a number."),
        ("m2,l1\n1.0\n", "m.csv:2: 1 entries in place of 2."),
        ("m1\n1.0\n", "m.csv: there is no column 'm2'. Known are 'm1'."),
    ):
        (tmp_path / "m.csv").write_text(content)
        assert message in kanegen("sweep", written(tmp_path, text), status=2).stderr


def test_a_folder_of_something_else(tmp_path: Path) -> None:
    error = kanegen("sweep", written(tmp_path), "-o", str(tmp_path), status=2).stderr
    assert "holds 'two.toml' and is no folder of a sweep" in error
    error = kanegen("sweep", written(tmp_path), "--executor", "cluster", status=2).stderr
    assert "two.toml: executor: 'cluster' is neither 'mpi' nor the address of a scheduler" in error


def test_a_log_has_lines_of_progress(capsys: pytest.CaptureFixture[str]) -> None:
    """Ten hours with a chunk of 100 rows each second."""
    with _bar() as report:
        for seconds in range(36001):
            report(Progress(100 * seconds, 3600000, seconds // 18000, 100 * seconds, float(seconds)))
    captured = capsys.readouterr()
    lines = captured.err.splitlines()
    assert lines[:2] == [
        "500 of 3600000, 100 rows/s, 9:59:55 left",
        "1000 of 3600000, 100 rows/s, 9:59:50 left",
    ]
    assert lines[-1].endswith(" left, 1 with a reason")
    assert 600 <= len(lines) <= 700  # in the end one each minute
    assert not captured.out


@pytest.mark.slow
def test_ctrl_c_keeps_what_is_finished(tmp_path: Path) -> None:
    text = SWEEP.replace("duration = 0.4", "duration = 400.0").replace("count = 16", "count = 1024")
    folder = tmp_path / "out"
    command = [sys.executable, "-m", "kanegen", "sweep", written(tmp_path, text), "-o", str(folder)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        while not list((folder / "table").glob("part-*")):
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
    assert process.returncode == 130
    assert errors.splitlines() == [
        "The finished rows are kept. The same command goes on from there.",
        "interrupted",
    ]
    found = kg.open_sweep(folder)
    assert 0 < found.finished < found.rows
