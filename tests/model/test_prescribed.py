"""Prescribed freedoms in models, files and arguments, and functions that refuse them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import kanegen as kg
from kanegen.cli.app import app
from kanegen.measure import truth as certified
from kanegen.simulation import simulate
from kanegen.studies.bench import BenchOptions
from kanegen.studies.bench.compare import compare
from kanegen.studies.tradeoff.domain import default_domain
from kanegen.studies.tradeoff.study import study
from tests.support import systems
from tests.support.paths import MODELS

BODY = """
name = "shaken"
[[body]]
name = "table"
connection = 0
mass = 1.0
inertia = [1, 1, 1]
"""


def file(folder: Path, *lines: str) -> Path:
    path = folder / "model.toml"
    path.write_text(BODY + "\n".join(f"joint.{line}" for line in lines))
    return path


def pendulum() -> kg.System:
    return kg.load(MODELS / "double_pendulum.toml").with_prescribed(["q1"])


def test_what_is_not_prescribed_is_free_unless_more_is_said(tmp_path: Path) -> None:
    table = kg.load(file(tmp_path, "prescribed = ['s1', 'theta2']"))
    assert table.prescribed_names == ("table.theta2", "table.s1")
    assert table.freedom_names == ("table.theta1", "table.theta3", "table.s2", "table.s3")
    few = kg.load(file(tmp_path, "prescribed = ['s1']", "free = ['s2']", "locked = {s3 = 0.5}"))
    assert few.freedom_names == ("table.s2",)
    for system in (table, few, pendulum()):
        system.save(tmp_path / "saved.toml")
        assert kg.load(tmp_path / "saved.toml") == system
    assert systems.from_values(table.values()).values().prescribed.tolist() == [
        list(table.bodies[0].joint.prescribed)
    ]


def test_a_joint_keeps_its_name() -> None:
    system = pendulum()
    assert system.prescribed_names == ("q1",)
    assert system.freedom_names == ("q2",)
    assert system.with_prescribed(["q1"]) == system
    angular = systems.random_system(
        np.random.default_rng(1), 1, free=systems.flags(1, ["theta1", "theta2", "theta3", "s1"])
    )
    assert angular.with_prescribed(["body1.s1"]).with_coordinates("quaternion").prescribed_names == (
        "body1.s1",
    )


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["prescribed = ['s4']"], r"prescribed: 's4' is no freedom"),
        (["prescribed = 's1'"], r"prescribed: 's1' is neither"),
        (["prescribed = ['s1', 's1']"], r"prescribed: freedom 's1' "),
        (["prescribed = ['s1']", "free = 'all'"], r"prescribed: 's1' is free as well"),
        (["prescribed = ['s1']", "locked = {s1 = 0}"], r"locked: 's1' is prescribed. Delete it here"),
        (["prescribed = 'all'"], r"no free freedom: every joint is locked or prescribed"),
        (["prescribed = ['theta1']", "speeds = 'angular_velocity'"], r"needs three free angles"),
        (["prescribed = ['theta1']", "coordinates = 'quaternion'"], r"needs three free angles"),
    ],
)
def test_what_a_file_may_not_say(lines: list[str], message: str, tmp_path: Path) -> None:
    with pytest.raises(kg.ReadError, match=message):
        kg.load(file(tmp_path, *lines))


def test_what_arrays_may_not_say() -> None:
    arrays = kg.load(MODELS / "double_pendulum.toml").values()
    both = replace(arrays, prescribed=arrays.free)
    with pytest.raises(kg.ModelError, match=r"body 1: prescribed: 'theta3' is free as well"):
        systems.from_values(both)
    locked, prescribed = arrays.locked.copy(), arrays.prescribed.copy()
    locked[0, 0], prescribed[0, 0] = 0.2, True
    with pytest.raises(kg.ModelError, match=r"prescribed: 'theta1' is locked at 0.2. Leave one out"):
        systems.from_values(replace(arrays, locked=locked, prescribed=prescribed))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("upper.theta1", r"'upper.theta1' is locked; free it, then prescribe it"),
        ("q3", r"there is no freedom 'q3'. Known are 'q1', 'q2'"),
    ],
)
def test_what_cannot_be_prescribed(name: str, message: str) -> None:
    with pytest.raises(kg.ModelError, match=message):
        kg.load(MODELS / "double_pendulum.toml").with_prescribed([name])


def test_three_angles_stay_together() -> None:
    system = systems.random_system(np.random.default_rng(2), 1, free=systems.flags(1, systems.FREEDOMS))
    with pytest.raises(kg.ModelError, match=r"'body1.theta2': joint speeds: .* three free angles"):
        system.with_speeds("angular_velocity").with_prescribed(["body1.theta2"])


def test_arguments() -> None:
    library = kg.build(pendulum())
    with pytest.raises(kg.ArrayError, match=r"prescribed: missing, .*\(3, 1\).* of q1"):
        library.forcing([0.1], [0.2])
    with pytest.raises(kg.ArrayError, match="prescribed: expected shape"):
        library.mass_matrix([0.1], prescribed=[1, 2, 3])
    plain = kg.build(kg.load(MODELS / "double_pendulum.toml"))
    with pytest.raises(
        kg.ArrayError, match="prescribed: no output of system 'double_pendulum' depends on it"
    ):
        plain.mass_matrix([0.1, 0.2], prescribed=[[0], [0], [0]])


def test_only_where_something_is_prescribed() -> None:
    with pytest.raises(
        kg.OptionError, match=r"'prescribed_efforts': system 'scara' has no prescribed freedoms"
    ):
        kg.generate(kg.load(MODELS / "scara.toml"), ("prescribed_efforts",))


def test_functions_without_prescribed_motion_refuse() -> None:
    system = pendulum()
    message = r"system 'double_pendulum' has prescribed freedoms \(q1\), whose motion cannot be passed here"
    for refuse in (
        lambda: compare(system, BenchOptions()),
        lambda: study(system),
        lambda: default_domain(system),
        lambda: certified.truth(system, [0.1], [0.2]),
    ):
        with pytest.raises(kg.OptionError, match=message):
            refuse()


def shaken(time: float) -> np.ndarray:
    return np.array([[0.3 * np.sin(4 * time)], [1.2 * np.cos(4 * time)], [-4.8 * np.sin(4 * time)]])


@pytest.mark.parametrize("method", ["RK4", "DOP853", "leapfrog"])
def test_simulations_take_the_prescribed_motion(method: str) -> None:
    """The work of the prescribed efforts is the change of energy in a simulation."""
    outputs = ("forward_dynamics", "kinetic_energy", "potential_energy", "prescribed_efforts")
    library = kg.build(pendulum(), outputs)
    times = np.linspace(0.0, 1.0, 6)
    chosen = {"tolerance": 1e-12} if method == "DOP853" else {"step": 2.0**-12}
    found = simulate(library, [0.1], [0.2], times, method, prescribed=shaken, **chosen)
    assert np.ptp(found.work) > 1.0
    assert found.energy_drift.largest < (1e-5 if method == "leapfrog" else 1e-10)
    if method == "RK4":
        many = simulate(library, [[0.1], [0.5]], [[0.2], [0.0]], times, prescribed=shaken, **chosen)
        assert np.array_equal(many.x[:, 0], found.x)
        assert many.energy_drift.largest < 1e-10


def test_simulations_ask_for_the_motion() -> None:
    library = kg.build(pendulum(), ("forward_dynamics",))
    plain = kg.build(kg.load(MODELS / "double_pendulum.toml"), ("forward_dynamics",))
    with pytest.raises(kg.OptionError, match=r"has prescribed freedoms \(q1\)\. Say how they move"):
        simulate(library, [0.1], [0.2], [0, 1], step=0.1)
    with pytest.raises(kg.OptionError, match=r"prescribed: 3 cannot be called"):
        simulate(library, [0.1], [0.2], [0, 1], step=0.1, prescribed=3)  # type: ignore[arg-type]
    with pytest.raises(kg.OptionError, match="no freedom of system 'double_pendulum' is prescribed"):
        simulate(plain, [0.1, 0], [0.2, 0], [0, 1], step=0.1, prescribed=shaken)
    with pytest.raises(kg.OptionError, match=r"prescribed: .*shape \(3, 1\)"):
        simulate(library, [0.1], [0.2], [0, 1], step=0.1, prescribed=lambda time: [time])


def test_a_frame_in_which_a_translation_is_prescribed_stays() -> None:
    free = systems.flags(2, ["theta1", "theta2", "theta3"])
    free[0, 4] = True
    system = systems.random_system(np.random.default_rng(3), 2, free=free).with_prescribed(["body1.s2"])
    x, y = np.full((2, len(system.freedoms)), 0.3)
    with pytest.raises(kg.OptionError, match=r"body 'body1' cannot be re-anchored: .*prescribed"):
        kg.reanchored(system, x, y, bodies="body1")
    assert kg.reanchored(system, x, y, bodies="body2").system.prescribed == system.prescribed


def test_right_angles_beside_what_is_prescribed(tmp_path: Path) -> None:
    """The effect of exact right angles is measured in states that include the prescribed motion."""
    model = file(
        tmp_path, "prescribed = ['s1']", "free = ['s2', 'theta3']", "orientation_angles = [1.5708, 0, 0]"
    )
    drive = '[[drive]]\nfreedom = "table.s2"\neffort = "sin(t)*x.table.s1"\n'
    model.write_text(model.read_text() + "\n" + drive)
    found = CliRunner().invoke(app, ["info", str(model), "--json"], catch_exceptions=False)
    assert found.exit_code == 0
    assert 0 < json.loads(found.stdout)["right_angles"]["results"]["forcing"] < 1e-4


def test_info_says_what_is_prescribed(tmp_path: Path) -> None:
    model = str(file(tmp_path, "prescribed = ['s1']", "free = ['s2']"))
    found = json.loads(CliRunner().invoke(app, ["info", model, "--json"]).stdout)
    assert found["prescribed"] == [{"name": "table.s1", "body": 1, "freedom": "s1", "unit": "m"}]
    assert found["bodies"][0]["prescribed"] == ["s1"]
    shown = CliRunner().invoke(app, ["info", model]).stdout
    assert "s2, prescribed s1" in shown
    assert "Prescribed freedoms" in shown
