"""kanegen's own model files; docs/model-files.md describes the format."""

from __future__ import annotations

import re
import tomllib
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kanegen.errors import KanegenWarning, ModelError, ReadError
from kanegen.model.description import GRAVITY
from kanegen.model.right_angles import AS_WRITTEN
from kanegen.model.system import System
from kanegen.readers import force_elements
from kanegen.readers.bodies import read_bodies
from kanegen.readers.keys import Table, check_keys
from kanegen.readers.parameters import Parameters
from kanegen.readers.text import read_text

KEYS = ("name", "gravity", "parameters", "outputs", "body", *force_elements.KEYS)
OUTPUT_KEYS = ("body_poses", "reaction_loads")

NO_GRAVITY = "none"


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
    check_keys(table, KEYS)
    parameters = Parameters.read(table.get("parameters", {}))
    bodies = read_bodies(table.get("body", []), parameters, tolerance)
    gravity = table.get("gravity", GRAVITY)
    gravity = (0, 0, 0) if gravity == NO_GRAVITY else parameters.resolve(gravity, "gravity")
    elements = force_elements.read_force_elements(table, parameters)
    chosen = _outputs(table.get("outputs", {}))
    system = System(table.get("name", path.stem), bodies, gravity, elements, *chosen)
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
