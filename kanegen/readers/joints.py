"""The table of a joint in a model file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError
from kanegen.model import validation
from kanegen.model.coordinates import FREEDOMS, NOTES, ORIENTATIONS, SPEEDS, selected_freedoms
from kanegen.model.joint import IDENTITY, Joint
from kanegen.model.numbers import Parameter, numbers
from kanegen.model.right_angles import angle
from kanegen.readers.keys import ORIGIN, Table, check_keys
from kanegen.readers.parameters import Parameters

KEYS = (
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


def read_joint(table: Any, parameters: Parameters, tolerance: float) -> Joint:
    """The joint that a table describes.

    Args:
        table: It.
        parameters: Those of the model.
        tolerance: Within which `orientation_angles` are made exact (rad).

    Raises:
        ModelError: If it is not usable.
    """
    if not isinstance(table, Mapping):
        raise ModelError("joint: write a table [body.joint], or keys such as joint.position = [0, 0, 1].")
    check_keys(table, KEYS, what="joint: ")
    prescribed = _flags("prescribed", table.get("prescribed", []))
    rest = selected_freedoms(not flag for flag in prescribed)
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
        for name in selected_freedoms(flags):
            if name in table:
                raise ModelError(f"locked: {name!r} is {key}. Delete it here, or leave it out of {key}.")
    return tuple(parameters.resolve(table.get(name, 0), f"locked {name}") for name in FREEDOMS)
