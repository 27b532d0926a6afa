"""The tutorials do what they say: every command and every program runs, and prints what the page shows."""

import re
import sys
from pathlib import Path

import pytest

from tests.support.pages import copy_of_checkout, fenced, require_shown, run, run_console
from tests.support.paths import ROOT

FOLDER = ROOT / "docs" / "tutorials"
PAGES = sorted(page for page in FOLDER.glob("*.md") if page.name != "index.md")
ELSEWHERE = ("tradeoff", "make ", "source ")
"""Commands that set up the machine, or take a minute; other tests run them."""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A folder with the examples and the models, where commands may write."""
    return copy_of_checkout(tmp_path)


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=() if page.stem == "embed" else pytest.mark.slow, id=page.stem)
        for page in PAGES
    ],
)
def test_a_tutorial_does_what_it_says(page: Path, checkout: Path) -> None:
    code, printed = "", []
    for block in fenced(page):
        if block.language == "console":
            run_console(block.text, checkout, ELSEWHERE)
        elif block.language == "python":
            code += block.text
        elif block.language == "text":
            printed += block.text.splitlines()
        elif block.language == "c":
            (name,) = re.findall(r"as `(\w+\.c)`", block.before)
            (checkout / name).write_text(block.text, encoding="utf-8")
    if code:
        require_shown(printed, run([sys.executable, "-c", code], checkout))
