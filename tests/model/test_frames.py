"""Named frames of bodies and of the ground: names, files, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.model.numbers import is_fixed, value_of
from kanegen.model.rotations import rotation_123
from kanegen.reference.equations import forcing
from kanegen.reference.frames import frame_motions
from kanegen.studies.explain.general_form import with_numbers_as_parameters
from tests.support.paths import MODELS
from tests.support.random_trees import everything


@pytest.fixture
def pendulum() -> kg.System:
    return kg.load(MODELS / "double_pendulum.toml")


def test_every_body_is_a_frame_under_its_own_name(pendulum: kg.System) -> None:
    assert pendulum.frame_names == ("upper", "lower")
    assert pendulum.frame("lower") == pendulum.frame(2) == kg.Frame("lower", 2)
    assert pendulum.frame("ground").body == 0


def test_frames_are_given_in_frames(pendulum: kg.System) -> None:
    """The frames of the ground come first, those of a body in the order in which they were made."""
    system = pendulum.with_frames(
        {
            "tool": ("lower", (0.1, 0.2, 0.3), (0.3, -0.2, 0.1)),
            "world": ("ground", (1, 2, 3)),
            "tip": ("tool", (0, 0, 0.5), (0, 0, 0.4)),
        }
    )
    assert system.frame_names == ("upper", "lower", "world", "tool", "tip")
    assert [frame.name for frame in system.frame_path("tip")] == ["tool", "tip"]
    tip, turned = system.values().frames["tip"], np.array(rotation_123((0.3, -0.2, 0.1)))
    assert tip.position == pytest.approx(np.array([0.1, 0.2, 0.3]) + turned.T @ [0, 0, 0.5], abs=1e-15)
    assert tip.rotation == pytest.approx(np.array(rotation_123((0, 0, 0.4))) @ turned, abs=1e-15)
    assert tip.body == 2


def test_the_frame_with_the_name_of_its_body_is_what_its_user_sees(pendulum: kg.System) -> None:
    system = pendulum.with_frames({"lower": ("lower", (0.1, 0, 0), (0, 0, 0.5))})
    assert system.frame_names == pendulum.frame_names
    system = system.with_points({"tip": ("lower", (0.2, 0, 0))}).with_frames({"tool": (2, (0, 0, 1))})
    assert system.bodies[1].points[0].frame == system.frame("tool").frame == "lower"
    expected = [0.1 + 0.2 * np.cos(0.5), 0.2 * np.sin(0.5), 0.0]
    assert system.values().forces.points["tip"][1] == pytest.approx(np.array(expected), abs=1e-15)


def test_numbers_of_frames_are_numbers_of_the_model(pendulum: kg.System) -> None:
    reach, tilt = kg.Parameter("reach", 0.5), kg.Parameter("tilt", 0.1)
    system = pendulum.with_frames({"tool": ("lower", (reach, 0, 0), (0, tilt, 0))})
    assert {"reach", "tilt"} <= {parameter.name for parameter in system.parameters}
    longer = system.with_parameters({"reach": 0.75})
    assert value_of(longer.frame("tool").position[0]) == 0.75
    plain = system.map_numbers(value_of)
    assert plain.frame("tool").position == (0.5, 0.0, 0.0)
    assert plain.frame("tool").orientation == (0.0, 0.1, 0.0) or len(plain.frame("tool").orientation) == 3


def test_nearly_right_angles_of_frames_become_exact(pendulum: kg.System) -> None:
    system = pendulum.with_frames({"tool": ("lower", (0, 0, 0), (1.5708, 0, 0))})
    exact = system.with_right_angles(5e-5).frame("tool").orientation
    assert exact == ((1, 0, 0), (0, 0, 1), (0, -1, 0))


@pytest.mark.parametrize("seed", range(8))
def test_a_file_keeps_frames(seed: int, tmp_path: Path) -> None:
    system = everything(seed)
    system.save(tmp_path / "everything.toml")
    assert kg.load(tmp_path / "everything.toml") == system


def test_a_file_gives_frames_by_positions_and_tables(tmp_path: Path) -> None:
    file = tmp_path / "model.toml"
    file.write_text(
        "parameters = {length = 0.3}\n"
        "frames = {table = [0, 0, 0.8]}\n"
        "[outputs]\nbody_poses = ['camera', 'b', 'table']\n"
        "[[body]]\nname = 'b'\nconnection = 'ground'\nmass = 1\ninertia = [1, 1, 1]\n"
        "frames.tool.position = [0, 0, 'length']\n"
        "frames.camera = {frame = 'tool', orientation_angles = [0, 1.5707963267948966, 0]}\n"
        "points.tip = {position = [0, 0, 0.1], frame = 'camera'}\n"
    )
    system = kg.load(file)
    assert system.frame_names == ("b", "table", "tool", "camera")
    assert [frame.name for frame in system.pose_frames] == ["camera", "b", "table"]
    assert system.frame("camera").frame == "tool"
    assert system.values().forces.points["tip"][1] == pytest.approx(np.array([0.1, 0, 0.3]), abs=1e-15)


@pytest.mark.parametrize(
    ("frames", "message"),
    [
        (
            {"t": ("forearm", (0, 0, 1))},
            r"frame 't': there is no body or frame 'forearm'\. Known are 'upper'",
        ),
        ({"t": (0, (0, 0, 1))}, r"frame 't': there is no body or frame 0"),
        ({"t": (True, (0, 0, 1))}, r"frame 't': there is no body or frame True"),
        ({"t": (1, (0, 0))}, r"frame 't': position: expected 3 numbers, got 2 entries"),
        ({"t": (1, (0, 0, float("nan")))}, r"frame 't': position\[2\]: nan is not finite"),
        ({"t": (1, (0, 0, 1), ((1, 0, 0), (0, 1, 0)))}, r"frame 't': orientation: expected 3 x 3"),
        ({"t": (1, (0, 0, 1), np.diag([1.0, 1.0, -1.0]))}, r"frame 't': orientation is not a rotation"),
        ({"t": (1,)}, r"frame 't': expected a frame or body, a position and perhaps an orientation, as in"),
        ({"t": (1, 2, 3, 4)}, r"frame 't': expected a frame or body, a position and"),
        ({"t": None}, r"frame 't': expected a sequence, got None"),
        ({"upper": ("lower", (0, 0, 1))}, r"frame 'upper': another body has this name"),
        ({3: ("lower", (0, 0, 1))}, r"frame name: 3 is not a string"),
        (["t"], r"frames: expected a table such as"),
        (None, r"frames: expected a table such as"),
    ],
)
def test_invalid_frames_are_refused(pendulum: kg.System, frames: Any, message: str) -> None:
    with pytest.raises(kg.ModelError, match=message):
        pendulum.with_frames(frames)


def test_a_name_is_used_once(pendulum: kg.System) -> None:
    system = pendulum.with_frames({"tool": (1, (0, 0, 1))})
    with pytest.raises(kg.ModelError, match="frame name 'tool' is used twice"):
        system.with_frames({"tool": (2, (0, 0, 1))})


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (kg.Frame("t", 3), r"frame 't': there is no body 3; bodies count from 1 to 2, and 0 is the ground"),
        (kg.Frame("t", -1), r"frame 't': there is no body -1"),
        (kg.Frame("t", 1, frame="lower"), r"frame 't': it is given in 'lower', which is no earlier frame"),
        (kg.Frame("t", 1, frame="t"), r"frame 't': it is given in 't', which is no earlier frame"),
    ],
)
def test_frames_hang_together(pendulum: kg.System, frame: kg.Frame, message: str) -> None:
    with pytest.raises(kg.ModelError, match=message):
        kg.System("s", pendulum.bodies, frames=(frame,))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("frames = 3", r"frames: write a table such as"),
        ("frames = {tool = [0, 0]}", r"frame 'tool': position: expected 3 numbers"),
        ("frames = {tool = {at = [0, 0, 1]}}", r"frame 'tool': unknown key 'at'"),
        ("frames = {tool = {orientation = 1, orientation_angles = [0, 0, 0]}}", r"frame 'tool': both orient"),
        ("frames = {tool = {frame = 'hand'}}", r"frame 'tool': it is given in 'hand', which is no earlier"),
        (
            "points = {tip = {position = [0, 0, 1], frame = 'hand'}}",
            r"point 'tip': its body has no frame 'hand'",
        ),
    ],
)
def test_invalid_frames_of_a_file_are_refused(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "model.toml"
    file.write_text(f"[[body]]\nconnection = 0\nmass = 1.0\ninertia = [1, 1, 1]\n{text}\n")
    with pytest.raises(kg.ReadError, match=message):
        kg.load(file)


def test_springs_and_loads_act_at_the_origins_of_frames(pendulum: kg.System) -> None:
    """At a frame they do what they do at a point of the same place, and cost the same."""
    place, hook = (0.3, 0.1, -0.2), (0.2, -1.0, 0.5)
    frames = pendulum.with_frames({"tool": ("lower", place, (0.2, 0.1, 0)), "hook": ("ground", hook)})
    points = pendulum.with_points({"tool": ("lower", place)})
    by_frames = frames.with_force_elements(
        kg.Spring(("hook", "tool"), 20.0, 0.1, 0.3), kg.PointLoad("tool", force=(1.0, 2.0, "sin(t)"))
    )
    by_points = points.with_force_elements(
        kg.Spring((hook, "tool"), 20.0, 0.1, 0.3), kg.PointLoad("tool", force=(1.0, 2.0, "sin(t)"))
    )
    found, expected = kg.build(by_frames), kg.build(by_points)
    x, y = np.array([0.3, -0.5]), np.array([1.0, 2.0])
    assert found.forcing(x, y, t=0.4).tolist() == expected.forcing(x, y, t=0.4).tolist()
    assert found.source.operations == expected.source.operations
    assert found.forcing(x, y, t=0.4) == pytest.approx(forcing(by_frames, x, y, t=0.4), abs=1e-13)


def test_a_load_in_components_of_a_frame_turns_with_the_frame(pendulum: kg.System) -> None:
    """In every derivation it is a load whose inertial components turn as the frame does."""
    frames = pendulum.with_frames({"tool": ("lower", (0.3, 0.1, -0.2), (0.2, 0.7, -0.4))})
    force, moment = (1.0, 2.0, -3.0), (0.5, -1.5, 2.5)
    thrust = frames.with_force_elements(kg.PointLoad("tool", force, moment, frame="tool"))
    found, literal = kg.build(thrust, outputs=("forcing",)), kg.derive(thrust).lambdify()
    for x, y in (((0.3, -0.5), (1.0, 2.0)), ((-2.0, 0.7), (0.2, -0.4))):
        (pose,) = frame_motions(frames, ["tool"], np.array(x), np.zeros(2), np.zeros(2)).poses
        still = kg.PointLoad("tool", tuple(pose[:3].T @ force), tuple(pose[:3].T @ moment))
        expected = forcing(frames.with_force_elements(still), np.array(x), np.array(y))
        assert found.forcing(x, y) == pytest.approx(expected, abs=1e-13)
        assert forcing(thrust, np.array(x), np.array(y)) == pytest.approx(expected, abs=1e-13)
        assert literal.forcing(x, y) == pytest.approx(expected, abs=1e-13)


def test_the_frame_of_a_load_belongs_to_the_body_of_its_point(pendulum: kg.System) -> None:
    frames = pendulum.with_frames({"tool": ("lower", (0.3, 0.1, -0.2))})
    with pytest.raises(kg.ModelError, match=r"point_load 1 at 'tool': its body has no frame 'upper'\."):
        frames.with_force_elements(kg.PointLoad("tool", (1, 0, 0), frame="upper"))
    with pytest.raises(kg.ModelError, match="point_load frame: 3 is not a name"):
        kg.PointLoad("tool", (1, 0, 0), frame=3)  # type: ignore[arg-type]


def test_loads_on_a_body_are_components_of_its_frame() -> None:
    """Turned by a quarter about axis 3, the force along axis 1 of the frame is along axis 2 of the body."""
    body = kg.Body("arm", 0, 1.0, np.eye(3).tolist(), (0.3, 0, 0), loads=True)
    plain = kg.System("arm", (body,))
    turned = plain.with_frames({"arm": ("arm", (0.1, 0.2, 0.3), (0, 0, np.pi / 2))})
    x, y = np.full(6, 0.2), np.full(6, 0.1)
    in_frame, in_body = np.array([[1.0, 2.0, 3.0]]), np.array([[-2.0, 1.0, 3.0]])
    ours, theirs = kg.build(turned), kg.build(plain)
    for name in ("force", "torque"):
        expected = theirs.forcing(x, y, **{name: in_body})
        assert ours.forcing(x, y, **{name: in_frame}) == pytest.approx(expected, abs=1e-14)
        assert forcing(turned, x, y, **{name: in_frame}) == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize(
    ("element", "message"),
    [
        (kg.PointLoad("world"), r"point_load 1: 'world' is fixed to the ground, where a load does nothing"),
        (kg.PointLoad("tol"), r"point_load 1: there is no point or frame 'tol'\. Did you mean 'tool'\?"),
        (kg.Spring(("world", (0, 0, 1)), 1.0), r"both ends are on one body"),
        (kg.Spring(("tool", "lower"), 1.0), r"both ends are on one body"),
    ],
)
def test_elements_that_would_do_nothing(pendulum: kg.System, element: Any, message: str) -> None:
    system = pendulum.with_frames({"world": ("ground", (1, 2, 3)), "tool": ("lower", (0, 0, 1))})
    with pytest.raises(kg.ModelError, match=message):
        system.with_force_elements(element)


def test_loads_by_names_of_points_bodies_and_frames(pendulum: kg.System) -> None:
    system = pendulum.with_frames({"tool": ("lower", (0.1, 0, 0)), "world": ("ground", (0, 0, 1))})
    system = system.with_points({"tip": ("tool", (0.2, 0, 0))}).with_loads(["tip", "upper", "tool"])
    upper, lower = system.bodies
    assert (upper.loads, lower.loads) == (True, False)
    assert [(point.name, point.loads, point.frame, point.load_frame) for point in lower.points] == [
        ("tip", True, "tool", ""),
        ("tool", True, "tool", "tool"),
    ]
    assert system.with_loads("tool") == system
    for names, message in (
        (["hand"], r"loads: there is no body or frame 'hand'"),
        ("world", r"loads: 'world' is fixed to the ground"),
        ([], r"loads: none is chosen\. Name one, or leave the choice out to add none"),
        (None, r"loads: there is no body or frame None"),
    ):
        with pytest.raises(kg.ModelError, match=message):
            system.with_loads(names)  # type: ignore[arg-type]


def test_the_general_form_of_a_model_has_parameters_in_its_frames() -> None:
    system = everything(2)
    general = with_numbers_as_parameters(system)
    numbers = [value for frame in general.frames for value in (*frame.position, *frame.orientation)]
    assert not any(is_fixed(value) for value in numbers)
    for name, frame in system.values().frames.items():
        assert general.values().frames[name].position == pytest.approx(frame.position, abs=1e-14)
        assert general.values().frames[name].rotation == pytest.approx(frame.rotation, abs=1e-14)


def test_a_wrench_acts_in_a_frame(pendulum: kg.System) -> None:
    """Generalized forces are the transposed Jacobian times moment and force in inertial components."""
    system = pendulum.with_frames({"sensor": ("lower", (0.3, 0.1, -0.2), (0.4, -0.3, 0.2))})
    system = system.with_loads("sensor").with_poses(["sensor"])
    library = kg.build(system, ("forcing", "frame_jacobians", "body_poses"))
    x, y = np.array([0.3, -0.8]), np.array([1.0, 2.0])
    force, moment = np.array([[1.0, 2.0, 3.0]]), np.array([[-0.5, 0.7, 0.2]])
    unloaded = library.forcing(x, y)
    loaded = library.forcing(x, y, point_force=force, point_moment=moment)
    to_inertial = library.body_poses(x)[0, :3].T
    wrench = np.concatenate([to_inertial @ moment[0], to_inertial @ force[0]])
    assert loaded - unloaded == pytest.approx(library.frame_jacobians(x)[0].T @ wrench, abs=1e-14)
    assert loaded == pytest.approx(forcing(system, x, y, point_force=force, point_moment=moment), abs=1e-13)
    header = library.source.files["double_pendulum.h"]
    assert "0  sensor  in components of sensor" in header
    assert "| 0 | `sensor`, in components of `sensor` |" in library.source.files["README.md"]


def test_a_load_frame_is_one_of_the_body(pendulum: kg.System, tmp_path: Path) -> None:
    system = pendulum.with_frames({"tool": ("upper", (0, 0, 1))}).with_loads("tool")
    system.save(tmp_path / "loaded.toml")
    assert kg.load(tmp_path / "loaded.toml") == system
    lower = replace(system.bodies[1], points=(kg.Point("tip", (0, 0, 0), loads=True, load_frame="tool"),))
    with pytest.raises(kg.ModelError, match=r"point 'tip': its body has no frame 'tool'"):
        replace(system, bodies=(system.bodies[0], lower))


def test_ground_never_means_another_frame_in_silence() -> None:
    pendulum = kg.load(MODELS / "double_pendulum.toml")
    with pytest.raises(kg.ModelError, match="frame 'ground': this is the name of the inertial frame"):
        pendulum.with_frames({"ground": ("lower", (0, 0, 1))})
    shifted = replace(pendulum, frames=(kg.Frame("ground", 0, (0, 0, 1)),))
    named = replace(pendulum, bodies=(replace(pendulum.bodies[0], name="ground"), pendulum.bodies[1]))
    for system, kind in ((shifted, "frame"), (named, "body")):
        message = f"'ground' is the inertial frame, but a {kind} of the model has this name, too"
        for choose in (
            lambda system=system: system.frame("ground"),
            lambda system=system: system.with_frames({"mark": ("ground", (0, 0, 1))}),
            lambda system=system: system.with_poses("ground"),
        ):
            with pytest.raises(kg.ModelError, match=message):
                choose()
        assert [frame.body for frame in system.pose_frames] == [1, 2]
    same = replace(pendulum, frames=(kg.Frame("ground", 0),))
    assert same.frame("ground").body == 0
    assert same.with_frames({"mark": ("ground", (0, 0, 1))}).frame("mark").body == 0
