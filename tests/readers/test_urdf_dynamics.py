"""Damping and friction of URDF joints: read on request, and never left out in silence."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.model.force_elements.elements import JointFriction, JointSpring
from kanegen.readers.urdf_dynamics import inertia_at_zero
from kanegen.reference import equations as reference
from tests.support import systems
from tests.support.paths import FROM_REPORTS
from tests.support.robots import robot_file
from tests.support.urdf import BASE, joint, link

PENDULUM = FROM_REPORTS / "damping.urdf"
LEFT_OUT = r"joint damping and friction are left out"


def test_a_damped_pendulum() -> None:
    """The case of a report, with its equation of motion."""
    system = kg.load(PENDULUM, joint_dynamics=True)
    assert system.force_elements == (JointSpring("rod.theta2", damping=0.6),)
    q, rate = 0.4, 5.0
    expected = (-2 * 9.81 * 0.5 * np.sin(q) - 0.6 * rate) / (0.1 + 2 * 0.25)
    found = kg.build(system, "forward_dynamics").forward_dynamics([q], [rate], [0.0])
    assert found == pytest.approx([expected], rel=1e-14)


def test_it_is_not_left_out_in_silence() -> None:
    """0.6 N m s/rad at 0.6 kg m^2 change the acceleration by 1 rad/s^2 per rad/s."""
    with pytest.warns(kg.KanegenWarning, match=LEFT_OUT) as caught:
        kg.load(PENDULUM)
    (warning,) = caught
    text = str(warning.message)
    assert text.startswith(f"{PENDULUM}: ")
    assert "joint_dynamics=True or --joint-dynamics" in text
    assert "0.6 of 'pivot', changing {ydot} by up to 1 rad/s^2 or m/s^2 per rad/s" in text
    assert "\n" not in text


def test_a_robot_names_few_joints_and_the_largest_change() -> None:
    with pytest.warns(kg.KanegenWarning, match=LEFT_OUT) as caught:
        kg.load(robot_file("go1"))
    (text,) = (str(one.message) for one in caught if re.search(LEFT_OUT, str(one.message)))
    assert "0.01 of 'FR_hip_joint', 0.01 of 'FR_thigh_joint', 0.01 of 'FR_calf_joint' and 9 others" in text
    assert "friction (N m, N): 0.2 of 'FR_hip_joint'" in text
    assert len(text) < 800
    system = kg.load(robot_file("go1"), joint_dynamics=True)
    kinds = [type(element) for element in system.force_elements]
    assert kinds == [JointSpring] * 12 + [JointFriction] * 12
    assert {element.smoothing for element in system.force_elements[12:]} == {0.01}


def read(folder: Path, dynamics: str, **options: bool) -> kg.System:
    path = folder / "r.urdf"
    text = BASE + link("a") + joint("j", "base", "a", dynamics, "prismatic")
    path.write_text(f'<robot name="r">\n{text}</robot>\n', encoding="utf-8")
    return kg.load(path, **options)


def test_friction_of_a_slide(tmp_path: Path) -> None:
    system = read(tmp_path, '<dynamics friction="2.5"/>', joint_dynamics=True)
    assert system.force_elements == (JointFriction("a.s1", 2.5, 0.01),)
    for rate in (0.0, 0.003, -1.0):
        assert reference.forcing(system, [0.0], [rate]) == pytest.approx([-2.5 * np.tanh(rate / 0.01)])


@pytest.mark.parametrize(
    "dynamics", ["", "<dynamics/>", '<dynamics damping="0"/>', '<dynamics damping="0.0" friction="-0.0"/>']
)
def test_zeros_need_no_warning(tmp_path: Path, dynamics: str) -> None:
    assert read(tmp_path, dynamics) == read(tmp_path, dynamics, joint_dynamics=True)


@pytest.mark.parametrize(
    ("dynamics", "message"),
    [
        ('<dynamics damping="-1"/>', r"r\.urdf:\d+: <dynamics damping>: -1\.0 is negative"),
        ('<dynamics friction="-1"/>', r"r\.urdf:\d+: <dynamics friction>: -1\.0 is negative"),
        ('<dynamics damping="much"/>', r"r\.urdf:\d+: .*damping.*much"),
    ],
)
@pytest.mark.parametrize("joint_dynamics", [True, False])
def test_what_is_refused(tmp_path: Path, dynamics: str, message: str, joint_dynamics: bool) -> None:
    """What is wrong in the file is wrong whether or not damping and friction are read."""
    with pytest.raises(kg.ReadError, match=message):
        read(tmp_path, dynamics, joint_dynamics=joint_dynamics)


def test_it_is_not_for_toml_files() -> None:
    with pytest.raises(
        kg.OptionError, match=r"is for URDF and MJCF files.*\[\[joint_spring\]\] with a damping"
    ):
        kg.load("models/double_pendulum.toml", joint_dynamics=True)


@pytest.mark.parametrize("seed", range(4))
def test_the_inertia_at_zero_is_the_diagonal_of_the_mass_matrix(seed: int) -> None:
    rng = np.random.default_rng(seed)
    free = np.zeros((6, 6), dtype=bool)
    free[np.arange(6), rng.integers(0, 6, 6)] = True
    system = systems.random_system(rng, 6, free=free, locked=False, loads=False)
    a = reference.mass_matrix(system, np.zeros(6))
    for place, freedom in enumerate(system.freedoms):
        found = inertia_at_zero(system.values(), freedom.body - 1, freedom.index)
        assert found == pytest.approx(a[place, place], rel=1e-12)
