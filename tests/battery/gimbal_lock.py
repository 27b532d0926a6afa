"""States next to gimbal lock, where the angle rates of a body with three free angles are undefined: X7,
X8."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

import kanegen as kg
from kanegen.measure import truth
from kanegen.program.precision import DOUBLE, Precision
from kanegen.reference.states import States, random_states
from tests.battery import scenes
from tests.battery.experiments import Point, Row, Size, count, experiment
from tests.battery.measurement import (
    LINEAR,
    PRECISIONS,
    Floats,
    built,
    efforts,
    forward,
    linear,
    points,
    worst,
)
from tests.support.paths import MODELS

EIGHT_BODY = MODELS / "eight_body.toml"


def _scene(bodies: int) -> kg.System:
    rng = np.random.default_rng(bodies)
    return scenes.tree(rng, range(bodies), np.ones((bodies, 6), dtype=bool))


def _scenes(size: Size) -> dict[str, kg.System]:
    """Return chains of free bodies and, in the full size, the eight bodies of the notes."""
    found = {f"N = {bodies}": _scene(bodies) for bodies in (1, 4)}
    if size.pick(False, True):
        whole = kg.load(EIGHT_BODY)
        found["eight-body"] = replace(whole, bodies=tuple(replace(b, loads=False) for b in whole.bodies))
    return found


def _near_lock(system: kg.System, distance: float, precision: Precision) -> States:
    """Return states in which every body is at theta2 = +-pi/2 -+ distance (rad), rounded to the precision."""
    states = random_states(system, 4, 7)
    sign = np.array([1.0, -1.0, 1.0, -1.0])[:, None]
    states.x[:, _places(system, 1)] = sign * (np.pi / 2 - distance)
    return states.rounded(precision)


def _places(system: kg.System, *indices: int) -> np.ndarray:
    """Return the indices in {x} of the freedoms of these kinds."""
    return np.array([i for i, freedom in enumerate(system.freedoms) if freedom.index in indices])


def _distances(size: Size) -> list[float]:
    return [0.0, *size.pick([1e-1, 1e-6, 1e-12], [10.0**-k for k in range(12, 0, -1)])]


@experiment("X7", "Gimbal lock, speeds that are angle rates")
def angle_rates(size: Size) -> Iterator[Row]:
    """A direct solution for angle rates may lose accuracy by 1/cos(theta2)^2; the recursion must not."""
    for name, system in _scenes(size).items():
        for precision in PRECISIONS:
            found = _curve(system, precision, size)
            yield worst(f"{name}, {precision.name}", found, LINEAR, _over(size))
    yield _diagnosed(size)


def _curve(system: kg.System, precision: Precision, size: Size) -> list[Point]:
    """Measure the errors of forward dynamics at every distance from gimbal lock."""
    found: list[Point] = []
    for distance in _distances(size):
        states = _near_lock(system, distance, precision)
        tau = efforts(system, states, np.random.default_rng(7))
        measured = forward(system, precision, states, tau)
        found += points(distance, measured, linear(measured, system.number_of_bodies, precision))
    return found


def _over(size: Size) -> str:
    return f"{len(_distances(size))} distances 0 to 0.1 rad, both signs, every body"


def _diagnosed(size: Size) -> Row:
    """Count the states in which `diagnose` does not report the distance from gimbal lock."""
    system = _scene(4)
    library = built(system, outputs=("forward_dynamics", "error_estimate", "regularity"))
    silent = []
    for distance in _distances(size):
        states = _near_lock(system, distance, DOUBLE)
        for x, y in zip(states.x, states.y, strict=True):
            singularity = library.diagnose(x, y).singularity
            silent.append(singularity is None or singularity.value > 1.001 * distance + DOUBLE.roundoff)
    return count("distance that diagnose does not report", silent, f"{len(silent)} states", "none")


@experiment("X8", "Gimbal lock, speeds that are angular velocities")
def angular_velocities(size: Size) -> Iterator[Row]:
    """Angular velocities have no pole at gimbal lock, so forward dynamics loses no accuracy, even at pi/2.

    With angle rates, and without efforts, the accelerations of theta2 and of the translations have no pole.
    """
    for name, system in _scenes(size).items():
        regular = system.with_speeds("angular_velocity")
        for precision in PRECISIONS:
            found = _curve(regular, precision, size)
            yield worst(f"{name}, {precision.name}", found, LINEAR, _over(size))
            part = [p for d in _distances(size) for p in _regular(system, d, precision)]
            case = f"regular part of angle rates, {name}, {precision.name}"
            yield worst(case, part, "80 N u", _over(size))


def _regular(system: kg.System, distance: float, precision: Precision) -> list[Point]:
    states = _near_lock(system, distance, precision)
    with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
        found = built(system, precision).forward_dynamics(states.x, states.y)
    part = _places(system, 1, 3, 4, 5)
    result = []
    for x, y, value in zip(states.x, states.y, found, strict=True):
        exact = truth.truth(system, x, y, outputs=("forward_dynamics",), unit_roundoff=precision.roundoff)
        right: Floats = exact["forward_dynamics"].value[part]
        error = float(np.linalg.norm(value[part] - right) / np.linalg.norm(right))
        result.append(Point(distance, error, 80 * system.number_of_bodies * precision.roundoff))
    return result
