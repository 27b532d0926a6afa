"""The notebooks in docs/notebooks: their Python runs, and shows what the sentences around it say."""

import ast
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import nbformat
import numpy as np
import pytest
import sympy
from IPython.core.formatters import DisplayFormatter
from myst_nb.core.read import read_myst_markdown_notebook

from tests.support.paths import ROOT

NOTEBOOKS = ROOT / "docs" / "notebooks"


def cells(name: str) -> list[str]:
    """Return the code of a notebook, cell by cell."""
    page = NOTEBOOKS / f"{name}.md"
    notebook = read_myst_markdown_notebook(page.read_text(encoding="utf-8"))
    return [cell.source for cell in notebook.cells if cell.cell_type == "code"]


def run(name: str, monkeypatch: pytest.MonkeyPatch) -> tuple[dict[str, Any], list[dict[str, str]]]:
    """Run a notebook in this process; return its variables, and what each cell shows by kind of text."""
    monkeypatch.chdir(NOTEBOOKS)
    monkeypatch.setattr(sys, "argv", ["notebook"])
    mpl.use("Agg")
    space: dict[str, Any] = {}
    shown = []
    for source in cells(name):
        tree = ast.parse(source)
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, name, "exec"), space)
        if last is None:
            shown.append({})
            continue
        value = eval(compile(ast.Expression(last.value), name, "eval"), space)
        shown.append(DisplayFormatter().format(value)[0] if value is not None else {})
    return space, shown


@pytest.mark.slow
def test_the_eight_bodies(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    space, shown = run("eight-bodies", monkeypatch)
    assert "8 bodies, 48 freedoms" in shown[0]["text/html"]
    assert r"[{}^{2}R_{3}][{}^{1}R_{2}][\hat{P}_{1}]" in shown[2]["text/latex"]
    assert "R_2_3_11 = C_3_2*C_3_3" in capsys.readouterr().out
    assert "passed" in shown[-1]["text/html"]
    body, where = space["body"], {one.symbol: one.value for one in space["body"].definitions}
    rotation = body.relative_rotation.xreplace(where).xreplace(where)
    angles = dict(zip(sympy.symbols("theta_3_1:4", real=True), (0.3, -0.4, 0.5), strict=True))
    numbers = np.array(rotation.xreplace(angles).evalf(), float)
    assert np.allclose(numbers @ numbers.T, np.eye(3), atol=1e-15)


def test_from_a_robot_file_to_c(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    space, shown = run("robot-to-c", monkeypatch)
    assert r"\cos^{2} {\mathit{shoulder\_joint}}" in shown[1]["text/latex"]
    printed = capsys.readouterr().out
    assert "int arm_mass_matrix(const double x[3], double A[3 * 3])" in printed
    assert "return all_finite" in printed
    assert len(re.findall(r"^\d\.\d\d Hz: ", printed, flags=re.MULTILINE)) == 2
    assert not space["library"].forward_dynamics(space["x"], space["y"], tau=-space["f"]).any()
    assert "passed" in shown[-2]["text/html"]


@pytest.mark.slow
def test_speed_against_accuracy(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    space, shown = run("speed-and-accuracy", monkeypatch)
    assert "C in single precision" in shown[1]["text/html"]
    assert shown[2]["image/svg+xml"].startswith("<?xml")
    counts = dict(
        re.findall(r"^(double|single|pairs of doubles) +(\d+)$", capsys.readouterr().out, re.MULTILINE)
    )
    assert counts["double"] == counts["single"]
    assert int(counts["pairs of doubles"]) > 2 * int(counts["double"])
    assert (np.log2(space["ratio"]) > 28.9).all()  # 2^29 is the ratio of the roundoffs
    assert any("proven bounds" in cell.get("text/html", "") for cell in shown)


def test_a_passage_by_gimbal_lock(monkeypatch: pytest.MonkeyPatch) -> None:
    space, shown = run("gimbal-lock", monkeypatch)
    assert shown[2]["text/plain"] == "2*cos(theta_1_2)**2"
    errors, evaluations = space["errors"], space["evaluations"]
    rates, velocity, quaternion = space["descriptions"]
    assert max(errors[quaternion]) < 1e-12  # a step of order 4 in 1 ms, at rates of a few rad/s
    assert errors[rates][-1] == np.inf
    for name in (rates, velocity):
        assert errors[name] == sorted(errors[name])
        assert errors[name][2] > 1e4 * errors[name][0]
        assert evaluations[name] == sorted(evaluations[name])
        assert evaluations[name][0] > 3 * evaluations[quaternion][0]
    assert errors[velocity][2] < errors[rates][2] / 100
    assert len(set(evaluations[quaternion])) == 1
    for found in space["chosen"].values():
        assert max(error for error, _ in found) < 1e-9  # a tolerance of 1e-11 for a step


@pytest.mark.parametrize("page", sorted(NOTEBOOKS.glob("*.md")), ids=lambda page: page.stem)
def test_notebooks_are_text_that_jupyter_opens(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert "format_name: myst" in text.partition("\n# ")[0]
    assert "{code-cell} ipython3" in text
    code = "\n".join(cells(page.stem)).splitlines()
    assert max(map(len, code)) <= 92  # the width of a page


@pytest.mark.slow
def test_notebooks_run_in_a_kernel(tmp_path: Path) -> None:
    """Run them as `make notebooks` does: converted, then executed by nbclient."""
    folder = tmp_path / "docs" / "ipynb"
    folder.mkdir(parents=True)
    for name in ("models", "examples"):
        (tmp_path / name).symlink_to(ROOT / name)
    scripts = Path(sys.executable).parent
    for page in NOTEBOOKS.glob("*.md"):
        target = folder / f"{page.stem}.ipynb"
        subprocess.run([scripts / "mystnb-to-jupyter", page, target], check=True, capture_output=True)
        subprocess.run([scripts / "jupyter-execute", "--inplace", target], check=True, capture_output=True)
        outputs = [one for cell in nbformat.read(target, 4).cells for one in cell.get("outputs", [])]
        assert outputs and not any(one.output_type == "error" for one in outputs)
