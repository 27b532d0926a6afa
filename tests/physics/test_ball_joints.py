"""Ball joints of robot files and TOML: a quaternion and the angular velocity, compared with Pinocchio's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import kanegen as kg
from kanegen.reference import equations as reference
from tests.support.paths import FROM_REPORTS
from tests.support.urdf import axis, joint, link, origin

CHEST = FROM_REPORTS / "spherical.urdf"
ARM = f"""<robot name="arm"><link name="root"/>
    {link("upper", 3, origin("0 0.1 -0.2"))}{link("fore", 2)}{link("hand")}
    {joint("shoulder", "root", "upper", origin("0.1 0 1", "0.1 0.2 0.3"), "ball")}
    {joint("elbow", "upper", "fore", origin("0 0 -0.4") + axis("0 1 0"))}
    {joint("wrist", "fore", "hand", origin("0.1 0 -0.3", "0 1 0"), "spherical")}</robot>"""


@pytest.mark.parametrize("kind", ["spherical", "ball"])
def test_the_arm_of_a_public_report(kind: str, tmp_path: Path) -> None:
    """[A] is the inertia about the joint: I_G + m (r.r 1 - r r^T), with r = (0, 0.1, -0.2) m and m = 3 kg."""
    path = tmp_path / "chest.urdf"
    path.write_text(CHEST.read_text().replace("spherical", kind))
    system = kg.load(path)
    assert system.coordinate_names == ("upper.e0", "upper.e1", "upper.e2", "upper.e3")
    assert system.speed_names == ("upper.omega1", "upper.omega2", "upper.omega3")
    expected = [[0.25, 0.01, 0], [0.01, 0.32, 0.06], [0, 0.06, 0.18]]
    library = kg.build(system)
    np.testing.assert_allclose(library.mass_matrix([1, 0, 0, 0]), expected, atol=1e-16)
    turned = [0.5, 0.1, -0.7, 0.2]
    np.testing.assert_allclose(library.mass_matrix(turned), expected, atol=1e-16)  # components in the body


def pinocchio_arm() -> pin.Model:
    """Return the arm with Pinocchio's own ball joints, which its reader of URDF does not know."""
    model = pin.Model()
    model.gravity.linear = np.array([0, 0, -9.81])
    turned = pin.rpy.rpyToMatrix(0.1, 0.2, 0.3)
    inertia = np.diag([3.0, 4.0, 5.0])
    shoulder = model.addJoint(0, pin.JointModelSpherical(), pin.SE3(turned, np.array([0.1, 0, 1])), "s")
    model.appendBodyToJoint(shoulder, pin.Inertia(3, np.array([0, 0.1, -0.2]), inertia), pin.SE3.Identity())
    elbow = model.addJoint(shoulder, pin.JointModelRY(), pin.SE3(np.eye(3), np.array([0, 0, -0.4])), "e")
    model.appendBodyToJoint(elbow, pin.Inertia(2, np.zeros(3), inertia), pin.SE3.Identity())
    place = pin.SE3(pin.rpy.rpyToMatrix(0.0, 1.0, 0.0), np.array([0.1, 0, -0.3]))
    wrist = model.addJoint(elbow, pin.JointModelSpherical(), place, "w")
    model.appendBodyToJoint(wrist, pin.Inertia(1, np.zeros(3), inertia), pin.SE3.Identity())
    return model


def test_a_tree_with_ball_joints_agrees_with_pinocchio(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    system, model = kg.load(path), pinocchio_arm()
    data = model.createData()
    rng = np.random.default_rng(4)
    for _ in range(20):
        first, second = rng.normal(size=(2, 4))
        hinge, y = rng.uniform(-3, 3), rng.normal(size=7)
        x = np.concatenate([first, [hinge], second])
        turns = [np.roll(e / np.linalg.norm(e), -1) for e in (first, second)]  # Pinocchio's scalar is last
        q = np.concatenate([turns[0], [hinge], turns[1]])
        upper = np.triu(pin.crba(model, data, q))
        a = upper + np.triu(upper, 1).T
        f = -pin.nonLinearEffects(model, data, q, y)
        np.testing.assert_allclose(reference.mass_matrix(system, x), a, atol=1e-13 * np.abs(a).max())
        np.testing.assert_allclose(reference.forcing(system, x, y), f, atol=1e-13 * np.abs(f).max())
        library = kg.build(system)
        np.testing.assert_allclose(library.mass_matrix(x), a, atol=1e-13 * np.abs(a).max())
        np.testing.assert_allclose(library.forcing(x, y), f, atol=1e-13 * np.abs(f).max())


@pytest.mark.parametrize(("name", "free"), [("ball", '["theta1", "theta2", "theta3"]'), ("free", '"all"')])
def test_types_of_joints_in_toml(name: str, free: str, tmp_path: Path) -> None:
    """The type is a short form: the system is that with the freedoms and coordinates written out."""
    text = "[[body]]\nconnection = 0\nmass = 2\ninertia = [1, 2, 2]\njoint.position = [0, 0, 1]\n"
    path, other = tmp_path / "m.toml", tmp_path / "other" / "m.toml"
    other.parent.mkdir()
    path.write_text(f'{text}joint.type = "{name}"\n')
    other.write_text(f'{text}joint.free = {free}\njoint.coordinates = "quaternion"\n')
    assert kg.load(path) == kg.load(other)
    kg.load(path).save(path)
    assert kg.load(path) == kg.load(other)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ('type = "bal"', r"joint type: 'bal' is unknown\. Did you mean 'ball'\?"),
        ("type = 3", r"joint type: 3 is unknown\. Known are 'ball', 'free'\."),
        (
            'type = "ball"\nfree = ["theta1"]\ncoordinates = "angles"',
            r'joint type: "ball" says what is free\. Leave out free and coordinates, or the type\.',
        ),
    ],
)
def test_wrong_types_of_joints_in_toml(lines: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text(f"[[body]]\nconnection = 0\nmass = 2\n[body.joint]\n{lines}\n")
    with pytest.raises(kg.ReadError, match=message):
        kg.load(path)


def test_a_ball_joint_cannot_be_followed(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(ARM.replace("<axis", '<mimic joint="wrist"/><axis'))
    with pytest.raises(
        kg.ReadError, match=r"joint 'wrist' is to be followed, but is spherical and has 3 freed"
    ):
        kg.load(path)
