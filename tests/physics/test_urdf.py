"""The dynamics of URDF robots compared with Pinocchio, which shares only the file format with kanegen."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest

from kanegen.errors import ReadError
from kanegen.model.rotations import Triple
from kanegen.model.system import System
from kanegen.readers import load
from kanegen.reference import equations as reference
from tests.support.couplings import rate_matrices, released
from tests.support.paths import EVERY_JOINT
from tests.support.robots import (
    FOLLOWERS_FIRST,
    REFUSED,
    dynamics,
    fixed_model,
    floating_model,
    places,
    robot_files,
)
from tests.support.systems import random_inertia

FLOATING_ONLY = ("quadrotor_base", "iris_simple")


def assert_same_dynamics(system: System, model: pin.Model, several: dict[str, tuple[str, ...]]) -> None:
    """Require equal [A] and {f} of kanegen and Pinocchio at a random state."""
    x, y = np.random.default_rng(4).uniform(-1, 1, (2, len(system.freedoms)))
    a, f = dynamics(model, places(system, model, several), x, y)
    ours = reference.mass_matrix(system, x)
    np.testing.assert_allclose(ours, a, rtol=0, atol=1e-14 * np.abs(a).max())
    ours = reference.forcing(system, x, y)
    np.testing.assert_allclose(ours, f, rtol=0, atol=1e-14 * max(np.abs(f).max(), 1e-3))


def assert_reduced(system: System, model: pin.Model, several: dict[str, tuple[str, ...]]) -> None:
    """Require that couplings reduce [A] and {f} of Pinocchio's independent joints, by [G] of the rates."""
    independent, (free, _, offset) = released(system), rate_matrices(system)
    x, y = np.random.default_rng(4).uniform(-1, 1, (2, len(system.freedoms)))
    order = places(independent, model, several)
    a, f = dynamics(model, order, free @ x + offset, free @ y)
    a, f = free.T @ a @ free, free.T @ f
    np.testing.assert_allclose(reference.mass_matrix(system, x), a, rtol=0, atol=1e-14 * np.abs(a).max())
    np.testing.assert_allclose(reference.forcing(system, x, y), f, rtol=0, atol=1e-14 * np.abs(f).max())


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
@pytest.mark.parametrize(
    "floating_base",
    [False, pytest.param(True, marks=pytest.mark.slow)],
    ids=["fixed", "floating"],
)
@pytest.mark.parametrize("path", robot_files(), ids=lambda path: path.stem)
def test_real_robots(path: Path, floating_base: bool) -> None:
    if path.stem in REFUSED and not (floating_base and path.stem in FLOATING_ONLY):
        with pytest.raises(ReadError, match=REFUSED[path.stem]):
            load(path, floating_base)
        return
    system = load(path, floating_base)
    independent = released(system)
    if floating_base:
        model, several = floating_model(path, independent)
    else:
        model, several = pin.buildModelFromUrdf(str(path)), {}
    assert system.values().mass.sum() == pytest.approx(
        sum(inertia.mass for inertia in list(model.inertias)[1:]), rel=1e-14
    )
    assert_same_dynamics(independent, model, several)
    if system.couplings:
        assert_reduced(system, model, several)
    if system.couplings and path.stem not in FOLLOWERS_FIRST:
        model, several = floating_model(path, system) if floating_base else (fixed_model(path), {})
        assert_same_dynamics(system, model, several)


def test_there_are_real_robots() -> None:
    assert len(robot_files()) > 60


def row(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def random_robot(rng: np.random.Generator, links: int) -> str:
    """Return a random tree of links with all joint types of at most one freedom and all kinds of axes."""
    text = '<robot name="random">'
    for k in range(links):
        tensor = random_inertia(rng)
        names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        pairs = zip(names, tensor[np.triu_indices(3)].tolist(), strict=True)
        inertia = " ".join(f'{name}="{value!r}"' for name, value in pairs)
        mass = 0.0 if k % 4 == 3 else rng.uniform(0.1, 5)
        text += f'''<link name="link{k}"><inertial><mass value="{mass!r}"/><inertia {inertia}/>
            <origin xyz="{row(rng.standard_normal(3))}" rpy="{row(rng.uniform(-4, 4, 3))}"/>
            </inertial></link>'''
    for k in range(1, links):
        kind = rng.choice(["revolute", "continuous", "prismatic", "fixed"])
        along = rng.choice([-2, 1]) * np.eye(3)[k % 3]
        axis = along if rng.random() < 0.5 else rng.standard_normal(3)
        text += f'''<joint name="joint{k}" type="{kind}">
            <parent link="link{rng.integers(k)}"/><child link="link{k}"/><axis xyz="{row(axis)}"/>
            <origin xyz="{row(rng.standard_normal(3))}" rpy="{row(rng.uniform(-4, 4, 3))}"/>
            <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>'''
    return text + "</robot>"


@pytest.mark.parametrize("seed", range(12))
def test_random_robots(seed: int, tmp_path: Path) -> None:
    text = random_robot(np.random.default_rng(seed), 9)
    path = tmp_path / "random.urdf"
    path.write_text(text)
    assert_same_dynamics(load(path), pin.buildModelFromXML(text), {})


def with_chain(
    robot: ElementTree.Element, name: str, motions: Sequence[tuple[str, str, Iterable[float]]]
) -> None:
    """Replace joint `name` by a chain of joints (name, type, axis) through massless links."""
    joint = next(joint for joint in robot.iter("joint") if joint.get("name") == name)
    robot.remove(joint)
    below, above = joint.find("parent").get("link"), joint.find("child").get("link")
    origin = joint.find("origin")
    for i, (motion, kind, axis) in enumerate(motions):
        link = above if i == len(motions) - 1 else f"{name}_{i}"
        if link != above:
            ElementTree.SubElement(robot, "link", name=link)
        step = ElementTree.SubElement(robot, "joint", name=motion, type=kind)
        ElementTree.SubElement(step, "parent", link=below)
        ElementTree.SubElement(step, "child", link=link)
        ElementTree.SubElement(step, "axis", xyz=row(axis))
        ElementTree.SubElement(step, "limit", lower="-9", upper="9", effort="1", velocity="1")
        if i == 0:
            step.append(origin)
        below = link


@pytest.mark.parametrize(
    ("axis", "first", "second", "names"),
    [
        ((0, 0, 1), (1, 0, 0), (0, 1, 0), ("s1", "s2", "theta3")),
        ((1, 0, 0), (0, 1, 0), (0, 0, 1), ("s2", "s3", "theta1")),
        ((0, -1, 0), (0, 0, 1), (-1, 0, 0), ("s3", "s1", "theta2")),
        ((0, 0.6, -0.8), (1, 0, 0), (0, -0.8, -0.6), ("s1", "s2", "theta3")),
    ],
)
def test_planar_and_floating_joints(
    tmp_path: Path, axis: Triple, first: Triple, second: Triple, names: tuple[str, str, str]
) -> None:
    """Every joint type in one robot; Pinocchio gets slides and hinges for the planar and the floating one."""
    text = EVERY_JOINT.read_text().replace('<axis xyz="0 0 1"/>', f'<axis xyz="{row(axis)}"/>')
    path = tmp_path / "rig.urdf"
    path.write_text(text)
    robot = ElementTree.fromstring(text.replace("sensor:camera", "camera"))
    kinds = ("prismatic", "prismatic", "revolute")
    motions = zip([f"plate.{name}" for name in names], kinds, (first, second, axis), strict=True)
    with_chain(robot, "slab", list(motions))
    basis = np.eye(3).tolist()
    shifts = [(f"ball.s{i + 1}", "prismatic", basis[i]) for i in range(3)]
    turns = [(f"ball.theta{i + 1}", "revolute", basis[i]) for i in range(3)]
    with_chain(robot, "free", shifts + turns)
    model = pin.buildModelFromXML(ElementTree.tostring(robot, "unicode"))
    assert_same_dynamics(load(path), model, {})
