"""Systems from arrays: accepted values, and the message for each refused one."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.model.coordinates import FREEDOMS

HOSTILE = ('a; system("x")', "../../x", "a b", "größe", "1abc", "a\n", "a*/", "x" * 64)


def arrays(bodies: int = 3, **changes: Any) -> dict[str, Any]:
    return {
        "connection": [0, 1, 1][:bodies],
        "mass": np.ones(bodies),
        "inertia": np.array([np.eye(3)] * bodies),
        "mass_center": np.zeros((bodies, 3)),
        "joint_position": np.zeros((bodies, 3)),
        **changes,
    }


def test_arrays_become_bodies() -> None:
    rng = np.random.default_rng(1)
    free = np.zeros((3, 6), dtype=bool)
    free[0, 5] = free[1, 0] = free[1, 3] = free[2, 1] = True
    locked = rng.normal(size=(3, 6))
    quarter = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
    system = kg.System.from_arrays(
        **arrays(mass=[1, 2.5, np.float32(3)], mass_center=rng.normal(size=(3, 3))),
        joint_orientation=[quarter] * 3,
        free=free,
        locked=locked,
        gravity=[0, 1, 2],
        loads=[True, False, True],
        name="machine",
    )
    assert system.name == "machine"
    assert system.connection == (0, 1, 1)
    assert system.freedom_names == ("body2.theta1", "body3.theta2", "body1.s3", "body2.s1")
    assert [f.unit for f in system.freedoms] == ["rad", "rad", "m", "m"]
    values = system.values()
    np.testing.assert_array_equal(values.mass, [1, 2.5, 3])
    np.testing.assert_array_equal(values.joint_orientation[1], quarter)
    np.testing.assert_array_equal(values.locked, np.where(free, 0, locked))
    np.testing.assert_array_equal(values.gravity, [0, 1, 2])
    np.testing.assert_array_equal(values.loads, [True, False, True])


def test_defaults_free_everything() -> None:
    system = kg.System.from_arrays(**arrays(1))
    assert system.freedom_names == tuple(f"body1.{name}" for name in FREEDOMS)
    assert system.gravity == (0.0, 0.0, -9.81)
    assert not system.bodies[0].loads
    assert kg.System.from_arrays(**arrays(2), loads=True).bodies[1].loads


def test_systems_are_values() -> None:
    system = kg.System.from_arrays(**arrays())
    assert system == kg.System.from_arrays(**arrays())
    assert hash(system) == hash(kg.System.from_arrays(**arrays()))
    with pytest.raises(FrozenInstanceError):
        system.name = "other"  # type: ignore[misc]


def test_a_joint_of_one_freedom_gives_it_its_name() -> None:
    hinge = kg.Joint(free=(False, False, True, False, False, False), name="elbow")
    free = kg.Joint(name="base")
    one = np.eye(3).tolist()
    system = kg.System(
        "arm", (kg.Body("trunk", 0, 1.0, one, joint=free), kg.Body("arm", 1, 1.0, one, joint=hinge))
    )
    assert system.freedom_names[3] == "elbow"
    assert system.freedom_names[0] == "trunk.theta1"


def test_parameters_are_collected_once_in_order() -> None:
    m, r = kg.Parameter("m", 2), kg.Parameter("r", 0.5)
    system = kg.System.from_arrays(**arrays(mass=[1, m, m], mass_center=[[0, 0, 0], [r, 0, 0], [0, r, 0]]))
    assert system.parameters == (m, r)
    changed = system.with_parameters({"m": 3.0})
    assert changed.parameters == (kg.Parameter("m", 3.0), r)
    assert changed.values().mass.tolist() == [1, 3, 3]
    with pytest.raises(kg.ModelError, match=r"unknown parameter 'mm'. Known are 'm', "):
        system.with_parameters({"mm": 1.0})
    with pytest.raises(kg.ModelError, match=r"mass m = -1\.0 kg is negative"):
        system.with_parameters({"m": -1.0})
    with pytest.raises(kg.ModelError, match=r"parameter 'm' has two values, 2.0 and 5.0"):
        kg.System.from_arrays(**arrays(mass=[m, kg.Parameter("m", 5), 1]))


CONNECTIONS = {
    "empty": ([], "connection array is empty"),
    "not from the ground": ([1, 1], "starts with 1, but body 1 is connected to the ground"),
    "upward": ([0, 3, 1], "body 2 has the lower body 3, a higher number"),
    "itself": ([0, 2], "body 2 is its own lower body"),
    "out of range": ([0, 7], "lower body 7 of body 2 is out of range"),
    "negative": ([0, -1], "lower body -1 of body 2 is out of range"),
    "fraction": ([0, 0.5], r"connection\[1\]: 0.5 is not an integer"),
    "truth value": ([False, 1], "is not an integer"),
    "text": ("01", "expected a sequence of integers"),
    "number": (3, "expected a sequence of integers"),
    "without an order": ({0, 1}, "expected a sequence of integers"),
    "table": ({0: 1}, "expected a sequence of integers"),
}


@pytest.mark.parametrize("case", CONNECTIONS)
def test_bad_connections(case: str) -> None:
    connection, message = CONNECTIONS[case]
    with pytest.raises(kg.ModelError, match=message):
        kg.System.from_arrays(**arrays() | {"connection": connection})


def with_entry(array: Any, index: tuple[int, ...], value: Any) -> np.ndarray:
    changed = np.array(array, dtype=object)
    changed[index] = value
    return changed


EYES = np.array([np.eye(3)] * 3)
NUMBERS = {
    "too few masses": ({"mass": [1, 1]}, "mass: expected 3 numbers, got 2 entries"),
    "one mass": ({"mass": 1.0}, "mass: expected 3 numbers, got 1.0"),
    "nested too little": ({"mass_center": np.zeros(3)}, r"mass_center\[0\]: expected 3 numbers"),
    "too wide": ({"joint_position": np.zeros((3, 4))}, r"joint_position\[0\]: expected 3 numbers, got 4"),
    "NaN": ({"mass": [1, np.nan, 1]}, r"mass\[1\]: nan is not finite"),
    "infinite": (
        {"joint_position": with_entry(np.zeros((3, 3)), (2, 1), np.inf)},
        r"joint_position\[2\]\[1\].*finite",
    ),
    "huge integer": ({"mass": [1, 10**5000, 1]}, "is not finite"),
    "text": ({"mass": [1, "2", 1]}, r"mass\[1\]: '2' is not a number"),
    "complex": ({"mass": [1, 2j, 1]}, "is not a number"),
    "truth value": ({"mass": [1, True, 1]}, "True is not a number"),
    "nothing": ({"gravity": None}, "gravity: expected 3 numbers"),
    "masses without an order": ({"mass": {1.0, 2.0, 3.0}}, "mass: expected 3 numbers"),
    "negative mass": ({"mass": [1, 1, -2]}, "body 'body3': mass -2.0 kg is negative"),
    "asymmetric inertia": (
        {"inertia": with_entry(EYES, (1, 0, 1), 0.1)},
        r"'body2': inertia is not symmetric",
    ),
    "indefinite inertia": ({"inertia": with_entry(EYES, (0, 2, 2), -1.0)}, "not positive semidefinite"),
    "free of wrong type": ({"free": np.ones((3, 6))}, "is not true or false"),
    "free of wrong shape": ({"free": np.ones((3, 5), dtype=bool)}, r"free\[0\]: expected 6 entries, got 5"),
    "locked NaN": ({"locked": np.full((3, 6), np.nan)}, "locked.*is not finite"),
    "loads of wrong length": ({"loads": [True]}, "loads: expected 3 entries, got 1"),
    "scaled orientation": ({"joint_orientation": 2 * EYES}, "body 1: joint orientation is not a rotation"),
    "reflection": ({"joint_orientation": -EYES}, "it is a reflection"),
    "all locked": ({"free": np.zeros((3, 6), dtype=bool)}, "has no free freedom"),
}


@pytest.mark.parametrize("case", NUMBERS)
def test_bad_numbers(case: str) -> None:
    changes, message = NUMBERS[case]
    with pytest.raises(kg.ModelError, match=message):
        kg.System.from_arrays(**arrays(**changes))


def test_bodies_and_joints_of_another_kind() -> None:
    body = kg.Body("a", 0, 1.0, EYES[0])
    with pytest.raises(kg.ModelError, match="body 'a': joint: 'hinge' is no Joint"):
        replace(body, joint="hinge")
    with pytest.raises(kg.ModelError, match="bodies: 'a' is no Body"):
        kg.System("one", ("a",))
    with pytest.raises(kg.ModelError, match="bodies: expected a sequence of Body objects, got None"):
        kg.System("none", None)
    assert kg.System("one", [body]).bodies == (body,)


def test_a_violated_triangle_inequality_is_a_warning() -> None:
    inertia = EYES.copy()
    inertia[1] = np.diag([1.0, 1.0, 2.5])
    with pytest.warns(kg.KanegenWarning, match="body 'body2'.*triangle inequality"):
        kg.System.from_arrays(**arrays(inertia=inertia))


@pytest.mark.parametrize("unit", [5e-324, 1e-300, 1e200, 7e307])
def test_inertias_of_every_size_are_checked(unit: float) -> None:
    """Inertias of every magnitude are checked without overflow or underflow."""
    inertia = EYES * unit
    assert kg.System.from_arrays(**arrays(inertia=inertia)).bodies[0].inertia[0][0] == unit
    inertia[1] = np.diag([0.0, unit, 2 * unit])
    with pytest.warns(kg.KanegenWarning, match="body 'body2'.*triangle inequality"):
        kg.System.from_arrays(**arrays(inertia=inertia))
    inertia[1] = np.diag([unit, -unit, unit])
    with pytest.raises(kg.ModelError, match="not positive semidefinite"):
        kg.System.from_arrays(**arrays(inertia=inertia))


@pytest.mark.parametrize("name", [*HOSTILE, "", "while", "class", "a-b"])
def test_hostile_parameter_names(name: str) -> None:
    """Parameters are variables of the code; every other name is in tests/model/test_names.py."""
    with pytest.raises(kg.ModelError, match="parameter name"):
        kg.Parameter(name, 1.0)


def test_names_that_are_no_strings() -> None:
    with pytest.raises(kg.ModelError, match="system name: 3 is not a string"):
        kg.System.from_arrays(**arrays(), name=3)


def test_duplicate_names() -> None:
    body = kg.Body("a", 0, 1.0, EYES[0])
    with pytest.raises(kg.ModelError, match="body name 'a' is used twice"):
        kg.System("two", (body, replace(body, lower=1)))
    slider = kg.Joint(free=(False,) * 5 + (True,), name="slide")
    twins = (replace(body, joint=slider), replace(body, name="b", joint=slider))
    with pytest.raises(kg.ModelError, match="freedom name 'slide' is used twice"):
        kg.System("twins", twins)


@pytest.mark.parametrize("name", ["theta_1_1", "s_3_2", "thetadot_2_3", "F_1_1"])
def test_parameters_must_not_hide_coordinates(name: str) -> None:
    with pytest.raises(kg.ModelError, match="already names a coordinate"):
        kg.System.from_arrays(**arrays(mass=[1, 1, kg.Parameter(name, 1.0)]))
