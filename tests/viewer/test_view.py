"""`kg.view`, `View` and `kanegen view`: what they take, what they refuse, and the files that they write."""

from __future__ import annotations

import base64
import json
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.viewer.motion import MOST_TIMES, motion_of
from kanegen.viewer.poses import body_poses
from kanegen.viewer.scene import embedded_json
from kanegen.viewer.stored import stored_motion
from tests.support.command import kanegen
from tests.support.paths import MODELS, ROOT

TIMES = np.linspace(0.0, 1.0, 11)
X = np.stack([TIMES, -TIMES], axis=1)


@pytest.fixture(scope="module")
def pendulum() -> kg.System:
    system = kg.load(MODELS / "double_pendulum.toml")
    return system.with_points({"tip": ("lower", (0, 0, -0.5))}).with_loads(["tip", "upper"])


@pytest.fixture(scope="module")
def library(pendulum: kg.System) -> kg.Library:
    outputs = ("forward_dynamics", "kinetic_energy", "potential_energy", "point_positions")
    return kg.build(pendulum, outputs=outputs)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"trajectory": 3}, kg.OptionError, "trajectory: 3 is none. Pass what kg.simulate returns"),
        ({"trajectory": (TIMES, X[:, :1])}, kg.OptionError, "need (11, 2). It is one of another model."),
        ({"trajectory": (TIMES, X[:9])}, kg.OptionError, "need (11, 2). Pass as many rows as times."),
        ({"trajectory": (TIMES, X.T)}, kg.OptionError, "need (11, 2). Transpose them: a row for each time."),
        ({"trajectory": (TIMES, X[:, 0])}, kg.OptionError, "need (11, 2). Pass one row of coordinates"),
        (
            {"trajectory": (TIMES, X[:5])},
            kg.OptionError,
            "but 11 times of system 'double_pendulum' need (11, 2)",
        ),
        ({"trajectory": (TIMES[::-1], X)}, kg.ArrayError, "times: they must be finite and increase"),
        (
            {"trajectory": (TIMES, np.zeros((11, 4, 2)))},
            kg.OptionError,
            "it holds 4 motions. Pass one of them",
        ),
        (
            {"trajectory": (TIMES, np.where(TIMES[:, None] == TIMES[3], np.nan, X))},
            kg.ArrayError,
            "coordinate 'q1' is nan at t = 0.3 s",
        ),
        ({"trajectory": (TIMES, X), "x": [0, 0]}, kg.OptionError, "x: the motion has its own start."),
        (
            {"trajectory": (TIMES, X), "paths": ["tipp"]},
            kg.OptionError,
            "no point, frame or body 'tipp'. Did you",
        ),
        ({"trajectory": (TIMES, X), "forces": {"tipp": (0, 0, 1)}}, kg.ModelError, "'tipp'"),
        (
            {"trajectory": (TIMES, X), "forces": {"tip": (0, 1)}},
            kg.ArrayError,
            "force 'tip': expected shape (11, 3)",
        ),
        (
            {"trajectory": (TIMES, X), "plots": {"a": X}},
            kg.ArrayError,
            "plot 'a': expected shape (11,), got (11, 2).",
        ),
        ({"paths": "tip"}, kg.OptionError, "paths: only with a trajectory."),
        ({"x": {"q3": 1.0}}, kg.OptionError, "x: there is no 'q3'."),
        ({"x": [1.0]}, kg.ArrayError, "x: expected 2 values"),
        ({"x": [np.nan, 0.0]}, kg.OptionError, "x: the value of 'q1' is nan"),
    ],
)
def test_what_fits_nothing_is_refused_in_one_line(
    pendulum: kg.System, arguments: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=re.escape(message)) as raised:
        kg.view(pendulum, **arguments)
    assert "\n" not in str(raised.value)


def test_a_trajectory_of_another_model_is_refused(library: kg.Library, pendulum: kg.System) -> None:
    trajectory = kg.simulate(library, [0.1, 0.2], [0.0, 0.0], TIMES, step=0.01)
    other = kg.load(MODELS / "cart_pole.toml")
    with pytest.raises(kg.OptionError, match="whose coordinates are not those of system 'cart_pole'"):
        kg.view(other, trajectory)
    with pytest.raises(kg.OptionError, match="is no System"):
        kg.view(library)  # type: ignore[arg-type]


def test_a_motion_holds_what_the_trajectory_holds(library: kg.Library, pendulum: kg.System) -> None:
    trajectory = kg.simulate(library, [0.5, 0.2], [0.0, 1.0], TIMES, step=0.01)
    motion = kg.view(pendulum, trajectory).motion
    times, x, prescribed = motion.decoded()
    assert times.tolist() == TIMES.tolist()
    assert x.tolist() == trajectory.x.tolist()
    assert prescribed.shape == (11, 0)
    groups = {one.group for one in motion.series}
    assert {"Coordinates, rad", "Speeds, rad/s", "Energies, J"} <= groups
    assert [one.name for one in motion.series if one.group == "Coordinates, rad"] == ["q1", "q2"]


def test_an_angle_after_many_turns_keeps_its_value(pendulum: kg.System) -> None:
    """Single precision would be off by 30 rad at 1e9 rad."""
    x = 1e9 + X
    assert kg.view(pendulum, (TIMES, x)).motion.decoded()[1].tolist() == x.tolist()


def test_a_force_that_a_page_cannot_hold_is_refused(pendulum: kg.System) -> None:
    message = "force 'tip': 1e+39 is too large; a page holds numbers up to 3.4e+38 here."
    with pytest.raises(kg.ArrayError, match=re.escape(message)):
        kg.view(pendulum, (TIMES, X), forces={"tip": (0.0, 0.0, -1e39)})


def test_loads_of_a_trajectory_are_forces_of_the_picture(pendulum: kg.System) -> None:
    """Loads on bodies are in components of the body, at its mass centre, those on points in inertial ones."""
    force = np.zeros((11, 2, 3))
    force[:, 0, 2] = 2.0
    point_force = np.zeros((11, 1, 3))
    point_force[:, 0, 0] = TIMES
    inputs = {"force": force, "point_force": point_force}
    motion = motion_of(pendulum, SimpleNamespace(times=TIMES, x=X, inputs=inputs))
    upper, tip = motion.forces
    assert (upper.name, upper.body, upper.rotation) == ("upper", 1, np.eye(3).ravel().tolist())
    assert (tip.name, tip.body, tip.rotation) == ("tip", 2, None)
    assert upper.position == pendulum.values().mass_center[0].tolist()
    assert tip.position == pytest.approx([0, 0, -0.5])


def test_reactions_stand_at_the_joints_along_locked_directions() -> None:
    """A pendulum at rest hangs on its joints with the weight of all that is below."""
    system = kg.load(MODELS / "planar_pendulum.toml")
    arrays = system.values()
    weights = np.linalg.norm(arrays.gravity) * np.array([arrays.mass.sum(), arrays.mass[1]])
    up = -arrays.gravity / np.linalg.norm(arrays.gravity)
    rotations, _ = body_poses(arrays, [0.0, 0.0])
    library = kg.build(system, outputs=("reaction_loads",))
    loads = np.tile(library.reaction_loads([0.0, 0.0], [0.0, 0.0], [0.0, 0.0]), (11, 1))
    trajectory = SimpleNamespace(times=TIMES, x=0 * X, outputs=("reaction_loads",), output=lambda name: loads)
    forces = motion_of(system, trajectory).forces
    assert [force.name for force in forces] == ["reaction on upper", "reaction on lower"]
    assert [force.body for force in forces] == [0, 1]
    for force, weight in zip(forces, weights, strict=True):
        values = np.frombuffer(base64.b64decode(force.values), "<f4").reshape(11, 3)
        inertial = rotations[force.body] @ np.reshape(force.rotation, (3, 3)) @ values[0]
        assert inertial == pytest.approx(weight * up, abs=1e-5 * weight)


def test_a_long_motion_is_thinned_and_the_page_says_so(pendulum: kg.System) -> None:
    times = np.linspace(0, 100, 3 * MOST_TIMES)
    view = kg.view(pendulum, (times, np.zeros((len(times), 2))))
    assert len(view.motion.decoded()[0]) <= MOST_TIMES
    assert view.scene.notes[-1] == "Of 60000 times 1 in 3 is kept."


def test_json_in_a_page_cannot_end_its_script() -> None:
    value = {"</script>": "<!--&\u2028\u2029é"}
    text = embedded_json(value)
    assert not set("<&\u2028\u2029") & set(text)
    assert json.loads(text) == value


def test_the_same_picture_is_the_same_file(pendulum: kg.System, tmp_path: Path) -> None:
    for name in ("a.html", "b.html"):
        kg.view(pendulum, (TIMES, X)).save(tmp_path / name)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
    assert str(tmp_path) not in (tmp_path / "a.html").read_text()
    for wrong, message in (("a.txt", r"a\.txt: a page ends in \.html"), ("no/a.html", "cannot be written")):
        with pytest.raises(kg.KanegenError, match=message):
            kg.view(pendulum).save(tmp_path / wrong)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--y", "q1=1"], "--y: only for a motion. Add --duration, or leave --y out."),
        (["--live", "-o", "a.html"], "--live writes no file."),
        (["--duration", "-1"], "--duration: -1.0 is not a positive number of seconds."),
        (["-o", "nowhere/a.html"], "nowhere/a.html: cannot be written"),
        (["-o", "a.txt"], "a.txt: a page ends in .html."),
        (["--x", "q9=1"], "x: there is no 'q9'."),
    ],
)
def test_the_command_refuses_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: list[str], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    result = kanegen("view", str(MODELS / "double_pendulum.toml"), *options, status=2)
    assert message in result.stderr and result.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_the_command_writes_a_page_with_a_motion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    model = str(MODELS / "double_pendulum.toml")
    result = kanegen("view", model, "--duration", "0.5", "--x", "q1=1", "--path", "lower")
    assert result.stdout == "wrote double_pendulum.html\n"
    text = (tmp_path / "double_pendulum.html").read_text()
    data = json.loads(re.search(r'id="kanegen-data">(.*)</script>', text)[1])
    assert data["paths"] == ["lower"]
    assert data["motion"]["series"][0]["name"] == "q1"


def test_a_motion_in_a_file_is_shown(
    library: kg.Library, pendulum: kg.System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Files of every format that a trajectory writes and that holds columns."""
    monkeypatch.chdir(tmp_path)
    trajectory = kg.simulate(library, [0.5, 0.2], [0.0, 1.0], TIMES, step=0.01)
    for name in ("motion.csv", "motion.npz", "motion.parquet"):
        trajectory.save(name)
        motion = kg.view(pendulum, stored_motion(pendulum, name)).motion
        assert motion.decoded()[1] == pytest.approx(trajectory.x, rel=1e-6)
        assert {"Coordinates, rad", "Speeds, rad/s"} <= {one.group for one in motion.series}
    model = str(MODELS / "double_pendulum.toml")
    kanegen("view", model, "--motion", "motion.csv", "--path", "lower", "-o", "shown.html")
    assert (tmp_path / "shown.html").stat().st_size > 500_000
    for options, message in (
        (["--motion", "none.csv"], "none.csv: cannot be read: No such file or directory."),
        (["--motion", "motion.csv", "--duration", "1"], "--duration simulates, --motion has been simulated."),
        (["--motion", "motion.txt"], "motion.txt: there is no format '.txt'."),
    ):
        assert message in kanegen("view", model, *options, status=2).stderr
    other = kanegen("view", str(MODELS / "cart_pole.toml"), "--motion", "motion.csv", status=2)
    assert (
        "motion.csv: there is no column 'x.pole'. A motion of 'cart_pole' has the columns t" in other.stderr
    )


@pytest.mark.parametrize("has_browser", [True, False])
def test_the_command_opens_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_browser: bool
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or has_browser)
    file = tmp_path / "page.html"
    printed = kanegen("view", str(MODELS / "cart_pole.toml"), "-o", str(file), "--open").stdout
    assert opened == [file.as_uri()]
    assert ("no browser was found here; open file://" in printed) is not has_browser


def test_simulate_writes_a_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    model = str(MODELS / "double_pendulum.toml")
    kanegen("simulate", model, "--duration", "0.5", "--step", "0.01", "--view", "motion.html")
    assert "kanegenViewer.page" in (tmp_path / "motion.html").read_text()
    refused = kanegen("simulate", model, "--duration", "0.5", "--view", "motion.txt", status=2)
    assert "--view: motion.txt does not end in .html." in refused.stderr


def test_prescribed_freedoms_rest_and_move(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    model = str(MODELS / "quarter_car.toml")
    kanegen("view", model, "--duration", "0.1", "--step", "0.01", "-o", "car.html")
    system = kg.load(model)
    inputs = np.zeros((11, 3, 1))
    inputs[:, 0, 0] = TIMES
    motion = motion_of(system, SimpleNamespace(times=TIMES, x=0 * X, inputs={"prescribed": inputs}))
    assert motion.decoded()[2][:, 0] == pytest.approx(TIMES, rel=1e-6)


def test_rollouts_are_motions(pendulum: kg.System) -> None:
    library = kg.build(pendulum, outputs=("rollout_rk4",))
    rollout = library.rollout([0.5, 0.2], [0.0, 1.0], steps=10, step=0.01)
    assert kg.view(pendulum, rollout).motion.decoded()[1] == pytest.approx(rollout.x, rel=1e-6)
    several = library.rollout(np.zeros((3, 2)), np.zeros((3, 2)), steps=10, step=0.01)
    with pytest.raises(kg.OptionError, match=r"it holds 3 motions\. .* trajectory\.x\[0\]"):
        kg.view(pendulum, several)


def test_a_picture_needs_no_compiler_and_no_sympy() -> None:
    code = (
        "import sys, kanegen as kg; kg.view(kg.load(sys.argv[1])).html(); "
        "print([name for name in ('cffi', 'trimesh', 'viser') if name in sys.modules])"
    )
    model = str(MODELS / "eight_body.toml")
    printed = subprocess.run(
        [sys.executable, "-c", code, model], capture_output=True, text=True, check=True
    ).stdout
    assert printed.strip() == "[]"


def test_python_of_the_document_runs(tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    text = (ROOT / "docs" / "view.md").read_text(encoding="utf-8")
    code = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)[0]
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True)
    for name in ("arm.html", "arm-moving.html"):
        assert "kanegenViewer.page" in (tmp_path / name).read_text(encoding="utf-8")
