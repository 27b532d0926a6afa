"""Derivatives of rates, points, energies, momenta, gravity: against complex steps through the reference."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.recursion.outputs import DERIVATIVES, OUTPUTS
from kanegen.reference.coriolis import gravity_forces
from kanegen.reference.freedoms import free_columns
from kanegen.reference.kinematics import kinematics
from kanegen.reference.matrices import skew
from kanegen.reference.momentum import centroidal_momentum
from tests.support import moving_bodies
from tests.support.cases import slow_except
from tests.support.complex_steps import STEP, rates_of, state
from tests.support.orientation_trees import KINDS, close, tree_of_kind, values
from tests.support.paths import MODELS

NAMES = tuple(name for name in DERIVATIVES if "dynamics" not in name and "forcing" not in name)


def pointed(kind: str, seed: int) -> kg.System:
    """Return a random tree with points on its first and last bodies."""
    rng = np.random.default_rng(seed)
    system = tree_of_kind(kind, seed)
    places = {"inner": 1, "outer": system.number_of_bodies}
    return system.with_points({name: (k, rng.normal(size=3)) for name, k in places.items()})


def of_points(system: kg.System, x: Any, y: Any, ydot: Any) -> dict[str, Any]:
    """Return positions, velocities and accelerations of the points, Eqs. (22), (27), (33)."""
    bodies = kinematics(system.values(), x, y)
    rows: dict[str, list[Any]] = {"positions": [], "velocities": [], "accelerations": []}
    columns = free_columns(system.values())
    for k, point in system.points:
        body, arm = bodies[k - 1], skew(np.array(point.position))
        below = body.relative_rotation
        below_dot = skew(body.relative_omega).T @ below
        v_y = (below @ body.origin_y - arm @ body.omega_y)[:, columns]
        v_y_dot = (below @ body.origin_y_dot + below_dot @ body.origin_y - arm @ body.omega_y_dot)[:, columns]
        velocity = v_y @ y
        rows["positions"].append(body.rotation.T @ (body.position + point.position))
        rows["velocities"].append(body.rotation.T @ velocity)
        rows["accelerations"].append(
            body.rotation.T @ (v_y @ ydot + v_y_dot @ y + np.cross(body.omega, velocity))
        )
    return {f"point_{name}": np.array(found) for name, found in rows.items()}


def quantity(system: kg.System, name: str, given: dict[str, Any]) -> Any:
    """Return the differentiated output by the reference, for real or complex numbers."""
    kind = np.result_type(given["x"], given["y"])
    x, y = given["x"].astype(kind), given["y"].astype(kind)
    if name == "gravity_forces":
        return gravity_forces(system, x)
    if name == "centroidal_momentum_bias":
        return centroidal_momentum(system, x, y).bias
    if name == "coordinate_rates":
        return rates_of(system, x, y)
    if name.startswith("point_"):
        return of_points(system, x, y, given["ydot"])[name]
    return moving_bodies.expected(system.values(), x, y)[name]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", slow_except(KINDS, "slides and hinges", "quaternions"))
@pytest.mark.parametrize("seed", slow_except(range(3), 1))
def test_derivatives_agree_with_complex_steps(seed: int, kind: str, name: str) -> None:
    system = pointed(kind, seed)
    given = state(system, seed)
    columns = []
    for array in DERIVATIVES[name].by:
        for k in range(len(given[array])):
            moved = given[array].astype(complex)
            moved[k] += 1j * STEP
            base = name.removesuffix("_derivatives")
            columns.append(np.asarray(quantity(system, base, given | {array: moved})).imag / STEP)
    close(values(system, given, name)[name], np.stack(columns, axis=-1), 1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_columns_by_parameters(name: str) -> None:
    """Compiled code against central differences of the differentiated output, with a step of 1e-6."""
    system = kg.load(MODELS / "gantry_crane.toml").with_points({"hook": ("load", (0, 0, 1.0))})
    base = name.removesuffix("_derivatives")
    library = kg.build(system, (name, base))
    given = dict(zip(("x", "y", "ydot"), np.random.default_rng(3).uniform(-0.5, 0.5, (3, 5)), strict=True))
    arguments = [given[one] for one in OUTPUTS[name].arguments]
    found = getattr(library, name)(*arguments)
    columns = library.derivative_columns(name)
    assert list(columns) == [*DERIVATIVES[name].by, "parameters"]
    for k, (parameter, value) in enumerate(library.parameters.items()):
        high, low = (
            getattr(library.with_parameters({parameter: value * (1 + sign * 1e-6)}), base)(*arguments)
            for sign in (1, -1)
        )
        close(found[..., columns["parameters"]][..., k], (high - low) / (2e-6 * value), 1e-7)


def test_derivatives_of_rates_are_missing_in_gimbal_lock() -> None:
    body = kg.Body("top", 0, 1.0, np.eye(3), joint=kg.Joint(sequence="3-1-3", speeds="angular_velocity"))
    library = kg.build(kg.System("top", (body,)), ("coordinate_rates_derivatives",))
    with pytest.raises(kg.SingularError, match="the angles have no rates"):
        library.coordinate_rates_derivatives(np.zeros(6), np.zeros(6))
