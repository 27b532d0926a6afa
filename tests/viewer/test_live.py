"""The live view: it serves a page on this machine, follows the program, and stops."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import threading
import urllib.request
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from tests.support.paths import MODELS


@pytest.fixture
def pendulum() -> kg.System:
    return kg.load(MODELS / "double_pendulum.toml")


def answers(port: int) -> bool:
    """Whether something listens on a port of this machine."""
    with socket.socket() as probe:
        probe.settimeout(1.0)
        return probe.connect_ex(("127.0.0.1", port)) == 0


def test_it_serves_moves_and_stops(pendulum: kg.System, capsys: pytest.CaptureFixture[str]) -> None:
    before = threading.active_count()
    with kg.view(pendulum).live(port=8340) as live:
        with urllib.request.urlopen(live.url) as answer:
            assert b"<html" in answer.read()
        live.set([0.5, -0.25])
        assert [slider.value for slider in live._sliders] == pytest.approx([0.5, -0.25])
        q1 = live._frames[1].wxyz
        assert 2 * np.arccos(abs(q1[0])) == pytest.approx(0.5, abs=1e-6)
        with pytest.raises(kg.ArrayError, match=r"x: expected shape \(2,\), got \(3,\)"):
            live.set([0, 0, 0])
        with pytest.raises(kg.ArrayError, match="not finite"):
            live.set([0, np.nan])
    assert not answers(live.port)
    live.close()
    assert threading.active_count() <= before + 1
    assert capsys.readouterr().out == ""


def test_a_second_view_takes_the_next_port_and_a_motion_plays(pendulum: kg.System) -> None:
    times = np.linspace(0, 10, 101)
    motion = (times, np.stack([times, 0 * times], axis=1))
    with (
        kg.view(pendulum).live(port=8350) as first,
        kg.view(pendulum, motion).live(port=first.port) as second,
    ):
        assert second.port != first.port
        moved = threading.Event()
        for _ in range(100):
            if second._frames[1].wxyz[0] < 1 - 1e-6:
                moved.set()
                break
            threading.Event().wait(0.05)
        assert moved.is_set()


def test_the_command_serves_until_it_is_interrupted(tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "kanegen",
        "view",
        str(MODELS / "double_pendulum.toml"),
        "--live",
        "--port",
        "8360",
    ]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=tmp_path, **pipes) as process:
        try:
            line = process.stdout.readline()
            assert line.startswith("serving http://127.0.0.1:")
            port = int(line.split(":")[2].split()[0])
            urllib.request.urlopen(f"http://127.0.0.1:{port}").close()
            process.send_signal(signal.SIGINT)
            assert process.wait(30) == 128 + signal.SIGINT
            assert not answers(port)
            assert "Traceback" not in process.stderr.read()
        finally:
            process.kill()
