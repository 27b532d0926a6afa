"""Readers of model files: from TOML, URDF and MJCF to a `System`.

Each format is a `Reader` in a module of its own (`toml`, `urdf`, `mjcf`), entered in `registry`; `load` picks
one by suffix and root element. A module here may import the model, and nothing that derives or generates.
Whatever is wrong with a file raises a `ReadError` that begins with the file and, where it is known, the line.
"""

from __future__ import annotations

import os
from pathlib import Path

from kanegen.choices import flag
from kanegen.errors import ReadError, quoted
from kanegen.model.right_angles import AS_WRITTEN, checked_tolerance
from kanegen.model.system import System
from kanegen.readers.reader import ModelFile, ReadOptions
from kanegen.readers.registry import reader_of
from kanegen.readers.visual import Visuals

__all__ = ["load", "visuals_of"]


def load(
    path: str | os.PathLike[str],
    floating_base: bool = False,
    right_angles: float = AS_WRITTEN,
    joint_dynamics: bool = False,
) -> System:
    """Return the system in a model file: `.toml` (kanegen's own format), `.urdf` or `.xml` (MJCF of MuJoCo).

    Args:
        path: The file.
        floating_base: URDF only: the root link moves freely and becomes body 1; otherwise it is the ground.
        right_angles: Tolerance (rad): constant orientations that are no farther from a right angle, such as
            1.5708, are made exact. With 0 every number stays as written; see `kanegen.model.right_angles`.
        joint_dynamics: Damping and friction of `<dynamics>` in URDF, and `frictionloss` in MJCF, become a
            `JointSpring` and a `JointFriction` with a smoothing of 0.01 rad/s or m/s. Otherwise a warning
            says what is left out.

    Raises:
        ReadError: If the file cannot be read or does not describe a usable system; the message begins with
            the file and, where known, the line.
        OptionError: If `floating_base` is set for a file that is no URDF file, `joint_dynamics` for TOML, or
            `right_angles` is out of range.

    Example:
        system = kg.load("robot.urdf", floating_base=True)
    """
    try:
        file = ModelFile(Path(path))
    except TypeError:
        raise ReadError(f"{quoted(path)} is not the path of a file.") from None
    options = ReadOptions(
        flag("floating_base", floating_base),
        checked_tolerance(right_angles),
        flag("joint_dynamics", joint_dynamics),
    )
    system = reader_of(file).read(file, options).with_right_angles(options.right_angles)
    return system.with_geometry(file.path)


def visuals_of(path: str | os.PathLike[str]) -> Visuals:
    """Return the shapes by which a model file says how its bodies look; none for a format without shapes.

    Args:
        path: The file.

    Raises:
        ReadError: If the file cannot be read.
        MissingError: If it is an MJCF file and MuJoCo is not installed.

    Example:
        visuals_of("robot.urdf").shapes
    """
    file = ModelFile(Path(path))
    visuals = reader_of(file).visuals
    return visuals(file) if visuals else Visuals()
