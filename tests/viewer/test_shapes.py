"""Shapes of files stand where Pinocchio and MuJoCo put them, and ellipsoids have the inertia of their
bodies."""

from __future__ import annotations

import base64
import importlib.util
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import trimesh

import kanegen as kg
from kanegen import extras
from kanegen.interop.pinocchio import state_map
from kanegen.viewer.ellipsoids import THINNEST, equivalent_ellipsoid
from kanegen.viewer.making import scene_of
from kanegen.viewer.poses import body_poses, wxyz
from kanegen.viewer.scene import MeshData, Scene, Shape
from tests.support.mujoco_models import DATA, MujocoModel
from tests.support.robots import robot_file
from tests.support.systems import random_inertia, random_rotation

pytestmark = pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")

TOLERANCE = 1e-9
"""Of rounding errors, and of the nine digits of some numbers in the files (m)."""


def placed(scene: Scene, system: kg.System, x: Any) -> list[tuple[Shape, np.ndarray, np.ndarray]]:
    """The shapes of the file with their inertial rotations and centres, in the order of bodies."""
    rotations, origins = body_poses(system.values(), x, np.zeros(len(system.prescribed)))
    return [
        (shape, turn @ np.reshape(shape.rotation, (3, 3)), origin + turn @ shape.position)
        for body, turn, origin in zip(scene.bodies, rotations, origins, strict=True)
        for shape in body.shapes
        if shape.role == "geometry"
    ]


def vertices_of(mesh: MeshData) -> np.ndarray:
    integers = np.frombuffer(base64.b64decode(mesh.vertices), "<u2").reshape(-1, 3)
    return np.array(mesh.origin) + integers * np.array(mesh.step)


def test_primitives_of_mjcf_stand_where_mujoco_puts_them() -> None:
    path = DATA / "gymnasium" / "humanoid.xml"
    system = kg.load(path)
    scene = scene_of(system)
    simulator = MujocoModel(path, system)
    x, _ = simulator.draw_state(np.random.default_rng(3))
    mujoco = extras.module("mujoco", extra=extras.MUJOCO)
    mujoco.mj_kinematics(simulator.model, simulator.data)
    plane = int(mujoco.mjtGeom.mjGEOM_PLANE)
    geoms = [i for i in range(simulator.model.ngeom) if simulator.model.geom_type[i] != plane]
    found = placed(scene, system, x)
    assert len(found) == len(geoms) == 17
    for place in geoms:
        kind = mujoco.mjtGeom(int(simulator.model.geom_type[place])).name.removeprefix("mjGEOM_").lower()
        radius, half, _ = simulator.model.geom_size[place]
        size = [radius, 2 * half] if kind == "capsule" else [radius]
        axis = simulator.data.geom_xmat[place].reshape(3, 3)[:, 2]
        assert any(
            shape.kind == kind
            and shape.size == pytest.approx(size)
            and center == pytest.approx(simulator.data.geom_xpos[place], abs=TOLERANCE)
            and (kind == "sphere" or rotation[:, 2] == pytest.approx(axis, abs=TOLERANCE))
            for shape, rotation, center in found
        ), place


MESH_MODEL = """
<mujoco model="wedge">
  <compiler meshdir="meshes"/>
  <asset><mesh name="wedge" file="wedge.stl" scale="0.5 0.4 0.3"/></asset>
  <worldbody>
    <body name="arm" pos="0.1 0.2 0.3" euler="10 20 30">
      <joint name="hinge" axis="0 1 1"/>
      <geom type="mesh" mesh="wedge" pos="0.05 -0.1 0.2" euler="40 50 60" rgba="1 0 0 1"/>
      <geom type="box" size="0.1 0.2 0.3" group="3"/>
    </body>
  </worldbody>
</mujoco>
"""


def test_meshes_of_mjcf_stand_where_mujoco_puts_them(tmp_path: Path) -> None:
    """The compiler turns a mesh into its principal frame and scales it; the file has neither."""
    (tmp_path / "meshes").mkdir()
    corners = np.random.default_rng(4).uniform(-1, 2, (12, 3))
    trimesh.convex.convex_hull(corners).export(tmp_path / "meshes" / "wedge.stl")
    (tmp_path / "wedge.xml").write_text(MESH_MODEL)
    system = kg.load(tmp_path / "wedge.xml")
    scene = scene_of(system)
    mujoco = extras.module("mujoco", extra=extras.MUJOCO)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "wedge.xml"))
    data = mujoco.MjData(model)
    data.qpos[:] = 0.7
    mujoco.mj_kinematics(model, data)
    expected = data.geom_xpos[0] + model.mesh_vert @ data.geom_xmat[0].reshape(3, 3).T
    ((shape, rotation, center),) = placed(scene, system, [0.7])
    assert shape.kind == "mesh" and shape.color == "#ff0000"
    found = center + (vertices_of(scene.meshes[shape.mesh]) * shape.size) @ rotation.T
    step = max(scene.meshes[shape.mesh].step)
    distances = np.linalg.norm(found[:, None] - expected[None], axis=-1)
    assert distances.min(axis=0).max() < 2 * step and distances.min(axis=1).max() < 2 * step


def test_meshes_of_urdf_stand_where_pinocchio_puts_them() -> None:
    path = robot_file("panda")
    system = kg.load(path)
    scene = scene_of(system)
    model = pin.buildModelFromUrdf(str(path), mimic=True)
    folders = [str(parent) for parent in path.parents]
    visuals = pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.VISUAL, package_dirs=folders)
    x = np.random.default_rng(2).uniform(-0.5, 0.5, len(system.coordinates))
    x[-1] = 0.02
    q = state_map(system, model).to_q(x)
    data, geometry = model.createData(), visuals.createData()
    pin.forwardKinematics(model, data, q)
    pin.updateGeometryPlacements(model, data, visuals, geometry)
    expected = [geometry.oMg[i] for i in range(len(visuals.geometryObjects))]
    found = placed(scene, system, x)
    assert len(expected) == 11 and {shape.kind for shape, *_ in found} == {"mesh"}

    def are_near(place: Any, rotation: np.ndarray, center: np.ndarray) -> bool:
        off = np.abs(place.rotation - rotation).max() + np.abs(place.translation - center).max()
        return bool(off < TOLERANCE)

    for _, rotation, center in found:
        assert any(are_near(place, rotation, center) for place in expected)
    for place in expected:
        assert any(are_near(place, rotation, center) for _, rotation, center in found)


BOX = """
<robot name="boxes">
  <material name="green"><color rgba="0 1 0 0.5"/></material>
  <link name="base"><visual><geometry><box size="1 2 3"/></geometry><material name="green"/></visual></link>
  <link name="arm">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><geometry>{geometry}</geometry></visual>
    <visual><geometry><sphere radius="0.4"/></geometry></visual>
  </link>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 1"/></joint>
</robot>
"""


def load(folder: Path, geometry: str) -> kg.System:
    (folder / "boxes.urdf").write_text(BOX.format(geometry=geometry))
    return kg.load(folder / "boxes.urdf")


def cube(folder: Path, triangles: int = 12) -> Path:
    mesh = trimesh.creation.box((2.0, 4.0, 6.0))
    while len(mesh.faces) < triangles:
        mesh = mesh.subdivide()
    mesh.export(folder / "cube.stl")
    return folder / "cube.stl"


def geometry_of(scene: Scene, body: int) -> list[Shape]:
    return [shape for shape in scene.bodies[body].shapes if shape.role == "geometry"]


def test_shapes_of_a_turned_body_are_those_of_its_link(tmp_path: Path) -> None:
    """The axis is no basis vector, so that the body is turned in its link; the shapes stay in the link."""
    system = load(tmp_path, '<cylinder radius="0.2" length="0.7"/>')
    scene = scene_of(system)
    (base,) = geometry_of(scene, 0)
    assert (base.kind, base.size, base.color, base.opacity) == ("box", [1, 2, 3], "#00ff00", 0.5)
    cylinder, sphere = placed(scene, system, [0.0])[1:]
    assert cylinder[0].size == [0.2, 0.7] and sphere[0].size == [0.4]
    assert cylinder[2] == pytest.approx([0.1, 0.2, 0.3])
    assert cylinder[1] == pytest.approx(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), abs=1e-15)


def test_a_mesh_has_the_vertices_of_its_file(tmp_path: Path) -> None:
    cube(tmp_path)
    scene = scene_of(load(tmp_path, '<mesh filename="cube.stl" scale="0.1 0.1 0.1"/>'))
    mesh, sphere = geometry_of(scene, 1)
    assert (mesh.kind, mesh.size, sphere.kind) == ("mesh", [0.1] * 3, "sphere")
    (data,) = scene.meshes
    corners = vertices_of(data)
    assert np.unique(np.abs(corners).round(4), axis=0).tolist() == [[1, 2, 3]]
    assert len(corners) == 8 and len(base64.b64decode(data.faces)) == 12 * 3 * 2


def test_a_large_mesh_is_thinned_and_the_page_says_so(tmp_path: Path) -> None:
    cube(tmp_path, triangles=40_000)
    scene = scene_of(load(tmp_path, '<mesh filename="cube.stl"/>'))
    drawn = len(base64.b64decode(scene.meshes[0].faces)) // 6
    assert 12 <= drawn <= 8100
    assert any(
        f"Meshes of 1 file are drawn with {drawn} of their 49152 triangles." == note for note in scene.notes
    )


@pytest.mark.parametrize(
    ("geometry", "message"),
    [
        ('<mesh filename="absent.stl"/>', r"boxes\.urdf:7: .*absent\.stl: there is no such file\."),
        ('<mesh filename="package://arm/absent.stl"/>', r"absent\.stl: there is no such file\."),
        ('<mesh filename="boxes.urdf"/>', r"pictures show meshes in \.stl, \.obj, \.dae"),
        ('<mesh filename="empty.stl"/>', r"empty\.stl: this file holds no triangles\."),
        ('<mesh filename="broken.dae"/>', r"broken\.dae: this mesh cannot be read: .+\."),
        ('<sphere radius="big"/>', r"boxes\.urdf:7: <sphere radius>: 'big' is not a finite number\."),
        ("<torus/>", r"boxes\.urdf:7: <geometry> holds <torus>, which is no box"),
    ],
)
def test_what_cannot_be_drawn_is_left_out_and_named(tmp_path: Path, geometry: str, message: str) -> None:
    """The equations do not need it: the model loads, the rest is drawn, and the page names what is
    missing."""
    (tmp_path / "empty.stl").write_text("solid nothing\nendsolid")
    (tmp_path / "broken.dae").write_text("<COLLADA")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        system = load(tmp_path, geometry)
    with pytest.warns(kg.KanegenWarning, match=f"not drawn: .*{message}"):
        scene = scene_of(system)
    assert [shape.kind for shape in geometry_of(scene, 1)] == ["sphere"]
    assert re.search(f"^Not drawn: .*{message}", scene.notes[-1])
    assert str(tmp_path) not in scene.notes[-1]


def test_without_the_extra_one_warning_stands_for_all_meshes(monkeypatch: pytest.MonkeyPatch) -> None:
    system = kg.load(robot_file("panda"))
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "trimesh" else find(name))
    with pytest.warns(
        kg.KanegenWarning, match="not drawn: the meshes of .dae files, because .*kanegen.viewer."
    ) as given:
        scene = scene_of(system)
    assert len(given) == 1
    assert not any(shape.role == "geometry" for body in scene.bodies for shape in body.shapes)


def test_shapes_stay_with_the_system_when_it_changes(tmp_path: Path) -> None:
    system = load(tmp_path, '<box size="1 1 1"/>')
    changed = system.with_points({"tip": ("arm", (0, 0, 1))}).with_right_angles(1e-4)
    assert len(geometry_of(scene_of(changed), 1)) == 2
    assert not geometry_of(scene_of(system.with_geometry(None)), 1)
    assert system == system.with_geometry(None)
    system.save(tmp_path / "boxes.toml")
    from_table = kg.load(tmp_path / "boxes.toml")
    assert not geometry_of(scene_of(from_table), 1)
    assert len(geometry_of(scene_of(from_table.with_geometry(tmp_path / "boxes.urdf")), 1)) == 2
    with pytest.raises(kg.ModelError, match="geometry: 3 is not the path of a file"):
        system.with_geometry(3)  # type: ignore[arg-type]


def test_ellipsoids_have_the_inertia_of_their_bodies() -> None:
    """The moments of a uniform ellipsoid are m (b^2 + c^2) / 5 about its axes."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        mass = float(rng.uniform(0.1, 10))
        inertia = random_inertia(rng, mass)
        semi_axes, axes = equivalent_ellipsoid(mass, inertia)
        if semi_axes.min() <= THINNEST * semi_axes.max():
            continue
        a, b, c = semi_axes**2
        moments = np.diag([b + c, a + c, a + b]) * mass / 5
        assert axes @ moments @ axes.T == pytest.approx(inertia, rel=1e-9, abs=1e-12 * np.trace(inertia))
        assert np.linalg.det(axes) == pytest.approx(1)
    assert equivalent_ellipsoid(0.0, np.zeros((3, 3))) is None
    assert equivalent_ellipsoid(1.0, np.zeros((3, 3))) is None
    rod, _ = equivalent_ellipsoid(1.0, np.diag([1.0, 1.0, 0.0]))
    assert sorted(rod / rod.max()) == pytest.approx([THINNEST, THINNEST, 1])


def test_quaternions_are_those_of_rotations() -> None:
    rng = np.random.default_rng(5)
    turns = [random_rotation(rng) for _ in range(40)]
    turns += [np.diag([1.0, -1, -1]), np.diag([-1.0, 1, -1]), np.diag([-1.0, -1, 1]), np.eye(3)]
    for turn in turns:
        w, x, y, z = wxyz(turn)
        expected = trimesh.transformations.quaternion_matrix([w, x, y, z])[:3, :3]
        assert turn == pytest.approx(expected, abs=1e-14)
