"""Reads TOML model files, kanegen's own format, which docs/model-files.md describes."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kanegen.errors import ModelError, OptionError, ReadError, quoted, warn
from kanegen.model.contact import Contact
from kanegen.model.coupling import Coupling
from kanegen.model.rotor import Rotor
from kanegen.model.system import System
from kanegen.model.system_fields import GRAVITY
from kanegen.readers import toml_force_elements
from kanegen.readers.reader import ModelFile, Reader, ReadOptions
from kanegen.readers.toml_bodies import read_bodies
from kanegen.readers.toml_frames import read_frames
from kanegen.readers.toml_tables import Parameters, Table, TextError, check_keys, tables_named

KEYS = (
    "name",
    "gravity",
    "parameters",
    "outputs",
    "frames",
    "body",
    "coupling",
    "rotor",
    "contact",
    *toml_force_elements.KEYS,
)
COUPLING_KEYS = ("freedom", "terms", "offset")
CONTACT_KEYS = ("name", "point", "frame", "directions", "damping")
ROTOR_KEYS = ("name", "freedom", "axis", "inertia", "ratio", "body")
OUTPUT_KEYS = ("body_poses", "reaction_loads")

NO_GRAVITY = "none"

MOST_DOTS = 100
"""Largest number of dots in a key."""


def read_toml(file: ModelFile, options: ReadOptions) -> System:
    """Return the system that a TOML file describes.

    Raises:
        ReadError: If the file is not TOML, or does not describe a usable system.
        OptionError: If a floating base or joint dynamics are asked for.

    Warns:
        KanegenWarning: If a parameter is not used.
    """
    if options.floating_base:
        raise OptionError(
            f"{file.path}: floating_base is for URDF files. In a TOML file, free all six freedoms of body 1."
        )
    if options.joint_dynamics:
        raise OptionError(
            f"{file.path}: joint_dynamics is for URDF and MJCF files. In a TOML file, write [[joint_spring]] "
            "with a damping and [[joint_friction]]."
        )
    table = parse_toml(file.text, file.path)
    try:
        return _system(table, file.path, options.right_angles)
    except ModelError as error:
        raise ReadError(f"{file.path}{_line(error, file.text)}: {error}") from None


READER = Reader("TOML", ".toml", read_toml)


def _line(error: BaseException | None, text: str) -> str:
    """Return ":" and the line of the text in a file that an error is about; "" if it is about no text."""
    while error is not None and not isinstance(error, TextError):
        error = error.__context__
    if error is not None:
        shown = [f"{quote}{error.text}{quote}" for quote in "\"'"]
        for number, line in enumerate(text.splitlines(), start=1):
            if any(one in line for one in shown):
                return f":{number}"
    return ""


def parse_toml(text: str, where: str | Path) -> Table:
    """Return the table of a TOML document.

    Args:
        text: The document.
        where: Start of error messages, such as the name of a file.

    Raises:
        ReadError: If the text is not TOML; the message names the line where that is known.
    """
    _require_short_keys(text, where)
    try:
        return tomllib.loads(text)
    except ValueError as error:  # TOMLDecodeError, and the plain one of an integer with too many digits
        message = str(error)
        place = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", message)
        if place:
            where = f"{where}:{place[1] or len(text.splitlines())}"
            message = message[: place.start()]
        if message.endswith("for a key part"):
            message += '. A key with other characters than a to z, digits, - and _ stands between "quotes"'
        raise ReadError(f"{where}: not valid TOML: {message}.") from None
    except RecursionError:
        raise ReadError(f"{where}: its arrays are nested too deeply.") from None


def _require_short_keys(text: str, where: str | Path) -> None:
    """Make sure that no key has more than `MOST_DOTS` dots: tomllib's time grows with their square.

    Raises:
        ReadError: If a key has more; the message names its line.
    """
    line = 1
    parts = re.split(r"([=\]\[{},#\n])", text)
    for part, ending in zip(parts[::2], parts[1::2], strict=False):
        if ending in ("=", "]") and part.count(".") > MOST_DOTS:
            raise ReadError(f"{where}:{line}: key {quoted(part.strip())} has more than {MOST_DOTS} dots.")
        line += ending == "\n"


def _system(table: Table, path: Path, tolerance: float) -> System:
    """Return the system of a table; `path` is for warnings."""
    check_keys(table, KEYS)
    parameters = Parameters.read(table.get("parameters", {}))
    bodies = read_bodies(table.get("body", []), parameters, tolerance)
    gravity = table.get("gravity", GRAVITY)
    gravity = (0, 0, 0) if gravity == NO_GRAVITY else parameters.resolve(gravity, "gravity")
    elements = toml_force_elements.read_force_elements(table, parameters)
    poses, reactions = _outputs(table.get("outputs", {}))
    couplings = _couplings(table, parameters)
    frames = read_frames(table, parameters, tolerance)
    rotors = _rotors(table, parameters)
    contacts = _contacts(table, parameters)
    name = table.get("name", path.stem)
    system = System(name, bodies, gravity, elements, poses, reactions, couplings, frames, rotors, contacts)
    if unused := parameters.unused():
        warn(f"{path}: unused parameters: {', '.join(unused)}.")
    return system


def _couplings(table: Table, parameters: Parameters) -> tuple[Coupling, ...]:
    """Return the couplings of a model file from its tables."""
    found = []
    for place, entry in enumerate(tables_named(table, "coupling"), start=1):
        label = f"coupling {place}"
        check_keys(entry, COUPLING_KEYS, required=COUPLING_KEYS[:2], label=f"{label}: ")
        if not isinstance(entry["terms"], Mapping):
            raise ModelError(f"{label}: terms: write a table such as {{right_finger = 1.0}}.")
        terms = {name: parameters.resolve(value, label) for name, value in entry["terms"].items()}
        offset = parameters.resolve(entry.get("offset", 0), f"{label}: offset")
        found.append(Coupling(entry["freedom"], terms, offset))
    return tuple(found)


def _rotors(table: Table, parameters: Parameters) -> tuple[Rotor, ...]:
    """Return the rotors of a model file from its tables."""
    found = []
    for place, entry in enumerate(tables_named(table, "rotor"), start=1):
        label = f"rotor {place}"
        check_keys(entry, ROTOR_KEYS, required=ROTOR_KEYS[:4], label=f"{label}: ")
        resolved = {
            key: parameters.resolve(entry[key], f"{label}: {key}")
            for key in ("axis", "inertia", "ratio")
            if key in entry
        }
        found.append(Rotor(**{**entry, **resolved}))
    return tuple(found)


def _contacts(table: Table, parameters: Parameters) -> tuple[Contact, ...]:
    """Return the contacts of a model file from its tables."""
    found = []
    for place, entry in enumerate(tables_named(table, "contact"), start=1):
        label = f"contact {place}"
        check_keys(entry, CONTACT_KEYS, label=f"{label}: ")
        damping = parameters.resolve(entry.get("damping", 0), f"{label}: damping")
        found.append(Contact(**{**entry, "damping": damping}))
    return tuple(found)


def _outputs(table: Any) -> tuple[Any, Any]:
    """Return the frames of `body_poses` and the rows of `reaction_loads`; None for all."""
    if not isinstance(table, Mapping):
        raise ModelError('outputs: write a table, [outputs], with lines such as body_poses = ["tool"].')
    check_keys(table, OUTPUT_KEYS, label="outputs: ")
    poses, reactions = (table.get(key) for key in OUTPUT_KEYS)
    return poses, reactions
