"""Puts faults into a copy of the repository, one at a time, and runs the tests that should see them."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.mutations.faults import Fault
from tests.support.paths import ROOT

FOLDERS = ("kanegen", "templates", "tests", "models", "generated", "examples", "docs", "benchmarks")
"""Folders of the copy; `kanegen/templates` leads to the templates of the copy, not to those installed."""

COMPUTED_SECONDS = 600
"""Processor time of each process of the tests of one fault, s; a program that hangs is seen, too."""

ELAPSED_SECONDS = 6000.0
"""Time after which tests that wait without computing count as hanging, s, also on a busy machine."""


def copy(folder: Path) -> Path:
    """Copy the repository into a folder and return it."""
    ignored = shutil.ignore_patterns("__pycache__", ".*")
    for name in FOLDERS:
        shutil.copytree(ROOT / name, folder / name, ignore=ignored)
    for name in ("pyproject.toml", "README.md", "Makefile", "CONTRIBUTING.md", "CHANGELOG.md", "LICENSE"):
        shutil.copy(ROOT / name, folder)
    (folder / "kanegen" / "templates").symlink_to(folder / "templates")
    return folder


def is_seen(fault: Fault, folder: Path) -> bool:
    """Return whether a test fails, or hangs, in the copy `folder` with the fault.

    Raises:
        RuntimeError: If the tests could not be run at all.
    """
    with _in_place(fault, folder):
        return _fails(fault.tests, folder)


def require_sound(tests: Iterable[str], folder: Path) -> None:
    """Make sure that tests pass without a fault, each file within the time that the tests of a fault have.

    Raises:
        RuntimeError: If one does not.
    """
    for test in tests:
        if _fails((test,), folder):
            raise RuntimeError(f"{test}: fails without a fault.")


@contextmanager
def _in_place(fault: Fault, folder: Path) -> Iterator[None]:
    path = folder / fault.file
    whole = path.read_text(encoding="utf-8")
    path.write_text(fault.applied(whole), encoding="utf-8")
    try:
        yield
    finally:
        path.write_text(whole, encoding="utf-8")


def _fails(tests: Iterable[str], folder: Path) -> bool:
    options = ("-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", "--no-header", "--tb=no")
    limited = ("sh", "-c", f'ulimit -t {COMPUTED_SECONDS} && exec "$@"', "sh")
    command = [*limited, sys.executable, "-B", "-m", "pytest", *options, *tests]
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    environment.pop("PYTEST_XDIST_WORKER", None)
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=environment,
            timeout=ELAPSED_SECONDS,
            capture_output=True,
            text=True,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return True
    if done.returncode not in (0, 1, 2, 3, 4) and done.returncode >= 0:
        raise RuntimeError(
            f"{' '.join(command)}: status {done.returncode}\n{done.stdout[-1000:]}{done.stderr}"
        )
    return done.returncode != 0
