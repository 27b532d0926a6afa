"""Compiles MJCF files with MuJoCo's own compiler: defaults, classes, includes and inertias are MuJoCo's.

The compiler opens the files that a model includes, its meshes and textures, and nothing else; a model file
contains no code. Numbers that the compiler converts, such as quaternions from angles, have its rounding
error.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from kanegen import extras
from kanegen.errors import ReadError, quoted, warn
from kanegen.model import right_angles
from kanegen.model.rotations import UNIT, ZERO, Square, Triple, normalized, rotation_quaternion, transpose
from kanegen.readers.mjcf_assets import compiled_without_assets
from kanegen.readers.reader import ModelFile
from kanegen.readers.welding import Frame, Rigid

ROUNDING = 2e-15
"""Largest error (rad) of a direction or an orientation by the conversions of MuJoCo's compiler."""

_NUMBERS = (
    ("body", "body", ("pos", "quat", "mass", "inertia", "ipos", "iquat", "gravcomp")),
    ("joint", "jnt", ("pos", "axis", "stiffness")),
    ("site", "site", ("pos", "quat")),
)
"""Kinds of parts, what the names of their arrays begin with, and the arrays that the reader uses."""

_OTHER_NUMBERS = """
    qpos0 qpos_spring jnt_stiffnesspoly dof_armature dof_damping dof_dampingpoly dof_frictionloss
    actuator_gear actuator_gainprm actuator_biasprm actuator_armature actuator_damping actuator_dampingpoly
    tendon_stiffness tendon_stiffnesspoly tendon_damping tendon_dampingpoly wrap_prm eq_data
""".split()
"""Further arrays that the reader uses."""

_NO_RANGE = (-math.inf, math.inf)

_NOT_OF_THE_FILE = "is deprecated|Inertia matrix is too close to singular"
"""Warnings of MuJoCo about old syntax, and about the state in which it tries its own solver."""

_NO_FILE = "Error opening file"
"""What MuJoCo says of a file that a model refers to and that is missing."""

JointType = Literal["free", "ball", "slide", "hinge"]
JOINT_TYPES: tuple[JointType, ...] = ("free", "ball", "slide", "hinge")
"""Types of joints, in the order of MuJoCo's `mjtJoint`."""


@dataclass(frozen=True)
class MjcfJoint:
    """A joint of a body in an MJCF file.

    Attributes:
        number: Its number in the compiled model, from 0.
        name: Its name.
        type: One of `JOINT_TYPES`.
        axis: (3,) unit vector of a slide or a hinge, in the frame of the body.
        anchor: (3,) point about which the joint turns, in the frame of the body (m).
        reference: Coordinate of a slide or a hinge where the body is at its place in the file (m or rad).
        range: Smallest and largest coordinate of a slide or a hinge (m or rad).
        effort: Largest magnitude of the force of actuators on a slide or a hinge (N or N m).
        armature: Reflected inertia against each of its speeds (kg m^2 or kg).
    """

    number: int
    name: str
    type: JointType
    axis: Triple
    anchor: Triple
    reference: float
    range: tuple[float, float]
    effort: float
    armature: float


@dataclass(frozen=True)
class Compiled:
    """A model that MuJoCo has compiled.

    Attributes:
        path: The file.
        mujoco: The module `mujoco`.
        model: The `mujoco.MjModel`.
    """

    path: Path
    mujoco: Any
    model: Any

    def disables(self, flag: str) -> bool:
        """Return whether the file switches off a part of the physics, such as "GRAVITY"."""
        bit = getattr(self.mujoco.mjtDisableBit, f"mjDSBL_{flag}")
        return bool(int(self.model.opt.disableflags) & int(bit))

    def name(self, kind: str, number: int) -> str:
        """Return the name of an object of a kind such as "body", `<kind><number>` where the file has none."""
        return str(getattr(self.model, kind)(number).name) or f"{kind}{number}"

    def of_actuator(self, values: Any, actuator: int) -> float:
        """Return the inertia or damping that an actuator adds to what it drives, 0 for the number -1."""
        if actuator < 0:
            return 0.0
        gear = float(self.model.actuator_gear[self.model.actuator_outadr[actuator]][0])
        return gear * gear * float(values[actuator])

    def names(self, kind: str, numbers: Iterable[int]) -> tuple[str, ...]:
        """Return the names of several objects of a kind."""
        return tuple(self.name(kind, int(number)) for number in numbers)

    def parent(self, body: int) -> int:
        """Return the number of the parent of a body; 0 is the world."""
        return int(self.model.body_parentid[body])

    def place(self, body: int) -> Frame:
        """Return the frame of a body in its parent, at reference coordinates."""
        return Frame(triple(self.model.body_pos[body]), rotation(self.model.body_quat[body]))

    def site(self, site: int) -> Frame:
        """Return the frame of a site in its body."""
        return Frame(triple(self.model.site_pos[site]), rotation(self.model.site_quat[site]))

    def rigid(self, body: int) -> Rigid:
        """Return the mass properties of a body in its own frame."""
        moments = triple(self.model.body_inertia[body])
        axes = transpose(rotation(self.model.body_iquat[body]))
        center = triple(self.model.body_ipos[body])
        return Rigid(float(self.model.body_mass[body]), center, _inertia(moments, axes))

    def joints(self, body: int) -> list[MjcfJoint]:
        """Return the joints of a body in the order in which they move it."""
        first = int(self.model.body_jntadr[body])
        return [self._joint(number) for number in range(first, first + int(self.model.body_jntnum[body]))]

    def _joint(self, number: int) -> MjcfJoint:
        """Return a joint by its number."""
        model = self.model
        scalar = JOINT_TYPES[int(model.jnt_type[number])] in ("slide", "hinge")
        lower, upper = model.jnt_range[number] if scalar and model.jnt_limited[number] else _NO_RANGE
        forces = model.jnt_actfrcrange[number] if scalar and model.jnt_actfrclimited[number] else _NO_RANGE
        return MjcfJoint(
            number=number,
            name=self.name("joint", number),
            type=JOINT_TYPES[int(model.jnt_type[number])],
            axis=right_angles.direction(normalized(triple(model.jnt_axis[number])), ROUNDING),
            anchor=triple(model.jnt_pos[number]),
            reference=float(model.qpos0[model.jnt_qposadr[number]]),
            range=(float(lower), float(upper)),
            effort=max(abs(float(force)) for force in forces),
            armature=float(model.dof_armature[model.jnt_dofadr[number]])
            + self.of_actuator(model.actuator_armature, int(model.jnt_actuatorid[number])),
        )


def compiled(file: ModelFile) -> Compiled:
    """Return the model in an MJCF file as MuJoCo compiles it.

    Raises:
        ReadError: If MuJoCo refuses the file.
        MissingError: If MuJoCo is not installed.

    Warns:
        KanegenWarning: If MuJoCo warns of something in the file other than old syntax.
    """
    mujoco = extras.module("mujoco", extra=extras.MUJOCO)
    messages: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(messages.append)  # or MuJoCo writes a file into the current folder
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            model = _model(mujoco, file, messages)
    finally:
        mujoco.set_mju_user_warning(before)
    for message in map(_one_line, (*messages, *(str(warning.message) for warning in caught))):
        if not re.search(_NOT_OF_THE_FILE, message):
            warn(f"{file.path}: MuJoCo warns: {message}.")
    found = Compiled(file.path, mujoco, model)
    _check_numbers(found)
    return found


def _model(mujoco: Any, file: ModelFile, messages: list[str]) -> Any:
    """Return the `mujoco.MjModel` of a file; what MuJoCo says beside it is added to `messages`.

    Raises:
        ReadError: If MuJoCo refuses the file.
    """
    path = str(file.path)
    try:
        spec = mujoco.MjSpec.from_file(path)
    except Exception as error:
        raise ReadError(_refusal(file, str(error))) from None
    try:
        return spec.compile()
    except Exception as error:
        model = compiled_without_assets(mujoco, path) if _NO_FILE in str(error) else None
        if model is None:
            raise ReadError(_refusal(file, str(error))) from None
        messages.append(f"{error}. No inertia needs it, so meshes and textures are left out")
        return model


def _check_numbers(compiled: Compiled) -> None:
    """Make sure that the numbers of the model are finite, and its directions not zero.

    Raises:
        ReadError: If one is not; the message names the part, or the array of MuJoCo.
    """
    for kind, prefix, names in _NUMBERS:
        for name in names:
            for number, row in enumerate(getattr(compiled.model, f"{prefix}_{name}")):
                if problem := _problem(row, is_direction=name.endswith("quat") or name == "axis"):
                    label = f"{kind} {quoted(compiled.name(kind, number))}"
                    raise ReadError(f"{compiled.path}: {label} has {problem} ({name}). Correct its numbers.")
    arrays = [(name, getattr(compiled.model, name)) for name in _OTHER_NUMBERS]
    for name, values in (*arrays, ("gravity", compiled.model.opt.gravity)):
        if problem := _problem(values):
            raise ReadError(f"{compiled.path}: the model has {problem} ({name}). Correct its numbers.")


def _problem(values: Any, is_direction: bool = False) -> str:
    """Return what is wrong with an array of numbers, "" if nothing is."""
    entries = [float(value) for value in values.flat]
    if not all(map(math.isfinite, entries)):
        return "a number that is not finite"
    return "no direction" if is_direction and not any(entries) else ""


def triple(values: Any) -> Triple:
    """Return three numbers of the compiled model, with zeros where a number is the rounding error of zero."""
    x, y, z = (float(value) for value in values)
    limit = ROUNDING * max(abs(x), abs(y), abs(z))
    return (
        x if abs(x) > limit else 0.0,
        y if abs(y) > limit else 0.0,
        z if abs(z) > limit else 0.0,
    )


def rotation(quaternion: Any) -> Square:
    """Return the rotation from a frame that is turned by a quaternion w, x, y, z to the frame before."""
    w, x, y, z = (float(value) for value in quaternion)
    return right_angles.rotation(rotation_quaternion(x, y, z, w), ROUNDING)


def _inertia(moments: Triple, axes: Square) -> Square:
    """Return the inertia with principal moments about axes, the rows of `axes`.

    With m the least moment it is m [1] + sum (m_i - m) {a_i} {a_i}^T, which is diagonal without rounding
    errors where two or three moments are equal about axes of the frame.
    """
    least = min(moments)

    def entry(i: int, j: int) -> float:
        further = zip(moments, axes, strict=True)
        return least * UNIT[i][j] + sum((moment - least) * axis[i] * axis[j] for moment, axis in further)

    def row(i: int) -> Triple:
        return entry(i, 0), entry(i, 1), entry(i, 2)

    return (row(0), row(1), row(2)) if any(moments) else (ZERO, ZERO, ZERO)


def _refusal(file: ModelFile, message: str) -> str:
    """Return in one line why MuJoCo refuses a file, with the line of the file where it is known."""
    line = re.search(r",? *line (\d+)", message)
    place = str(file.path)
    if line and not _includes(file):
        message = message.replace(line[0], "")
        place += f":{line[1]}" if int(line[1]) else ""
    hint = ""
    if _NO_FILE in message:
        hint = " Put the file where the model expects it, beside the model or in its meshdir."
    return f"{place}: MuJoCo refuses the model: {_one_line(message)}.{hint}"


def _includes(file: ModelFile) -> bool:
    """Return whether a file includes others, so that a number of a line may be that of another file."""
    waiting = [file.root]
    while waiting:
        element = waiting.pop()
        if element.tag == "include":
            return True
        waiting += element.children
    return False


def _one_line(message: str) -> str:
    """Return a message of MuJoCo as one line, without a full stop at its end."""
    words = re.sub(r"^(XML )?(Error: )+", "", message.strip())
    return "; ".join(line.strip().rstrip(".") for line in words.splitlines() if line.strip())
