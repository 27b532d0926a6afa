"""TOML model files: the meaning of every key, and saving without loss."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kanegen.errors import KanegenWarning, WriteError
from kanegen.model.body import Body
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.joint import Joint
from kanegen.model.numbers import Parameter
from kanegen.model.system import System
from kanegen.readers import load
from kanegen.reference import equations as reference
from tests.support.paths import MODEL_FILES, MODELS
from tests.support.systems import random_inertia, random_rotation
from tests.support.toml_models import ONE_BODY, read_toml


def test_every_key(tmp_path: Path) -> None:
    m = Parameter("m", 2.0)
    system = read_toml(
        tmp_path,
        """
        name = "arm"
        gravity = [1, 2.5, -3]
        parameters = {m = 2, tilt = 0.25}
        [[body]]
        connection = "ground"
        mass = "m"
        mass_center = [0.1, "m", 0.3]
        inertia = {xx = 3, yy = "m", zz = 4, yz = 0.5}
        [body.joint]
        position = [1, 2, 3]
        orientation = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
        free = ["s1", "theta2"]
        locked = {theta1 = 0.5, s3 = "m"}
        [[body]]
        name = "hand"
        connection = "body1"
        mass = 0
        loads = true
        joint.name = "wrist"
        joint.orientation_angles = [0, "tilt", 1]
        joint.free = ["theta3"]
        [[body]]
        connection = 1
        mass = 1.5
        joint.free = "none"
        """,
    )
    first = Joint(
        position=(1, 2, 3),
        orientation=((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
        free=(False, True, False, True, False, False),
        locked=(0.5, 0, 0, 0, 0, m),
    )
    second = Joint(
        orientation=(0, Parameter("tilt", 0.25), 1),
        free=(False, False, True, False, False, False),
        name="wrist",
    )
    zero = ((0, 0, 0),) * 3
    bodies = (
        Body("body1", 0, m, ((3, 0, 0), (0, m, 0.5), (0, 0.5, 4)), (0.1, m, 0.3), first),
        Body("hand", 1, 0, zero, joint=second, loads=True),
        Body("body3", 1, 1.5, zero, joint=Joint(free=(False,) * 6)),
    )
    assert system == System("arm", bodies, (1, 2.5, -3))


def test_defaults(tmp_path: Path) -> None:
    assert read_toml(tmp_path, "[[body]]\nconnection = 0\nmass = 1\n") == System(
        "model", (Body("body1", 0, 1.0, ((0, 0, 0),) * 3),), (0, 0, -9.81)
    )


@pytest.mark.parametrize("form", ["[3, 4, 5]", "{xx=3,yy=4,zz=5}", "[[3,0,0],[0,4,0],[0,0,5]]"])
def test_three_ways_to_write_an_inertia(tmp_path: Path, form: str) -> None:
    assert read_toml(tmp_path, f"{ONE_BODY}inertia = {form}\n").bodies[0].inertia == (
        (3, 0, 0),
        (0, 4, 0),
        (0, 0, 5),
    )


def test_right_angles_are_exact(tmp_path: Path) -> None:
    almost = math.pi / 2
    for _ in range(4):
        almost = math.nextafter(almost, 2)
    angles = f"[{math.pi / 2!r}, {-math.pi!r}, {almost!r}]"
    c = read_toml(tmp_path, f"{ONE_BODY}joint.orientation_angles = {angles}\n").bodies[0].joint.orientation
    assert c == ((0, 0, 1), (1, 0, 0), (0, 1, 0))
    off = math.nextafter(almost, 2)
    c = (
        read_toml(tmp_path, f"{ONE_BODY}joint.orientation_angles = [0, 0, {off!r}]\n")
        .bodies[0]
        .joint.orientation
    )
    assert c == ((math.cos(off), math.sin(off), 0), (-math.sin(off), math.cos(off), 0), (0, 0, 1))


def test_outputs_are_about_bodies_and_directions(tmp_path: Path) -> None:
    """Selected bodies, by name or number, and directions keep the order of the file."""
    outputs = '[outputs]\nbody_poses = ["c", 1]\nreaction_loads = ["c.s1", "c.theta2"]\n'
    other = ONE_BODY.replace('"b"', '"c"') + 'joint.free = ["theta3"]\n'
    system = read_toml(tmp_path, outputs + ONE_BODY + other)
    assert system.poses == ("c", "b")
    assert system.reactions == system.reaction_names == ("c.s1", "c.theta2")
    plain = read_toml(tmp_path, ONE_BODY + other)
    assert (plain.poses, plain.reactions) == (None, None)
    assert plain.reaction_names == ("c.theta1", "c.theta2", "c.s1", "c.s2", "c.s3")


def test_angles_follow_equation_4(tmp_path: Path) -> None:
    a, b, c = 0.3, -0.7, 1.1
    system = read_toml(tmp_path, f"{ONE_BODY}joint.orientation_angles = [{a}, {b}, {c}]\n")
    one = np.array([[1, 0, 0], [0, np.cos(a), np.sin(a)], [0, -np.sin(a), np.cos(a)]])
    two = np.array([[np.cos(b), 0, -np.sin(b)], [0, 1, 0], [np.sin(b), 0, np.cos(b)]])
    three = np.array([[np.cos(c), np.sin(c), 0], [-np.sin(c), np.cos(c), 0], [0, 0, 1]])
    np.testing.assert_allclose(np.array(system.bodies[0].joint.orientation), three @ two @ one, atol=1e-15)


def test_byte_order_mark_and_crlf(tmp_path: Path) -> None:
    file = tmp_path / "m.TOML"
    file.write_bytes(b"\xef\xbb\xbf" + ONE_BODY.replace("\n", "\r\n").encode())
    assert load(file).bodies[0].name == "b"


def test_unused_parameters(tmp_path: Path) -> None:
    with pytest.warns(KanegenWarning, match=r"model\.toml: unused parameters: k, c\."):
        read_toml(tmp_path, "parameters = {k = 1, m = 1, c = 2}\n" + ONE_BODY.replace("= 1", "= 'm'"))


@st.composite
def any_system(draw: st.DrawFn) -> System:
    """Draw a system with numbers of every magnitude, parameters and unusual names."""
    floats = st.floats(allow_nan=False, allow_infinity=False)
    pool = [Parameter(f"p{i}", draw(floats)) for i in range(3)]
    heavy = Parameter("m", draw(st.floats(0, 1e300)))
    number = floats | st.sampled_from(pool)
    vector = st.tuples(number, number, number)
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    rotation = st.builds(lambda: tuple(map(tuple, random_rotation(rng))))
    moments = st.tuples(*[st.sampled_from([1.5, 2.0, Parameter("I", 1.75)])] * 3)
    diagonal = moments.map(lambda m: ((m[0], 0, 0), (0, m[1], 0), (0, 0, m[2])))
    inertia = diagonal | st.builds(lambda: tuple(map(tuple, random_inertia(rng))))
    label = st.from_regex(r"[A-Za-z0-9_]([A-Za-z0-9_:.-]?[A-Za-z0-9_]){0,4}", fullmatch=True)
    bodies = []
    for k in range(1, draw(st.integers(1, 5)) + 1):
        joint = Joint(
            position=draw(vector),
            orientation=draw(st.just(Joint().orientation) | rotation | vector),
            free=(k == 1, *draw(st.tuples(*[st.booleans()] * 5))),
            locked=draw(st.tuples(*[number] * 6)),
            name=draw(st.just("") | label.map(lambda name, k=k: f"{name}.joint{k}")),
        )
        name = draw(st.just("ground") if k == 2 else label.map(lambda name, k=k: f"{name}:{k}"))
        mass = draw(st.floats(0, 1e300) | st.just(heavy))
        lower, loads = draw(st.integers(0, k - 1)), draw(st.booleans())
        bodies.append(Body(name, lower, mass, draw(inertia), draw(vector), joint, loads))
    return System(draw(st.sampled_from(["tree", "A_2"])), tuple(bodies), draw(vector))


@settings(max_examples=40)
@given(system=any_system())
def test_saving_and_loading_gives_an_equal_system(
    system: System, tmp_path_factory: pytest.TempPathFactory
) -> None:
    file = tmp_path_factory.mktemp("saved") / "model.toml"
    system.save(file)
    assert load(file) == system
    assert os.listdir(file.parent) == ["model.toml"]


@pytest.mark.parametrize("place", [(0, 1), (0, 2), (1, 2)])
def test_a_single_product_of_inertia_is_saved(place: tuple[int, int], tmp_path: Path) -> None:
    inertia = np.diag([2.0, 3.0, 4.0])
    inertia[place] = inertia[place[::-1]] = 0.5
    system = System("one", (Body("body", 0, 1.0, inertia),))
    system.save(tmp_path / "one.toml")
    assert load(tmp_path / "one.toml") == system


def test_a_file_that_cannot_be_saved(tmp_path: Path) -> None:
    system = load(MODEL_FILES[0])
    with pytest.raises(WriteError, match=r"arm\.urdf: a model file ends in \.toml"):
        system.save(tmp_path / "arm.urdf")
    with pytest.raises(WriteError, match=r"cannot be written: No such file or directory"):
        system.save(tmp_path / "nowhere" / "arm.toml")
    taken = tmp_path / "taken.toml"
    taken.mkdir()
    with pytest.raises(WriteError, match=r"taken\.toml: cannot be written: Is a directory"):
        system.save(taken)
    assert os.listdir(tmp_path) == ["taken.toml"]


@pytest.mark.parametrize("path", MODEL_FILES, ids=lambda path: path.stem)
def test_models_are_regular(path: Path) -> None:
    system = load(path)
    assert system.name == path.stem
    x = np.random.default_rng(7).uniform(-1, 1, (20, len(system.coordinates)))
    motion = np.ones((3, len(system.prescribed)))
    assert np.linalg.eigvalsh(reference.mass_matrix(system, x, motion)).min() > 0


def test_models_are_the_textbook_ones() -> None:
    folder = MODELS
    pendulum = load(folder / "double_pendulum.toml")
    q1, q2 = 0.4, -0.9
    m1, m2, l1, l2, g = 1.0, 0.5, 1.0, 0.7, 9.81
    near, far = m2 * l1 * l2 * np.cos(q2), m2 * l2**2
    expected = [[(m1 + m2) * l1**2 + far + 2 * near, far + near], [far + near, far]]
    np.testing.assert_allclose(reference.mass_matrix(pendulum, [q1, q2]), expected, rtol=1e-14)
    lower = -m2 * g * l2 * np.sin(q1 + q2)
    weight = [-(m1 + m2) * g * l1 * np.sin(q1) + lower, lower]
    np.testing.assert_allclose(reference.forcing(pendulum, [q1, q2], [0, 0]), weight, rtol=1e-14)
    cart = load(folder / "cart_pole.toml")
    mixed = 0.1 * 0.5 * np.cos(q1)
    expected = [[0.1 / 3, mixed], [mixed, 1.1]]
    np.testing.assert_allclose(reference.mass_matrix(cart, [q1, 2.0]), expected, rtol=1e-14)
    eight = load(folder / "eight_body.toml")
    assert eight.connection == (0, 1, 2, 2, 1, 1, 1, 7)
    assert len(eight.freedoms) == 8 * len(FREEDOMS)
    assert all(body.loads for body in eight.bodies)
