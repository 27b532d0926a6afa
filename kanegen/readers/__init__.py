"""Model files: TOML and URDF to `System`."""

from __future__ import annotations

import os
from pathlib import Path

from kanegen.errors import OptionError, ReadError
from kanegen.model.right_angles import AS_WRITTEN, checked
from kanegen.model.system import System
from kanegen.readers.toml import read_toml
from kanegen.readers.urdf import read_urdf

__all__ = ["load"]


def load(
    path: str | os.PathLike[str], floating_base: bool = False, right_angles: float = AS_WRITTEN
) -> System:
    """The system in a model file: `.toml` (kanegen's own format) or `.urdf`.

    Args:
        path: The file.
        floating_base: URDF only: the root link moves freely and becomes body 1; otherwise it is the ground.
        right_angles: Tolerance (rad): constant orientations that miss a right angle by no more, such as
            1.5708, are made exact. With 0 every number means what it says; see `kanegen.model.right_angles`.

    Raises:
        ReadError: If the file cannot be read or does not describe a usable system; the message begins with
            the file and, where known, the line.
        OptionError: If `floating_base` is asked of a TOML file, or `right_angles` makes no sense.
    """
    try:
        file = Path(path)
    except TypeError:
        raise ReadError(f"{path!r} is not the path of a file.") from None
    tolerance = checked(right_angles)
    kind = file.suffix.lower()
    if kind == ".urdf":
        return read_urdf(file, floating_base, tolerance).with_right_angles(tolerance)
    if kind != ".toml":
        hint = " Run xacro on it first." if kind == ".xacro" else ""
        raise ReadError(f"{file}: kanegen reads .toml and .urdf files.{hint}")
    if floating_base:
        raise OptionError(
            f"{file}: floating_base is for URDF files. In a TOML file, free all six freedoms of body 1."
        )
    return read_toml(file, tolerance).with_right_angles(tolerance)
