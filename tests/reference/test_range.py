"""Numbers of models at the ends of the range of doubles: results that are right, or one error."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from tests.support.cases import slow_among

HINGE = [False, False, True, False, False, False]
HUGE = (1e155, 1e160, 1e200, 1e300, 1e308)
TINY = (1e-155, 1e-200, 1e-300, 1e-308, 5e-324)
OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics", "inverse_dynamics", "kinetic_energy")


def arm(**changes: Any) -> kg.System:
    """Return two links in space, with some arrays replaced."""
    arrays: dict[str, Any] = {
        "connection": [0, 1],
        "mass": [1.0, 2.0],
        "inertia": [np.eye(3) * 0.1] * 2,
        "mass_center": [[0.1, 0, 0.2]] * 2,
        "joint_position": [[0, 0, 0.5]] * 2,
        "free": [HINGE] * 2,
    }
    return kg.System.from_arrays(**{**arrays, **changes})


def changes(value: float) -> dict[str, dict[str, Any]]:
    """Return the places at which a model may hold a value."""
    free = {"free": [[True] * 6] * 2}
    return {
        "mass": {"mass": [value, 1.0]},
        "masses": {"mass": [value, value]},
        "parameter": {"mass": [kg.Parameter("m", value), 1.0]},
        "inertia": {"inertia": [np.eye(3) * value, np.eye(3)]},
        "inertias": {"inertia": [np.eye(3) * value] * 2, **free},
        "mass centre": {"mass_center": [[value, 0, 0], [0, 0.1, 0]]},
        "mass centres": {"mass_center": [[value] * 3] * 2},
        "joint position": {"joint_position": [[0, 0, 0], [value, 0, 0]]},
        "locked": {"locked": [[0, 0, 0, value, 0, 0], [value, 0, 0, 0, 0, 0]]},
        "gravity": {"gravity": (0, 0, value)},
        "free bodies": {"mass": [value, value], **free},
        "angular velocities": {"inertia": [np.eye(3) * value] * 2, "speeds": "angular_velocity", **free},
        "quaternions": {"mass": [value, value], "coordinates": "quaternion", **free},
    }


@pytest.mark.parametrize("place", changes(1.0))
@pytest.mark.parametrize("value", slow_among((*HUGE, *TINY), 1e155, 1e300, 1e-200, 1e-308))
def test_huge_and_tiny_numbers_are_refused_or_right(place: str, value: float) -> None:
    try:
        source = kg.generate(arm(**changes(value)[place]), OUTPUTS)
    except kg.ModelError as error:
        assert re.search("nearer to 1|orientation is not a rotation", str(error)), error
        assert len(str(error)) < 300
    else:
        assert source.operations


@pytest.mark.parametrize("place", ["mass", "masses", "inertia", "inertias", "mass centre", "free bodies"])
@pytest.mark.parametrize("value", [2.0**480, 2.0**-450])
def test_what_is_accepted_is_right(place: str, value: float) -> None:
    """Lengths of 2^480 or masses of 2^-450 leave no term out of range: [A] is that of the reference."""
    system = arm(**changes(value)[place])
    assert kg.compare(system, states=20).passed


def test_message_names_body_and_freedom() -> None:
    with pytest.raises(
        kg.ModelError, match=r"body 'body1': the inertia that freedom 'body1.theta3' moves is too large"
    ):
        kg.generate(arm(joint_position=[[0, 0, 0], [1e155, 0, 0]]))
    with pytest.raises(kg.ModelError, match=r"body 'body2': the mass is too small"):
        kg.generate(arm(mass=[1, 1e-310], inertia=[np.eye(3), np.zeros((3, 3))]))


@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
@pytest.mark.parametrize("attribute", ["mass", "inertia", "xyz", "rpy", "origin", "joint"])
@pytest.mark.parametrize("value", ["1e155", "1e200", "1e308", "1e-308", "-1e300"])
def test_robot_files(attribute: str, value: str, tmp_path: Path) -> None:
    numbers = dict.fromkeys(["mass", "inertia", "xyz", "rpy", "origin", "joint"], "1") | {attribute: value}
    file = tmp_path / "robot.urdf"
    file.write_text(
        """<robot name="r"><link name="base"/><link name="a"><inertial>
<origin xyz="{xyz} 0 0" rpy="{rpy} 0.1 0"/><mass value="{mass}"/>
<inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial>
</link><link name="b"><inertial><origin xyz="{xyz} 1 0"/><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0.1" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0 0 {origin}"/>
<axis xyz="{joint} 1 0"/></joint><joint name="w" type="fixed"><parent link="a"/><child link="b"/>
<origin xyz="{origin} 0 0" rpy="{rpy} 0 0"/></joint></robot>""".format(**numbers)
    )
    try:
        assert kg.generate(kg.load(file), OUTPUTS).operations
    except kg.ModelError as error:
        assert len(str(error)) < 400
