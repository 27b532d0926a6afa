"""Boxes of inputs in parts: the largest bound over the parts holds for the whole, and is often smaller."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product

import numpy as np

from kanegen.measure.bounds.intervals import Intervals
from kanegen.model.arrays import Floats

PARTS = 3
"""Number of parts into which the range of an element is cut."""

LEAST_GAIN = 0.995
"""Ratio of bounds above which cutting an element does not pay."""

Element = tuple[str, int]
"""An element of an input array: name and index."""

Box = Mapping[str, Intervals]
"""Intervals (size, B) of the elements of every input array, by name."""


def subdivided(box: Box, elements: Sequence[Element], most: int, bounds: Callable[[Box], Floats]) -> Floats:
    """Return bounds (outputs,) over B boxes together, the smallest that a few parts give.

    Args:
        box: The boxes.
        elements: Elements that may be cut.
        most: Largest number of parts.
        bounds: Function that returns bounds (outputs, B) over B boxes.
    """
    whole: Floats = bounds(box).max(axis=1)
    helpful = _helpful(box, elements, whole, bounds) if most >= PARTS else []
    chosen = helpful[: int(np.log(max(most, 1)) / np.log(PARTS) + 1e-9)]
    if not chosen:
        return whole
    least: Floats = np.minimum(whole, bounds(cut(box, chosen)).max(axis=1))
    return least


def cut(box: Box, elements: Sequence[Element]) -> dict[str, Intervals]:
    """Return all combinations of the parts of elements as boxes."""
    cells = list(product(range(PARTS), repeat=len(elements)))
    low = {name: np.repeat(part.low, len(cells), axis=1) for name, part in box.items()}
    high = {name: np.repeat(part.high, len(cells), axis=1) for name, part in box.items()}
    for place, (name, index) in enumerate(elements):
        first, last = low[name][index].copy(), high[name][index].copy()
        own = np.tile([cell[place] for cell in cells], len(first) // len(cells))
        step = (last - first) / PARTS
        low[name][index] = np.where(own == 0, first, first + own * step)
        high[name][index] = np.where(own == PARTS - 1, last, first + (own + 1) * step)
    return {name: Intervals(low[name], high[name]) for name in box}


def _helpful(
    box: Box, elements: Sequence[Element], whole: Floats, bounds: Callable[[Box], Floats]
) -> list[Element]:
    """Return the elements that it pays to cut, the most helpful first."""
    counts = (whole > 0) & np.isfinite(whole)
    if not elements or not counts.any():
        return []
    parts = [cut(box, [element]) for element in elements]
    together = {
        name: Intervals(
            np.concatenate([part[name].low for part in parts], axis=1),
            np.concatenate([part[name].high for part in parts], axis=1),
        )
        for name in box
    }
    found = bounds(together).reshape(len(whole), len(elements), -1).max(axis=2)
    gains = np.exp(np.log(found[counts] / whole[counts, None]).mean(axis=0))
    order = sorted(range(len(gains)), key=lambda k: float(gains[k]))
    return [elements[k] for k in order if gains[k] < LEAST_GAIN]
