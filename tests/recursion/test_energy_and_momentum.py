"""Energies, momentum and mass centre: against sums over the bodies, textbooks, and what is conserved."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.coordinates import FREEDOMS, Freedom
from kanegen.model.numbers import Number, value_of
from kanegen.reference import equations as reference
from kanegen.reference.kinematics import kinematics
from tests.support import moving_bodies, systems
from tests.support.cases import slow_except
from tests.support.programs import Arrays, values

ENERGIES = ("kinetic_energy", "potential_energy")
OUTPUTS = (*ENERGIES, "momentum", "mass_center")


def generic(seed: int) -> kg.System:
    """Return a tree; together the seeds have every kind of joint and constant orientations."""
    rng = np.random.default_rng(seed)
    free = [None, systems.flags(5, ["theta3"]), systems.flags(5, ["s2"]), systems.flags(5, FREEDOMS)][
        seed % 4
    ]
    return systems.random_system(rng, 5, free=free, orientations=seed % 3 > 0, locked=seed % 5 > 0)


def speeds(system: kg.System, seed: int) -> tuple[Any, Any]:
    x, y = np.random.default_rng(seed).normal(size=(2, len(system.freedoms)))
    return x, y


@pytest.mark.parametrize("seed", slow_except(range(24), *range(8)))
def test_against_sums_over_the_bodies(seed: int) -> None:
    system = generic(seed)
    x, y = speeds(system, seed)
    found = values(system, OUTPUTS, {"x": x, "y": y})
    expected = moving_bodies.expected(system.values(), x, y)
    size = np.abs(system.values().mass).sum() * (20 + np.abs(x).sum() + np.abs(y).sum() ** 2)
    for name in OUTPUTS:
        assert found[name] == pytest.approx(np.ravel(expected[name]), rel=1e-13, abs=1e-16 * size), name


@pytest.mark.parametrize("seed", range(12))
def test_kinetic_energy_is_half_y_a_y(seed: int) -> None:
    system = generic(seed)
    x, y = speeds(system, seed)
    found = values(system, ("kinetic_energy",), {"x": x, "y": y})["kinetic_energy"]
    assert found[0] == pytest.approx(y @ reference.mass_matrix(system, x) @ y / 2, rel=1e-13)


@pytest.mark.parametrize("seed", slow_except(range(6), 0, 1, 2))
def test_energy_changes_by_the_power_of_what_acts(seed: int) -> None:
    """The rates follow {ydot} of forward dynamics in 50 digits; only folded constants are rounded."""
    system = generic(seed)
    rng = np.random.default_rng(seed)
    x, y = speeds(system, seed)
    takes = np.array([body.loads for body in system.bodies])[:, None]
    tau, force, torque = rng.normal(size=len(x)), *(rng.normal(size=(2, 5, 3)) * takes)
    rates = rate(system, ENERGIES, {"x": x, "y": y, "tau": tau, "force": force, "torque": torque})
    power = tau @ y
    for k, body in enumerate(kinematics(system.values(), x, y)):
        power += force[k] @ body.center_velocity + torque[k] @ body.omega
    parts = [rates[name][0] for name in ENERGIES]
    assert sum(parts) == pytest.approx(power, abs=1e-12 * (np.abs(parts).sum() + abs(power)))


@pytest.mark.parametrize("gravity", [pytest.param((0, 0, 0), marks=pytest.mark.slow), (1, -2, 9)])
def test_momentum_of_a_floating_tree_changes_by_its_weight_alone(gravity: tuple[float, ...]) -> None:
    rng = np.random.default_rng(3)
    free = systems.random_free(rng, 5)
    free[0] = True
    system = systems.random_system(
        rng, 5, connection=(0, 1, 2, 2, 1), free=free, gravity=gravity, loads=False
    )
    x, y = speeds(system, 4)
    rates = rate(system, ("momentum", "mass_center"), {"x": x, "y": y, "tau": 0 * x})
    mass = system.values().mass.sum()
    size = np.abs(values(system, ("momentum",), {"x": x, "y": y})["momentum"]).max()
    assert rates["momentum"] == pytest.approx([*(mass * np.array(gravity)), 0, 0, 0], abs=1e-12 * size)
    assert mass * rates["mass_center"] == pytest.approx(
        values(system, ("momentum",), {"x": x, "y": y})["momentum"][:3], rel=1e-12
    )


def rate(system: kg.System, outputs: tuple[str, ...], inputs: Arrays) -> Arrays:
    """Return the time derivatives of outputs in the motion that follows from the inputs."""
    with mpmath.workdps(50):
        ydot = values(system, ("forward_dynamics",), inputs, mpmath.mpf)["acceleration"]
        x, y = (np.array([mpmath.mpf(v) for v in inputs[name]]) for name in ("x", "y"))
        step = mpmath.mpf(10) ** -16
        after, before = (
            values(system, outputs, {"x": x + h * y, "y": y + h * ydot}, mpmath.mpf) for h in (step, -step)
        )
        return {name: ((after[name] - before[name]) / (2 * step)).astype(float) for name in outputs}


def test_double_pendulum() -> None:
    """Axis 1 points down, both angles are relative; see models/double_pendulum.toml."""
    system = kg.load("models/double_pendulum.toml")
    m1, m2, l1, l2, g = 1.25, 0.5, 0.75, 1.5, 9.75
    library = kg.build(system, OUTPUTS)
    library = library.with_parameters({"m1": m1, "m2": m2, "l1": l1, "l2": l2, "g": g})
    x, y = np.array([0.3, -0.8]), np.array([1.1, 0.6])
    (a, b), u, v = (x[0], x.sum()), y[0], y.sum()
    kinetic = (m1 + m2) * l1**2 * u**2 / 2 + m2 * l2**2 * v**2 / 2 + m2 * l1 * l2 * u * v * np.cos(a - b)
    potential = -(m1 + m2) * g * l1 * np.cos(a) - m2 * g * l2 * np.cos(b)
    first, second = (np.array([np.cos(angle), np.sin(angle), 0]) for angle in (a, b))
    turned = [np.array([-d[1], d[0], 0]) for d in (first, second)]
    apart, approach = l2 * second, l2 * v * turned[1]  # of two point masses only their separation matters
    center = l1 * first + m2 / (m1 + m2) * apart
    linear = m1 * l1 * u * turned[0] + m2 * (l1 * u * turned[0] + approach)
    found = library.evaluate(x, y)
    assert found.kinetic_energy == pytest.approx(kinetic, rel=1e-14)
    assert found.potential_energy == pytest.approx(potential, rel=1e-14)
    assert found.mass_center == pytest.approx(center, rel=1e-14)
    angular = m1 * m2 / (m1 + m2) * np.cross(apart, approach)
    assert found.momentum == pytest.approx([*linear, *angular], rel=1e-13, abs=1e-15)


def free_body(mass: float, inertia: list[float], **more: Any) -> kg.System:
    return kg.System.from_arrays((0,), [mass], [np.diag(inertia)], np.zeros((1, 3)), np.zeros((1, 3)), **more)


def test_a_free_body() -> None:
    """At zero angles the rates are the angular velocity, also about another origin than the mass centre."""
    system = replace(free_body(2.0, [3.0, 4.0, 5.0], gravity=(0, 0, -10)), name="body")
    y = np.array([0.5, -1, 2, 7, 8, 9])
    found = values(system, OUTPUTS, {"x": [0, 0, 0, 1, 2, 3], "y": y})
    assert found["kinetic_energy"] == [(3 / 4 + 4 + 20) / 2 + 49 + 64 + 81]
    assert found["potential_energy"] == [60]
    assert found["momentum"].tolist() == [14, 16, 18, 1.5, -4, 10]
    assert found["mass_center"].tolist() == [1, 2, 3]


def test_without_gravity_there_is_no_potential_energy() -> None:
    system = systems.random_system(np.random.default_rng(1), 2, gravity=(0, 0, 0), loads=False)
    library = kg.build(system, ("potential_energy", "mass_center"))
    x = np.ones((9, library.n))
    assert library.potential_energy(x[0]) == 0
    assert library.potential_energy(x).tolist() == [0] * 9
    assert compile_module(system, ("potential_energy",)).operations["sincos"] == 0


def test_bodies_without_mass() -> None:
    """Three hinges with two massless bodies between them are one joint of three angles; a disc only turns."""
    rng = np.random.default_rng(8)
    heavy = systems.random_system(rng, 1, free=systems.flags(1, FREEDOMS[:3]), locked=False)
    (body,) = heavy.bodies
    free = np.eye(6, dtype=bool)[:3]
    bodies = [
        replace(
            body,
            name=f"body{k}",
            lower=k,
            mass=body.mass if k == 2 else 0.0,
            inertia=body.inertia if k == 2 else ((0.0,) * 3,) * 3,
            joint=replace(body.joint, free=free[k]) if k == 0 else kg.Joint(free=free[k]),
        )
        for k in range(3)
    ]
    x, y = rng.normal(size=(2, 3))
    one, three = (
        values(system, OUTPUTS, {"x": x, "y": y}) for system in (heavy, replace(heavy, bodies=tuple(bodies)))
    )
    for name in OUTPUTS:
        assert three[name] == pytest.approx(one[name], rel=1e-13, abs=1e-14), name

    disc = free_body(0.0, [3.0, 4.0, 5.0], free=systems.flags(1, ["theta3"]))
    found = values(disc, (*ENERGIES, "momentum"), {"x": [0.3], "y": [2.0]})
    assert found["kinetic_energy"] == [10]
    assert found["potential_energy"] == [0]
    assert found["momentum"].tolist() == [0, 0, 0, 0, 0, 10]
    with pytest.raises(kg.OptionError, match=r"no body with mass, so there is no mass centre\.$"):
        kg.generate(disc, "mass_center")


@pytest.mark.parametrize("free", [("theta2",), ("theta1", "s3"), ("s2",), FREEDOMS])
def test_run_time_parameters_are_prepared(free: tuple[str, ...]) -> None:
    """Masses, places and gravity as parameters: the same values, and every division in `prepare`."""
    numbers = systems.chain(3, free)
    named = iter(range(1000))

    def parameter(value: Number) -> kg.Parameter:
        return kg.Parameter(f"p{next(named)}", value_of(value))

    bodies = [
        replace(
            body,
            mass=parameter(body.mass),
            mass_center=tuple(map(parameter, body.mass_center)),
            joint=replace(body.joint, position=tuple(map(parameter, body.joint.position))),
        )
        for body in numbers.bodies
    ]
    system = kg.System("named", tuple(bodies), tuple(map(parameter, numbers.gravity)))
    x, y = speeds(numbers, 5)
    found, expected = (values(s, OUTPUTS, {"x": x, "y": y}) for s in (system, numbers))
    for name in OUTPUTS:
        size = 1 + np.abs(expected[name]).max()
        assert found[name].astype(float) == pytest.approx(expected[name], abs=1e-13 * size), name
    operations = compile_module(system, OUTPUTS).operations
    assert operations["divide"] == 0 < operations["prepare"]


def test_far_from_the_origin_nothing_is_lost() -> None:
    """Angular momentum about the mass centre does not depend on place and velocity of a floating tree."""
    system = systems.chain(3, FREEDOMS)
    x, y = speeds(system, 2)
    far = x + 1e6 * np.array([freedom == Freedom(1, 3) for freedom in system.freedoms])
    near = values(system, ("momentum",), {"x": x, "y": y})["momentum"]
    far_away = values(system, ("momentum",), {"x": far, "y": y})["momentum"]
    fast = values(system, ("momentum",), {"x": far, "y": y + far - x})["momentum"]
    assert far_away == pytest.approx(near, rel=1e-13)
    assert fast[3:] == pytest.approx(near[3:], rel=1e-13)
    assert np.linalg.norm(fast[:3]) == pytest.approx(1e6 * system.values().mass.sum(), rel=1e-4)
