"""Installs what tests of embedding need, and runs them: all, or those of some targets.

python -m tests.embedding [TARGET ...]
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest

from tests.embedding.conftest import needs
from tests.support.paths import ROOT
from tests.support.tools import TOOLS, Package, Program

FOLDER = Path(__file__).parent


def files() -> dict[str, Path]:
    """Return the file of tests of every target, by the name of the target on the command line."""
    found = {path.stem.removeprefix("test_"): path for path in sorted(FOLDER.glob("test_*.py"))}
    return {name.replace("_", "-"): path for name, path in found.items() if name != "frame"}


class _Needs:
    """A plugin of pytest that keeps the names of the tools of all collected tests."""

    def __init__(self) -> None:
        self.names: set[str] = set()

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        for item in items:
            self.names.update(needs(item))


def tools_of(paths: Iterable[Path]) -> list[Program | Package]:
    """Return the tools that the tests in some files need.

    Raises:
        SystemExit: If the tests cannot be collected.
    """
    plugin, printed = _Needs(), io.StringIO()
    arguments = ["--collect-only", "-q", "-m", "", "-p", "no:cacheprovider", *map(str, paths)]
    with contextlib.redirect_stdout(printed):
        status = pytest.main(arguments, [plugin])
    if status != pytest.ExitCode.OK:
        sys.exit(printed.getvalue())
    return [TOOLS[name] for name in sorted(plugin.names)]


def install(tools: Iterable[Program | Package]) -> None:
    """Install the tools that are missing: packages of Python here, programs where this is root.

    Raises:
        SystemExit: If a program is missing that only the administrator can install, or an installer fails.
    """
    absent = [tool for tool in tools if tool.is_missing()]
    extras = sorted({tool.extra for tool in absent if isinstance(tool, Package)})
    debian = sorted({name for tool in absent if isinstance(tool, Program) for name in tool.debian})
    if debian:
        line = f"apt-get install -y --no-install-recommends {' '.join(debian)}"
        if os.geteuid() != 0 or shutil.which("apt-get") is None:
            names = ", ".join(tool.command for tool in absent if isinstance(tool, Program))
            sys.exit(f"missing: {names}. On Debian and Ubuntu: sudo {line}")
        _call("apt-get", "update", "-qq")
        _call(*line.split())
    if extras:
        _call(sys.executable, "-m", "pip", "install", "--quiet", "--editable", f".[{','.join(extras)}]")


def _call(*command: str) -> None:
    """Run a command in the checkout.

    Raises:
        SystemExit: If it fails.
    """
    status = subprocess.run(command, cwd=ROOT, check=False).returncode
    if status != 0:
        sys.exit(status)


def main() -> None:
    """Install tools, print their versions, and run the tests."""
    found = files()
    summary = (__doc__ or "").splitlines()[0]
    parser = argparse.ArgumentParser(prog="python -m tests.embedding", description=summary)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=", ".join(found))
    named = parser.parse_args().targets or list(found)
    unknown = [name for name in named if name not in found]
    if unknown:
        parser.error(f"no target {', '.join(unknown)}. There are {', '.join(found)}.")
    paths = [found[name] for name in named]
    tools = tools_of(paths)
    install(tools)
    _call(sys.executable, "-c", _DESCRIBE, *_names(tools))
    _call(sys.executable, "-m", "pytest", "-m", "", *map(str, paths))


_DESCRIBE = """
import sys

from tests.support.tools import TOOLS
for name in sys.argv[1:]:
    print("with", TOOLS[name].describe())
"""
"""Prints versions in a new process: this one may have looked for a package before it was installed."""


def _names(tools: Iterable[Program | Package]) -> list[str]:
    return [tool.command if isinstance(tool, Program) else tool.module for tool in tools]


if __name__ == "__main__":
    main()
