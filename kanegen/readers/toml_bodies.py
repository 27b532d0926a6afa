"""Reads the bodies of a TOML model file, with their points and the joints below them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from kanegen.choices import did_you_mean, is_among
from kanegen.errors import ModelError, quoted
from kanegen.model import right_angles, validation
from kanegen.model.body import Body, Point
from kanegen.model.coordinates import FREEDOMS, NOTES, ORIENTATIONS, SPEEDS, selected_freedoms
from kanegen.model.joint import IDENTITY, Joint
from kanegen.model.limits import Limits
from kanegen.model.numbers import numbers
from kanegen.readers.toml_tables import ORIGIN, Parameters, Table, check_keys

KEYS = ("name", "connection", "mass", "mass_center", "inertia", "loads", "frames", "points", "joint")
POINT_KEYS = ("position", "loads", "frame", "load_frame")
INERTIA_KEYS = ("xx", "yy", "zz", "xy", "xz", "yz")
JOINT_KEYS = (
    "type",
    "name",
    "position",
    "orientation",
    "orientation_angles",
    "coordinates",
    "sequence",
    "free",
    "locked",
    "prescribed",
    "speeds",
    "limits",
    "freedom_names",
    "armature",
)

JOINT_TYPES = {"ball": FREEDOMS[:3], "free": FREEDOMS}
"""Free freedoms of the types of joints whose orientation is a quaternion, by the name of the type."""

GROUND = "ground"


def read_bodies(tables: Any, parameters: Parameters, tolerance: float) -> tuple[Body, ...]:
    """Return the bodies of a model file.

    Args:
        tables: The array of tables `[[body]]`.
        parameters: The run-time parameters of the model.
        tolerance: Largest distance (rad) of `orientation_angles` from right angles that are made exact.

    Raises:
        ModelError: If a body is not usable; the message begins with its name.
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
    """Return body `k` from its table."""
    name = table.get("name", f"body{k}")
    try:
        check_keys(table, KEYS, required=("connection", "mass"))
        lower = _lower(table["connection"], numbers_of)
        mass = parameters.resolve(table["mass"], "mass")
        inertia = _inertia(table.get("inertia", [0, 0, 0]), parameters)
        mass_center = parameters.resolve(table.get("mass_center", ORIGIN), "mass_center")
        joint = _joint(table.get("joint", {}), parameters, tolerance)
        points = _points(table.get("points", {}), parameters)
    except ModelError as error:
        raise ModelError(f"body {quoted(name)}: {error}") from None
    return Body(name, lower, mass, inertia, mass_center, joint, table.get("loads", False), points)


def _points(table: Any, parameters: Parameters) -> tuple[Point, ...]:
    """Return the points of a body from its table of points."""
    if not isinstance(table, Mapping):
        raise ModelError("points: write a table such as {tool = [0, 0, 0.1]}.")
    return tuple(_point(name, value, parameters) for name, value in table.items())


def _point(name: str, value: Any, parameters: Parameters) -> Point:
    """Return a point from its position or its table."""
    label = f"point {quoted(name)}"
    table = value if isinstance(value, Mapping) else {"position": value}
    check_keys(table, POINT_KEYS, required=POINT_KEYS[:1], label=f"{label}: ")
    position = numbers(parameters.resolve(table["position"], label), (3,), label)
    frames = table.get("frame", ""), table.get("load_frame", "")
    return Point(name, position, table.get("loads", False), *frames)


def _lower(connection: Any, numbers_of: Mapping[str, int]) -> Any:
    """Return the number of the lower body, which a file calls by name or number."""
    if not isinstance(connection, str):
        return connection
    if connection == GROUND:
        return 0
    if connection not in numbers_of:
        hint = did_you_mean(connection, (GROUND, *numbers_of))
        raise ModelError(f"connection: {quoted(connection)} is no earlier body. {hint}")
    return numbers_of[connection]


def _inertia(value: Any, parameters: Parameters) -> Any:
    """Return (3, 3) an inertia, from a matrix, three principal moments, or a table of entries."""
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


def _joint(table: Any, parameters: Parameters, tolerance: float) -> Joint:
    """Return the joint of a body from its table."""
    if not isinstance(table, Mapping):
        raise ModelError("joint: write a table [body.joint], or keys such as joint.position = [0, 0, 1].")
    check_keys(table, JOINT_KEYS, label="joint: ")
    table = _with_type(table)
    prescribed = _flags("prescribed", table.get("prescribed", []))
    not_prescribed = selected_freedoms(not flag for flag in prescribed)
    free = _flags("free", table.get("free", list(not_prescribed)))
    return Joint(
        position=parameters.resolve(table.get("position", ORIGIN), "joint position"),
        orientation=read_orientation(table, parameters, tolerance),
        free=free,
        locked=_locked(table.get("locked", {}), {"free": free, "prescribed": prescribed}, parameters),
        name=table.get("name", ""),
        sequence=table.get("sequence", NOTES),
        speeds=table.get("speeds", SPEEDS[0]),
        coordinates=table.get("coordinates", ORIENTATIONS[0]),
        prescribed=prescribed,
        limits=Limits.of(_limits(table.get("limits", {}), parameters)),
        freedom_names=_freedom_names(table.get("freedom_names", {})),
        armature=_armature(table.get("armature", {}), parameters),
    )


def _with_type(table: Table) -> Table:
    """Return the table of a joint with free freedoms and coordinates in the place of its type."""
    if "type" not in table:
        return table
    name, set_by_type = table["type"], ("free", "coordinates")
    if not is_among(name, JOINT_TYPES):
        raise ModelError(f"joint type: {quoted(name)} is unknown. {did_you_mean(name, JOINT_TYPES)}")
    if given := [key for key in set_by_type if key in table]:
        raise ModelError(
            f'joint type: "{name}" says what is free. Leave out {" and ".join(given)}, or the type.'
        )
    return {**table, "free": list(JOINT_TYPES[name]), "coordinates": ORIENTATIONS[1]}


def _limits(table: Any, parameters: Parameters) -> Any:
    """Return a table of limits with numbers in the place of texts; other mistakes are left to `Limits`."""
    if isinstance(table, Mapping):
        return {name: _limits(value, parameters) for name, value in table.items()}
    return parameters.resolve(table, "limits")


def _freedom_names(table: Any) -> tuple[str, ...]:
    """Return (6,) names of freedoms, "" where the file says nothing."""
    if not isinstance(table, Mapping):
        raise ModelError('freedom_names: write a table such as {s1 = "rail", theta3 = "pole"}.')
    check_keys(table, FREEDOMS, label="freedom_names: ")
    return tuple(table.get(name, "") for name in FREEDOMS)


def read_orientation(table: Table, parameters: Parameters, tolerance: float) -> Any:
    """Return the constant orientation of a joint or frame: three 1-2-3 angles (rad), or a (3, 3) matrix.

    Raises:
        ModelError: If it is neither, or both are given.
    """
    if "orientation_angles" in table:
        if "orientation" in table:
            raise ModelError("both orientation and orientation_angles are given. Keep one.")
        angles = parameters.resolve(table["orientation_angles"], "orientation_angles")
        angles = numbers(angles, (3,), "orientation_angles")
        return tuple(right_angles.if_plain(angle, tolerance) for angle in angles)
    matrix = parameters.resolve(table.get("orientation", IDENTITY), "orientation")
    return numbers(matrix, (3, 3), "orientation")


def _flags(key: str, value: Any) -> tuple[bool, ...]:
    """Return (6,) flags of freedoms, from "all", "none" or a list of names."""
    if value in ("all", "none"):
        return (value == "all",) * len(FREEDOMS)
    if not isinstance(value, list):
        raise ModelError(
            f'{key}: {quoted(value)} is neither "all" nor "none" nor a list such as ["theta3", "s1"].'
        )
    for name in value:
        if name not in FREEDOMS:
            raise ModelError(f"{key}: {quoted(name)} is no freedom. {did_you_mean(name, FREEDOMS)}")
    validation.unique(f"{key}: freedom", value)
    return tuple(name in value for name in FREEDOMS)


def _armature(table: Any, parameters: Parameters) -> Any:
    """Return (6,) reflected inertias of motors by freedom (kg m^2, kg), 0 where the file says nothing."""
    if not isinstance(table, Mapping):
        raise ModelError("armature: write a table such as {theta3 = 0.7}.")
    check_keys(table, FREEDOMS, label="armature: ")
    return tuple(parameters.resolve(table.get(name, 0), f"armature {name}") for name in FREEDOMS)


def _locked(table: Any, moving: Mapping[str, tuple[bool, ...]], parameters: Parameters) -> Any:
    """Return (6,) values of locked freedoms (rad, m), 0 where the file says nothing."""
    if not isinstance(table, Mapping):
        raise ModelError("locked: write a table such as {theta1 = 0.5}.")
    check_keys(table, FREEDOMS, label="locked: ")
    for key, flags in moving.items():
        for name in selected_freedoms(flags):
            if name in table:
                raise ModelError(
                    f"locked: {quoted(name)} is {key}. Delete it here, or leave it out of {key}."
                )
    return tuple(parameters.resolve(table.get(name, 0), f"locked {name}") for name in FREEDOMS)
