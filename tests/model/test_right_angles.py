"""Rounded right angles of a file: which become exact, how results change, and how this is reported."""

from __future__ import annotations

import json
import math
import warnings
from dataclasses import replace
from itertools import permutations, product
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

import kanegen as kg
from kanegen.cli.app import app
from kanegen.compiler import compile_module
from kanegen.model.numbers import Parameter
from kanegen.model.right_angles import FOUR_DECIMALS, MAX_TOLERANCE, angle, direction, rotation
from kanegen.model.rotations import Square, rotation_123
from kanegen.reference.states import random_states
from kanegen.studies.explain import exactness
from tests.support import systems
from tests.support.robots import dynamics, places, robot_file
from tests.support.urdf import BASE, axis, joint, link, origin

EXACT = {
    "1.5708": math.pi / 2,
    "-1.5708": -math.pi / 2,
    "3.1416": math.pi,
    "3.14159": math.pi,
    "4.7124": 1.5 * math.pi,
    "1.57079632679": math.pi / 2,
    "6.1e-17": 0.0,
    "-0.00001": 0.0,
}
"""Numbers in a file that are rounded right angles, with the exact angles (rad)."""

INTENDED = {"1.5707": 1.5707, "1.57": 1.57, "3.1415": 3.1415, "0.0001": 0.0001, "0.785398": 0.785398}
"""Numbers in a file that are not rounded right angles (rad)."""

SIGNED = [
    np.array(signs)[:, None] * np.eye(3)[list(order)]
    for order in permutations(range(3))
    for signs in product((1.0, -1.0), repeat=3)
]
RIGHT = [m for m in SIGNED if np.linalg.det(m) > 0]
"""All 24 rotations by right angles."""


LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def urdf(folder: Path, name: str, quarter: str, half: str, zero: str, direction: str) -> Path:
    """Return a robot whose joints, welds, inertias and axes have rounded right angles."""
    text = BASE + link("a", 2, origin("0.1 0.2 0.3", f"0 0 {quarter}"))
    text += link("b", 1, origin("0.1 0 0.2", f"{quarter} 0.2 0"), (0.3, 0.4, 0.5)) + link("c") + link("d")
    text += joint("j", "base", "a", axis("0 0 1") + LIMIT + origin("1 2 3", f"{quarter} 0 0.3"))
    text += joint("k", "a", "b", axis(direction) + LIMIT + origin("0.4 0.5 0.6", f"{quarter} 0.2 {half}"))
    text += joint("w", "b", "c", origin("0.1 0.2 0", f"{zero} {quarter} 0"), "fixed")
    text += joint("l", "c", "d", axis("0 1 0") + LIMIT + origin("0.3 0.1 0", f"0 {quarter} 0"), "prismatic")
    path = folder / f"{name}.urdf"
    path.write_text(f'<robot name="r">\n{text}</robot>\n', encoding="utf-8")
    return path


def typed_and_exact(folder: Path) -> tuple[Path, Path]:
    return (
        urdf(folder, "typed", "1.5708", "-3.1416", "1e-6", "0 1 1e-6"),
        urdf(folder, "exact", repr(math.pi / 2), repr(-math.pi), "0", "0 1 0"),
    )


@pytest.mark.parametrize(("word", "meaning"), [*EXACT.items(), *INTENDED.items()])
def test_what_an_angle_means(word: str, meaning: float) -> None:
    assert angle(float(word), FOUR_DECIMALS) == meaning
    assert angle(float(word), 0.0) == float(word)


def test_far_turns_stay() -> None:
    """Angles beyond two full turns stay as they are."""
    assert angle(8 * math.pi / 2 + 1e-6, FOUR_DECIMALS) == 4 * math.pi
    assert angle(9 * math.pi / 2 + 1e-6, FOUR_DECIMALS) == 9 * math.pi / 2 + 1e-6


@given(st.sampled_from(range(24)), st.tuples(*[st.floats(-1, 1)] * 3))
def test_rotations_near_right_angles(which: int, turn: tuple[float, float, float]) -> None:
    small = np.array(rotation_123(tuple(0.4 * FOUR_DECIMALS * x for x in turn)))
    near: Any = tuple(map(tuple, (RIGHT[which] @ small).tolist()))
    assert np.array_equal(rotation(near, FOUR_DECIMALS), RIGHT[which])
    assert rotation(near, 0.0) == near


@given(st.sampled_from(range(24)), st.floats(0.1, 1.4), st.tuples(*[st.floats(-1, 1)] * 2))
def test_rotations_with_one_axis_along_another(which: int, turn: float, tilt: tuple[float, float]) -> None:
    """The tilt of the axis disappears; the rotation about it stays, to the square of the tilt."""
    plane = np.array(rotation_123((0.0, 0.0, turn))) @ RIGHT[which]
    small = np.array(rotation_123((0.4 * FOUR_DECIMALS * tilt[0], 0.4 * FOUR_DECIMALS * tilt[1], 0.0)))
    near: Any = tuple(map(tuple, (small @ plane).tolist()))
    found = np.array(rotation(near, FOUR_DECIMALS))
    assert np.array_equal(found == 0, plane == 0)
    assert np.abs(found @ found.T - np.eye(3)).max() < 1e-15
    assert np.linalg.det(found) > 0
    assert np.abs(found - plane).max() <= FOUR_DECIMALS**2


@given(st.integers(0, 2**32))
def test_other_rotations_and_exact_ones_keep_every_bit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    far: Any = tuple(map(tuple, systems.random_rotation(rng).tolist()))
    plane = rotation_123((0.0, float(rng.uniform(0.1, 1.4)), 0.0))
    kept: list[Square] = [far, plane]
    assert [rotation(m, FOUR_DECIMALS) for m in kept] == kept
    tilted = rotation_123((1e-8, 1e-8, 6e-17))  # whose cosines are 1 to the last digit
    assert tilted[0][0] == 1
    assert rotation(tilted, 1e-12) == tilted


def test_directions() -> None:
    assert direction((1e-6, -1.0, 0.0), FOUR_DECIMALS) == (0.0, -1.0, 0.0)
    x, y, z = direction((0.6, 0.8, 1e-6), FOUR_DECIMALS)
    assert (math.hypot(x, y), z) == (1.0, 0.0)
    assert direction((0.6, 0.8, 1e-4), FOUR_DECIMALS) == (0.6, 0.8, 1e-4)


def test_a_robot_means_what_it_would_say_with_all_digits(tmp_path: Path) -> None:
    typed, exact = typed_and_exact(tmp_path)
    assert kg.load(typed, right_angles=FOUR_DECIMALS) == kg.load(exact)
    assert kg.load(exact, right_angles=FOUR_DECIMALS) == kg.load(exact)


def test_by_default_a_file_means_what_it_says(tmp_path: Path) -> None:
    typed, exact = typed_and_exact(tmp_path)
    assert kg.load(typed) == kg.load(typed, right_angles=0)
    assert kg.load(typed) != kg.load(exact)
    assert abs(kg.load(typed).bodies[0].joint.orientation[1][1]) > 1e-7


def test_quaternions(tmp_path: Path) -> None:
    text = (
        BASE + link("a") + joint("j", "base", "a", '<origin quat_xyzw="0.70711 0 0 0.7071"/>' + axis("0 0 1"))
    )
    path = tmp_path / "r.urdf"
    path.write_text(f'<robot name="r">{text}</robot>', encoding="utf-8")
    (body,) = kg.load(path, right_angles=FOUR_DECIMALS).bodies
    assert body.joint.orientation == ((1, 0, 0), (0, 0, 1), (0, -1, 0))
    assert kg.load(path).bodies[0].joint.orientation != body.joint.orientation


TOML = """
parameters = {{tilt = 0.3}}
[[body]]
connection = 0
mass = 1
inertia = [1, 2, 2]
joint.free = ["theta3"]
joint.orientation_angles = [{quarter}, 0.2, {zero}]
joint.locked = {{theta1 = {half}, s1 = {quarter}}}
[[body]]
connection = 1
mass = 1
joint.free = ["s1"]
joint.orientation_angles = ["tilt", {quarter}, 0.1]
[[body]]
connection = 1
mass = 1
inertia = [1, 2, 2]
joint.free = ["theta2"]
joint.orientation = [[0.0, 1.0, 0.0], [-1.0, 0.0, {tiny}], [{tiny}, 0.0, 1.0]]
"""


def test_toml(tmp_path: Path) -> None:
    """Angles, locked angles and matrices of a TOML file become exact; lengths and parameters stay."""
    quarter, half = math.pi / 2, math.pi
    typed = {"quarter": 1.5708, "half": 3.1416, "zero": -1e-6, "tiny": 6e-17}
    exact = {"quarter": quarter, "half": half, "zero": 0.0, "tiny": 0.0}
    models = []
    for name, words in (("typed", typed), ("exact", exact)):
        path = tmp_path / f"{name}.toml"
        path.write_text('name = "m"\n' + TOML.format(**words))
        models.append(path)
    found, wanted = kg.load(models[0], right_angles=FOUR_DECIMALS), kg.load(models[1])
    assert found.bodies[0].joint.locked == (half, 0, 0, 1.5708, 0, 0)
    assert found.bodies[1].joint.orientation == (Parameter("tilt", 0.3), quarter, 0.1)
    assert [b.joint.orientation for b in found.bodies] == [b.joint.orientation for b in wanted.bodies]
    assert kg.load(models[0]).bodies[0].joint.locked[0] == 3.1416


def test_arrays() -> None:
    """The cosine 6e-17 that NumPy computes for a right angle becomes 0."""
    c, s = np.cos(np.pi / 2), np.sin(np.pi / 2)
    turned = np.array([[1, 0, 0], [0, c, s], [0, -s, c]])
    system = systems.chain(2, ["theta3"])
    fields = system.values().rows()
    rough = kg.System.from_arrays(**fields | {"joint_orientation": [np.eye(3), turned]})
    assert rough.bodies[1].joint.orientation[1][1] == c != 0
    exact = rough.with_right_angles(1e-15)
    assert exact.bodies[1].joint.orientation == ((1, 0, 0), (0, 0, 1), (0, -1, 0))
    assert rough.with_right_angles(0) == rough


def test_saving_loses_nothing(tmp_path: Path) -> None:
    typed, _ = typed_and_exact(tmp_path)
    for tolerance in (0.0, FOUR_DECIMALS):
        system = kg.load(typed, right_angles=tolerance)
        system.save(tmp_path / "saved.toml")
        assert kg.load(tmp_path / "saved.toml") == system


def test_the_report_says_what_pinocchio_finds(tmp_path: Path) -> None:
    """The reported change of [A], {f} and {ydot} agrees with Pinocchio, which reads the same files."""
    files = typed_and_exact(tmp_path)
    written, exact = kg.load(files[0]), kg.load(files[0], right_angles=FOUR_DECIMALS)
    report = exactness(written, exact, states=5, seed=3)
    assert report is not None
    sample = random_states(written, 5, 3, written.limits)
    changes = []
    for x, y in zip(sample.x, sample.y, strict=True):
        both = []
        for file, system in zip(files, (written, exact), strict=True):
            model = pin.buildModelFromUrdf(str(file))
            a, f = dynamics(model, places(system, model, {}), x, y)
            both.append((a, f, np.linalg.solve(a, f)))
        (a, f, ydot), (other_a, other_f, other_ydot) = both
        d = np.diag(np.sqrt(np.diag(a)))
        inverse = np.linalg.inv(d)
        sized = [
            (inverse @ (other_a - a) @ inverse, inverse @ a @ inverse),
            (inverse @ (other_f - f), inverse @ f),
            (d @ (other_ydot - ydot), d @ ydot),
        ]
        changes.append([np.linalg.norm(change) / np.linalg.norm(size) for change, size in sized])
    # The files' difference is 1e-6, of which 16 digits leave ten.
    np.testing.assert_allclose(list(report.results.values()), np.max(changes, axis=0), rtol=1e-6)
    assert list(report.results) == ["mass_matrix", "forcing", "ydot"]
    assert min(report.results.values()) > 1e-8


def test_the_report_names_bodies_and_counts(tmp_path: Path) -> None:
    files = typed_and_exact(tmp_path)
    written, exact = kg.load(files[0]), kg.load(files[1])
    report = exactness(written, exact, states=2)
    assert report is not None
    a, b, d = report.bodies
    assert [a.body, b.body, d.body] == ["a", "b", "d"]
    missed = 1.5708 - math.pi / 2
    assert a.turned == pytest.approx(missed, rel=1e-6)
    assert (a.shifted, a.inertia > 0) == (0, True)
    assert b.shifted > 1e-8
    assert d.turned == pytest.approx(2 * missed, rel=0.05)  # its own and that of the weld, and 1e-6
    assert report.turned == max(body.turned for body in report.bodies)
    for names, (before, after) in report.operations.items():
        for system, count in ((written, before), (exact, after)):
            operations = compile_module(system, names.split(" + ")).operations
            assert count == sum(operations.values()) - operations["prepare"]
        assert after < 0.8 * before
    locked = replace(
        written.bodies[0], joint=replace(written.bodies[0].joint, locked=(3.1416, 0, 0, 0, 0, 0))
    )
    turned = replace(written, bodies=(locked, *written.bodies[1:]))
    report = exactness(turned, turned.with_right_angles(FOUR_DECIMALS), states=2)
    assert report is not None
    assert report.bodies[0].turned == pytest.approx(3.1416 - math.pi)
    assert exactness(exact, exact) is None


def test_a_real_robot() -> None:
    """Every joint of the xArm 7 except the first has the angle 1.5708."""
    path = robot_file("xarm7")
    written, exact = kg.load(path), kg.load(path, right_angles=FOUR_DECIMALS)
    report = exactness(written, exact)
    assert report is not None
    assert {entry for body in exact.bodies for row in body.joint.orientation for entry in row} == {-1, 0, 1}
    assert [body.turned for body in report.bodies] == pytest.approx([1.5708 - math.pi / 2] * 6, rel=1e-9)
    assert max(report.results.values()) < 1e-4
    assert all(after < 0.7 * before for before, after in report.operations.values())


WRONG: list[Any] = [-1e-9, 0.011, math.nan, math.inf, "1e-5", None, True, 10**400]


@pytest.mark.parametrize("tolerance", WRONG, ids=lambda value: repr(value)[:8])
def test_a_tolerance_that_makes_no_sense(tolerance: Any) -> None:
    message = r"right_angles is .*; it must be a number from 0, the model as written, to 0\.01 rad\."
    with pytest.raises(kg.OptionError, match=message):
        kg.load("models/scara.toml", right_angles=tolerance)
    with pytest.raises(kg.OptionError, match=message):
        systems.chain(1, ["theta3"]).with_right_angles(tolerance)
    assert MAX_TOLERANCE == 0.01


COMMANDS = ("generate", "verify", "check", "equations", "info", "explain", "bench", "tradeoff")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_that_reads_a_model_takes_it(command: str) -> None:
    assert "--right-angles" in CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "200"}).output


def test_the_command_line_refuses_what_python_refuses(tmp_path: Path) -> None:
    typed, _ = typed_and_exact(tmp_path)
    done = CliRunner().invoke(app, ["equations", str(typed), "--right-angles", "nan"])
    assert isinstance(done.exception, kg.OptionError)
    assert "right_angles is nan" in str(done.exception)


def test_generate_takes_it(tmp_path: Path) -> None:
    """The C with the option is that of the exact model, byte for byte; without it that of the file."""
    typed, exact = typed_and_exact(tmp_path)
    run = CliRunner()
    run.invoke(app, ["generate", str(typed), "-o", str(tmp_path / "c"), "--right-angles", str(FOUR_DECIMALS)])
    run.invoke(app, ["generate", str(typed), "-o", str(tmp_path / "d")])
    assert (tmp_path / "c" / "r.c").read_text() == kg.generate(kg.load(exact)).files["r.c"]
    assert (tmp_path / "d" / "r.c").read_text() == kg.generate(kg.load(typed)).files["r.c"]


def test_info_says_what_it_changes_or_would(tmp_path: Path) -> None:
    typed, exact = (str(path) for path in typed_and_exact(tmp_path))
    run = CliRunner()
    text = run.invoke(app, ["info", typed]).output
    assert "Right angles missed by no more than 5e-05 rad are as written; --right-angles 5e-05 makes" in text
    assert "this would change: [A] " in text
    text = run.invoke(app, ["info", typed, "--right-angles", "1e-5"]).output
    assert "Right angles missed by no more than 1e-05 rad are exact here" in text
    assert "this changes: [A] " in text
    data = json.loads(run.invoke(app, ["info", typed, "--right-angles", "1e-5", "--json"]).output)
    found = data["right_angles"]
    assert (found["tolerance"], found["taken"], len(found["bodies"])) == (1e-5, True, 3)
    report = exactness(kg.load(typed), kg.load(exact))
    assert report is not None
    assert found["results"] == report.results
    assert found["operations"]["mass_matrix + forcing"]["exact"] == sum(
        data["operations"]["mass_matrix + forcing"].values()
    )
    assert "Right angles" not in run.invoke(app, ["info", exact]).output
    assert json.loads(run.invoke(app, ["info", exact, "--json"]).output)["right_angles"] is None


def test_warnings_come_once(tmp_path: Path) -> None:
    typed, _ = typed_and_exact(tmp_path)
    typed.write_text(typed.read_text().replace("</robot>", "<group/></robot>"))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = CliRunner().invoke(app, ["info", "--json", str(typed)])
    assert not caught
    left_out = json.loads(result.stdout)["left_out"]
    assert [line.count("<group> in <robot>") for line in left_out] == [1]
