"""A box of inputs, stated beside its bounds: as a table that `domain` reads, with units, and in words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby, product
from typing import Any

from kanegen.measure.bounds.domain import PRESCRIBED, TIME, InputBox, homogeneous_places, load_rows
from kanegen.model.system import System
from kanegen.program.ir import PARAMETERS

MOST_NAMED = 6
"""Most elements with one range that a text names; of more, the first and the last."""

POWERS_OF_TIME = {"x": "", "y": "/s", "ydot": "/s^2", "values": "", "rates": "/s", "accelerations": "/s^2"}
"""What the unit of a coordinate is divided by, by name of the array or row."""

LOAD_UNITS = {"force": "N", "torque": "N m", "point_force": "N", "point_moment": "N m"}
"""Units of loads, by name of the array."""

COMPONENTS = 3
"""Elements of the load of one body or point."""

OF_THE_MODEL = "(unit of its place in the model)"
"""Unit of a parameter: that of the place where it stands."""


@dataclass(frozen=True)
class Element:
    """One element of an input array, in the order of the array.

    Attributes:
        array: Name of the array.
        place: Index in the array, row-major.
        keys: Keys of its range in the table of a domain.
        name: Name in a text.
        unit: Unit.
    """

    array: str
    place: int
    keys: tuple[str, ...]
    name: str
    unit: str


def elements(system: System) -> Iterator[Element]:
    """Yield the elements of all input arrays, array by array, without loads of bodies that take none."""
    for place, (name, coordinate) in enumerate(zip(system.coordinate_names, system.coordinates, strict=True)):
        yield Element("x", place, ("x", name), name, coordinate.unit)
    for array in ("y", "ydot", "tau"):
        for place, (name, freedom) in enumerate(zip(system.freedom_names, system.freedoms, strict=True)):
            unit = freedom.unit + POWERS_OF_TIME.get(array, "")
            if array == "tau":
                unit = "N m" if freedom.is_angle else "N"
            yield Element(array, place, (array, name), name, unit)
    for array, rows in load_rows(system).items():
        for name, row in rows.items():
            for k in range(COMPONENTS):
                place, keys = COMPONENTS * row + k, (array, name, str(k))
                yield Element(array, place, keys, f"{name}[{k}]", LOAD_UNITS[array])
    for place, parameter in enumerate(system.parameters):
        name = parameter.name
        yield Element(PARAMETERS, place, (PARAMETERS, name), name, OF_THE_MODEL)
    moved = list(zip(system.prescribed_names, system.prescribed, strict=True))
    for place, (part, (name, freedom)) in enumerate(product(PRESCRIBED, moved)):
        unit = freedom.unit + POWERS_OF_TIME[part]
        yield Element("prescribed", place, ("prescribed", part, name), f"{part}.{name}", unit)
    if system.depends_on_time:
        yield Element(TIME, 0, ("time", TIME), TIME, "s")


def as_table(box: InputBox) -> dict[str, Any]:
    """Return the table from which `domain.box_from_table` makes the same box."""
    table: dict[str, Any] = {}
    for element in elements(box.system):
        ends = list(_ends(box, element))
        if element.array in LOAD_UNITS:
            _, name, _ = element.keys
            table.setdefault(element.array, {}).setdefault(name, []).append(ends)
        else:
            _set(table, element.keys, ends)
    excluded = {"clearance": box.clearance}
    if homogeneous_places(box.system):
        excluded["quaternions"] = box.shortest
    return table | {"exclude": excluded}


def units(system: System) -> dict[str, Any]:
    """Return the unit of every range of the table of a box, by the keys of the range."""
    found: dict[str, Any] = {}
    for element in elements(system):
        keys = element.keys[:2] if element.array in LOAD_UNITS else element.keys
        _set(found, keys, element.unit)
    return found


def lines(box: InputBox) -> Iterator[str]:
    """Yield the ranges of all inputs in words, to 6 digits.

    Neighbours with the same range and unit share a line.
    """

    def ends(element: Element) -> tuple[str, float, float, str]:
        return element.array, *_ends(box, element), element.unit

    for (array, low, high, unit), group in groupby(elements(box.system), ends):
        names = [element.name for element in group]
        if len(names) > MOST_NAMED:
            names = [names[0], "...", f"{names[-1]} ({len(names)} elements)"]
        size = f"{low:.6g}" if low == high else f"[{low:.6g}, {high:.6g}]"
        yield f"{array}: {', '.join(names)} = {size} {unit}".removesuffix(" 1")
    if words := box.system.limits.words:
        yield f"ranges that no domain sets are the limits of the model, where it has some: {words}"
    if box.clearance:
        yield f"without states closer to gimbal lock than a clearance of {box.clearance:.6g}"
    if box.shortest:
        yield f"without quaternions all of whose elements are below {box.shortest:.6g} in magnitude"


def _ends(box: InputBox, element: Element) -> tuple[float, float]:
    """Return both ends of the range of an element; 0 has no sign."""
    array, place = element.array, element.place
    return float(box.low[array][place]) + 0.0, float(box.high[array][place]) + 0.0


def _set(table: dict[str, Any], keys: tuple[str, ...], value: Any) -> None:
    """Write a value into nested tables, and make those that are missing."""
    for key in keys[:-1]:
        table = table.setdefault(key, {})
    table[keys[-1]] = value
