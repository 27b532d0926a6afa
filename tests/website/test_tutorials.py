"""The tutorials do what they say: every command and every program runs, and prints what the page shows."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.paths import ROOT

FOLDER = ROOT / "docs" / "tutorials"
PAGES = sorted(page for page in FOLDER.glob("*.md") if page.name != "index.md")
ELSEWHERE = ("tradeoff", "make ", "source ")
"""Commands that set up the machine, or take a minute; other tests run them."""


def _blocks(page: Path) -> list[tuple[str, str, str]]:
    """Return the language, the text and the line before each fenced block."""
    text = page.read_text(encoding="utf-8")
    fences = re.findall(r"([^\n]*)\n+```(\w+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return [(language, body, before) for before, language, body in fences]


def _require_shown(shown: list[str], printed: str) -> None:
    """Make sure that all lines of a page were printed, those with an ellipsis up to it."""
    lines = [line.rstrip() for line in printed.splitlines()]
    for line in shown:
        start, dots, _ = line.partition("...")
        found = any(one.startswith(start) for one in lines) if dots else line.rstrip() in lines
        assert found, f"{line!r} is not in\n{printed}"


def _run(command: list[str] | str, folder: Path) -> str:
    """Run a command in a folder, with kanegen on the path; a status other than 0 fails the test."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT), "COLUMNS": "120"},
        shell=isinstance(command, str),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}"
    return done.stdout


def _run_console(body: str, folder: Path) -> None:
    for part in re.split(r"^\$ ", body, flags=re.MULTILINE)[1:]:
        command, *shown = part.splitlines()
        if not any(word in command for word in ELSEWHERE):
            _require_shown(shown, _run(command, folder))


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A folder with the examples and the models, where commands may write."""
    for name in ("examples", "models"):
        shutil.copytree(ROOT / name, tmp_path / name)
    (tmp_path / "build").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=() if page.stem == "embed" else pytest.mark.slow, id=page.stem)
        for page in PAGES
    ],
)
def test_a_tutorial_does_what_it_says(page: Path, checkout: Path) -> None:
    code, printed = "", []
    for language, body, before in _blocks(page):
        if language == "console":
            _run_console(body, checkout)
        elif language == "python":
            code += body
        elif language == "text":
            printed += body.splitlines()
        elif language == "c":
            (name,) = re.findall(r"as `(\w+\.c)`", before)
            (checkout / name).write_text(body, encoding="utf-8")
    if code:
        _require_shown(printed, _run([sys.executable, "-c", code], checkout))
