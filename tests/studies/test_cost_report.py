"""Cost reports of scenes; and specialised programs compute the same as the general program of their tree."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import kanegen as kg
from kanegen.cli.app import app
from kanegen.compiler import compile_module
from kanegen.model.arrays import SystemArrays
from kanegen.model.coordinates import Coordinate, Freedom
from kanegen.program.count import count
from kanegen.reference.kinematics import kinematics
from kanegen.reference.matrices import skew
from kanegen.reference.states import random_states
from kanegen.studies.explain import cost_report
from kanegen.studies.explain.general_form import steps
from kanegen.studies.explain.page import drawing, html
from tests.support import systems
from tests.support.acting import acted_on
from tests.support.cases import slow_except
from tests.support.general_programs import compiled, require_equal
from tests.support.paths import MODEL_FILES, MODELS
from tests.support.robots import FIXED_ROBOTS, FLOATING_ROBOTS, robot_file

LARGE = ("panda_arm", "front_of_eight", "eight_body", "six_revolute_arm")


@pytest.mark.parametrize(
    "model", [pytest.param(m, id=m.stem, marks=[pytest.mark.slow] * (m.stem in LARGE)) for m in MODEL_FILES]
)
def test_models_agree_with_their_general_programs(model: Path) -> None:
    require_equal(kg.load(model), 0, 1, 2)


QUICK = ("ur5_robot", "double_pendulum")


@pytest.mark.parametrize(
    "robot",
    [
        pytest.param(name, marks=() if name in QUICK else pytest.mark.slow)
        for name in (*QUICK, *sorted({*FIXED_ROBOTS, *FLOATING_ROBOTS} - set(QUICK)))
    ],
)
@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_robots_agree_with_their_general_programs(robot: str) -> None:
    require_equal(kg.load(robot_file(robot), floating_base=robot in FLOATING_ROBOTS), 1)


@pytest.mark.parametrize("seed", slow_except(range(8), 1, 2, 3))
def test_random_scenes_agree_with_their_general_programs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    require_equal(systems.random_system(rng, int(rng.integers(1, 5))), seed)


@pytest.mark.parametrize("seed", slow_except(range(4), 0, 1))
def test_scenes_with_prescribed_freedoms_agree_with_their_general_programs(seed: int) -> None:
    """Freedoms that the scene prescribes are prescribed in the general program, too."""
    rng = np.random.default_rng([2, seed])
    system = systems.random_system(rng, 3, free=systems.flags(3, ["theta1", "theta3", "s2"]))
    system = system.with_prescribed(rng.choice(system.freedom_names, 4, replace=False).tolist())
    (_, general), *_ = steps(system)
    assert len(general.freedoms) == 14
    require_equal(system, seed)


@pytest.mark.slow
def test_two_hundred_scenes_agree_with_their_general_programs() -> None:
    """Every third scene has force elements, every fifth prescribed freedoms."""
    for seed in range(200):
        rng = np.random.default_rng([1, seed])
        scene = systems.random_system(rng, int(rng.integers(1, 6)), orientations=bool(seed % 4))
        scene = scene if seed % 3 else acted_on(scene, seed)
        prescribed = scene.freedom_names[: (len(scene.freedoms) - 1) // 2]
        require_equal(scene if seed % 5 else scene.with_prescribed(prescribed), seed)


def test_a_locked_joint_keeps_its_value() -> None:
    """The coordinates of the general program are those of the scene and the locked values."""
    system = systems.random_system(np.random.default_rng(5), 3)
    (_, general), *_, (_, last) = steps(system)
    assert last == system
    assert len(general.freedoms) == 18
    assert set(system.freedoms) <= {Freedom(c.body, c.index) for c in general.coordinates}
    assert Coordinate(1, 0) in general.coordinate_places
    assert all(body.loads for body in general.bodies)
    assert not any(isinstance(body.mass, float) for body in general.bodies)


def test_operations_fall_and_add_up() -> None:
    found = cost_report(kg.load(MODELS / "gantry_crane.toml"), ("mass_matrix", "forcing"))
    totals = [step.total for step in found.steps]
    assert totals == sorted(totals, reverse=True)
    assert sum(found.bodies.values()) == totals[-1]
    assert found.ratio == totals[0] / totals[-1] > 20
    assert [step.without for step in found.steps] == [
        "nothing",
        "locked freedoms",
        "loads",
        "run-time numbers",
    ]
    assert found.alone.keys() == {"mass_matrix", "forcing"}
    alone = compile_module(found.system, ("forcing",)).module.functions["forcing"]
    assert found.alone["forcing"] == sum(count(alone).values())
    assert json.loads(json.dumps(found.as_dict()))["steps"][0]["operations"] == found.steps[0].operations


def test_two_rods_locked_to_a_plane() -> None:
    """[A] and {f} of the textbook pendulum come from bodies that are locked to a plane."""
    pendulum = kg.load(MODELS / "planar_pendulum.toml")
    assert cost_report(pendulum).steps[-1].total <= 30
    x, y = np.random.default_rng(2).uniform(-1, 1, (2, 2))
    a, f = compiled(pendulum)({"x": x, "y": y})
    m1, m2, r1, r2, long, i1, i2, g = 1.2, 0.8, 0.3, 0.25, 0.6, 0.04, 0.02, 9.81
    far, both = i2 + m2 * r2**2, m2 * long * r2 * np.cos(x[1])
    near = i1 + m1 * r1**2 + m2 * long**2 + far + 2 * both
    swing = m2 * long * r2 * np.sin(x[1])
    weight = m2 * g * r2 * np.sin(x[0] + x[1])
    np.testing.assert_allclose(a, [[near, far + both], [far + both, far]], rtol=1e-14)
    first = swing * (2 * y[0] * y[1] + y[1] ** 2) - (m1 * r1 + m2 * long) * g * np.sin(x[0]) - weight
    np.testing.assert_allclose(f, [first, -swing * y[0] ** 2 - weight], rtol=1e-13)


def remade(arrays: SystemArrays, **changed: object) -> kg.System:
    kept = arrays.rows()
    return kg.System.from_arrays(**(kept | changed))


def lumped(system: kg.System, moving: int) -> kg.System:
    """Return the first bodies alone, each with the mass and inertia of the bodies welded to it."""
    arrays = system.values()
    n = len(system.freedoms)
    bodies = kinematics(arrays, np.zeros(n), np.zeros(n))
    carrier = list(range(moving))
    for lower in arrays.connection[moving:]:
        carrier.append(carrier[lower - 1])
    masses, centers, inertias = [], [], []
    for k in range(moving):
        own = [m for m, carrying in enumerate(carrier) if carrying == k]
        turns = [bodies[m].rotation @ bodies[k].rotation.T for m in own]
        # {p'_G} is resolved in its own body.
        points = [
            turn.T @ bodies[m].center_position - bodies[k].position
            for m, turn in zip(own, turns, strict=True)
        ]
        mass = arrays.mass[own].sum()
        center = sum(arrays.mass[m] * point for m, point in zip(own, points, strict=True)) / mass
        inertia = np.zeros((3, 3))
        for m, turn, point in zip(own, turns, points, strict=True):
            arm = skew(point - center)
            inertia += turn.T @ arrays.inertia[m] @ turn - arrays.mass[m] * arm @ arm
        masses.append(mass)
        centers.append(center)
        inertias.append((inertia + inertia.T) / 2)
    first = {
        name: values[:moving]
        for name, values in arrays.rows().items()
        if name not in {"gravity", "mass", "mass_center", "inertia"}
    }
    return kg.System.from_arrays(
        **first, gravity=arrays.gravity, mass=masses, mass_center=centers, inertia=inertias
    )


@pytest.mark.slow
def test_welded_bodies_cost_as_much_as_lumped_ones() -> None:
    """Bodies 4 to 8 welded to three bodies give the equations of three bodies with their masses."""
    eight = systems.eight_body(loads=False).values()
    free = eight.free.copy()
    free[3:] = False
    rng = np.random.default_rng(8)
    welded = remade(eight, free=free, locked=rng.uniform(-1, 1, (8, 6)) * ~free)
    direct = lumped(welded, 3)
    found = cost_report(welded)
    assert all(found.bodies.get(k, 0) == 0 for k in range(4, 9))
    assert found.steps[-1].total <= 1.1 * cost_report(direct).steps[-1].total
    sample = random_states(direct, 2)
    given = {"x": sample.x[0], "y": sample.y[0]}
    for one, other in zip(compiled(welded)(given), compiled(direct)(given), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())


def test_the_page_draws_every_body(tmp_path: Path) -> None:
    system = systems.random_system(
        np.random.default_rng(8),
        8,
        connection=systems.EIGHT_BODY_CONNECTION,
        free=systems.flags(8, ["theta2"]),
    )
    found = cost_report(system, ("mass_matrix",))
    places = [(box.x, box.y) for box in drawing(found).boxes]
    assert len(set(places)) == 8
    assert len(drawing(found).lines) == 7
    texts: list[str] = []

    class Reader(HTMLParser):
        def handle_data(self, data: str) -> None:
            texts.append(data.strip())

    page = html(found)
    Reader().feed(page)
    assert {f"body{k}" for k in range(1, 9)} <= set(texts)
    assert "http" not in page


def test_the_command(tmp_path: Path) -> None:
    model, run = str(MODEL_FILES[0]), CliRunner()
    shown = run.invoke(app, ["explain", model, "--html", str(tmp_path / "page.html")])
    assert shown.exit_code == 0
    assert "run-time numbers" in shown.output
    assert (tmp_path / "page.html").read_text().startswith("<!DOCTYPE html>")
    data = json.loads(run.invoke(app, ["explain", model, "--json", "--compile"]).output)
    assert data["steps"][0]["seconds"] > 0
    assert data["steps"][1]["seconds"] is None
