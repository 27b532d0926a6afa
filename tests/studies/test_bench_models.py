"""The forms in which the peers take a tree: joints with one freedom each, and MuJoCo's XML."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree as xml

import numpy as np
import pytest
from numpy.typing import NDArray

import kanegen as kg
from kanegen.errors import MissingError
from kanegen.model.coordinates import SEQUENCES
from kanegen.reference.kinematics import kinematics
from kanegen.studies.bench.peers.joints import KINDS, Placement, floating_joints, single_joints
from kanegen.studies.bench.peers.mujoco_peer import links, mjcf
from tests.support import systems

Floats = NDArray[np.float64]
SEEDS = range(6)


def tree(seed: int) -> kg.System:
    """Return a random tree without welded bodies; odd seeds have random sequences of axes."""
    rng = np.random.default_rng(seed)
    free = systems.random_free(rng, 6)
    free[:, seed % 6] = True
    system = systems.random_system(rng, 6, free=free)
    names = tuple(str(name) for name in rng.permutation(list(SEQUENCES))[:6])
    return systems.from_values(replace(system.values(), sequence=names)) if seed % 2 else system


def screw(axis: Floats, anchor: Floats, value: float, turns: bool) -> Placement:
    """Return the placement to which a hinge at `anchor`, or a slide, moves a frame."""
    if not turns:
        return Placement(np.eye(3), value * axis)
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation = np.eye(3) + np.sin(value) * cross + (1 - np.cos(value)) * cross @ cross
    return Placement(rotation, anchor - rotation @ anchor)


def moments(system: kg.System, x: Floats) -> tuple[float, Floats, Floats]:
    """Return mass, first moment sum m r, and sum of I + m r r of a system, by the reference."""
    arrays = system.values()
    first, second = np.zeros(3), np.zeros((3, 3))
    for k, body in enumerate(kinematics(arrays, x, np.zeros_like(x))):
        turn = body.rotation.T
        centre = turn @ body.center_position
        first += arrays.mass[k] * centre
        second += turn @ arrays.inertia[k] @ turn.T + arrays.mass[k] * np.outer(centre, centre)
    return float(arrays.mass.sum()), first, second


def carried(mass: float, centre: Floats, inertia: Floats, at: Placement) -> tuple[float, Floats, Floats]:
    """Return mass, first moment and I + m r r of one body at a placement."""
    point = at.position + at.rotation @ centre
    turned = at.rotation @ inertia @ at.rotation.T
    return mass, mass * point, turned + mass * np.outer(point, point)


def total(parts: list[tuple[float, Floats, Floats]]) -> tuple[float, Floats, Floats]:
    return (
        sum(part[0] for part in parts),
        np.sum([part[1] for part in parts], axis=0),
        np.sum([part[2] for part in parts], axis=0),
    )


def assert_same(got: tuple[float, Floats, Floats], expected: tuple[float, Floats, Floats]) -> None:
    for ours, theirs in zip(got, expected, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("seed", SEEDS)
def test_joints_carry_every_body_where_the_reference_has_it(seed: int) -> None:
    system = tree(seed)
    x = np.random.default_rng(seed).uniform(-1, 1, len(system.freedoms))
    places = [Placement(np.eye(3), np.zeros(3))]
    parts = []
    for joint in single_joints(system):
        index, axis = KINDS.index(joint.kind), np.eye(3)[KINDS.index(joint.kind) % 3]
        moved = screw(axis, np.zeros(3), x[joint.columns[0]], index < 3)
        places.append(places[joint.parent] * joint.placement * moved)
        parts.append(carried(joint.body.mass, joint.body.center, joint.body.central_inertia, places[-1]))
    assert_same(total(parts), moments(system, x))


def numbers(element: xml.Element, name: str) -> Floats:
    return np.array([float(word) for word in element.attrib[name].split()])


def mujoco_parts(element: xml.Element, at: Placement, x: Floats) -> list[tuple[float, Floats, Floats]]:
    """Read bodies, joints and inertias as MuJoCo's documentation defines them, at the state x."""
    parts = []
    for body in element.findall("body"):
        first, second = numbers(body, "xyaxes").reshape(2, 3)
        place = at * Placement(
            np.stack([first, second, np.cross(first, second)], axis=1), numbers(body, "pos")
        )
        for joint in body.findall("joint"):
            value, turns = x[int(joint.attrib["name"])], joint.attrib["type"] == "hinge"
            place = place * screw(numbers(joint, "axis"), numbers(joint, "pos"), value, turns)
        (inertial,) = body.findall("inertial")
        a, b, c, d, e, f = numbers(inertial, "fullinertia")
        inertia = np.array([[a, d, e], [d, b, f], [e, f, c]])
        parts.append(carried(float(inertial.attrib["mass"]), numbers(inertial, "pos"), inertia, place))
        parts += mujoco_parts(body, place, x)
    return parts


@pytest.mark.parametrize("seed", SEEDS)
def test_the_xml_carries_every_body_where_the_reference_has_it(seed: int) -> None:
    system = tree(seed)
    x = np.random.default_rng(seed).uniform(-1, 1, len(system.freedoms))
    (world,) = xml.fromstring(mjcf(system)).findall("worldbody")
    parts = mujoco_parts(world, Placement(np.eye(3), np.zeros(3)), x)
    assert_same(total(parts), moments(system, x))
    assert sorted(int(joint.attrib["name"]) for joint in world.iter("joint")) == list(range(len(x)))


def test_joints_without_bodies_between_them_share_a_body() -> None:
    six = systems.chain(2, ["theta1", "theta2", "theta3", "s1", "s2", "s3"])
    found = links(single_joints(six))
    assert [link.parent for link in found] == [0, 1]
    assert [[joint.kind for joint in link.joints] for link in found] == [
        ["PX", "PY", "PZ", "RX", "RY", "RZ"]
    ] * 2


def test_free_flyers_have_the_angles_of_the_notes() -> None:
    """A free-flyer needs angles 1-2-3; another sequence becomes six joints."""
    one, two = systems.chain(2, systems.FREEDOMS).bodies
    turned = replace(two, joint=replace(two.joint, sequence="3-1-3"))
    found = floating_joints(kg.System("two", (one, turned)))
    assert [joint.kind for joint in found] == ["free-flyer", "PX", "PY", "PZ", "RZ", "RX", "RZ"]


def test_a_fork_without_mass() -> None:
    masses = [1.0, 0.0, 1.0, 1.0]
    fork = kg.System.from_arrays(
        connection=[0, 1, 2, 2],
        mass=masses,
        inertia=[mass * np.eye(3) for mass in masses],
        mass_center=np.zeros((4, 3)),
        joint_position=np.ones((4, 3)),
        free=systems.flags(4, ["theta1"]),
    )
    with pytest.raises(MissingError, match="MuJoCo takes no moving body without mass"):
        mjcf(fork)
