"""Freedoms locked by name: the equations are those of the whole system there; names, values and errors."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import kanegen as kg
from kanegen.model.arrays import Floats
from kanegen.model.coordinates import EULER_PARAMETERS, FREEDOMS
from kanegen.model.numbers import value_of
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states
from tests.support.cases import slow_except
from tests.support.random_trees import everything
from tests.support.robots import places, robot_file

TOLERANCE = 1e-12
"""Sums of a dozen bodies in double precision, on two ways: about a hundred roundings of 1e-16."""


def _drawn(seed: int, bodies: int = 4) -> kg.System:
    """A random tree; the value of a freedom that follows locked ones is no expression with a parameter."""
    system = everything(seed, bodies)
    return replace(system, couplings=tuple(one.map_numbers(value_of) for one in system.couplings))


def _some_locked(system: kg.System, seed: int) -> dict[str, Any]:
    """Values of about a third of the freedoms, each orientation as a whole; numbers and parameters."""
    rng = np.random.default_rng(seed)
    values: dict[str, Any] = {}
    names = zip(system.freedom_names, system.freedoms, strict=True)
    whole = {k for k, body in enumerate(system.bodies, start=1) if body.joint.has_free_orientation}
    for k in whole:
        if rng.random() < 0.4:
            joint = system.bodies[k - 1].joint
            values[system.bodies[k - 1].name] = rng.uniform(-1, 1, len(joint.rotation.coordinates)).tolist()
    for name, freedom in names:
        if rng.random() < 0.4 and not (freedom.is_angle and freedom.body in whole):
            value = float(rng.uniform(-1, 1))
            stays = rng.random() < 0.3 and freedom not in system.in_couplings
            values[name] = kg.Parameter(f"at{len(values)}", value) if stays else value
    return values


def _locked(system: kg.System, values: dict[str, Any]) -> kg.System:
    """The system with freedoms locked, where drives on locked angular velocities are left out."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "locked: drives and friction on locked")
        return system.with_locked(values)


def _whole_state(system: kg.System, locked: kg.System, states: States, values: dict[str, Any]) -> States:
    """The states of the whole system in which the locked freedoms stand at their values, at rest."""
    x, y = np.zeros((len(states), len(system.coordinates))), np.zeros((len(states), len(system.freedoms)))
    for place, coordinate in enumerate(system.coordinates):
        body = system.bodies[coordinate.body - 1]
        if coordinate in locked.coordinate_places:
            x[:, place] = states.x[:, locked.coordinate_places[coordinate]]
        elif coordinate.index in EULER_PARAMETERS:
            x[:, place] = values[body.name][coordinate.index - EULER_PARAMETERS[0]]
        else:
            x[:, place] = value_of(locked.bodies[coordinate.body - 1].joint.locked[coordinate.index])
    for freedom, place in locked.places.items():
        y[:, system.places[freedom]] = states.y[:, place]
    return States(x, y, states.force, states.torque, states.inputs)


def _rows(system: kg.System, locked: kg.System) -> list[int]:
    return [system.places[freedom] for freedom in locked.freedoms]


@pytest.mark.parametrize("seed", slow_except(range(24), *range(8)))
def test_the_equations_are_those_of_the_whole_system_at_that_position(seed: int) -> None:
    system = _drawn(seed, bodies=5)
    values = _some_locked(system, seed)
    locked = _locked(system, values)
    assert len(locked.freedoms) < len(system.freedoms) or not values
    states = random_states(locked, 5, seed)
    whole, rows = _whole_state(system, locked, states, values), _rows(system, locked)
    a = reference.mass_matrix(locked, states.x)
    of_whole = reference.mass_matrix(system, whole.x)[:, rows][:, :, rows]
    assert np.abs(a - of_whole).max() <= TOLERANCE * np.abs(of_whole).max()
    f, expected = (
        reference.forcing(tree, s.x, s.y, s.force, s.torque, **s.inputs)
        for tree, s in ((locked, states), (system, whole))
    )
    assert np.abs(f - expected[:, rows]).max() <= TOLERANCE * np.abs(expected).max()


OUTPUTS = (
    "mass_matrix",
    "forcing",
    "kinetic_energy",
    "potential_energy",
    "momentum",
    "body_poses",
    "point_positions",
    "point_velocities",
)


@pytest.mark.parametrize("seed", slow_except((3, 8), 8))
def test_compiled_code_of_both_agrees_in_every_output(seed: int) -> None:
    system = _drawn(seed)
    values = _some_locked(system, seed + 100)
    locked = _locked(system, values)
    states = random_states(locked, 6, seed)
    whole, rows = _whole_state(system, locked, states, values), _rows(system, locked)
    found = [
        kg.build(tree, outputs=OUTPUTS).evaluate(x=s.x, y=s.y, force=s.force, torque=s.torque, **s.inputs)
        for tree, s in ((locked, states), (system, whole))
    ]
    for name in OUTPUTS:
        mine, theirs = (
            np.asarray(getattr(part, name) if hasattr(part, name) else part[name]) for part in found
        )
        if name == "mass_matrix":
            theirs = theirs[:, rows][:, :, rows]
        if name == "forcing":
            theirs = theirs[:, rows]
        assert mine.shape == theirs.shape, name
        assert np.abs(mine - theirs).max() <= TOLERANCE * np.abs(theirs).max(), name


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_pinocchio_reduces_a_robot_to_the_same_equations() -> None:
    file = robot_file("panda")
    system = kg.load(file)
    values = {"panda_joint2": 0.4, "panda_joint5": -1.1, "panda_finger_joint1": 0.02}
    locked = system.with_locked(values)
    values["panda_finger_joint2"] = values["panda_finger_joint1"]
    full = pin.buildModelFromUrdf(str(file))
    q = pin.neutral(full)
    for name, value in values.items():
        q[full.joints[full.getJointId(name)].idx_q] = value
    model = pin.buildReducedModel(full, [full.getJointId(name) for name in values], q)
    order, data = places(locked, model, {}), model.createData()
    states = random_states(locked, 10)
    for x, y in zip(states.x, states.y, strict=True):
        upper = np.triu(pin.crba(model, data, x[order]))
        a, f = np.zeros((len(order),) * 2), np.zeros(len(order))
        a[np.ix_(order, order)] = upper + np.triu(upper, 1).T
        f[order] = -pin.nonLinearEffects(model, data, x[order], y[order])
        assert np.abs(reference.mass_matrix(locked, x) - a).max() < 1e-12 * np.abs(a).max()
        assert np.abs(reference.forcing(locked, x, y) - f).max() < 1e-12 * np.abs(f).max()


def test_bodies_that_no_longer_move_cost_nothing_more() -> None:
    """A wrist whose three hinges are locked at numbers costs no more than one body in its place."""
    arm = kg.load("models/six_revolute_arm.toml")
    names = arm.freedom_names
    locked = arm.with_locked(dict.fromkeys(names[3:], 0.4))
    assert locked.freedom_names == names[:3]
    three = kg.System(arm.name, arm.bodies[:3], arm.gravity)
    most = kg.generate(three, ("mass_matrix",)).operations
    assert kg.generate(locked, ("mass_matrix",)).operations["multiply"] <= most["multiply"] + 12


def _cube(**joint: Any) -> kg.System:
    return kg.System(
        "cube", (kg.Body("cube", 0, 1.0, np.eye(3).tolist(), joint=kg.Joint(name="ball", **joint)),)
    )


@pytest.mark.parametrize("coordinates", ["angles", "quaternion"])
def test_an_orientation_is_locked_as_a_whole_by_the_name_of_its_joint(coordinates: str) -> None:
    system = _cube(coordinates=coordinates)
    value: Floats = np.array([0.3, -0.2, 0.7, 0.5] if coordinates == "quaternion" else [0.3, -0.2, 0.7])
    locked = system.with_locked({"ball": value})
    assert locked.freedom_names == ("cube.s1", "cube.s2", "cube.s3")
    angles = locked.bodies[0].joint.locked[:3]
    if coordinates == "angles":
        assert angles == tuple(value)
    else:
        turned = pin.Quaternion(*value / np.linalg.norm(value)).matrix()
        again = (
            pin.utils.rotate("x", angles[0])
            @ pin.utils.rotate("y", angles[1])
            @ pin.utils.rotate("z", angles[2])
        )
        assert np.abs(again - turned).max() < 1e-15 * 8


def test_a_quaternion_without_turn_locks_at_exact_zeros() -> None:
    assert (
        _cube(coordinates="quaternion").with_locked({"ball": (2, 0, 0, 0)}).bodies[0].joint.locked
        == (0.0,) * 6
    )


def test_limits_and_prescribed_motion_of_a_locked_freedom_end() -> None:
    free = (False, False, True, True, False, False)
    system = _cube(free=free).with_limits({"cube.theta3": {"position": (-1, 1)}, "cube.s1": {"speed": 2}})
    driven = system.with_prescribed("cube.theta3")
    locked = driven.with_locked({"cube.theta3": 0.5})
    assert not locked.prescribed
    assert locked.bodies[0].joint.limits == kg.Limits.of({"s1": {"speed": 2}})
    assert locked.with_locked({"cube.theta3": 0.25}).bodies[0].joint.locked[FREEDOMS.index("theta3")] == 0.25
    with pytest.warns(kg.KanegenWarning, match=r"cube.theta3 at 2 is outside its limits, -1 to 1"):
        system.with_locked({"cube.theta3": 2})


def test_a_drive_on_a_locked_angular_velocity_is_left_out_with_a_warning() -> None:
    system = _cube(coordinates="quaternion").with_force_elements(
        kg.Drive("cube.omega2", kg.parse("3 - y.cube.omega2")), kg.Drive("cube.s1", kg.parse("2*x.cube.e0"))
    )
    with pytest.warns(kg.KanegenWarning, match=r"left out: cube.omega2\.$"):
        locked = system.with_locked({"ball": (3, 0, 4, 0)})
    assert [str(element.effort) for element in locked.force_elements if isinstance(element, kg.Drive)] == [
        "2.0 * 3.0"
    ]


def _sliders() -> kg.System:
    """Four sliders a, b, c, d with b = 2 a + 0.1 and c = b - d."""
    bodies = tuple(
        kg.Body(name, k, 1.0 + k, np.eye(3).tolist(), joint=kg.Joint(name=name, free=_ALONG))
        for k, name in enumerate("abcd")
    )
    couplings = kg.Coupling("c", {"b": 1.0, "d": -1.0}), kg.Coupling("b", {"a": 2.0}, 0.1)
    return kg.System("sliders", bodies).with_couplings(*couplings)


_ALONG = (False, False, False, True, False, False)


def test_generated_documents_say_where_freedoms_are_locked_and_which_are_coupled() -> None:
    """Turns have the sequence of their angles, values may be parameters, and joints at 0 are named, too."""
    constant = ("a.s1 = 0.25 m (joint a)", "b.s1 = 0.6 m (joint b)")
    assert _sliders().with_locked({"a": 0.25}).locked_summaries == constant
    assert _sliders().with_locked({"d": 0}).locked_summaries == ("all six freedoms of d = 0 (joint d)",)
    files = kg.generate(_sliders().with_locked({"d": 0.5})).files
    header, readme = files["sliders.h"], files["README.md"]
    assert "Locked freedoms, constant and not in x and y; those that are not in this list are at 0" in header
    assert " *     d.s1 = 0.5 m (joint d)\n" in header
    assert "- `d.s1 = 0.5 m (joint d)`\n" in readme
    for equation in ("b = 2.0 a + 0.1", "c = 1.0 b + -0.5"):
        assert equation in header
        assert f"- `{equation}`\n" in readme
    turned = _cube(sequence="3-2-1").with_locked({"ball": (0, kg.Parameter("pitch", 0.4), 0)})
    assert turned.locked_summaries == ("cube.theta2 = pitch rad, sequence 3-2-1",)


def test_what_follows_only_locked_freedoms_is_locked_and_other_couplings_keep_their_value() -> None:
    locked = _sliders().with_locked({"a": 0.3})
    assert locked.freedom_names == ("d",)
    assert [body.joint.locked[3] for body in locked.bodies] == [0.3, 2 * 0.3 + 0.1, 0.0, 0.0]
    assert locked.couplings == (kg.Coupling("c.s1", {"d.s1": -1.0}, 2 * 0.3 + 0.1),)
    assert _sliders().with_locked({"d": 0.5}).couplings[0].offset in (-0.5, 0.1)
    with pytest.raises(kg.ModelError, match=r"'b' is coupled. Lock the freedoms that it follows"):
        _sliders().with_locked({"b": 0.0})
    value = _sliders().with_locked({"a": kg.Parameter("at", 0.3)}).bodies[1].joint.locked[3]
    assert str(value) == "0.1 + 2 * at"
    assert value_of(value) == pytest.approx(0.7, rel=1e-15)


@pytest.mark.parametrize(
    ("joint", "values", "message"),
    [
        ({}, {"cub.s1": 0}, "locked: there is no freedom 'cub.s1'. Did you mean 'cube.s1'?"),
        ({}, {"cube.s1": "x"}, "locked: 'cube.s1': 'x' is not a number"),
        ({}, {"ball": 0.3}, "locked: 'ball': expected 3 numbers, got 0.3"),
        ({}, ["cube.s1"], 'locked: expected a table such as {"elbow": 0.3}'),
        (
            {"coordinates": "quaternion"},
            {"cube.theta1": 0.3},
            "Lock the whole orientation, such as {'ball': (1",
        ),
        (
            {"coordinates": "quaternion"},
            {"cube.omega1": 0},
            "'cube.omega1' has no coordinate of its own. Lock the whole orientation, such as {'ball': (1",
        ),
        ({"coordinates": "quaternion"}, {"ball": [0] * 4}, "4 zeros are no orientation"),
        (
            {"coordinates": "quaternion"},
            {"ball": [kg.Parameter("e", 1.0), 0, 0, 0]},
            "an orientation by 4 numbers takes no parameters",
        ),
        ({"speeds": "angular_velocity"}, {"cube.theta1": 0.3}, "Lock theta1, theta2 and theta3 together"),
        ({"free": (False,) * 5 + (True,)}, {"ball": 0.3}, "has no free freedom: every joint is locked"),
    ],
)
def test_what_cannot_be_locked_is_refused(joint: Any, values: Any, message: str) -> None:
    with pytest.raises(kg.ModelError) as caught:
        _cube(**joint).with_locked(values)
    assert message in str(caught.value)
