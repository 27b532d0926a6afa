"""The tables of bodies in a model file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError
from kanegen.model.body import Body, Point
from kanegen.model.numbers import numbers
from kanegen.readers.joints import read_joint
from kanegen.readers.keys import ORIGIN, Table, check_keys
from kanegen.readers.parameters import Parameters

KEYS = ("name", "connection", "mass", "mass_center", "inertia", "loads", "points", "joint")
POINT_KEYS = ("position", "loads")
INERTIA_KEYS = ("xx", "yy", "zz", "xy", "xz", "yz")

GROUND = "ground"


def read_bodies(tables: Any, parameters: Parameters, tolerance: float) -> tuple[Body, ...]:
    """The bodies that tables describe.

    Args:
        tables: They.
        parameters: Those of the model.
        tolerance: Within which `orientation_angles` are made exact (rad).

    Raises:
        ModelError: If one is not usable; names it.
    """
    if not isinstance(tables, list) or not tables or not all(isinstance(entry, Mapping) for entry in tables):
        raise ModelError("a model needs bodies: begin each with a line [[body]], in double brackets.")
    numbers_of: dict[str, int] = {}
    bodies = []
    for k, table in enumerate(tables, start=1):
        body = _body(table, k, numbers_of, parameters, tolerance)
        numbers_of.setdefault(body.name, k)
        bodies.append(body)
    return tuple(bodies)


def _body(
    table: Table, k: int, numbers_of: Mapping[str, int], parameters: Parameters, tolerance: float
) -> Body:
    name = table.get("name", f"body{k}")
    try:
        check_keys(table, KEYS, required=("connection", "mass"))
        lower = _lower(table["connection"], numbers_of)
        mass = parameters.resolve(table["mass"], "mass")
        inertia = _inertia(table.get("inertia", [0, 0, 0]), parameters)
        mass_center = parameters.resolve(table.get("mass_center", ORIGIN), "mass_center")
        joint = read_joint(table.get("joint", {}), parameters, tolerance)
        points = _points(table.get("points", {}), parameters)
    except ModelError as error:
        raise ModelError(f"body {name!r}: {error}") from None
    return Body(name, lower, mass, inertia, mass_center, joint, table.get("loads", False), points)


def _points(table: Any, parameters: Parameters) -> tuple[Point, ...]:
    if not isinstance(table, Mapping):
        raise ModelError("points: write a table such as {tool = [0, 0, 0.1]}.")
    return tuple(_point(name, value, parameters) for name, value in table.items())


def _point(name: str, value: Any, parameters: Parameters) -> Point:
    what = f"point {name!r}"
    table = value if isinstance(value, Mapping) else {"position": value}
    check_keys(table, POINT_KEYS, required=POINT_KEYS[:1], what=f"{what}: ")
    position = numbers(parameters.resolve(table["position"], what), (3,), what)
    return Point(name, position, table.get("loads", False))


def _lower(connection: Any, numbers_of: Mapping[str, int]) -> Any:
    if not isinstance(connection, str):
        return connection
    if connection == GROUND:
        return 0
    if connection not in numbers_of:
        hint = did_you_mean(connection, (GROUND, *numbers_of))
        raise ModelError(f"connection: {connection!r} is no earlier body. {hint}")
    return numbers_of[connection]


def _inertia(value: Any, parameters: Parameters) -> Any:
    if isinstance(value, Mapping):
        check_keys(value, INERTIA_KEYS, required=INERTIA_KEYS[:3])
        entries = [value.get(key, 0) for key in INERTIA_KEYS]
        xx, yy, zz, xy, xz, yz = parameters.resolve(entries, "inertia")
        return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    value = parameters.resolve(value, "inertia")
    if isinstance(value, list) and not any(isinstance(row, list) for row in value):
        xx, yy, zz = numbers(value, (3,), "inertia")
        return [[xx, 0, 0], [0, yy, 0], [0, 0, zz]]
    return value
