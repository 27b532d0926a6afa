"""The frame of tests of embedding: tools that are missing are named with the line that installs them."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from benchmarks.embedding.__main__ import document, measures
from benchmarks.embedding.row import Row, in_turns, turn_of
from kanegen.measure.machine import Machine
from kanegen.measure.timing import Times
from tests.embedding.__main__ import files, install
from tests.embedding.conftest import pytest_itemcollected
from tests.support.pages import blocks, fenced
from tests.support.pages import files as saved
from tests.support.paths import ROOT
from tests.support.tools import TOOLS, Package, Program, missing


def test_a_missing_program_is_named_with_the_line_that_installs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    assert missing("cargo") == "cargo is not installed: apt-get install -y --no-install-recommends cargo"


def test_a_missing_package_is_named_with_its_extra() -> None:
    assert Package("no_such_module", "jax").is_missing()
    assert Package("no_such_module", "jax").install == "pip install 'kanegen[jax]'"


def test_tools_that_cannot_be_installed_end_with_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.geteuid", lambda: 1000)
    absent = Program("no-such-program", ("its-package",))
    line = r"^missing: no-such-program\. .*sudo apt-get install -y .* its-package$"
    with pytest.raises(SystemExit, match=line):
        install([absent])


TEST = """
import pytest

@pytest.mark.embed("cargo")
def test_of_a_tool():
    pass
"""


def test_a_test_fails_without_its_tool(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text("from tests.embedding.conftest import *\n")
    (tmp_path / "test_one.py").write_text(TEST)
    command = [sys.executable, "-m", "pytest", "-q", "-m", "", "-c", ROOT / "pyproject.toml", tmp_path]
    done = subprocess.run(
        [*map(str, command), "-p", "no:cacheprovider"],
        check=False,
        cwd=ROOT,
        env={"PATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1 and "cargo is not installed: apt-get install" in done.stdout


def test_a_tool_that_nobody_can_install_is_refused(request: pytest.FixtureRequest) -> None:
    request.node.add_marker(pytest.mark.embed("carg"))
    with pytest.raises(pytest.UsageError, match=r"no such tool in tests/support/tools\.py: carg"):
        pytest_itemcollected(request.node)


def test_every_target_of_the_index_has_tests() -> None:
    text = (ROOT / "docs" / "embedding.md").read_text(encoding="utf-8")
    targets = re.findall(r"`make embed-([a-z-]+)`", text)
    assert len(targets) == len(set(targets))
    assert files().keys() == set(targets)


def test_the_code_of_every_page_is_run() -> None:
    tests = "".join(path.read_text(encoding="utf-8") for path in files().values())
    for page in (ROOT / "docs" / "embedding").glob("*.md"):
        assert not fenced(page) or f'"embedding/{page.stem}"' in tests, page.name


def test_every_package_is_in_an_extra() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for tool in TOOLS.values():
        if isinstance(tool, Package):
            needed = project["optional-dependencies"][tool.extra]
            assert any(line.startswith(tool.distribution or tool.module) for line in needed), tool


def test_versions_of_tools_are_printed() -> None:
    assert re.match(r"numpy: \d", Package("numpy", "").describe())
    assert re.search(r"\d\.\d", Program("gcc", ("gcc",)).describe())
    assert all(name == getattr(tool, "command", getattr(tool, "module", "")) for name, tool in TOOLS.items())


def test_call_times_have_a_row_for_each_call() -> None:
    row = Row("a program", "a call", *in_turns(lambda: 10.0, lambda: 35.0, rounds=3), "program 1.0")
    assert row.beyond == 25.0
    text = document([row], ["another, because it is missing"], Machine.here())
    assert "| a program | a call | 10.0 | 35.0 | 25.0 |" in text
    assert "Left out: another" in text and "- program 1.0" in text
    assert Row("a", "b", Times((1.0, 9.0, 1.0)), Times((5.0, 9.0, 4.0)), "").beyond == 3.0
    assert turn_of(lambda: None, seconds=1e-4) > 0.0
    assert all(callable(measure) for measure in measures().values())


def test_blocks_of_a_page_are_found_by_language_and_by_file(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "# A\n\n```cpp title\nint a;\n```\n\n<!-- file: src/main.c -->\n\n```c\nint b;\n```\n\n"
        "````text\n```c\n```\n````\n```\nplain\n```\n"
    )
    assert saved(page) == {"src/main.c": "int b;\n"}
    assert blocks(page, "cpp") == ["int a;\n"]
    assert blocks(page, "c") == ["int b;\n"]
    assert blocks(page, "text") == ["```c\n```\n"]
    assert blocks(page, "") == ["plain\n"]
