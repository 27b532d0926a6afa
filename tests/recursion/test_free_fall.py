"""What falls freely needs no gravity: bodies behind three free translations, by certified truth.

Gravity, loads at mass centres and the motion of lower bodies cause no moment about the mass centre of a free
body. Next to gimbal lock, in slow motion, a moment that only nearly vanishes would be all there is to see.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kanegen as kg
from kanegen.measure.truth import truth
from kanegen.program.precision import DOUBLE
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.refinement import FORWARD, SOLVERS, computed

SLOW = 1e-3
"""Factor of random speeds, so that velocity terms are a millionth of what gravity would cause."""

BAR = 1e-14
"""Largest error of the angular accelerations over the largest of them: some 90 roundoffs."""


def floating_arm(loads: bool) -> kg.System:
    """A free body that carries an arm of three hinges; gravity leaves all of it."""
    free = np.eye(6, dtype=bool)[[0, 2, 0, 2]]
    free[0] = True
    return systems.random_system(
        np.random.default_rng(5), 4, connection=range(4), free=free, loads=[loads, False, False, False]
    )


def carrying_arm() -> kg.System:
    """An arm of three hinges under gravity whose last link carries a free body."""
    free = np.eye(6, dtype=bool)[[0, 2, 0, 2]]
    free[3] = True
    return systems.random_system(np.random.default_rng(6), 4, connection=range(4), free=free, loads=True)


def far_body() -> kg.System:
    """A free body whose mass centre is far from its joint, where m d^2 is 10 000 times its inertia."""
    inertia = np.diag([0.3, 0.4, 0.5])
    return kg.System.from_arrays([0], [2.0], [inertia], [[30.0, 20.0, 10.0]], [[0.0, 0.0, 0.0]])


SCENES = {
    "eight bodies": systems.eight_body,
    "floating arm": lambda: floating_arm(loads=False),
    "floating arm with loads": lambda: floating_arm(loads=True),
    "arm that carries a free body": carrying_arm,
    "body far from its joint": far_body,
}


def near_lock(system: kg.System, distance: float, count: int = 2) -> States:
    """Return slow states in which every joint with three angles is at theta2 = +-(pi/2 - distance)."""
    states = random_states(system, count, 3)
    x, y = states.x.copy(), SLOW * states.y
    sign = 1.0
    for place, coordinate in enumerate(system.coordinates):
        joint = system.bodies[coordinate.body - 1].joint
        if coordinate.index == 1 and all(joint.free[:3]):
            x[:, place], sign = sign * (np.pi / 2 - distance), -sign
    torque = None if states.torque is None else np.zeros_like(states.torque)
    return States(x, y, states.force, torque)


def angular_error(system: kg.System, states: States, found: np.ndarray) -> float:
    """Return the largest error of angular accelerations over the largest of them."""
    angles = np.array([freedom.is_angle for freedom in system.freedoms])
    errors = []
    for i in range(len(states)):
        loads = {} if states.force is None else {"force": states.force[i], "torque": states.torque[i]}
        exact = truth(system, states.x[i], states.y[i], outputs=FORWARD, **loads)["forward_dynamics"].value
        errors.append(np.abs(found[i] - exact)[angles].max() / np.abs(exact[angles]).max())
    return max(errors)


@pytest.mark.parametrize("steps", [0, 1])
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("distance", slow_except([10.0**-k for k in range(1, 10)], 1e-9))
def test_angular_accelerations_are_exact_next_to_gimbal_lock(scene: str, distance: float, steps: int) -> None:
    system = SCENES[scene]()
    states = near_lock(system, distance)
    tau = np.zeros((len(states), len(system.freedoms)))
    found = computed(system, states, tau, refinement=steps)
    assert angular_error(system, states, found) <= BAR


@pytest.mark.parametrize("coordinates", ["angles", "quaternion"])
def test_regular_speeds_lose_nothing_either(coordinates: str) -> None:
    """With angular velocities or quaternions a moment that only nearly vanishes costs 1e-10 here."""
    system = floating_arm(loads=True)
    system = (
        system.with_speeds("angular_velocity")
        if coordinates == "angles"
        else system.with_coordinates(coordinates)
    )
    states = near_lock(system, 0.3)
    found = computed(system, states, np.zeros(states.y.shape))
    assert angular_error(system, states, found) <= BAR


@pytest.mark.parametrize("speeds", ["angle_rates", "angular_velocity"])
def test_gravity_and_loads_at_mass_centres_cause_exactly_no_rotation(speeds: str) -> None:
    """Free bodies at rest, far from their joints' origins: their angular accelerations are zeros."""
    system = systems.eight_body(loads=True).with_speeds(speeds)
    states = random_states(system, 2, 1)
    still = States(states.x, 0 * states.y, states.force, 0 * states.torque)
    found = computed(system, still, np.zeros(states.y.shape))
    angles = np.array([freedom.is_angle for freedom in system.freedoms])
    assert not found[:, angles].any()
    assert np.abs(found[:, ~angles]).max() > 1


def test_the_error_estimate_sees_angular_errors_alone() -> None:
    """The estimate is a correction of a solution without gravity, so it is as small as the errors."""
    system = floating_arm(loads=False)
    states = near_lock(system, 1e-5)
    tau = np.zeros(states.y.shape)
    estimate = computed(system, states, tau, ("error_estimate",))
    solution = computed(system, states, tau)
    angles = np.array([freedom.is_angle for freedom in system.freedoms])
    assert np.abs(estimate[:, angles]).max() <= BAR * np.abs(solution[:, angles]).max()


@st.composite
def falling_trees(draw: st.DrawFn) -> kg.System:
    """Trees in which a body anywhere has three free translations, with any of its angles free."""
    system = draw(systems.systems(max_bodies=5, min_bodies=2))
    falling = draw(st.integers(1, system.number_of_bodies))
    angles = draw(st.lists(st.booleans(), min_size=3, max_size=3))
    arrays = system.values()
    arrays.free[falling - 1] = [*angles, True, True, True]
    arrays.armature[arrays.free[:, :3].all(axis=1)] = 0.0  # their speeds may change, those of motors may not
    arrays.armature[falling - 1] = 0.0
    system = systems.from_values(arrays)
    if draw(st.booleans()):
        system = system.with_speeds("angular_velocity")
    moving = [
        name
        for name, freedom in zip(system.freedom_names, system.freedoms, strict=True)
        if freedom.body != falling and not freedom.is_angle
    ]
    return system.with_prescribed(moving[:1]) if draw(st.booleans()) and moving else system


@settings(max_examples=8, deadline=None, derandomize=True)
@given(falling_trees(), st.sampled_from(SOLVERS), st.sampled_from([0, 1]))
def test_falling_trees_obey_the_equations(system: kg.System, solver: str, steps: int) -> None:
    """[A]{ydot} = {f} + {tau} of the reference, to the accuracy that the conditioning of [A] leaves."""
    states = random_states(system, 2, 4)
    a = reference.mass_matrix(system, states.x, states.prescribed)
    f = reference.forcing(system, states.x, states.y, states.force, states.torque, **states.inputs)
    tau = np.random.default_rng(4).normal(size=f.shape)
    found = np.atleast_2d(computed(system, states, tau, solver=solver, refinement=steps))
    for one, right, matrix in zip(found, f + tau, a, strict=True):
        scale = np.sqrt(np.diag(matrix))
        scaled = matrix / np.outer(scale, scale)
        expected = np.linalg.solve(scaled, right / scale)
        limit = 40 * len(scale) * DOUBLE.roundoff * np.linalg.cond(scaled)
        assert np.abs(one * scale - expected).max() <= limit * np.abs(expected).max()
