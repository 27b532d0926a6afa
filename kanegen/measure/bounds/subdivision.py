"""Boxes of inputs in parts: the largest bound over the parts holds for the whole, and is often smaller."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import cycle, product

import numpy as np
from numpy.typing import NDArray

from kanegen.measure.bounds.intervals import Intervals
from kanegen.model.arrays import Floats

PARTS = 3
"""Number of parts into which the range of an element is cut."""

LEAST_GAIN = 0.995
"""Ratio of bounds above which cutting does not pay."""

NEAR = 0.97
"""Parts whose bounds are at least this share of the largest of an output are cut further."""

Element = tuple[str, int]
"""An element of an input array: name and index."""

Box = Mapping[str, Intervals]
"""Intervals (size, B) of the elements of every input array, by name."""


class Subdivision:
    """The parts of some boxes.

    Elements that help are cut in all combinations first. Then the parts with the largest bounds are cut along
    one helpful element after the other.

    Args:
        box: The boxes.
        elements: Elements that may be cut.

    Attributes:
        first: The boxes, and their parts along one element after the other.
    """

    def __init__(self, box: Box, elements: Sequence[Element]) -> None:
        self._box, self._elements = box, elements
        self.first = _joined([box, *(cut(box, [element]) for element in elements)])

    def bounds(self, first: Floats, least: int, most: int, bounds: Callable[[Box], Floats]) -> Floats:
        """Return bounds (outputs,) over the boxes together, the smallest that some parts of them give.

        Args:
            first: Bounds (outputs, B) over `first`.
            least: Least number of parts for whose sake `bounds` is called once more.
            most: Largest number of parts.
            bounds: Function that returns bounds (outputs, B) over B boxes.
        """
        boxes = next((part.low.shape[1] for part in self._box.values()), 1)
        whole: Floats = first[:, :boxes].max(axis=1)
        helpful = self._helpful(whole, first[:, boxes:])
        depth = np.log(max(most / PARTS / boxes, 1)) / np.log(PARTS)
        chosen = helpful[: int(depth + 1e-9)]
        if not chosen:
            return whole
        cells: Box = cut(self._box, chosen)
        found = np.minimum(bounds(cells), whole[:, None])
        left, gains = most - found.shape[1], [0.0] * len(helpful)
        for element in cycle(helpful):
            before: Floats = found.max(axis=1)
            worst = _worst(found, left // PARTS)
            if PARTS * len(worst) < least or max(gains[-len(helpful) :]) > LEAST_GAIN:
                break
            smaller = cut(_taken(cells, worst), [element])
            better = np.minimum(bounds(smaller), np.repeat(found[:, worst], PARTS, axis=1))
            rest = np.setdiff1d(np.arange(found.shape[1]), worst)
            cells = _joined([_taken(cells, rest), smaller])
            found = np.concatenate([found[:, rest], better], axis=1)
            left -= PARTS * len(worst)
            gains.append(_ratio(found.max(axis=1), before))
        return before

    def _helpful(self, whole: Floats, parts: Floats) -> list[Element]:
        """Return the elements that it pays to cut, the most helpful first, from the bounds of their parts."""
        found = np.split(parts, len(self._elements), axis=1) if self._elements else []
        gains = [_ratio(part.max(axis=1), whole) for part in found]
        order = sorted(range(len(found)), key=lambda k: gains[k])
        return [self._elements[k] for k in order if gains[k] < LEAST_GAIN]


def columns_of(box: Box, most: int) -> Iterator[Box]:
    """Yield the boxes of a box, at most `most` at a time."""
    count = next((part.low.shape[1] for part in box.values()), 1)
    for first in range(0, count, most):
        yield _taken(box, np.arange(first, min(first + most, count), dtype=np.intp))


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


def _worst(found: Floats, most: int) -> NDArray[np.intp]:
    """Return the places of at most `most` parts whose bounds are near the largest of an output."""
    largest = found.max(axis=1, keepdims=True)
    share = np.where(largest > 0, found / np.where(largest > 0, largest, 1.0), 0.0).max(axis=0)
    order = np.argsort(-share, kind="stable")[:most]
    return np.sort(order[share[order] >= NEAR])


def _ratio(bounds: Floats, before: Floats) -> float:
    """Return the mean ratio of bounds to those before, 1 if there are none."""
    counts = (before > 0) & np.isfinite(before)
    return float(np.exp(np.log(bounds[counts] / before[counts]).mean())) if counts.any() else 1.0


def _taken(box: Box, places: NDArray[np.intp]) -> Box:
    """Return some of several boxes."""
    return {name: Intervals(part.low[:, places], part.high[:, places]) for name, part in box.items()}


def _joined(boxes: Sequence[Box]) -> Box:
    """Return the boxes of several boxes together."""
    return {
        name: Intervals(
            np.concatenate([one[name].low for one in boxes], axis=1),
            np.concatenate([one[name].high for one in boxes], axis=1),
        )
        for name in boxes[0]
    }
