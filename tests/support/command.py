"""The command line as tests call it: within the test's process, or as a process of its own."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import warnings
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from unittest import mock

from kanegen.cli import terminal
from kanegen.cli.app import main

WIDTH = 200
"""Columns of the terminal, so that no line of a table is broken, unless a test says otherwise."""


@dataclass(frozen=True)
class Finished:
    """What a command printed, and its exit status."""

    stdout: str
    stderr: str
    returncode: int


def kanegen(*arguments: str, status: int = 0, **environment: str) -> Finished:
    """Run `kanegen` with `arguments` within this process, and require its exit status.

    Starting Python and importing SymPy takes most of the time of a command. What depends on the process, such
    as encodings and imports, needs `process`.
    """
    columns = int(environment.get("COLUMNS", WIDTH))
    out, err, code = io.StringIO(), io.StringIO(), 0
    with (
        mock.patch.dict(os.environ, {"COLUMNS": str(columns), "NO_COLOR": "1", **environment}),
        mock.patch.object(sys, "argv", ["kanegen", *arguments]),
        mock.patch.object(terminal.screen, "_width", columns),
        mock.patch.object(terminal.errors, "_width", columns),
        warnings.catch_warnings(),
        redirect_stdout(out),
        redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else int(ended.code is not None)
    return _required(Finished(out.getvalue(), err.getvalue(), code), status)


def process(*arguments: str, status: int = 0, **environment: str) -> Finished:
    """Run `kanegen` with `arguments` as a process of its own, and require its exit status."""
    done = subprocess.run(
        [sys.executable, "-m", "kanegen", *arguments],
        capture_output=True,
        text=True,
        env={**os.environ, "COLUMNS": str(WIDTH), "NO_COLOR": "1", **environment},
        check=False,
    )
    return _required(Finished(done.stdout, done.stderr, done.returncode), status)


def _required(done: Finished, status: int) -> Finished:
    assert done.returncode == status, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    return done
