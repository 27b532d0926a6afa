"""Reads MJCF files, the models of MuJoCo, through MuJoCo's own compiler.

{x} and {y} are MuJoCo's `qpos` and `qvel` in another order: a ball joint is a quaternion with the angular
velocity in the body, a free joint has its translation in world axes beside it, and slides and hinges are
single freedoms with the names of their joints.
"""

from __future__ import annotations

from kanegen.errors import ModelError, OptionError, ReadError
from kanegen.model.names import usable_identifier
from kanegen.model.rotations import ZERO, Triple
from kanegen.model.system import System
from kanegen.readers.mjcf_compiled import Compiled, compiled
from kanegen.readers.mjcf_tree import mjcf_tree
from kanegen.readers.reader import ModelFile, Reader, ReadOptions


def read_mjcf(file: ModelFile, options: ReadOptions) -> System:
    """Return the system that an MJCF file describes, as MuJoCo compiles it.

    Args:
        file: The file.
        options: `floating_base` must not be set: an MJCF file says itself which body moves freely.

    Raises:
        ReadError: If MuJoCo refuses the file, or the model has a body that cannot exist.
        OptionError: If `floating_base` is set.
        MissingError: If MuJoCo is not installed.
    """
    if options.floating_base:
        raise OptionError(
            f"{file.path}: floating_base is for URDF files. In an MJCF file, put <freejoint/> into the body."
        )
    model = compiled(file)
    if not int(model.model.njnt):
        raise ReadError(f"{file.path}: no joint of this model moves. A body moves by <joint> or <freejoint>.")
    name = usable_identifier(file.root.attributes.get("model", "") or file.path.stem)
    try:
        tree = mjcf_tree(model)
        return System(name, tree.bodies, gravity=_gravity(model), frames=tree.frames)
    except ModelError as error:
        raise ReadError(f"{file.path}: {error}") from None


READER = Reader("MJCF", ".xml", read_mjcf, root="mujoco")


def _gravity(model: Compiled) -> Triple:
    """Return the acceleration of gravity in world axes (m/s^2), zero where the file switches it off."""
    if model.disables("GRAVITY"):
        return ZERO
    x, y, z = (float(component) for component in model.model.opt.gravity)
    return x, y, z
