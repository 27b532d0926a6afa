"""A cost report as one self-contained HTML page; a drawing of the tree colours each body by its cost."""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.c.templates import fill
from kanegen.studies.explain.report import ALL_BODIES, CostReport
from kanegen.studies.explain.tables import heads, rows

WIDTH, HEIGHT, GAP = 190, 40, 14
"""Width and height of a box, and distance between boxes (px)."""


@dataclass(frozen=True)
class Box:
    """A body of the drawing.

    Attributes:
        x: Left edge (px).
        y: Upper edge (px).
        name: Name of the body.
        text: Text below the name.
        color: CSS colour.
        width: Width (px).
        height: Height (px).
    """

    x: int
    y: int
    name: str
    text: str
    color: str
    width: int = WIDTH
    height: int = HEIGHT


@dataclass(frozen=True)
class Drawing:
    """The tree, drawn from left to right: boxes, and lines (x1, y1, x2, y2) between them (px)."""

    boxes: tuple[Box, ...]
    lines: tuple[tuple[int, int, int, int], ...]

    @property
    def width(self) -> int:
        """The width of the drawing (px)."""
        return max(box.x + box.width for box in self.boxes) + GAP

    @property
    def height(self) -> int:
        """The height of the drawing (px)."""
        return max(box.y + box.height for box in self.boxes) + GAP


def html(report: CostReport) -> str:
    """Return the cost report as an HTML page."""
    return fill(
        "cost_report.html",
        report=report,
        heads=heads(report),
        rows=rows(report),
        drawing=drawing(report),
        shared=report.bodies.get(ALL_BODIES, 0),
    )


def drawing(report: CostReport) -> Drawing:
    """Place every body to the right of its lower body, and bodies with the same lower body in a column."""
    most = max((n for k, n in report.bodies.items() if k != ALL_BODIES), default=1)
    places: dict[int, tuple[int, int]] = {}
    boxes, lines, rows_taken, continued = [], [], 0, {0}
    for k in _depth_first(report.system.connection):
        lower = report.system.connection[k - 1]
        column, beside = (places[lower][0] + 1, places[lower][1]) if lower else (0, 0)
        if lower in continued:
            beside, rows_taken = rows_taken, rows_taken + 1
        continued.add(lower)
        places[k] = column, beside
        x, y = GAP + column * (WIDTH + 3 * GAP), GAP + beside * (HEIGHT + GAP)
        cost = report.bodies.get(k, 0)
        body = report.system.bodies[k - 1]
        boxes.append(Box(x, y, body.name, f"{cost} operations", _color(cost / most)))
        if lower:
            before = places[lower]
            start = GAP + before[0] * (WIDTH + 3 * GAP) + WIDTH
            middle = GAP + before[1] * (HEIGHT + GAP) + HEIGHT // 2
            lines.append((start, middle, x, y + HEIGHT // 2))
    return Drawing(tuple(boxes), tuple(lines))


def _depth_first(connection: tuple[int, ...]) -> list[int]:
    """Return the numbers of the bodies in depth-first order."""
    found: list[int] = []
    waiting = [k for k in range(len(connection), 0, -1) if not connection[k - 1]]
    while waiting:
        k = waiting.pop()
        found.append(k)
        waiting += [upper for upper in range(len(connection), 0, -1) if connection[upper - 1] == k]
    return found


def _color(share: float) -> str:
    """Return a colour from white, for a share of 0, to red, for a share of 1."""
    return f"hsl(12, 85%, {98 - 42 * share:.0f}%)"
