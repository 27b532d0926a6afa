"""The reader of MJCF files: values against MuJoCo, several joints of one body, and errors."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import KanegenError, KanegenWarning, OptionError, ReadError
from tests.support.mujoco_models import MODELS, MujocoModel, assert_same_values, model_file, random_model

pytestmark = pytest.mark.filterwarnings("ignore:.*the equations leave out:kanegen.errors.KanegenWarning")


def body(joints: str, inside: str = "") -> str:
    """Return a model of one body with some joints."""
    return (
        f'<mujoco><compiler angle="radian"/><worldbody><body name="one" pos="0.1 0.2 0.3">{joints}'
        '<inertial mass="2" pos="0.1 0 0" diaginertia="0.3 0.4 0.5"/>'
        f"{inside}</body></worldbody></mujoco>"
    )


@pytest.mark.parametrize("path", MODELS, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_dynamics_of_published_models_are_those_of_mujoco(path: Path) -> None:
    assert_same_values(path)


@pytest.mark.parametrize("seed", range(40))
def test_dynamics_of_random_models_are_those_of_mujoco(seed: int, tmp_path: Path) -> None:
    assert_same_values(model_file(tmp_path, random_model(seed)), states=1)


@pytest.mark.parametrize("seed", range(3))
def test_bodies_and_sites_are_frames_where_mujoco_has_them(seed: int, tmp_path: Path) -> None:
    path = model_file(tmp_path, random_model(seed, bodies=4))
    system = kg.load(path)
    mujoco = MujocoModel(path, system)
    names = [name for name in system.frame_names if ":" not in name]
    assert {"b1", "b2", "b3", "b4", "s1", "s4", "b2_site"} <= set(names)
    x, _ = mujoco.draw_state(np.random.default_rng(seed))
    poses = kg.build(system.with_poses(names), outputs=("body_poses",)).body_poses(x)
    for name, pose in zip(names, poses, strict=True):
        rotation, position = mujoco.frame(name.removesuffix("_site"), name.startswith("s") or "_" in name)
        np.testing.assert_allclose(pose[:3], rotation.T, atol=1e-13)
        np.testing.assert_allclose(pose[3], position, atol=1e-13)


def test_limits_of_slides_and_hinges_are_kept(tmp_path: Path) -> None:
    joints = '<joint name="x" type="slide" range="-1 2" limited="true" actuatorfrcrange="-3 4"/>'
    joints += '<joint name="free" axis="1 0 0" range="0 0" limited="false"/>'
    system = kg.load(model_file(tmp_path, body(joints)))
    assert system.freedom_names == ("free", "x")
    assert system.limits.lower.tolist() == [-np.inf, -1]
    assert system.limits.upper.tolist() == [np.inf, 2]
    assert system.limits.effort.tolist() == [np.inf, 4]


def test_names_are_those_of_the_file(tmp_path: Path) -> None:
    joints = '<joint name="my joint"/><joint name="my_joint" axis="1 0 0"/><joint axis="0 1 0"/>'
    system = kg.load(model_file(tmp_path, body(joints)))
    assert set(system.freedom_names) == {"my joint", "my_joint", "joint2"}


def test_joints_through_one_point_about_axes_of_one_frame_are_one_joint(tmp_path: Path) -> None:
    joints = (
        '<joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1" ref="1.25"/>'
    )
    joints += '<joint name="pitch" axis="0 1 0" pos="0 0 0.5"/>'
    system = kg.load(model_file(tmp_path, body(joints)))
    assert [one.name for one in system.bodies] == ["one"]
    assert system.freedom_names == ("pitch", "x", "z")
    assert system.bodies[0].joint.free == (False, True, False, True, False, True)


@pytest.mark.parametrize(
    ("axes", "sequence", "free"),
    [
        (("1 0 0", "0 1 0", "0 0 1"), "1-2-3", (0, 1, 2)),
        (("1 0 0", "0 0 1", "0 1 0"), "1-3-2", (0, 1, 2)),
        (("0 0 1", "1 0 0", "0 0 1"), "3-1-3", (0, 1, 2)),
        (("1 0 0", "0 0 1"), "1-2-3", (0, 2)),
        (("0 0 1", "0 1 0"), "1-3-2", (1, 2)),
        (("0 1 0",), "1-2-3", (1,)),
    ],
)
def test_hinges_are_angles_of_a_sequence(
    axes: tuple[str, ...], sequence: str, free: tuple[int, ...], tmp_path: Path
) -> None:
    joints = "".join(f'<joint name="{name}" axis="{axis}"/>' for name, axis in zip("abc", axes, strict=False))
    (only,) = kg.load(model_file(tmp_path, body(joints))).bodies
    assert only.joint.sequence == sequence
    assert only.joint.free == tuple(i in free for i in range(6))
    assert only.joint.orientation == ((1, 0, 0), (0, 1, 0), (0, 0, 1))


@pytest.mark.parametrize(
    "joints",
    [
        '<joint name="a" axis="1 0 0"/><joint name="b" axis="1 0 0" pos="0 0 1"/>',
        '<joint name="a" axis="1 0 0"/><joint name="b" axis="0 1 0" pos="0 0 1"/>',
        '<joint name="a" axis="1 0 0"/><joint name="b" axis="1 1 0"/>',
        '<joint name="a" axis="1 0 0"/><joint name="b" type="slide" axis="0 1 0"/>',
        '<joint name="a" axis="1 0 0" type="slide"/><joint name="b" type="hinge" axis="-1 0 0"/>',
    ],
)
def test_other_joints_have_a_massless_body_between_them(joints: str, tmp_path: Path) -> None:
    system = kg.load(model_file(tmp_path, body(joints)))
    assert [(one.name, one.mass, one.lower) for one in system.bodies] == [("one:a", 0.0, 0), ("one", 2.0, 1)]
    assert set(system.freedom_names) == {"a", "b"}


def test_a_free_body_is_a_quaternion_in_world_axes(tmp_path: Path) -> None:
    system = kg.load(model_file(tmp_path, body("<freejoint/>")))
    assert system.coordinate_names[:4] == ("one.e0", "one.e1", "one.e2", "one.e3")
    assert system.coordinate_names[4:] == ("one.s1", "one.s2", "one.s3")
    assert system.bodies[0].joint.position == (0, 0, 0)


def test_static_bodies_are_welded(tmp_path: Path) -> None:
    inside = (
        '<body name="top" pos="0 0 1"><inertial mass="2" pos="0.1 0 0" diaginertia="0.3 0.4 0.5"/></body>'
    )
    (only,) = kg.load(model_file(tmp_path, body("<joint/>", inside))).bodies
    assert only.mass == 4
    assert only.mass_center == pytest.approx((0.1, 0, 0.5))
    assert only.inertia[2][2] == 1.0


def test_names_of_freedoms_survive_saving(tmp_path: Path) -> None:
    system = kg.load(MODELS[0].with_name("half_cheetah.xml").parents[1] / "gymnasium" / "half_cheetah.xml")
    system.save(tmp_path / "cheetah.toml")
    assert kg.load(tmp_path / "cheetah.toml") == system
    assert {"rootx", "rootz", "rooty"} < set(system.freedom_names)


def test_gravity_that_is_switched_off_is_zero(tmp_path: Path) -> None:
    text = body("<joint/>").replace("<worldbody>", '<option><flag gravity="disable"/></option><worldbody>')
    assert kg.load(model_file(tmp_path, text)).gravity == (0, 0, 0)


NO_MESH = """<mujoco><asset><mesh name="m" file="no.stl"/></asset>
<worldbody><body><joint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "<mujoco>\n<worldbody>\n<body><foo/></body></worldbody></mujoco>",
            r":3: MuJoCo refuses the model: .*foo",
        ),
        ("<mujoco><worldbody/></mujoco>", "no joint of this model moves"),
        ("<mujoco", "not well-formed XML"),
        ("<robot/>", "a URDF file: let its name end in .urdf"),
        ('<mujoco>\n<include file="no.xml"/></mujoco>', "no.xml.*Put the file where the model"),
        (NO_MESH, "no.stl.*Put the file where the model"),
        ("<mujoco><worldbody><body><joint/></body></worldbody></mujoco>", "mass and inertia"),
        (body('<joint name="j" axis="inf 0 0"/>'), "joint 'j' has a number that is not finite"),
        (body('<joint ref="inf"/>'), r"the model has a number that is not finite \(qpos0\)"),
    ],
)
def test_a_file_that_mujoco_refuses_gets_one_line(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ReadError, match=message) as caught:
        kg.load(model_file(tmp_path, text))
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(str(tmp_path / "model.xml"))


MESH = '<geom type="mesh" mesh="m"/><geom type="box" size="1 1 1" material="shiny"/>'


def test_a_missing_mesh_is_no_loss_where_the_body_has_its_inertia(tmp_path: Path) -> None:
    assets = '<asset><mesh name="m" file="no.stl"/><texture name="t" type="2d" file="no.png"/>'
    assets += '<material name="shiny" texture="t"/></asset><worldbody>'
    path = model_file(tmp_path, body("<joint/>" + MESH).replace("<worldbody>", assets))
    with pytest.warns(
        KanegenWarning, match="no.stl.*No inertia needs it, so meshes and textures are left out"
    ):
        system = kg.load(path)
    assert system.bodies[0].mass == 2
    without = re.sub("<inertial[^>]*/>", "", path.read_text())
    with pytest.raises(ReadError, match=r"opening file.*no\.stl"):
        kg.load(model_file(tmp_path, without))


def test_a_floating_base_is_for_urdf_files(tmp_path: Path) -> None:
    with pytest.raises(OptionError, match="put <freejoint/> into the body"):
        kg.load(model_file(tmp_path, body("<joint/>")), floating_base=True)


def test_without_mujoco_the_error_says_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kanegen.extras.importlib.util.find_spec", lambda name: None)
    with pytest.raises(KanegenError, match=r"mujoco is not installed \(pip install 'kanegen\[mujoco\]'\)"):
        kg.load(model_file(tmp_path, body("<joint/>")))
