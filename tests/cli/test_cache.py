"""`kanegen cache`, and Ctrl-C at any time."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kanegen.library import load
from tests.support.command import kanegen
from tests.support.handmade import source
from tests.support.paths import PENDULUM, ROOT


def test_list_and_clear(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KANEGEN_CACHE", str(tmp_path / "cache"))
    assert f"0 entries, 0.0 MB of at most 1024 MB, in {tmp_path}" in kanegen("cache", "list").stdout
    path = load(source()).path
    text = kanegen("cache", "list", KANEGEN_CACHE_MB="0.5").stdout
    assert "libhandmade.so" in text
    assert "of at most 0.5 MB" in text
    for age, words in ((120.0, "2 minutes ago"), (5400.0, "1.5 hours ago"), (2.5 * 86400.0, "2.5 days ago")):
        moment = time.time() - age
        os.utime(path.parent / "SHA256SUMS", (moment, moment))
        assert words in kanegen("cache", "list").stdout
    os.utime(path.parent / "SHA256SUMS")
    listed = json.loads(kanegen("cache", "list", "--json").stdout)
    assert str(path.parent) in [entry["path"] for entry in listed["entries"]]
    assert listed["folder"] == str(tmp_path / "cache")
    assert "removed 0 entries" in kanegen("cache", "clear", "--unused-for", "1").stdout
    assert path.exists()
    count = len(listed["entries"])
    assert f"removed {count} entries" in kanegen("cache", "clear").stdout
    assert list((tmp_path / "cache").iterdir()) == []


def test_errors(tmp_path: Path) -> None:
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache").chmod(0o777)
    open_to_all = str(tmp_path / "cache")
    assert "is not safe" in kanegen("cache", "clear", status=2, KANEGEN_CACHE=open_to_all).stderr
    bad = kanegen("cache", "list", status=2, KANEGEN_CACHE=str(tmp_path / "none"), KANEGEN_CACHE_MB="much")
    assert "$KANEGEN_CACHE_MB: 'much' is not a number" in bad.stderr


BEGIN = """
print("begun", flush=True)
from kanegen.__main__ import main
main()
"""


def start(tmp_path: Path, *arguments: str, **environment: str) -> subprocess.Popen[str]:
    """Start `kanegen` with a cache of its own, and return when the interpreter has begun to run it."""
    process = subprocess.Popen(
        [sys.executable, "-c", BEGIN, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "KANEGEN_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(ROOT), **environment},
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    return process


INTERRUPTED_IMPORT = """
import os, signal
try:
    os.kill(os.getpid(), signal.SIGINT)
except BaseException:
    {answer}
"""


ANOTHER_ERROR = "raise ImportError('numpy.core failed to import') from None"


@pytest.mark.parametrize(
    ("module", "answer"),
    [("typer", "raise"), ("rich", ANOTHER_ERROR), ("numpy", ANOTHER_ERROR), ("cffi", "raise")],
)
def test_an_interrupted_import(tmp_path: Path, module: str, answer: str) -> None:
    """Ctrl-C while a package is imported, also where the package answers with an error of its own."""
    (tmp_path / module).mkdir()
    (tmp_path / module / "__init__.py").write_text(INTERRUPTED_IMPORT.format(answer=answer))
    process = start(tmp_path, "check", PENDULUM, PYTHONPATH=f"{tmp_path}{os.pathsep}{ROOT}")
    printed = process.communicate(timeout=60)
    assert (process.returncode, printed) == (130, ("", "interrupted\n"))


@pytest.mark.parametrize(
    ("number", "word"),
    [
        (signal.SIGINT, "interrupted"),
        pytest.param(signal.SIGTERM, "terminated", marks=pytest.mark.slow),
    ],
)
def test_an_interrupted_compiler(tmp_path: Path, number: signal.Signals, word: str) -> None:
    """Ctrl-C while two files are compiled: the compilers are killed, and the cache holds nothing half."""
    compiler = tmp_path / "cc"
    compiler.write_text(
        f'#!/bin/sh\ncase "$*" in --version|*selftest*) exec gcc "$@" ;; esac\n'
        f"sleep 60 & echo $! > {tmp_path}/$$.pid; wait\n"
    )
    compiler.chmod(0o755)
    process = start(tmp_path, "check", PENDULUM, KANEGEN_CC=str(compiler))
    deadline = time.monotonic() + 60
    while len(list(tmp_path.glob("*.pid"))) < 2 and time.monotonic() < deadline:
        time.sleep(0.02)
    process.send_signal(number)
    printed = process.communicate(timeout=40)
    assert (process.returncode, printed[1]) == (128 + number, f"{word}\n")
    for file in tmp_path.glob("*.pid"):
        command = ["ps", "-o", "stat=", "-p", file.read_text().strip()]
        state = subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
        assert state[:1] in ("", "Z")
    assert not [path for path in (tmp_path / "cache").iterdir() if path.name.startswith(".")]


def interrupt(tmp_path: Path, number: int, seconds: float) -> None:
    """Interrupt `kanegen generate` after some time, and see that the files are all there or none is."""
    folder = tmp_path / str(number)
    process = start(tmp_path, "generate", PENDULUM, "-o", str(folder))
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode in (0, 130, -signal.SIGINT), errors
    if process.returncode != -signal.SIGINT:  # before kanegen runs, and after it has ended
        assert errors in ("", "interrupted\n")
    names = {path.name for path in folder.iterdir()} if folder.exists() else set()
    assert not names or {"double_pendulum.c", "double_pendulum.h", "README.md", "main.c"} <= names
    assert process.returncode != 0 or names
    assert not list(tmp_path.glob(".kanegen-*"))


def test_an_interruption_at_some_time(tmp_path: Path) -> None:
    for number, seconds in enumerate((0.1, 0.5, 0.9)):
        interrupt(tmp_path, number, seconds)


@pytest.mark.slow
def test_an_interruption_at_any_time(tmp_path: Path) -> None:
    rng = random.Random(13)
    for number in range(200):
        interrupt(tmp_path, number, rng.uniform(0.0, 1.5))
