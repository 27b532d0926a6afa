"""The README does what it says: its commands succeed, its Python runs, its C compiles and links."""

from __future__ import annotations

import pydoc
import re
import sys
from pathlib import Path

import pytest

import kanegen as kg
from kanegen.library.native import compilers
from kanegen.recursion.outputs import OUTPUTS
from tests.support.pages import blocks, copy_of_checkout, run
from tests.support.paths import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")

COMMANDS = [line for text in blocks(ROOT / "README.md", "") for line in text.splitlines()]


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A folder with the examples and the models, where commands may write."""
    return copy_of_checkout(tmp_path)


def test_commands_and_c_of_the_readme(checkout: Path) -> None:
    commands = [line.partition("#")[0].split() for line in COMMANDS if line.startswith("kanegen ")]
    assert len(commands) == 5
    for _, *arguments in commands:
        assert run([sys.executable, "-m", "kanegen", *arguments], checkout)
    (code,) = blocks(ROOT / "README.md", "c")
    include, *statements = code.strip().splitlines()
    program = [include, "int main(void)", "{", "double x[3] = {0, 0.5, -0.3}, y[3] = {0};", *statements]
    folder = checkout / "build" / "arm"
    (folder / "use.c").write_text("\n".join([*program, "return !(A[0] > 0.5 && f[1] > 0);", "}", ""]))
    run([*compilers.find().command, "use.c", "arm.c", "-o", "use", "-lm"], folder)
    run(["./use"], folder)


def test_python_of_the_readme(checkout: Path) -> None:
    (code,) = blocks(ROOT / "README.md", "python")
    printed = run([sys.executable, "-c", code], checkout)
    assert printed.startswith("('column_joint', 'shoulder_joint', 'elbow_joint')\narm: passed over 1000")


def test_help_that_the_readme_names_exists_and_has_the_methods_of_systems() -> None:
    names = re.findall(r"`help\(kg\.(\w+)\)`", README)
    assert "System" in names
    for name in names:
        text = pydoc.plaintext.document(getattr(kg, name))
        assert "Example:" in text
        if name == "System":
            assert all(method in text for method in ("with_frames(", "with_poses(", "with_locked("))


def test_make_targets_of_the_readme() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = re.findall(r"make ([\w-]+)", README)
    assert {"demo", "test"} <= {*targets}
    assert all(re.search(rf"^{target}:", makefile, flags=re.MULTILINE) for target in targets)


def test_the_page_of_outputs_has_every_output() -> None:
    page = (ROOT / "docs" / "outputs.md").read_text(encoding="utf-8")
    table = page.split("## All outputs")[1]
    assert re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE) == list(OUTPUTS)
