"""Reads the frames of a TOML model file: those of a body from its table, those of the ground from the top."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from kanegen.errors import ModelError, quoted
from kanegen.model.frame import Frame
from kanegen.model.numbers import numbers
from kanegen.readers.toml_bodies import read_orientation
from kanegen.readers.toml_tables import ORIGIN, Parameters, Table, check_keys

KEYS = ("position", "orientation", "orientation_angles", "frame")


def read_frames(table: Table, parameters: Parameters, tolerance: float) -> tuple[Frame, ...]:
    """Return the frames of a model file.

    Args:
        table: The whole file, whose bodies are known to be tables.
        parameters: The run-time parameters of the model.
        tolerance: Largest distance (rad) of `orientation_angles` from right angles that are made exact.

    Raises:
        ModelError: If a frame is not usable; the message names it.
    """
    places = [table, *table["body"]]
    return tuple(
        _frame(name, value, k, parameters, tolerance)
        for k, place in enumerate(places)
        for name, value in _entries(place.get("frames", {}))
    )


def _entries(table: Any) -> Iterator[tuple[str, Any]]:
    """Yield the names and values of a table of frames."""
    if not isinstance(table, Mapping):
        raise ModelError("frames: write a table such as {tool = {position = [0, 0, 0.1]}}.")
    yield from table.items()


def _frame(name: str, value: Any, body: int, parameters: Parameters, tolerance: float) -> Frame:
    """Return a frame from its position or its table."""
    label = f"frame {quoted(name)}"
    table = value if isinstance(value, Mapping) else {"position": value}
    check_keys(table, KEYS, label=f"{label}: ")
    try:
        position = numbers(parameters.resolve(table.get("position", ORIGIN), "position"), (3,), "position")
        orientation = read_orientation(table, parameters, tolerance)
    except ModelError as error:
        raise ModelError(f"{label}: {error}") from None
    return Frame(name, body, position, orientation, table.get("frame", ""))
