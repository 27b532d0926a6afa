"""The picture of a tree: a row for each body, and lines that follow the connection array."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import kanegen as kg
from kanegen.pictures.tree import STEP, Mark, Node, tree_svg
from tests.support.paths import MODELS

SVG = "{http://www.w3.org/2000/svg}"


def drawn(
    svg: str,
) -> tuple[dict[int, tuple[float, float]], list[tuple[tuple[float, float], tuple[float, float]]]]:
    """Return where the label of each body stands, by its number, and where each line begins and ends."""
    root = ElementTree.fromstring(svg)
    labels, lines = {}, []
    for text in root.iter(f"{SVG}text"):
        if text.get("font-weight"):
            words = "".join(text.itertext()).split()
            number = int(words[0]) if words[0].isdecimal() else 0
            labels[number] = (float(text.get("x", 0)), float(text.get("y", 0)))
    for path in root.iter(f"{SVG}path"):
        if path.get("stroke-width") == "1.5":
            d = path.get("d", "")
            x, y = map(int, re.findall(r"^M(\d+) (\d+)", d)[0])
            if bend := re.search(r"V(\d+)q0 8 8 8H(\d+)$", d):
                lines.append(((x, y), (int(bend[2]) + 6, int(bend[1]) + 8)))
            else:
                lines.append(((x, y), (x, int(d.rpartition("V")[2]) + 6)))
    return labels, lines


def connected(svg: str) -> dict[int, int]:
    """Return the lower body of each body, as the lines of the picture say it."""
    labels, lines = drawn(svg)
    at = {(x - 12, y - 4): number for number, (x, y) in labels.items()}
    found = {}
    for (x, y), end in lines:
        start = min(
            (place for place in at if place[0] == x and place[1] <= y), key=lambda place: y - place[1]
        )
        found[at[end]] = at[start]
    return found


@pytest.mark.parametrize("seed", range(5))
def test_lines_follow_the_connection(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = 30
    connection = [int(rng.integers(max(0, k - 4), k + 1)) for k in range(count)]
    nodes = [
        Node(lower, list(Mark)[1 + k % 6], f"body {k}", ("θ₁", "1 kg")) for k, lower in enumerate(connection)
    ]
    found = connected(tree_svg(nodes, "a random tree"))
    assert [found[k] for k in range(1, count + 1)] == connection


def test_a_chain_stays_on_one_line_and_branches_step_aside() -> None:
    labels, _ = drawn(kg.load(MODELS / "eight_body.toml").picture().svg)
    steps = {number: round((x - labels[0][0]) / STEP) for number, (x, _) in labels.items()}
    assert steps == {0: 0, 1: 0, 2: 1, 3: 2, 4: 2, 5: 1, 6: 1, 7: 1, 8: 1}
    rows = sorted(labels, key=lambda number: labels[number][1])
    assert rows == [0, 1, 2, 3, 4, 5, 6, 7, 8]


def test_the_key_has_the_marks_that_occur() -> None:
    texts = ["".join(one.itertext()) for one in _texts(kg.load(MODELS / "satellite.toml").picture().svg)]
    assert Mark.FREE.value in texts and Mark.TURNS.value in texts
    assert Mark.SLIDES.value not in texts


def test_long_names_are_cut_and_titled() -> None:
    name = "a name with far more letters than a row of the picture has room for"
    (body,) = (
        one
        for one in _texts(tree_svg([Node(0, Mark.TURNS, name)], "long"))
        if one.find(f"{SVG}title") is not None
    )
    assert body.find(f"{SVG}title").text == f"1 {name}"  # type: ignore[union-attr]
    assert len(body.find(f"{SVG}tspan").text or "") <= 32  # type: ignore[union-attr]


def test_a_picture_is_written(tmp_path: Path) -> None:
    picture = kg.load(MODELS / "double_pendulum.toml").picture()
    picture.write(tmp_path / "tree.svg")
    assert (tmp_path / "tree.svg").read_text(encoding="utf-8") == picture._repr_svg_()
    with pytest.raises(kg.WriteError):
        picture.write(tmp_path / "missing" / "tree.svg")


def _texts(svg: str) -> list[ElementTree.Element]:
    return [*ElementTree.fromstring(svg).iter(f"{SVG}text")]
