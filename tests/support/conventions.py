"""One robot in two formats and one state of it, by which the conventions of several programs are compared."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

import kanegen as kg
from kanegen.model.arrays import Floats

OUTPUTS = (
    "mass_matrix",
    "forcing",
    "gravity_forces",
    "coriolis_matrix",
    "inverse_dynamics",
    "kinetic_energy",
    "potential_energy",
    "momentum",
    "centroidal_momentum_matrix",
    "centroidal_momentum_bias",
    "regressor",
    "mass_center",
    "body_poses",
    "frame_velocities",
    "frame_accelerations",
    "frame_jacobians",
)

URDF = """<robot name="robot">
<link name="base"><inertial><origin xyz="0.1 0.2 -0.1" rpy="0.3 -0.2 0.5"/><mass value="4"/>
<inertia ixx="0.4" iyy="0.5" izz="0.6" ixy="0.02" ixz="-0.03" iyz="0.04"/></inertial></link>
<link name="arm"><inertial><origin xyz="0 0.3 0.1"/><mass value="2"/>
<inertia ixx="0.2" iyy="0.1" izz="0.15" ixy="0.01" ixz="0.02" iyz="-0.03"/></inertial></link>
<link name="tool"><inertial><origin xyz="0.05 0 0"/><mass value="1"/>
<inertia ixx="0.05" iyy="0.04" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<origin xyz="0.2 -0.1 0.4" rpy="0.4 0.1 -0.7"/><limit lower="-2" upper="2" velocity="3" effort="9"/></joint>
<joint name="slide" type="prismatic"><parent link="arm"/><child link="tool"/><axis xyz="1 0 0"/>
<origin xyz="0 0.5 0" rpy="0 0.6 0"/><limit lower="-1" upper="1" velocity="3" effort="9"/></joint>
</robot>"""

MJCF = """<mujoco model="robot"><compiler angle="radian" eulerseq="XYZ"/><option gravity="0 0 -9.81"/>
<worldbody>
<body name="base"><freejoint/><inertial pos="0.1 0.2 -0.1" mass="4" {base}/>
<body name="arm" pos="0.2 -0.1 0.4" euler="0.4 0.1 -0.7"><joint name="shoulder" axis="0 1 0"/>
<inertial pos="0 0.3 0.1" mass="2" fullinertia="0.2 0.1 0.15 0.01 0.02 -0.03"/>
<body name="tool" pos="0 0.5 0" euler="0 0.6 0"><joint name="slide" type="slide" axis="1 0 0"/>
<inertial pos="0.05 0 0" mass="1" diaginertia="0.05 0.04 0.03"/></body></body></body></worldbody></mujoco>"""
"""The same robot; an upper-case sequence of MuJoCo is about fixed axes, as rpy is. The inertia of the base,
in the axes of the body, is filled in."""


@dataclass(frozen=True)
class Robot:
    """The robot in kanegen, with quaternions, and everything that it computes of one state.

    Attributes:
        system: The system.
        x: (9,) coordinates: shoulder, quaternion, slide and translations, in the order of the system.
        y: (8,) generalized speeds.
        ydot: (8,) generalized accelerations.
        results: Every output by its name.
    """

    system: kg.System
    x: Floats
    y: Floats
    ydot: Floats
    results: dict[str, Floats]


def write_urdf(folder: Path) -> Path:
    """Write the URDF file and return its path."""
    path = folder / "robot.urdf"
    path.write_text(URDF)
    return path


def write_mjcf(folder: Path) -> Path:
    """Write the MJCF file and return its path."""
    (base, *_) = robot_bodies()
    i = np.asarray(base.inertia, dtype=float)
    entries = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    full = " ".join(repr(float(i[row, column])) for row, column in entries)
    path = folder / "robot.xml"
    path.write_text(MJCF.format(base=f'fullinertia="{full}"'))
    return path


@cache
def robot_bodies() -> tuple[kg.Body, ...]:
    """The bodies of the URDF file."""
    with tempfile.TemporaryDirectory() as folder:
        return kg.load(write_urdf(Path(folder)), floating_base=True).bodies


@cache
def robot() -> Robot:
    """The robot and its results in one state, at which no number is special."""
    system = kg.System("robot", robot_bodies()).with_coordinates("quaternion")
    rng = np.random.default_rng(11)
    x, y = rng.uniform(-0.8, 0.8, len(system.coordinates)), rng.normal(size=len(system.freedoms))
    place = system.coordinate_names.index("base.e0")
    x[place : place + 4] /= np.linalg.norm(x[place : place + 4])
    ydot = rng.normal(size=len(system.freedoms))
    library = kg.build(system, outputs=OUTPUTS)
    arguments = {"mass_matrix": (x,), "potential_energy": (x,), "body_poses": (x,), "mass_center": (x,)}
    arguments |= {"frame_jacobians": (x,), "centroidal_momentum_matrix": (x,), "gravity_forces": (x,)}
    with_ydot = dict.fromkeys(("inverse_dynamics", "frame_accelerations", "regressor"), (x, y, ydot))
    results = {
        name: np.asarray(getattr(library, name)(*(arguments | with_ydot).get(name, (x, y))))
        for name in OUTPUTS
    }
    return Robot(system, x, y, ydot, results)
