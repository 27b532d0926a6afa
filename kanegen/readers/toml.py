"""kanegen's own model files; docs/model-files.md describes the format."""

from __future__ import annotations

import re
import tomllib
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kanegen import validation
from kanegen.body import FREEDOMS, IDENTITY, ORIENTATIONS, SPEEDS, Body, Joint, Point, named
from kanegen.errors import KanegenWarning, ModelError, ReadError
from kanegen.numbers import Parameter, numbers
from kanegen.readers import force_elements
from kanegen.readers.keys import check_keys
from kanegen.readers.parameters import Parameters
from kanegen.readers.text import read_text
from kanegen.right_angles import AS_WRITTEN, angle
from kanegen.sequences import NOTES
from kanegen.suggest import did_you_mean
from kanegen.system import GRAVITY, System

MODEL_KEYS = ("name", "gravity", "parameters", "outputs", "body", *force_elements.KEYS)
OUTPUT_KEYS = ("body_poses", "reaction_loads")
BODY_KEYS = ("name", "connection", "mass", "mass_center", "inertia", "loads", "points", "joint")
POINT_KEYS = ("position", "loads")
JOINT_KEYS = (
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
)
INERTIA_KEYS = ("xx", "yy", "zz", "xy", "xz", "yz")

GROUND = "ground"
NO_GRAVITY = "none"
ORIGIN = (0, 0, 0)

Table = Mapping[str, Any]


def read_toml(path: Path, right_angles: float = AS_WRITTEN) -> System:
    """The system that a TOML file describes.

    Args:
        path: The file.
        right_angles: Tolerance (rad) within which `orientation_angles` are made exact.

    Raises:
        ReadError: If the file is not TOML, or does not describe a usable system.

    Warns:
        KanegenWarning: Of parameters that stand nowhere.
    """
    table = parsed(read_text(path), path)
    try:
        return _system(table, path, right_angles)
    except ModelError as error:
        raise ReadError(f"{path}: {error}") from None


def parsed(text: str, where: str | Path) -> Table:
    """A TOML document.

    Args:
        text: It.
        where: What error messages begin with, such as the name of a file.

    Raises:
        ReadError: If it is none; names the line where that is known.
    """
    try:
        return tomllib.loads(text)
    except ValueError as error:  # TOMLDecodeError, and the plain one of an integer with too many digits
        message = str(error)
        place = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", message)
        if place:
            where = f"{where}:{place[1] or len(text.splitlines())}"
            message = message[: place.start()]
        raise ReadError(f"{where}: not valid TOML: {message}.") from None
    except RecursionError:
        raise ReadError(f"{where}: its arrays are nested too deeply.") from None


def _system(table: Table, path: Path, tolerance: float) -> System:
    check_keys(table, MODEL_KEYS)
    parameters = Parameters.read(table.get("parameters", {}))
    tables = table.get("body", [])
    if not isinstance(tables, list) or not tables or not all(isinstance(entry, Mapping) for entry in tables):
        raise ModelError("a model needs bodies: begin each with a line [[body]], in double brackets.")
    numbers_of: dict[str, int] = {}
    bodies = []
    for k, entry in enumerate(tables, start=1):
        body = _body(entry, k, numbers_of, parameters, tolerance)
        numbers_of.setdefault(body.name, k)
        bodies.append(body)
    gravity = table.get("gravity", GRAVITY)
    gravity = (0, 0, 0) if gravity == NO_GRAVITY else parameters.resolve(gravity, "gravity")
    elements = force_elements.read_force_elements(table, parameters)
    chosen = _outputs(table.get("outputs", {}))
    system = System(table.get("name", path.stem), tuple(bodies), gravity, elements, *chosen)
    if unused := parameters.unused():
        warnings.warn(f"{path}: unused parameters: {', '.join(unused)}.", KanegenWarning, stacklevel=4)
    return system


def _outputs(table: Any) -> tuple[Any, Any]:
    """The bodies of `body_poses` and the locked directions of `reaction_loads`; None for all."""
    if not isinstance(table, Mapping):
        raise ModelError('outputs: write a table, [outputs], with lines such as body_poses = ["tool"].')
    check_keys(table, OUTPUT_KEYS, what="outputs: ")
    poses, reactions = (table.get(key) for key in OUTPUT_KEYS)
    return poses, reactions


def _body(
    table: Table, k: int, numbers_of: Mapping[str, int], parameters: Parameters, tolerance: float
) -> Body:
    name = table.get("name", f"body{k}")
    try:
        check_keys(table, BODY_KEYS, required=("connection", "mass"))
        lower = _lower(table["connection"], numbers_of)
        mass = parameters.resolve(table["mass"], "mass")
        inertia = _inertia(table.get("inertia", [0, 0, 0]), parameters)
        mass_center = parameters.resolve(table.get("mass_center", ORIGIN), "mass_center")
        joint = _joint(table.get("joint", {}), parameters, tolerance)
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


def _joint(table: Any, parameters: Parameters, tolerance: float) -> Joint:
    if not isinstance(table, Mapping):
        raise ModelError("joint: write a table [body.joint], or keys such as joint.position = [0, 0, 1].")
    check_keys(table, JOINT_KEYS, what="joint: ")
    prescribed = _flags("prescribed", table.get("prescribed", []))
    rest = named(not flag for flag in prescribed)
    free = _flags("free", table.get("free", list(rest)))
    return Joint(
        position=parameters.resolve(table.get("position", ORIGIN), "joint position"),
        orientation=_orientation(table, parameters, tolerance),
        free=free,
        locked=_locked(table.get("locked", {}), {"free": free, "prescribed": prescribed}, parameters),
        name=table.get("name", ""),
        sequence=table.get("sequence", NOTES),
        speeds=table.get("speeds", SPEEDS[0]),
        coordinates=table.get("coordinates", ORIENTATIONS[0]),
        prescribed=prescribed,
    )


def _orientation(table: Table, parameters: Parameters, tolerance: float) -> Any:
    if "orientation_angles" in table:
        if "orientation" in table:
            raise ModelError("both orientation and orientation_angles are given. Keep one.")
        angles = parameters.resolve(table["orientation_angles"], "orientation_angles")
        angles = numbers(angles, (3,), "orientation_angles")
        return tuple(a if isinstance(a, Parameter) else angle(a, tolerance) for a in angles)
    matrix = parameters.resolve(table.get("orientation", IDENTITY), "orientation")
    return numbers(matrix, (3, 3), "orientation")


def _flags(key: str, value: Any) -> tuple[bool, ...]:
    if value in ("all", "none"):
        return (value == "all",) * len(FREEDOMS)
    if not isinstance(value, list):
        raise ModelError(f'{key}: {value!r} is neither "all" nor "none" nor a list such as ["theta3", "s1"].')
    for name in value:
        if name not in FREEDOMS:
            raise ModelError(f"{key}: {name!r} is no freedom. {did_you_mean(name, FREEDOMS)}")
    validation.unique(f"{key}: freedom", value)
    return tuple(name in value for name in FREEDOMS)


def _locked(table: Any, moving: Mapping[str, tuple[bool, ...]], parameters: Parameters) -> Any:
    if not isinstance(table, Mapping):
        raise ModelError("locked: write a table such as {theta1 = 0.5}.")
    check_keys(table, FREEDOMS, what="locked: ")
    for key, flags in moving.items():
        for name in named(flags):
            if name in table:
                raise ModelError(f"locked: {name!r} is {key}. Delete it here, or leave it out of {key}.")
    return tuple(parameters.resolve(table.get(name, 0), f"locked {name}") for name in FREEDOMS)
