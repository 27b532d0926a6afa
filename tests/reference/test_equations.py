"""The NumPy reference against textbooks, calculus and conservation laws."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from numpy.typing import NDArray

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.reference.states import States
from tests.support import systems

Numbers = NDArray[Any]

STEP = 1e-200
"""Imaginary step of complex-step derivatives, which have no truncation error."""

EXAMPLES = settings(max_examples=40, deadline=None, derandomize=True)


def rate(function: Any, *pairs: tuple[Numbers, Numbers]) -> Numbers:
    """Return the time derivative of `function`, from pairs of its arguments and their time derivatives."""
    return np.imag(function(*(value + 1j * STEP * dot for value, dot in pairs))) / STEP


def accelerations(system: kg.System, state: States) -> Numbers:
    """Return the accelerations that the reference gives, solved after scaling [A]."""
    a = reference.mass_matrix(system, state.x)
    f = reference.forcing(system, state.x, state.y, state.force, state.torque)
    scale = np.sqrt(np.diag(a))
    return np.linalg.solve(a / np.outer(scale, scale), f / scale) / scale


def body(system: kg.System, x: Numbers, y: Numbers, number: int = 1) -> BodyKinematics:
    """Return the kinematics of one body."""
    return kinematics(system.values(), x, y)[number - 1]


def hinges(names: list[str], bodies: int) -> NDArray[np.bool_]:
    """Return flags by which every body has the freedoms of these names."""
    return systems.flags(bodies, names)


# Textbook systems


def test_double_pendulum() -> None:
    m1, m2, c1, c2, l1, i1, i2, g = 1.3, 0.7, 0.4, 0.6, 0.9, 0.2, 0.3, 9.81
    system = kg.System.from_arrays(
        connection=[0, 1],
        mass=[m1, m2],
        inertia=[np.diag([0.1, i1, i1]), np.diag([0.1, i2, i2])],
        mass_center=[[c1, 0, 0], [c2, 0, 0]],
        joint_position=[[0, 0, 0], [l1, 0, 0]],
        free=hinges(["theta3"], 2),
        gravity=(0, -g, 0),
    )
    (q1, q2), (u1, u2) = x, y = np.array([0.3, -1.1]), np.array([0.8, 1.7])
    h = m2 * l1 * c2 * np.sin(q2)
    a12 = i2 + m2 * (c2**2 + l1 * c2 * np.cos(q2))
    a11 = i1 + m1 * c1**2 + a12 + m2 * (l1**2 + l1 * c2 * np.cos(q2))
    np.testing.assert_allclose(
        reference.mass_matrix(system, x), [[a11, a12], [a12, i2 + m2 * c2**2]], rtol=1e-14
    )
    outer = m2 * g * c2 * np.cos(q1 + q2)
    f1 = h * (2 * u1 * u2 + u2**2) - (m1 * c1 + m2 * l1) * g * np.cos(q1) - outer
    np.testing.assert_allclose(reference.forcing(system, x, y), [f1, -h * u1**2 - outer], rtol=1e-14)


def test_spherical_pendulum() -> None:
    m, length, g = 1.7, 0.8, 9.81
    system = kg.System.from_arrays(
        [0], [m], np.zeros((1, 3, 3)), [[0, 0, -length]], [[0, 0, 0]], free=hinges(["theta1", "theta2"], 1)
    )
    (q1, q2), (u1, u2) = x, y = np.array([0.4, -0.9]), np.array([1.2, 0.6])
    moment = m * length**2
    np.testing.assert_allclose(
        reference.mass_matrix(system, x), np.diag([moment * np.cos(q2) ** 2, moment]), atol=1e-15
    )
    f1 = moment * np.sin(2 * q2) * u1 * u2 - m * g * length * np.sin(q1) * np.cos(q2)
    f2 = -moment * np.sin(q2) * np.cos(q2) * u1**2 - m * g * length * np.cos(q1) * np.sin(q2)
    np.testing.assert_allclose(reference.forcing(system, x, y), [f1, f2], rtol=1e-14)


def test_free_body_follows_newton_and_euler() -> None:
    system = systems.random_system(
        np.random.default_rng(5), 1, free=np.ones((1, 6), bool), loads=True, locked=False
    )
    state, arrays = systems.random_state(system), system.values()
    assert state.force is not None and state.torque is not None
    ydot = accelerations(system, state)
    now = body(system, state.x, state.y)
    omega_dot = rate(lambda x, y: body(system, x, y).omega, (state.x, state.y), (state.y, ydot))
    inertia = arrays.inertia[0]
    euler = inertia @ omega_dot + np.cross(now.omega, inertia @ now.omega)
    np.testing.assert_allclose(euler, state.torque[0], rtol=1e-12)

    def velocity(x: Numbers, y: Numbers) -> Numbers:
        moving = body(system, x, y)
        return moving.rotation.T @ moving.center_velocity

    newton = arrays.mass[0] * (rate(velocity, (state.x, state.y), (state.y, ydot)) - arrays.gravity)
    np.testing.assert_allclose(now.rotation @ newton, state.force[0], rtol=1e-12)


@pytest.mark.parametrize("tilt", [0.0, 0.5, -1.2])
def test_top_in_steady_precession(tilt: float) -> None:
    """A symmetric top that precesses about the vertical axis 1, its axis 3 tilted out of the horizontal."""
    m, arm, a, c, g, precession = 0.9, 0.3, 0.05, 0.02, 9.81, 1.4
    system = kg.System.from_arrays(
        [0], [m], [np.diag([a, a, c])], [[0, 0, arm]], [[0, 0, 0]],
        free=hinges(["theta1", "theta2", "theta3"], 1), gravity=(-g, 0, 0),
    )  # fmt: skip
    about_point = a + m * arm**2
    spin = (m * g * arm + about_point * precession**2 * np.sin(tilt)) / (c * precession)
    y = np.array([precession, 0.0, spin - precession * np.sin(tilt)])
    f = reference.forcing(system, [0.7, tilt, 0.2], y)
    np.testing.assert_allclose(f, np.zeros(3), atol=1e-14 * m * g)


# Calculus: the time derivatives of the notes are derivatives


@EXAMPLES
@given(systems.systems(max_bodies=6))
def test_dotted_matrices_are_time_derivatives(system: kg.System) -> None:
    state = systems.random_state(system)
    x, y = state.x, state.y
    for number, now in enumerate(kinematics(system.values(), x, y), start=1):
        for name in ("rate_matrix", "omega_y", "origin_y", "center_y"):
            derivative = rate(lambda x, n=number, a=name: getattr(body(system, x, y, n), a), (x, y))
            np.testing.assert_allclose(getattr(now, f"{name}_dot"), derivative, rtol=1e-12, atol=1e-12)

        def inertial_position(x: Numbers, n: int = number) -> Numbers:
            moving = body(system, x, y, n)
            return moving.rotation.T @ moving.center_position

        velocity = now.rotation.T @ now.center_velocity
        np.testing.assert_allclose(velocity, rate(inertial_position, (x, y)), rtol=1e-11, atol=1e-12)


# Laws of mechanics


@EXAMPLES
@given(systems.systems())
def test_mass_matrix_is_symmetric_and_positive_definite(system: kg.System) -> None:
    a = reference.mass_matrix(system, systems.random_state(system).x)
    scale = np.sqrt(np.diag(a))
    scaled = a / np.outer(scale, scale)
    np.testing.assert_allclose(scaled, scaled.T, atol=1e-14)
    assert np.linalg.eigvalsh(scaled).min() > 0


@EXAMPLES
@given(systems.systems())
def test_energy_changes_by_the_power_of_the_loads(system: kg.System) -> None:
    state, arrays = systems.random_state(system), system.values()
    x, y = state.x, state.y

    def potential(x: Numbers) -> Numbers:
        bodies = kinematics(arrays, x, np.zeros_like(x))
        centers = [b.rotation.T @ b.center_position for b in bodies]
        return -np.sum(arrays.mass @ np.array(centers) @ arrays.gravity)

    terms = [
        y @ reference.forcing(system, x, y, state.force, state.torque),  # = y . [A] ydot
        y @ rate(lambda x: reference.mass_matrix(arrays, x), (x, y)) @ y / 2,
        rate(potential, (x, y)),
    ]
    power = 0.0
    if state.force is not None and state.torque is not None:
        for k, now in enumerate(kinematics(arrays, x, y)):
            power += state.force[k] @ now.center_velocity + state.torque[k] @ now.omega
    assert sum(terms) == pytest.approx(power, rel=1e-11, abs=1e-12 * sum(map(abs, terms)))


@EXAMPLES
@given(systems.systems(max_bodies=6))
def test_a_floating_tree_keeps_its_momentum(system: kg.System) -> None:
    arrays = system.values()
    free = arrays.free.copy()
    free[arrays.connection == 0] = True
    floating = kg.System.from_arrays(
        np.maximum(arrays.connection, [0] + [1] * (len(free) - 1)),  # one body on the ground, fully free
        arrays.mass, arrays.inertia, arrays.mass_center, arrays.joint_position, arrays.joint_orientation,
        free, np.where(free, 0.0, arrays.locked), gravity=(0, 0, 0),
    )  # fmt: skip
    state, numbers = systems.random_state(floating), floating.values()

    def momentum(x: Numbers, y: Numbers) -> Numbers:
        linear, angular = np.zeros(3, complex), np.zeros(3, complex)
        for k, moving in enumerate(kinematics(numbers, x, y)):
            p = moving.rotation.T @ (numbers.mass[k] * moving.center_velocity)
            linear += p
            angular += np.cross(moving.rotation.T @ moving.center_position, p)
            angular += moving.rotation.T @ (numbers.inertia[k] @ moving.omega)
        return np.concatenate([linear, angular])

    x, y, still = state.x, state.y, np.zeros_like(state.x)
    transport = rate(momentum, (x, y), (y, still))
    push = rate(momentum, (x, still), (y, accelerations(floating, state)))
    np.testing.assert_allclose(transport + push, np.zeros(6), atol=1e-10 * np.abs(transport).max())
