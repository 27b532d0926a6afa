"""Blocks of code of Markdown pages: found, and run as a reader would, so that a page cannot promise too much.

A block begins with three backticks and a language. A comment before it names the file that a reader saves it
as, such as `<!-- file: main.cpp -->`; forges and the site show no comments.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.support.paths import ROOT

_BLOCK = re.compile(
    r"(?P<before>[^\n]*)\n+(?P<fence>```+)(?P<language>[^\n`]*)\n(?P<text>.*?)^(?P=fence)$", re.M | re.S
)
_FILE = re.compile(r"<!-- file: (?P<name>[\w./-]+) -->")


@dataclass(frozen=True)
class Block:
    """A fenced block of a page.

    Attributes:
        language: Language of the block, "" where none is named.
        text: Its lines, the last of which ends with a newline.
        before: Last line before the block that is not empty.
    """

    language: str
    text: str
    before: str

    @property
    def file(self) -> str:
        """Name of the file that a reader saves the block as, "" if the page names none."""
        found = _FILE.fullmatch(self.before)
        return found["name"] if found else ""


def fenced(page: Path | str) -> list[Block]:
    """Return all blocks of a page, which is a path or the name of a page in docs/ such as "embedding/cpp"."""
    path = page if isinstance(page, Path) else ROOT / "docs" / f"{page}.md"
    found = _BLOCK.finditer("\n" + path.read_text(encoding="utf-8"))
    return [Block(one["language"].partition(" ")[0], one["text"], one["before"]) for one in found]


def blocks(page: Path | str, language: str) -> list[str]:
    """Return the blocks of a page in one language, such as "python", "c", "cpp", "rust" or "console"."""
    return [block.text for block in fenced(page) if block.language == language]


def files(page: Path | str) -> dict[str, str]:
    """Return the blocks of a page that a reader saves, by the names of their files."""
    return {block.file: block.text for block in fenced(page) if block.file}


def copy_of_checkout(folder: Path) -> Path:
    """Copy examples and models into a folder, where commands of a page may write, and return it."""
    for name in ("examples", "models"):
        shutil.copytree(ROOT / name, folder / name)
    (folder / "build").mkdir()
    return folder


def run(command: Sequence[str] | str, folder: Path) -> str:
    """Run a command in a folder, with kanegen on the path, and return what it prints; a string needs a shell.

    Raises:
        AssertionError: If its status is not 0.
    """
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


def run_console(text: str, folder: Path, without: Sequence[str] = ()) -> None:
    """Run the commands of a block, lines that begin with "$ ", and compare what they print with the block.

    Args:
        text: The block.
        folder: Where the commands run.
        without: Words; a command with one of them does not run.

    Raises:
        AssertionError: If a command fails, or does not print a line that the block shows.
    """
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, *shown = part.splitlines()
        if not any(word in command for word in without):
            require_shown(shown, run(command, folder))


def require_shown(shown: Sequence[str], printed: str) -> None:
    """Make sure that all lines of a page were printed, those with an ellipsis up to it.

    Raises:
        AssertionError: If one was not.
    """
    lines = [line.rstrip() for line in printed.splitlines()]
    for line in shown:
        start, dots, _ = line.partition("...")
        found = any(one.startswith(start) for one in lines) if dots else line.rstrip() in lines
        assert found, f"{line!r} is not in\n{printed}"
