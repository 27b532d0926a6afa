"""The wheel holds the whole package and works where nothing else of the checkout is."""

import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile

import pytest

from kanegen import __version__
from tests.support.paths import ROOT

GENERATE = """
import pathlib, sys, kanegen as kg
assert pathlib.Path(kg.__file__).is_relative_to(sys.prefix), kg.__file__
system = kg.System.from_arrays([0], [2.0], [[[1, 0, 0], [0, 1, 0], [0, 0, 1]]], [[0.5, 0, 0]], [[0, 0, 0]])
kg.generate(system).write("out")
"""


def run(*command, folder):
    result = subprocess.run(
        list(map(str, command)),
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout
    return result.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """A wheel built from a copy of the files that belong into one."""
    copy = tmp_path_factory.mktemp("wheel")
    for name in ("kanegen", "templates"):
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    output = run(
        sys.executable, "-c", "from setuptools import build_meta as b; b.build_wheel('dist')", folder=copy
    )
    assert "would be ignored" not in output, output
    (path,) = (copy / "dist").glob("*.whl")
    return path


def test_the_wheel_holds_exactly_the_tree(wheel):
    with zipfile.ZipFile(wheel) as file:
        members = {name for name in file.namelist() if ".dist-info/" not in name}
    tree = {str(path.relative_to(ROOT)) for path in (ROOT / "kanegen").rglob("*.py")}
    templates = {
        f"kanegen/templates/{path.relative_to(ROOT / 'templates')}"
        for path in (ROOT / "templates").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    drivers = {
        str(path.relative_to(ROOT))
        for path in (ROOT / "kanegen" / "studies" / "bench" / "drivers").iterdir()
        if path.suffix in {".c", ".cpp", ".h"}
    }
    assert members == tree | templates | drivers | {"kanegen/py.typed"}
    assert {"kanegen/templates/c99/model.c.jinja", "kanegen/studies/bench/drivers/kanegen.c"} <= members


def test_the_installed_wheel_generates(wheel, tmp_path):
    """In an environment with nothing but the wheel and what it depends on."""
    environment = tmp_path / "environment"
    venv.create(environment)
    python = environment / "bin" / "python"
    run(
        sys.executable,
        "-m",
        "pip",
        "--python",
        python,
        "install",
        "--no-deps",
        "--no-index",
        wheel,
        folder=tmp_path,
    )
    (site,) = environment.glob("lib/python*/site-packages")
    (site / "dependencies.pth").write_text(sysconfig.get_path("purelib"))

    run(python, "-c", GENERATE, folder=tmp_path)
    made = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"system.h", "system.c", "README.md"} <= made
    assert run(environment / "bin" / "kanegen", "--version", folder=tmp_path) == f"kanegen {__version__}\n"
