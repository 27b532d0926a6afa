"""Work that takes long names its stages on a terminal, and nowhere else."""

from __future__ import annotations

import io
import re
import sys
import time

import pytest

import kanegen as kg
from kanegen.library.long_work import long_work
from tests.support.paths import MODELS


class Terminal(io.StringIO):
    """A text stream that says that it is a terminal."""

    def isatty(self) -> bool:
        return True


def terminal_of(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Put a terminal in the place of the standard error, and return it; a fixture would be too early."""
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    return stream


def wait_for(stream: Terminal, text: str) -> None:
    """Wait until a text was printed, at most 10 s."""
    end = time.monotonic() + 10
    while text not in stream.getvalue() and time.monotonic() < end:
        time.sleep(0.01)


def test_long_work_names_its_stages_from_then_on(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    with long_work("arm", patience=0.05) as stage:
        stage("deriving")
        wait_for(terminal, "deriving")
        stage("compiling")
    lines = terminal.getvalue().splitlines()
    assert lines[:2] == ["kanegen: arm: deriving ...", "kanegen: arm: compiling ..."]
    assert re.fullmatch(r"kanegen: arm: \d+ s", lines[2])
    assert len(lines) == 3


def test_short_work_says_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    kg.build(kg.load(MODELS / "planar_pendulum.toml"))
    assert terminal.getvalue() == ""


def test_work_that_fails_says_its_time_and_its_error_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    with pytest.raises(ZeroDivisionError), long_work("arm", patience=0.01) as stage:
        stage("compiling")
        wait_for(terminal, "compiling")
        raise ZeroDivisionError
    assert terminal.getvalue().count("\n") == 2


def test_a_function_of_the_caller_replaces_the_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    stages: list[str] = []
    with long_work("arm", stages.append, patience=0.0) as stage:
        stage("compiling")
        time.sleep(0.02)
    assert stages == ["compiling"]
    assert terminal.getvalue() == ""


def test_nothing_is_printed_where_there_is_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with long_work("arm", patience=0.0) as stage:
        stage("compiling")
        time.sleep(0.02)
    assert stream.getvalue() == ""
