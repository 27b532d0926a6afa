"""The tree of a system as SVG: a row for each body, with the kind of its joint and what moves.

Bodies on each other in a chain stand on one line; where several bodies have the same lower body, each has a
line of its own, one step to the right. So a long arm does not drift away, and a hand keeps its fingers apart.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum

from markupsafe import Markup

ROW = 24
"""Height of a row in pixels."""

STEP = 22
"""Distance of two lines side by side in pixels."""

FONT = 13
"""Height of the letters in pixels."""

MARK = 6
"""Half the size of the mark of a joint in pixels."""

LONGEST = 32
"""Number of letters after which a text is cut; its title has all of it."""

_BLUE, _ORANGE, _PURPLE, _GREY = "#2a78d6", "#d9730d", "#8b5cf6", "#888888"


class Mark(Enum):
    """Kinds of joints, by what moves, in the words of the key below the picture."""

    GROUND = "ground"
    WELDED = "fixed"
    TURNS = "turns about one axis"
    SLIDES = "slides along one axis"
    BALL = "turns about three axes"
    FREE = "moves in all six freedoms"
    SEVERAL = "several freedoms"


_SHAPES = {
    Mark.GROUND: '<path d="M{l} {y}H{r}M{l} {b}l4 -6M{x} {b}l4 -6M{r} {b}l4 -6" stroke="currentColor"/>',
    Mark.WELDED: '<path d="M{l} {t}L{r} {b}M{l} {b}L{r} {t}" stroke="currentColor" stroke-width="2"/>',
    Mark.TURNS: f'<circle cx="{{x}}" cy="{{y}}" r="{MARK}" stroke="{_BLUE}" stroke-width="2.5"/>',
    Mark.SLIDES: f'<rect x="{{l}}" y="{{t}}" width="{2 * MARK}" height="{2 * MARK}" '
    f'stroke="{_ORANGE}" stroke-width="2.5"/>',
    Mark.BALL: f'<circle cx="{{x}}" cy="{{y}}" r="{MARK}" stroke="{_PURPLE}" stroke-width="2.5"/>'
    f'<circle cx="{{x}}" cy="{{y}}" r="2.5" fill="{_PURPLE}"/>',
    Mark.FREE: f'<circle cx="{{x}}" cy="{{y}}" r="{MARK}" stroke="{_GREY}" stroke-width="2" '
    'stroke-dasharray="3 2"/>',
    Mark.SEVERAL: f'<path d="M{{x}} {{t}}L{{r}} {{y}}L{{x}} {{b}}L{{l}} {{y}}Z" stroke="{_PURPLE}" '
    'stroke-width="2.5"/>',
}
"""The SVG of each mark, around the point x, y, from l to r and from t to b."""


@dataclass(frozen=True)
class Node:
    """A body of the tree.

    Attributes:
        lower: Number of its lower body, 0 for the ground; always less than its own.
        mark: What its joint does.
        name: Its name.
        cells: Further texts, a column for each.
    """

    lower: int
    mark: Mark
    name: str
    cells: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Row:
    """A body at its place: number, line from the left, row from the top."""

    number: int
    line: int
    row: int

    @property
    def x(self) -> int:
        return 14 + STEP * self.line

    @property
    def y(self) -> int:
        return ROW // 2 + 4 + ROW * self.row


def tree_svg(nodes: Sequence[Node], title: str, most: int | None = None) -> str:
    """Return the picture of a tree.

    Args:
        nodes: The bodies in order; body K is `nodes[K - 1]`, below which is body `nodes[K - 1].lower`.
        title: What the picture shows, for those who cannot see it.
        most: Number of bodies that are drawn; by default all of them.
    """
    rows = [*_placed(nodes)][: None if most is None else most + 1]
    places = {row.number: row for row in rows}
    labels = [_label(row.number, nodes) for row in rows]
    starts = [row.x + 2 * MARK for row in rows]
    second = max(start + _width(label) for start, label in zip(starts, labels, strict=True)) + 2 * FONT
    columns = _columns([nodes[row.number - 1] for row in rows if row.number], second)
    lines = [_link(places[nodes[row.number - 1].lower], row, nodes) for row in rows if row.number]
    for row, label, start in zip(rows, labels, starts, strict=True):
        node = nodes[row.number - 1] if row.number else Node(0, Mark.GROUND, "ground")
        lines += [_mark(node.mark, row.x, row.y), _text(start, row.y, label, bold=True)]
        lines += [_text(x, row.y, cell) for x, cell in zip(columns, node.cells, strict=False)]
    used = list(dict.fromkeys(nodes[row.number - 1].mark for row in rows if row.number))
    bottom = rows[-1].y + ROW + 6
    key, key_end = _key(used, bottom)
    width = max(key_end, columns[-1] if columns else second)
    whole = Markup(
        '<svg xmlns="http://www.w3.org/2000/svg" role="img" width="{w}" height="{h}" viewBox="0 0 {w} {h}" '
        'style="max-width: 100%; height: auto" font-family="system-ui, sans-serif" font-size="{f}" '
        'fill="none">\n<title>{title}</title>\n{lines}\n</svg>\n'
    )
    return str(
        whole.format(
            w=round(width), h=bottom + ROW // 2, f=FONT, title=title, lines=Markup("\n").join([*lines, *key])
        )
    )


def _placed(nodes: Sequence[Node]) -> Iterator[_Row]:
    """Yield the ground and all bodies with their places, each before the bodies on it."""
    above: list[list[int]] = [[] for _ in range(len(nodes) + 1)]
    for number, node in enumerate(nodes, start=1):
        above[node.lower].append(number)
    waiting, row = [(0, 0)], 0
    while waiting:
        number, line = waiting.pop()
        yield _Row(number, line, row)
        row += 1
        aside = line + (len(above[number]) > 1)
        waiting += [(one, aside) for one in reversed(above[number])]


def _label(number: int, nodes: Sequence[Node]) -> str:
    """Return number and name of a body."""
    return f"{number} {nodes[number - 1].name}" if number else "ground"


def _columns(nodes: Sequence[Node], start: float) -> list[float]:
    """Return where the columns of further texts begin, and where the last one ends."""
    found = [start]
    for cells in zip(*(node.cells for node in nodes), strict=True):
        found.append(found[-1] + max(map(_width, cells)) + 2 * FONT)
    return found


def _link(lower: _Row, own: _Row, nodes: Sequence[Node]) -> Markup:
    """Return the line from the lower body to the joint of a body."""
    start = lower.y + (MARK if lower.number == 0 or nodes[lower.number - 1].mark != Mark.WELDED else 0)
    if lower.line == own.line:
        path = f"M{own.x} {start}V{own.y - MARK}"
    else:
        path = f"M{lower.x} {start}V{own.y - 8}q0 8 8 8H{own.x - MARK}"
    return Markup('<path d="{}" stroke="{}" stroke-width="1.5"/>').format(path, _GREY)


def _mark(mark: Mark, x: int, y: int) -> Markup:
    """Return the mark of a joint at a point."""
    edges = {"l": x - MARK, "r": x + MARK, "t": y - MARK, "b": y + MARK}
    return Markup(_SHAPES[mark].format(x=x, y=y, **edges))


def _text(x: float, y: float, text: str, bold: bool = False) -> Markup:
    """Return a text, cut where it is long; its title has all of it."""
    weight = Markup(' font-weight="600"') if bold else Markup("")
    title = Markup("<title>{}</title>").format(text) if len(text) > LONGEST else Markup("")
    line = Markup(
        '<text x="{}" y="{}" fill="currentColor"{} style="unicode-bidi: plaintext">{}<tspan>{}</tspan></text>'
    )
    return line.format(round(x), y + 4, weight, title, _cut(text))


def _key(marks: Sequence[Mark], y: int) -> tuple[list[Markup], float]:
    """Return the key of the marks in one row, and where it ends."""
    found, x = [], 14.0
    for mark in marks:
        found += [_mark(mark, round(x), y), _text(x + 2 * MARK, y, mark.value)]
        x += 2 * MARK + _width(mark.value) + 2 * FONT
    return found, x


def _cut(text: str) -> str:
    """Return a text that is not too long."""
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def _width(text: str) -> float:
    """Estimate how wide a text is, in pixels: wide letters of East Asia take a square, accents nothing."""
    wide = {"W": 1.0, "F": 1.0}
    return FONT * sum(
        0.0 if unicodedata.combining(letter) else wide.get(unicodedata.east_asian_width(letter), 0.58)
        for letter in _cut(text)
    )
