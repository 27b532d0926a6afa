"""The LaTeX of documents: read by a strict parser, and compiled by LaTeX itself, without overfull boxes."""

from __future__ import annotations

import re
import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest
from matplotlib.mathtext import MathTextParser

import kanegen as kg
from kanegen.symbolic import derive, notation
from kanegen.symbolic.printing.formats import render
from kanegen.symbolic.printing.prose import prose
from tests.support.cases import slow_among
from tests.support.paths import MODELS
from tests.support.random_trees import everything

NAMES = ("double_pendulum", "gantry_crane", "furuta_pendulum", "six_revolute_arm", "satellite", "eight_body")

WIDE = ("eight_body", "six_revolute_arm", "furuta_pendulum", "scara")
"""Models with many blocks, with long sums, with long names, and with long products of sums."""


@cache
def document(name: str, symbolic: bool = False) -> str:
    """The document on a model in LaTeX."""
    system = kg.load(MODELS / f"{name}.toml")
    return render(derive(system.symbolic() if symbolic else system), "latex")


def formulas(text: str) -> list[str]:
    """The cells of all formulas in a document, but for numbers of equations and borders of matrices."""
    text = re.sub(r"\\tag\*\{[^{}]*\}", "", text)
    text = re.sub(r"\\(begin|end)\{bmatrix\}", "", text)
    blocks = re.findall(r"\\begin\{align\*\}\n(.*?)\n\\end\{align\*\}", text, re.DOTALL)
    cells = [cell for block in blocks for row in re.split(r"\\\\\s", block) for cell in row.split("&")]
    return [cell.strip() for cell in cells if cell.strip()] + re.findall(r"\$([^$]+)\$", text)


def parse(formula: str) -> None:
    """Let Matplotlib read a formula: a double exponent, an unknown command or an open brace is an error."""
    known = re.sub(r"\\big[lr]|\\left|\\right(?!a)", "", formula).replace(r"\allowbreak", "")
    MathTextParser("agg").parse(f"${known}$")


@pytest.mark.parametrize(
    "name", ["double_pendulum", "furuta_pendulum", pytest.param("satellite", marks=pytest.mark.slow)]
)
def test_every_formula_is_read_by_a_strict_parser(name: str) -> None:
    found = set(formulas(document(name, symbolic=True)))
    assert len(found) > 15
    for formula in found:
        parse(formula)


@pytest.mark.parametrize("name", slow_among(NAMES, "eight_body"))
def test_no_formula_can_be_read_in_two_ways(name: str) -> None:
    for text in (document(name), document(name, symbolic=True)):
        assert not re.search(r"[\d}a-z] *\{\}\^\{", text)  # an index before a letter would be a power
        assert "F^{*}" not in text  # that is Kane's generalized inertia force
        assert not re.search(r"\d \d", "".join(formulas(text)))  # two numbers would be one
        plain = re.sub(r"\\begin\{align\*\}.*?\\end\{align\*\}|\$[^$]*\$", "", text, flags=re.DOTALL)
        assert not re.search(r"ydot|xdot|\bF\\_|\bO\\_[JK]|\\\{", plain)  # sentences have formulas, too


def test_notation() -> None:
    for plain, printed in {
        "[^7R_8]": r"[{}^{7}R_{8}]",
        "[Ṗ̂_3]": r"[\dot{\hat{P}}_{3}]",
        "[ṡ̃'_3]": r"[\dot{\tilde{s}}'_{3}]",
        "{θ̂̇_K}": r"\lbrace \dot{\hat{\theta}}_{K}\rbrace ",
        "[v̇'_GK,y]^T": r"[\dot{v}'_{G_{K},y}]^{T}",
        "[0]_{3x24}": r"[0]_{3\times 24}",
        "{F_y,3}": r"\lbrace F_{y,3}\rbrace ",
        "Σ_K {f_K}": r"\sum_{K} \lbrace f_{K}\rbrace ",
        "{ω'_t,3}": r"\lbrace \omega'_{t,3}\rbrace ",
    }.items():
        assert notation.latex(plain) == printed
        parse(printed)
    assert (
        prose("F_K_i of body K, 5 % of {ydot}") == r"$F'_{K,i}$ of body K, 5 \% of $\lbrace \dot{y}\rbrace$"
    )
    assert notation.lines("a + [b, c] - d", 6) == ["a + [b,", "c] - d"]


def compiled(text: str, folder: Path) -> str:
    """The log of LaTeX after a document; an error of LaTeX is one of the test."""
    program = shutil.which("pdflatex")
    assert program, "these tests need LaTeX: apt-get install texlive-latex-base"
    (folder / "equations.tex").write_text(text, encoding="utf-8")
    command = [program, "-halt-on-error", "-interaction=nonstopmode", "equations.tex"]
    done = subprocess.run(command, cwd=folder, capture_output=True, check=False)
    log = (folder / "equations.log").read_text(encoding="latin-1")
    assert done.returncode == 0, log[-2000:]
    return log


@pytest.mark.slow
@pytest.mark.parametrize("symbolic", [False, True])
@pytest.mark.parametrize("name", WIDE)
def test_latex_compiles_without_overfull_boxes(name: str, symbolic: bool, tmp_path: Path) -> None:
    log = compiled(document(name, symbolic), tmp_path)
    assert not re.findall(r"Overfull \\hbox.*", log)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_latex_of_trees_of_every_kind_compiles(seed: int, tmp_path: Path) -> None:
    compiled(render(derive(everything(seed)), "latex"), tmp_path)
