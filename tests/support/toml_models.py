"""Models as the text of TOML files."""

from __future__ import annotations

from pathlib import Path

from kanegen.model.system import System
from kanegen.readers import load

ONE_BODY = '[[body]]\nname = "b"\nconnection = 0\nmass = 1\n'
"""The table of one body on the ground."""

ROD = """
gravity = [0, 0, "-g"]
[parameters]
Iyy = "m*l**2/12"
g = 9.81
m = 2.0
l = 0.5
alpha = 0.3
[[body]]
name = "rod"
connection = "ground"
mass = "m"
mass_center = [0, 0, "-l/2"]
inertia = ["Iyy", "Iyy", "Iyy*1e-4"]
joint.free = ["theta1"]
joint.orientation_angles = ["pi/6", "-alpha", 0]
joint.position = ["1/12", "l*cos(alpha)", 0]
points = {tip = [0, 0, "-l"]}
frames = {hand = {position = [0, 0, "-l"], orientation_angles = ["alpha/2", 0, "pi/2"]}}
[[body]]
name = "tip"
connection = "rod"
mass = "m/2"
mass_center = [0, 0, "-l/2"]
inertia = ["Iyy/2", "Iyy/2", "Iyy*1e-4"]
joint.free = ["theta1", "s2"]
joint.locked.theta3 = "-alpha"
joint.position = [0, 0, "-l"]
joint.armature.theta1 = "Iyy"
[[body]]
name = "follower"
connection = "rod"
mass = 0.1
joint = {free = ["s3"]}
[[coupling]]
freedom = "follower.s3"
terms = {"tip.s2" = "l/2"}
offset = "-l"
[[rotor]]
name = "motor"
freedom = "tip.theta1"
axis = [0, "-1/3", 0]
inertia = "Iyy/1000"
ratio = "-(2 + 1)"
[[joint_spring]]
freedom = "tip.theta1"
stiffness = "m*g*l"
rest = "-alpha"
[[spring]]
between = ["tip", [0, "l", 0]]
stiffness = "2*m*g/l"
rest_length = "l/2"
[[drive]]
freedom = "tip.s2"
effort = "-Iyy*y.tip.s2"
"""
"""A model with an expression wherever a number may stand."""


def read_toml(folder: Path, text: str) -> System:
    """Write `text` to a file `model.toml` in `folder` and load it."""
    file = folder / "model.toml"
    file.write_text(text, encoding="utf-8")
    return load(file)
