"""Every numbered equation and every displayed row of the notes is found by its number."""

from __future__ import annotations

import re

import pytest

import kanegen as kg
from kanegen.errors import ModelError, OptionError
from kanegen.symbolic import derive
from kanegen.symbolic.printing.formats import FORMATS, ONLY, render
from kanegen.symbolic.printing.linear_model import render_linear_model
from tests.support import prescribed_trees
from tests.support.paths import MODELS, ROOT
from tests.support.random_trees import everything
from tests.support.rows_of_the_notes import (
    ANGULAR,
    ANGULAR_RATE,
    CENTER,
    ORIGIN,
    POSITIONS,
    VELOCITY_G8,
    VELOCITY_O8,
)

EIGHT = derive(kg.load(MODELS / "eight_body.toml").symbolic())
ROWS = render(EIGHT, only="blocks")

LAST = 45
"""Number of the last equation of the notes."""

OF_VECTORS = {2, 10, 12, 13, 14, 18, 21, 24, 26, 31, 36, 38}
"""Equations about vectors, and derivations of others, which stand in the document."""

OF_STATE = {1}
"""Equations that stand in the section on coordinates and speeds."""

ANGULAR_VELOCITIES = [
    "{ω'_1} = {ω̂'_1}  (11)",
    "{ω'_2} = [^1R_2]{ω'_1} + {ω̂'_2}  (11)",
    "{ω'_3} = [^2R_3]{ω'_2} + {ω̂'_3}  (11)",
    "{ω'_4} = [^2R_4]{ω'_2} + {ω̂'_4}  (11)",
    "{ω'_5} = [^1R_5]{ω'_1} + {ω̂'_5}  (11)",
    "{ω'_6} = [^1R_6]{ω'_1} + {ω̂'_6}  (11)",
    "{ω'_7} = [^1R_7]{ω'_1} + {ω̂'_7}  (11)",
    "{ω'_8} = [^7R_8]{ω'_7} + {ω̂'_8}  (11)",
]
"""The rows of Eq. (11) that the notes display; the labels of bodies 4 and 5 are swapped there."""

BY_LOWER_BODY = [
    "[R_8] = [^7R_8][R_7]  (3), (5)\n      = [^7R_8][^1R_7][R_1]",
    "[Ṙ_8] = [ω̃'_8]^T[R_8]  (6)",
    "[^7Ṙ_8] = [^7ω̃'_8]^T[^7R_8]  (7)",
    "{ω̂'_8} = [P̂_8]{θ̂̇_8}  (8)",
    "      = [^7R_8]([^1R_7]{ω̂'_1} + {ω̂'_7}) + {ω̂'_8}",
    "[ω'_8,y1] = [^7R_8][ω'_7,y1] + [ω̂'_8,y1]  (12)-(15)",
    "[ω̂'_8,y1] = [[0], [0], [0], [0], [0], [0], [0], [P̂_8]]  (16)",
    "{ω'_8} = [ω'_8,y1]{y_1}  (18), (19)",
    "[ω̇'_8,y1] = [^7R_8][ω̇'_7,y1] + [^7ω̃'_8]^T[^7R_8][ω'_7,y1] + [ω̂̇'_8,y1]  (20)",
    "{α'_8} = {ω̇'_8}  above (20)\n      = [ω'_8,y1]{ẏ_1} + [ω̇'_8,y1]{y_1}",  # noqa: RUF001 - alpha
    "{p'_O8} = [^7R_8]({p'_O7} + {q'_8} + {s'_8})  (21), (22)",
    "{p'_G8} = {p'_O8} + {r'_8}  (23)",
    "{v'_O8} = [^1R_7]{v'_O7} + {ṡ'_8} + [ω̃'_7]({q'_8} + {s'_8})  (24), (25)",
    "{v'_G8} = [^7R_8]{v'_O8} + [ω̃'_8]{r'_8}  (26), (27)",
    "[v'_O8,y] = [^1R_7][v'_O7,y] - ([q̃'_8]+[s̃'_8])[ω'_7,y] + [^7v'_O8,y]  (28)",
    "[^7v'_O8,y] = [[0]_{3x24}, [0], [0], [0], [0], [0], [0], [0], [I]]  (29), (30)",
    "[v'_G8,y] = [^7R_8][v'_O8,y] - [r̃'_8][ω'_8,y]  (31), (32)",
    "      = [v'_G8,y]{ẏ} + [v̇'_G8,y]{y} + [ω̃'_8]{v'_G8}",
    "[v̇'_G8,y] = [^7R_8][v̇'_O8,y] + [^7ω̃'_8]^T[^7R_8][v'_O8,y] - [r̃'_8][ω̇'_8,y]  (34)",
    "[v̇'_O8,y] = [^1R_7][v̇'_O7,y] + [^1ω̃'_7]^T[^1R_7][v'_O7,y] - [ṡ̃'_8][ω'_7,y]"
    " - ([q̃'_8]+[s̃'_8])[ω̇'_7,y]  (35)",
    "[A]{ẏ} = {f}  (38), (42)",
    "      = Σ_K (m_K[v'_GK,y]^T[v'_GK,y] + [ω'_K,y]^T[I'_GK][ω'_K,y])",
    "      - Σ_K m_K[v'_GK,y]^T[v̇'_GK,y]{y}",
    "      - Σ_K m_K[v'_GK,y]^T[ω̃'_K]{v'_GK}",
    "      - Σ_K [ω'_K,y]^T[I'_GK][ω̇'_K,y]{y}",
    "      - Σ_K [ω'_K,y]^T[ω̃'_K][I'_GK]{ω'_K}",
    "{ẋ} = {y}  (1), (45)",
]
"""General equations of the notes for body 8, and for the system."""


def numbers(text: str) -> set[int]:
    """The numbers of equations in a text: (11), (43) and all of (12)-(15)."""
    found: set[int] = set()
    for first, last in re.findall(r"\((\d+)\)(?:-\((\d+)\))?", text):
        found |= set(range(int(first), int(last or first) + 1))
    return found


def test_every_equation_is_found_by_its_number() -> None:
    document = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
    vectors = document.partition("## Vector forms")[2].partition("\n## ")[0]
    assert numbers("".join(line.split("|")[1] for line in vectors.splitlines() if "|" in line)) >= OF_VECTORS
    in_blocks = set(range(1, LAST + 1)) - OF_VECTORS - OF_STATE
    assert numbers(ROWS) >= in_blocks
    for form in ("markdown", "latex"):
        tags = "".join(re.findall(r"\\tag\*\{([^{}]*)\}", render(EIGHT, form, only="blocks")))
        assert numbers(tags) >= in_blocks
    assert "Coordinates and speeds. Eq. (1)." in render(EIGHT, only="definitions", closed=None)


@pytest.mark.parametrize("row", ANGULAR_VELOCITIES + BY_LOWER_BODY)
def test_rows_by_the_lower_body(row: str) -> None:
    assert row in ROWS


def test_rows_that_are_written_out() -> None:
    rows = [*ANGULAR.values(), *POSITIONS.values(), VELOCITY_O8, VELOCITY_G8]
    rows += [line for lines in (ANGULAR_RATE, ORIGIN, CENTER) for body in lines.values() for line in body]
    for row in rows:
        assert row in ROWS
    assert (
        "[P̂_8] =  (17)\n      [C_8_2*C_8_3, S_8_3, 0]\n      [-C_8_2*S_8_3, C_8_3, 0]\n      [S_8_2, 0, 1]\n"
    ) in ROWS


def test_one_body_and_one_part() -> None:
    three = render(EIGHT, only="blocks", body=3)
    assert three == render(EIGHT, only="blocks", body="body3") == render(EIGHT, only="blocks", body="3")
    assert "[A_3] = " in three
    assert "[A_2] = " not in three
    assert len(three.splitlines()) < 120
    definitions = render(EIGHT, only="definitions", body=3)
    assert "Body 3: angular velocity, Eq. (11)." in definitions
    assert "Body 2:" not in definitions
    rows = {int(row) for row in re.findall(r"A\[(\d+),", definitions)}
    assert rows == {7, 8, 9, 31, 32, 33}  # places of theta and s of body 3 in {y}
    arm = derive(kg.load(MODELS / "scara.toml"))
    whole, quill = render(arm, only="closed"), render(arm, only="closed", body="quill")
    assert quill.splitlines()[-1] in whole
    assert "f[1]" not in quill


@pytest.mark.parametrize("form", ["text", "markdown", "latex"])
@pytest.mark.parametrize("only", sorted(ONLY.keys() - {"linear"}))
def test_every_part_in_every_format(form: str, only: str) -> None:
    arm = derive(kg.load(MODELS / "gantry_crane.toml"))
    whole = render(arm, form, only=only)
    assert ("blocks" in whole) == (only == "blocks")
    assert render(arm, form, only=only, body=1) != whole
    assert set(FORMATS) == {"text", "markdown", "latex", "python"}


@pytest.mark.parametrize("seed", range(8))
def test_blocks_of_trees_of_every_kind_are_printed(seed: int) -> None:
    """Quaternions, hinges, turned frames, welds, couplings, motors and prescribed freedoms."""
    kinds = sorted(prescribed_trees.KINDS)
    for system in (everything(seed), prescribed_trees.tree(kinds[seed % len(kinds)], seed)):
        rows = render(derive(system), only="blocks")
        assert "{f_2}" in rows
        assert ("{ω'_t,K}" in rows) == bool(system.prescribed)


@pytest.mark.parametrize("form", ["text", "markdown", "latex", "python"])
def test_linear_model(form: str) -> None:
    pole = derive(kg.load(MODELS / "cart_pole.toml"))
    assert render(pole, form, only="linear") == render_linear_model(pole.linearize(), form)
    with pytest.raises(OptionError, match="a linear model is one of the whole system"):
        render(pole, form, only="linear", body=1)


def test_errors() -> None:
    with pytest.raises(OptionError, match=r"unknown part 'block'. Did you mean 'blocks'\?"):
        render(EIGHT, only="block")
    with pytest.raises(OptionError, match=r"no Python of the rows of \[A\] and \{f\} of one body"):
        render(EIGHT, "python", body=2)
    with pytest.raises(ModelError, match="no body or frame 'nobody'"):
        render(EIGHT, body="nobody")
    with pytest.raises(ModelError, match="has no equations of its own"):
        render(EIGHT, body="ground")
    with pytest.raises(OptionError, match="has 48 freedoms; closed forms are written for at most 8"):
        render(EIGHT, only="closed")
