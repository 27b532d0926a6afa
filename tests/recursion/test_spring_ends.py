"""Springs whose ends nearly touch: forces against the reference in 40 digits."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.force_elements.elements import Spring
from kanegen.program.precision import DOUBLE
from kanegen.reference.states import States, random_states
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.high_precision import true_values
from tests.support.programs import values

ROUNDOFF = DOUBLE.roundoff


def chain(free: list[list[str]], **choices: str) -> kg.System:
    """Return bodies on each other without turned joints, whose hook at the tip is one spring's end.

    The other end is where the hook is at {x} = {0}, in the ground.
    """
    flags = np.array([[name in row for name in FREEDOMS] for row in free])
    rng = np.random.default_rng(1)
    system = systems.random_system(
        rng,
        len(free),
        connection=range(len(free)),
        free=flags,
        loads=False,
        orientations=False,
        locked=False,
        gravity=(0.0, 0.0, 0.0),
        name="sprung",
    )
    # Sums of these positions are exact, so that the ends meet exactly at {x} = {0}.
    bodies = [replace(body, joint=replace(body.joint, position=(0.5, -0.25, 1.0))) for body in system.bodies]
    bodies[-1] = replace(bodies[-1], points=(kg.Point("hook", (0.25, -0.75, 1.125)),))
    system = replace(system, bodies=tuple(bodies))
    if speeds := choices.get("speeds"):
        system = system.with_speeds(speeds)
    if coordinates := choices.get("coordinates"):
        system = system.with_coordinates(coordinates)
    there = tuple(float(v) for v in np.array([0.5, -0.25, 1.0]) * len(free) + [0.25, -0.75, 1.125])
    return system.with_force_elements(Spring((there, "hook"), stiffness=3.0))


@pytest.fixture(autouse=True)
def _lengths_in_40_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the reference compute lengths of vectors of mpmath numbers, which have no `hypot`."""

    def lengths(vectors: np.ndarray, axis: int = -1) -> np.ndarray:
        roots = np.vectorize(mpmath.sqrt, otypes=[object])
        return np.asarray(roots(np.sum(vectors * vectors, axis=axis)))

    monkeypatch.setattr("kanegen.reference.force_elements.length", lengths)


ANGLES, TRANSLATIONS = ["theta1", "theta2", "theta3"], ["s1", "s2", "s3"]

TOUCHING = {
    "slider": chain([["s2"]]),
    "hinge": chain([["theta2"]]),
    "free body": chain([[*ANGLES, *TRANSLATIONS]]),
    "ball joint": chain([ANGLES]),
    "arm": chain([["theta1"], ["theta3"], ["theta2", "s1"]]),
    "angular velocities": chain([ANGLES, ["theta1"]], speeds="angular_velocity"),
    "quaternions": chain([ANGLES, [*ANGLES, "s3"]], coordinates="quaternion"),
}


def at_zero(system: kg.System, size: float, count: int = 2) -> States:
    """Return states at rest within `size` of {x} = {0}, where a quaternion is (1, 0, 0, 0)."""
    rng = np.random.default_rng(2)
    x = size * rng.uniform(-1, 1, (count, len(system.coordinates)))
    x[:, [i for i, one in enumerate(system.coordinates) if one.name == "e0"]] += 1.0
    return States(x, np.zeros((count, len(system.freedoms))))


def worst(system: kg.System, states: States) -> float:
    """Return the largest error of {f} over its largest entry in the state, in roundoffs."""
    exact = true_values(system.values(), states)["forcing"]
    errors = []
    for x, y, right in zip(states.x, states.y, exact, strict=True):
        found = values(system, ("forcing",), {"x": x, "y": y})["f"]
        size = max(abs(v) for v in right)
        errors.append(float(max(abs(a - b) for a, b in zip(found, right, strict=True)) / size))
    print("W", max(errors) / ROUNDOFF)
    return max(errors) / ROUNDOFF


@pytest.mark.parametrize("distance", slow_except([1e-15, 1e-12, 1e-6, 1.0, 3.2], 1e-12, 1.0))
@pytest.mark.parametrize("name", TOUCHING)
def test_forces_of_ends_that_nearly_touch(name: str, distance: float) -> None:
    """Differences of positions would lose 1e-16 over the distance: 1e4 roundoffs at 1e-12."""
    assert worst(TOUCHING[name], at_zero(TOUCHING[name], distance)) <= 20


def test_an_offset_that_is_not_zero_counts_exactly() -> None:
    """The ends of a slider are 1e-13 m apart at {x} = {0}; nothing is lost in a difference of positions."""
    system = TOUCHING["slider"]
    (spring,) = system.force_elements
    assert isinstance(spring, Spring)
    near = tuple(v + 1e-13 for v in spring.between[0])
    system = replace(system, force_elements=(replace(spring, between=(near, "hook")),))
    assert worst(system, at_zero(system, 1e-13)) <= 20


@pytest.mark.parametrize("scale", slow_except((1e-15, 1e-9, 1e-3), 1e-15))
def test_the_bound_where_ends_meet_elsewhere(scale: float) -> None:
    """The vector between the ends is wrong by at most 8 roundoffs of the way, times its turns and joints.

    A counterexample search: the end in the ground is put where the hook is in a random state, and states
    around it are climbed for the largest error.
    """
    rng = np.random.default_rng(3)
    arm = TOUCHING["arm"]
    way = 3 * np.linalg.norm([0.5, -0.25, 1.0]) + np.linalg.norm([0.25, -0.75, 1.125]) + 1.0
    limit = 3.0 * way * 8 * ROUNDOFF * way * 7  # stiffness, lever, and four turns and three joints of the way
    met = random_states(arm, 1, 5).x[0]
    met[-1] /= np.abs(met[-1]) + 1
    hook = kg.build(replace(arm, force_elements=()), ("point_positions",)).point_positions(met)[0]
    (spring,) = arm.force_elements
    assert isinstance(spring, Spring)
    system = replace(arm, force_elements=(replace(spring, between=(tuple(map(float, hook)), "hook")),))
    best, found = met, 0.0
    for _ in range(8):
        x = best + scale * rng.uniform(-1, 1, (3, len(met)))
        states = States(x, np.zeros_like(x))
        exact = true_values(system.values(), states)["forcing"].astype(float)
        errors = [
            np.abs(values(system, ("forcing",), {"x": one, "y": 0 * one})["f"] - right).max()
            for one, right in zip(x, exact, strict=True)
        ]
        if max(errors) > found:
            found, best = max(errors), x[int(np.argmax(errors))]
    print("B", found / limit)
    assert 0 < found <= limit
