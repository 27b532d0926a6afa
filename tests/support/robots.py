"""Real robots and their dynamics by Pinocchio, in kanegen's coordinates."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from kanegen.model.arrays import Floats
from kanegen.model.system import System

FIXED_ROBOTS = ("panda", "ur5_robot", "kinova", "allegro_right_hand", "double_pendulum")
"""Robots of example-robot-data whose root link is welded to the ground."""

FLOATING_ROBOTS = ("hyq_no_sensors", "solo12")
"""Robots of example-robot-data whose root link has six freedoms."""

REFUSED = {
    "quadrotor_base": r"quadrotor_base\.urdf:\d+: no joint of this robot moves\. floating_base=True frees",
    "iris_simple": r"iris_simple\.urdf:\d+: no joint of this robot moves",
    "romeo_laas_small": r"romeo_laas_small\.urdf:\d+: body '\w+': inertia is not positive semidefinite",
    "alex_psyonic_hands": r"alex_psyonic_hands\.urdf:\d+: <mimic>: there is no joint 'index_q1'",
    "ur3": r"ur3\.urdf:\d+: the robot has no <link>",
}
"""Error messages for files that describe no freedom, or a body that cannot exist, by stem."""

FOLLOWERS_FIRST = ("romeo", "talos_full_v2", "talos_full_v2_box")
"""Files in which a joint with `mimic` follows a joint further out or in another branch; Pinocchio refuses."""

FREE = ("s1", "s2", "s3", "theta1", "theta2", "theta3")
"""Freedoms of a floating joint in Pinocchio's order."""

Several = dict[str, tuple[str, ...]]
"""kanegen's names of the freedoms of joints with more than one, in Pinocchio's order."""


def robot_files() -> list[Path]:
    """Every URDF file of example-robot-data."""
    files = metadata.files("example-robot-data") or []
    return sorted(Path(str(file.locate())) for file in files if file.suffix == ".urdf")


def robot_file(name: str) -> Path:
    """The file `name`.urdf of example-robot-data."""
    (path,) = [path for path in robot_files() if path.stem == name]
    return path


def angles_and_translations() -> pin.JointModelComposite:
    """Six freedoms in kanegen's coordinates: translation in the lower frame, then 1-2-3 angles."""
    joint = pin.JointModelComposite(pin.JointModelTranslation())
    for turn in (pin.JointModelRX(), pin.JointModelRY(), pin.JointModelRZ()):
        joint.addJoint(turn)
    return joint


def fixed_model(path: Path) -> pin.Model:
    """Pinocchio's reading of a robot whose root link is welded to the ground; joints follow by `mimic`."""
    return pin.buildModelFromUrdf(str(path), mimic=True)


def floating_model(path: Path, system: System) -> tuple[pin.Model, Several]:
    """Pinocchio's reading of a robot whose root link has six freedoms; joints follow by `mimic`."""
    model = pin.buildModelFromUrdf(str(path), angles_and_translations(), mimic=bool(system.couplings))
    return model, {"root_joint": tuple(f"{system.bodies[0].name}.{name}" for name in FREE)}


def places(system: System, model: pin.Model, several: Several) -> NDArray[np.int64]:
    """For every velocity of Pinocchio's model its place in {x}."""
    joints = zip(list(model.names)[1:], list(model.joints)[1:], strict=True)
    moving = [name for name, joint in joints if joint.nv]
    names = [freedom for joint in moving for freedom in several.get(joint, (joint,))]
    assert sorted(names) == sorted(system.freedom_names)
    return np.array([system.freedom_names.index(name) for name in names])


def dynamics(model: pin.Model, order: NDArray[np.int64], x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """[A] and {f} by Pinocchio, rows and columns in the order of {x}."""
    n = len(order)
    data = model.createData()
    q = pin.integrate(model, pin.neutral(model), x[order])
    upper = np.array(pin.crba(model, data, q))
    a, f = np.zeros((n, n)), np.zeros(n)
    a[np.ix_(order, order)] = np.triu(upper) + np.triu(upper, 1).T
    f[order] = -pin.nonLinearEffects(model, data, q, y[order])
    return a, f
