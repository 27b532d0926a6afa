"""Cost reports of scenes; and specialised programs compute the same as the general program of their tree."""

from __future__ import annotations

import json
from collections.abc import Callable
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
from kanegen.model.numbers import map_numbers, value_of
from kanegen.program.count import count
from kanegen.program.evaluate import evaluate
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import (
    element_magnitude,
    forcing_magnitude,
    mass_matrix_magnitude,
    path_maxima,
    rounding_bound,
)
from kanegen.reference.matrices import skew
from kanegen.reference.states import random_states
from kanegen.studies.explain import cost_report
from kanegen.studies.explain.general_form import steps
from kanegen.studies.explain.page import drawing, html
from tests.physics.test_robots import FIXED, FLOATING
from tests.support import systems
from tests.support.acting import acted_on
from tests.support.paths import MODEL_FILES, MODELS
from tests.support.robots import robot_file

Results = tuple[np.ndarray, np.ndarray]


def compiled(system: kg.System) -> Callable[[dict[str, np.ndarray]], Results]:
    """Return [A] and {f} by the program that becomes C."""
    module = compile_module(system, regular=False).module
    function, n = module.functions["evaluate"], len(system.freedoms)
    known = {name: np.zeros(3 * system.number_of_bodies) for name in ("force", "torque")}
    if module.prepare is not None:
        parameters = [parameter.value for parameter in system.parameters]
        known["prepared"] = evaluate(module.prepare, {"parameters": parameters}, np)["prepared"]

    def run(given: dict[str, np.ndarray]) -> Results:
        values = known | {name: np.ravel(value) for name, value in given.items()}
        found = evaluate(function, {array.name: values[array.name] for array in function.inputs}, np)
        return np.array(found["A"], float).reshape(n, n), np.array(found["f"], float)

    return run


def require_equal(system: kg.System, *seeds: int) -> None:
    """Compare both programs at the locked state, up to rounding; loads act on the bodies that take them."""
    (_, general), *_ = steps(system)
    general_results, special_results = compiled(general), compiled(system)
    for seed in seeds:
        sample = random_states(system, 1, seed)
        given = {"x": sample.x[0], "y": sample.y[0]}
        if sample.force is not None and sample.torque is not None:
            given |= {"force": sample.force[0], "torque": sample.torque[0]}
        further = {name: rows[0] for name, rows in sample.inputs.items()}
        given |= further
        free = [general.places[freedom] for freedom in system.freedoms]
        matrix, forcing = general_results(given | at_locked_state(system, general, given))
        expected = matrix[np.ix_(free, free)], forcing[free]
        bounds = limits(system, given, further)
        for value, other, limit in zip(special_results(given), expected, bounds, strict=True):
            assert (np.abs(value - other) <= limit).all()


def at_locked_state(
    system: kg.System, general: kg.System, given: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return the state of the general system in which the freedoms that `system` locks have their locked
    values."""
    x, y = np.zeros(len(general.coordinates)), np.zeros(len(general.freedoms))
    for coordinate, place in general.coordinate_places.items():
        locked = map_numbers(system.bodies[coordinate.body - 1].joint.locked, value_of)
        known = system.coordinate_places.get(coordinate)
        x[place] = locked[coordinate.index] if known is None else given["x"][known]
    y[[general.places[freedom] for freedom in system.freedoms]] = given["y"]
    return {"x": x, "y": y}


def limits(system: kg.System, given: dict[str, np.ndarray], further: dict[str, np.ndarray]) -> Results:
    """Return the largest difference that rounding allows between two programs for [A] and {f}."""
    arrays, prescribed = system.values(), further.get("prescribed", np.zeros((3, 0)))
    bodies = kinematics(arrays, given["x"], given["y"], prescribed)
    maxima = path_maxima(arrays, bodies, given["y"], prescribed)
    share = 2 * rounding_bound(system.number_of_bodies)
    forcing = forcing_magnitude(arrays, maxima, given.get("force"), given.get("torque"))
    forcing = forcing + element_magnitude(arrays, bodies, given["x"], given["y"], **further)
    return share * mass_matrix_magnitude(arrays, maxima), share * forcing


@pytest.mark.parametrize("model", MODEL_FILES, ids=lambda path: path.stem)
def test_models_agree_with_their_general_programs(model: Path) -> None:
    require_equal(kg.load(model), 0, 1, 2)


QUICK = ("ur5_robot", "double_pendulum", "kinova")


@pytest.mark.parametrize(
    "robot",
    [
        pytest.param(name, marks=() if name in QUICK else pytest.mark.slow)
        for name in (*QUICK, *sorted({*FIXED, *FLOATING} - set(QUICK)))
    ],
)
@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_robots_agree_with_their_general_programs(robot: str) -> None:
    require_equal(kg.load(robot_file(robot), floating_base=robot in FLOATING), 1)


@pytest.mark.parametrize("seed", range(8))
def test_random_scenes_agree_with_their_general_programs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    require_equal(systems.random_system(rng, int(rng.integers(1, 5))), seed)


@pytest.mark.parametrize("seed", range(4))
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
    found = cost_report(systems.eight_body(), ("mass_matrix",))
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
