"""A receipt as one HTML page that needs nothing else, the tree drawn and each body coloured by its cost."""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.c.templates import fill
from kanegen.studies.explain.costs import SYSTEM
from kanegen.studies.explain.receipt import Receipt
from kanegen.studies.explain.tables import heads, rows

WIDTH, HEIGHT, GAP = 190, 40, 14


@dataclass(frozen=True)
class Box:
    """A body of the drawing."""

    x: int
    y: int
    name: str
    words: str
    color: str
    width: int = WIDTH
    height: int = HEIGHT


@dataclass(frozen=True)
class Drawing:
    """The tree from left to right: boxes, and lines between them as (x1, y1, x2, y2)."""

    boxes: tuple[Box, ...]
    lines: tuple[tuple[int, int, int, int], ...]

    @property
    def width(self) -> int:
        """Of all."""
        return max(box.x + box.width for box in self.boxes) + GAP

    @property
    def height(self) -> int:
        """Of all."""
        return max(box.y + box.height for box in self.boxes) + GAP


def html(receipt: Receipt) -> str:
    """The page."""
    return fill(
        "receipt.html",
        receipt=receipt,
        heads=heads(receipt),
        rows=rows(receipt),
        drawing=drawing(receipt),
        shared=receipt.bodies.get(SYSTEM, 0),
    )


def drawing(receipt: Receipt) -> Drawing:
    """Every body right of its lower body; where a body carries several, they stand below each other."""
    most = max((n for k, n in receipt.bodies.items() if k != SYSTEM), default=1)
    places: dict[int, tuple[int, int]] = {}
    boxes, lines, rows_taken, continued = [], [], 0, {0}
    for k in _depth_first(receipt.system.connection):
        lower = receipt.system.connection[k - 1]
        column, beside = (places[lower][0] + 1, places[lower][1]) if lower else (0, 0)
        if lower in continued:
            beside, rows_taken = rows_taken, rows_taken + 1
        continued.add(lower)
        places[k] = column, beside
        x, y = GAP + column * (WIDTH + 3 * GAP), GAP + beside * (HEIGHT + GAP)
        cost = receipt.bodies.get(k, 0)
        body = receipt.system.bodies[k - 1]
        boxes.append(Box(x, y, body.name, f"{cost} operations", _color(cost / most)))
        if lower:
            before = places[lower]
            start = GAP + before[0] * (WIDTH + 3 * GAP) + WIDTH
            middle = GAP + before[1] * (HEIGHT + GAP) + HEIGHT // 2
            lines.append((start, middle, x, y + HEIGHT // 2))
    return Drawing(tuple(boxes), tuple(lines))


def _depth_first(connection: tuple[int, ...]) -> list[int]:
    found: list[int] = []
    waiting = [k for k in range(len(connection), 0, -1) if not connection[k - 1]]
    while waiting:
        k = waiting.pop()
        found.append(k)
        waiting += [upper for upper in range(len(connection), 0, -1) if connection[upper - 1] == k]
    return found


def _color(share: float) -> str:
    """From white for nothing to red for the most."""
    return f"hsl(12, 85%, {98 - 42 * share:.0f}%)"
