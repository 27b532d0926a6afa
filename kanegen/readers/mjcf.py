"""Reads MJCF files, the models of MuJoCo, through MuJoCo's own compiler.

{x} and {y} are MuJoCo's `qpos` and `qvel` in another order: a ball joint is a quaternion with the angular
velocity in the body, a free joint has its translation in world axes beside it, and slides and hinges are
single freedoms with the names of their joints. Springs, dampers and actuators are force elements, the
controls of actuators are parameters, and linear equalities of joints are couplings.
"""

from __future__ import annotations

from itertools import chain

from kanegen.errors import ModelError, OptionError, ReadError, quoted, warn
from kanegen.model.coupling import Coupling
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.rotations import ZERO, Triple
from kanegen.model.system import System
from kanegen.readers.mjcf_actuators import actuators
from kanegen.readers.mjcf_compiled import Compiled, compiled
from kanegen.readers.mjcf_couplings import couplings
from kanegen.readers.mjcf_forces import compensated_gravity, dry_friction, springs_and_dampers
from kanegen.readers.mjcf_left_out import LeftOut, left_out, summary
from kanegen.readers.mjcf_tree import MjcfTree, mjcf_tree
from kanegen.readers.mjcf_visuals import mjcf_visuals
from kanegen.readers.reader import ModelFile, Reader, ReadOptions


def read_mjcf(file: ModelFile, options: ReadOptions) -> System:
    """Return the system that an MJCF file describes, as MuJoCo compiles it.

    Args:
        file: The file.
        options: `floating_base` must not be set: an MJCF file says itself which body moves freely. With
            `joint_dynamics`, dry friction of joints becomes `JointFriction`, which is smoothed.

    Raises:
        ReadError: If MuJoCo refuses the file, or the model has a body that cannot exist.
        OptionError: If `floating_base` is set.
        MissingError: If MuJoCo is not installed.

    Warns:
        KanegenWarning: One for all parts of the model that are left out, such as contacts, and one for names
            that have to be changed.
    """
    if options.floating_base:
        raise OptionError(
            f"{file.path}: floating_base is for URDF files. In an MJCF file, put <freejoint/> into the body."
        )
    model = compiled(file)
    if not int(model.model.njnt):
        raise ReadError(f"{file.path}: no joint of this model moves. A body moves by <joint> or <freejoint>.")
    name = file.root.attributes.get("model", "").strip() or file.path.stem
    try:
        tree = mjcf_tree(model)
        system = System(name, tree.bodies, gravity=_gravity(model), frames=tree.frames)
        system, without = _with_forces(system, model, tree, options.joint_dynamics)
    except ModelError as error:
        raise ReadError(f"{file.path}: {error}") from None
    if text := summary(chain(left_out(model), without)):
        warn(f"{file.path}: the equations leave out {text}.")
    if tree.renamed:
        changed = (f"{quoted(old)} is called {quoted(new)}" for old, new in tree.renamed.items())
        warn(f"{file.path}: names that are taken already are changed: {', '.join(changed)}.")
    return system


READER = Reader("MJCF", ".xml", read_mjcf, root="mujoco", visuals=mjcf_visuals)


def _with_forces(
    system: System, model: Compiled, tree: MjcfTree, friction: bool
) -> tuple[System, list[LeftOut]]:
    """Return a system with forces and couplings of a model, and what of them is left out."""
    found = [
        *springs_and_dampers(model, tree),
        *dry_friction(model, tree, friction),
        *actuators(model, tree),
    ]
    elements = [element for element in found if isinstance(element, ForceElement)]
    for frame, center, load in compensated_gravity(model, tree):
        system = system.with_frames({load.point: (frame, center)})
        elements.append(load)
    system = system.with_force_elements(*elements)
    equalities = list(couplings(model, tree))
    coupled = [one for one in equalities if isinstance(one, Coupling)]
    locked = dict(one for one in equalities if isinstance(one, tuple))
    system = system.with_couplings(*coupled) if coupled else system
    system = system.with_locked(locked) if locked else system
    return system, [part for part in (*found, *equalities) if isinstance(part, LeftOut)]


def _gravity(model: Compiled) -> Triple:
    """Return the acceleration of gravity in world axes (m/s^2), zero where the file switches it off."""
    if model.disables("GRAVITY"):
        return ZERO
    x, y, z = (float(component) for component in model.model.opt.gravity)
    return x, y, z
