"""Boxes of inputs without the states that have no bound: next to gimbal lock, and with short quaternions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kanegen.errors import OptionError
from kanegen.measure.bounds.intervals import Intervals
from kanegen.model.system import System

MOST_BOXES = 4096
"""Most boxes without short quaternions that are made of one box."""

SMALLEST_PIECES = 64
"""Most pieces of the range of one angle between two neighbourhoods of gimbal lock."""


def away_from_gimbal_lock(
    columns: dict[str, Intervals], system: System, place: int, lock: float, clearance: float
) -> dict[str, Intervals]:
    """Return boxes without the angles next to gimbal lock of one joint.

    Args:
        columns: Boxes (size, B) by name of the array.
        system: The system.
        place: Place in {x} of the middle angle of the joint.
        lock: An angle at which the joint is in gimbal lock (rad).
        clearance: Least |sin| of the distance from gimbal lock that stays.

    Raises:
        OptionError: If nothing is left, or the range of the angle is too long.
    """
    x = columns["x"]
    first, last = float(x.low[place].min()), float(x.high[place].max())
    margin = np.arcsin(clearance) * (1 - 1e-9)
    pieces = _pieces(first, last, lock, margin)
    name = system.coordinate_names[place]
    if not pieces:
        raise OptionError(f"domain: at clearance {clearance:g} nothing of x.{name} is left.")
    if len(pieces) > SMALLEST_PIECES:
        raise OptionError(f"domain: x.{name} passes gimbal lock {len(pieces)} times. Give a shorter range.")
    return _copies(columns, [(place, low, high) for low, high in pieces])


def without_short_homogeneous_coordinates(
    columns: dict[str, Intervals], system: System, places: Sequence[int], least: float
) -> dict[str, Intervals]:
    """Return boxes in which one element of a quaternion, each in turn, is at least `least` in size.

    Args:
        columns: Boxes (size, B) by name of the array.
        system: The system.
        places: Places in {x} of the four elements of the quaternion.
        least: Least magnitude of the largest element.

    Raises:
        OptionError: If nothing is left, or there are too many boxes.
    """
    x = columns["x"]
    ends = [(place, float(x.low[place].min()), float(x.high[place].max())) for place in places]
    pieces = [(place, max(low, least), high) for place, low, high in ends if high >= least]
    pieces += [(place, low, min(high, -least)) for place, low, high in ends if low <= -least]
    names = [system.coordinate_names[place] for place in places]
    if not pieces:
        raise OptionError(
            f"domain: at exclude.quaternions {least:g} nothing of {names[0]} to {names[-1]} is left."
        )
    if len(pieces) * x.low.shape[1] > MOST_BOXES:
        raise OptionError(
            f"domain: exclude.quaternions makes more than {MOST_BOXES} boxes of so many quaternions. "
            "Give ranges of them instead, without length 0."
        )
    return _copies(columns, pieces)


def _copies(
    columns: Mapping[str, Intervals], pieces: Sequence[tuple[int, float, float]]
) -> dict[str, Intervals]:
    """Return all boxes once for each piece (place in {x}, low, high), with this range at this place."""
    count = columns["x"].low.shape[1]
    copies = {
        key: Intervals(np.tile(part.low, len(pieces)), np.tile(part.high, len(pieces)))
        for key, part in columns.items()
    }
    for number, (place, low, high) in enumerate(pieces):
        own = slice(number * count, (number + 1) * count)
        copies["x"].low[place, own], copies["x"].high[place, own] = low, high
    return copies


def _pieces(first: float, last: float, lock: float, margin: float) -> list[tuple[float, float]]:
    """Return the parts of a range that have the distance `margin` from `lock` and its half turns (rad)."""
    found: list[tuple[float, float]] = []
    start = first
    turn = int(np.floor((first - lock) / np.pi))
    while start <= last and len(found) <= SMALLEST_PIECES:
        centre = lock + turn * np.pi
        if centre - margin > start:
            found.append((start, min(last, centre - margin)))
        start = max(start, centre + margin)
        turn += 1
        if centre > last + margin:
            break
    return found
