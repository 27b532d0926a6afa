"""Rotors in model files, and what is refused of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.model.reanchorable import require_free_frame
from kanegen.reference import equations as reference
from kanegen.studies.bench.states import without_loads_and_parameters
from tests.support import random_trees, systems

TOML = """
name = "arm"
[parameters]
J = 3e-5
[[body]]
name = "base"
connection = "ground"
mass = 3.0
inertia = [0.2, 0.2, 0.1]
joint = {name = "pan", free = ["theta3"]}
frames = {housing = {position = [0, 0, 0.2], orientation_angles = [0, 1.5707963267948966, 0]}}
[[body]]
name = "link"
connection = "base"
mass = 1.0
mass_center = [0.3, 0, 0]
inertia = [0.1, 0.1, 0.1]
joint = {name = "tilt", free = ["theta2"]}
[[rotor]]
name = "motor"
freedom = "tilt"
axis = [0, 0, 2]
inertia = "J"
ratio = 80
body = "housing"
"""


def test_it_is_saved_and_read(tmp_path: Path) -> None:
    system = random_trees.everything(3)
    assert system.rotors
    system.save(tmp_path / "again.toml")
    assert kg.load(tmp_path / "again.toml") == system


def test_a_file_with_a_rotor_in_a_frame(tmp_path: Path) -> None:
    file = tmp_path / "arm.toml"
    file.write_text(TOML)
    system = kg.load(file)
    (rotor,) = system.values().rotors
    assert rotor.body == 1
    assert rotor.axis == pytest.approx([1, 0, 0], abs=1e-15)
    assert system.rotors[0].freedom == "link.theta2"
    assert system.with_locked({"tilt": 0.1}).rotors == system.rotors
    assert [p.name for p in system.parameters] == ["J"]
    at_rest = reference.mass_matrix(system, [0, 0])
    assert at_rest[1, 1] == pytest.approx(0.1 + 0.09 + 3e-5 * 80**2)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("axis = [0, 0, 2]", "axis = [0, 0, 0]", "rotor 'motor': its axis has no direction"),
        ("axis = [0, 0, 2]", "", "rotor 1: axis is missing"),
        ("ratio = 80", "ratio = 0", "rotor 'motor': with the ratio 0 it never turns"),
        ('"J"', "-1e-5", "rotor 'motor': its inertia -1e-05 kg m\\^2 is negative"),
        ('"J"', "0.25", "body 'base': its inertia is less than that of its rotors about their axes"),
        (
            'freedom = "tilt"',
            'freedom = "til"',
            "rotor 'motor': there is no freedom 'til'. Did you mean 'tilt'",
        ),
        ('body = "housing"', 'body = "hous"', "rotor 'motor': there is no body or frame 'hous'"),
        ("ratio = 80", "gear = 80", "rotor 1: unknown key 'gear'"),
        ("[[rotor]]", "[rotor]", "rotor: begin each with a line \\[\\[rotor\\]\\]"),
    ],
)
def test_what_a_file_may_not_say(tmp_path: Path, before: str, after: str, message: str) -> None:
    file = tmp_path / "arm.toml"
    file.write_text(TOML.replace(before, after))
    with pytest.raises(kg.ReadError, match=f"arm.toml: {message}"):
        kg.load(file)


def test_what_is_refused() -> None:
    free = np.array([[True] * 6, [False, False, True, False, False, False]])
    bare = systems.random_system(np.random.default_rng(1), 2, free=free, loads=False)
    rotor = kg.Rotor("r", "body1.theta1", (0, 0, 1), 1e-3, 10.0)
    with pytest.raises(kg.ModelError, match="rotor name 'r' is used twice"):
        bare.with_rotors(rotor, rotor)
    with pytest.raises(kg.ModelError, match="speeds of body 'body1' are its angular velocity"):
        bare.with_rotors(rotor).with_speeds("angular_velocity")
    with pytest.raises(kg.OptionError, match="its coordinates drive rotors"):
        require_free_frame(bare.with_rotors(rotor), 1)
    with pytest.raises(kg.ModelError, match="rotor 'r': axis: a direction has no parameters"):
        kg.Rotor("r", "body1.theta1", (kg.Parameter("a", 1.0), 0, 0), 1e-3)  # type: ignore[arg-type]


def test_benches_count_rotors_as_armature() -> None:
    system = systems.chain(2, ["theta3"]).with_rotors(kg.Rotor("r", "body2.theta3", (0, 0, 1), 1e-3, 20.0))
    plain, notes = without_loads_and_parameters(system)
    assert not plain.rotors
    assert plain.bodies[1].joint.armature == pytest.approx((0, 0, 0.4, 0, 0, 0))
    assert any("rotors count as armature" in note for note in notes)
