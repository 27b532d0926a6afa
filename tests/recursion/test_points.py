"""Points of the bodies: positions, velocities, accelerations and partial velocities."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.program.count import count
from kanegen.reference.freedoms import free_columns
from kanegen.reference.kinematics import kinematics
from kanegen.reference.matrices import skew
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.orientation_trees import ANGULAR_VELOCITY, KINDS, close, mixed, tree_of_kind, values
from tests.support.paths import MODELS

POINTS = ("point_positions", "point_velocities", "point_accelerations", "point_jacobians")


def pointed(system: kg.System, seed: int, each: int) -> kg.System:
    """Return the system with `each` points on every body but the last."""
    rng = np.random.default_rng(seed)
    bodies = range(1, max(2, system.number_of_bodies))
    return system.with_points({f"p{k}-{i}": (k, rng.normal(size=3)) for k in bodies for i in range(each)})


def state(system: kg.System, seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    found = {name: rng.normal(size=len(system.freedoms)) for name in ("y", "ydot")}
    return found | {"x": rng.uniform(-1, 1, len(system.coordinates))}


def expected(system: kg.System, given: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the outputs by the reference, with the point in the place of the mass centre."""
    arrays = system.values()
    free = free_columns(arrays)
    bodies = kinematics(arrays, given["x"], given["y"])
    found: dict[str, list[np.ndarray]] = {name: [] for name in POINTS}
    for k, point in system.points:
        body, arm = bodies[k - 1], skew(np.array(point.position))
        back, below = body.rotation.T, body.relative_rotation
        below_dot = skew(body.relative_omega).T @ below
        v_y = (below @ body.origin_y - arm @ body.omega_y)[:, free]
        v_y_dot = (below @ body.origin_y_dot + below_dot @ body.origin_y - arm @ body.omega_y_dot)[:, free]
        velocity = v_y @ given["y"]
        acceleration = v_y @ given["ydot"] + v_y_dot @ given["y"] + np.cross(body.omega, velocity)
        found["point_positions"].append(back @ (body.position + point.position))
        found["point_velocities"].append(back @ velocity)
        found["point_accelerations"].append(back @ acceleration)
        found["point_jacobians"].append(back @ v_y)
    return {name: np.array(rows) for name, rows in found.items()}


@pytest.mark.parametrize("each", slow_except((1, 4), 4))
@pytest.mark.parametrize("kind", slow_except(KINDS, *KINDS[::2]))
def test_the_equations_of_the_notes(kind: str, each: int) -> None:
    """One point a body is turned joint by joint, four are turned by the rotation of the body."""
    for seed in range(3):
        system = pointed(tree_of_kind(kind, seed), seed, each)
        given = state(system, seed)
        right = expected(system, given)
        together = values(system, given, *POINTS)
        for name in POINTS:
            close(values(system, given, name)[name], right[name])
            close(together[name], right[name])


def test_compiled_code() -> None:
    system = pointed(mixed(2).with_speeds(ANGULAR_VELOCITY), 2, 2)
    library = kg.build(system, (*POINTS, "inverse_dynamics"))
    given = state(system, 4)
    right = expected(system, given)
    x, y, ydot = given["x"], given["y"], given["ydot"]
    assert library.point_names == system.point_names
    close(library.point_positions(x), right["point_positions"])
    close(library.point_velocities(x, y), right["point_velocities"])
    close(library.point_accelerations(x, y, ydot), right["point_accelerations"])
    jacobians = library.point_jacobians(np.stack([x, x]))
    assert jacobians.shape == (2, len(system.points), 3, library.n)
    close(jacobians[1], right["point_jacobians"])
    close(library.point_jacobians(x) @ y, library.point_velocities(x, y))


def test_a_point_costs_what_its_own_branch_costs() -> None:
    """A point on the first body takes three turns of six operations; other outputs change nothing."""
    near = systems.eight_body(loads=False).with_points({"near": ("body1", (0.1, 0.2, 0.3))})
    (alone,) = compile_module(near, ("point_positions",)).module.functions.values()
    assert count(alone)["add"] + count(alone)["multiply"] <= 3 * 6 + 3
    assert count(alone)["sincos"] == 6
    three = compile_module(near, ("point_positions", "mass_matrix", "forcing")).module.functions
    assert count(three["point_positions"]) == count(alone)


def test_gravity_is_no_acceleration() -> None:
    """A body at rest does not accelerate, whatever gravity is."""
    system = pointed(mixed(1), 1, 1)
    still = np.zeros(len(system.freedoms))
    found = values(system, {"x": state(system, 3)["x"], "y": still, "ydot": still}, "point_accelerations")
    assert not found["point_accelerations"].any()


def test_a_file_keeps_points(tmp_path: Path) -> None:
    length = kg.Parameter("reach", 0.4)
    system = kg.load(MODELS / "double_pendulum.toml")
    last = system.bodies[-1].name
    system = system.with_points({"tip": (last, (0.0, 0.0, length)), "elbow": (1, (0.1, 0, 0))})
    assert system.point_names == ("elbow", "tip")
    system.save(tmp_path / "pendulum.toml")
    assert kg.load(tmp_path / "pendulum.toml") == system
    library = kg.build(system, ("point_positions",))
    longer = library.with_parameters({"reach": 0.5})
    x = np.array([0.3, -0.4])
    moved = longer.point_positions(x) - library.point_positions(x)
    assert np.linalg.norm(moved[1]) == pytest.approx(0.1)
    assert not moved[0].any()
    header = library.source.files["double_pendulum.h"]
    assert "DOUBLE_PENDULUM_POINTS" in header
    assert f"1  tip  {last}" in header


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ({"tip": ("forearm", (0, 0, 1))}, r"point 'tip': there is no body or frame 'forearm'"),
        ({"tip": (9, (0, 0, 1))}, r"there is no body or frame 9"),
        ({"tip": (1, (0, 0))}, r"point 'tip'"),
        ({"tip": (1, (0, 0, float("nan")))}, r"point 'tip'"),
        ({"a\nb": (1, (0, 0, 1))}, r"point name"),
    ],
)
def test_invalid_points_are_refused(points: dict[str, tuple[str | int, object]], message: str) -> None:
    with pytest.raises(kg.ModelError, match=message):
        kg.load(MODELS / "double_pendulum.toml").with_points(points)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("points = 3", r"points: write a table such as"),
        ("points = {tip = [0, 0]}", r"point 'tip'"),
        ("points = {tip = 'far'}", r"point 'tip'"),
        ('points = {"a\\nb" = [0, 0, 1]}', r"point name"),
    ],
)
def test_invalid_points_of_a_file_are_refused(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "model.toml"
    file.write_text(f"[[body]]\nconnection = 0\nmass = 1.0\ninertia = [1, 1, 1]\n{text}\n")
    with pytest.raises(kg.ReadError, match=message):
        kg.load(file)


def test_names_are_unique_and_points_are_there() -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    with pytest.raises(kg.OptionError, match=r"'point_positions': system 'double_pendulum' has no points"):
        kg.generate(system, ("point_positions",))
    once = system.with_points({"tip": (1, (0, 0, 1))})
    with pytest.raises(kg.ModelError, match="point name"):
        once.with_points({"tip": (2, (0, 0, 1))})
