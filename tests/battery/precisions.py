"""Precisions higher than double: X37."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import kanegen as kg
from kanegen.measure.truth import Measurement, measure
from kanegen.program.precision import precision_named
from kanegen.reference.states import States, random_states
from tests.battery import scenes
from tests.battery.experiments import Point, Row, Size, experiment
from tests.battery.measurement import FLAGS, FORWARD, PROMISE, Floats, efforts, worst


@experiment("X37", "Precisions higher than double")
def wider(size: Size) -> Iterator[Row]:
    """Straight chains, growing masses and gimbal lock again, in double-double and in long double.

    Double-double must keep 30 digits less those that the condition number takes; long double must keep T(u).
    """
    trees = {
        "straight chain": (scenes.straight(size.pick(4, 32)), 0.0),
        "heavier outward": (scenes.planar([10.0**i for i in range(size.pick(3, 8))]), None),
        "next to gimbal lock": (_gimbal(size.pick(1, 2)), None),
    }
    for name, (system, angle) in trees.items():
        states, tau = _states(system, angle, size.pick(2, 4))
        double_double = _measured(system, "double-double", states, tau)
        limits = 1e-30 * double_double.kappa_s * double_double.chi * double_double.formation
        found = [
            Point(0.0, *pair) for pair in zip(double_double.normwise.tolist(), limits.tolist(), strict=True)
        ]
        over = f"{system.number_of_bodies} bodies, {len(found)} states"
        yield worst(f"{name}, double-double", found, "1e-30 kappa_s chi formation", over)
        long = _measured(system, "long double", states, tau)
        found = [Point(0.0, *pair) for pair in zip(long.normwise.tolist(), long.bound.tolist(), strict=True)]
        yield worst(f"{name}, long double", found, PROMISE, over)


def _gimbal(bodies: int) -> kg.System:
    return scenes.tree(np.random.default_rng(37), range(bodies), np.ones((bodies, 6), dtype=bool))


def _states(system: kg.System, angle: float | None, amount: int) -> tuple[States, Floats]:
    """Return random or straight states; joints with three free angles are 1e-6 rad from gimbal lock."""
    states = random_states(system, amount, 37)
    if angle is not None:
        states.x[:] = angle
    for i, freedom in enumerate(system.freedoms):
        if system.bodies[freedom.body - 1].joint.has_free_orientation and freedom.index == 1:
            states.x[:, i] = np.pi / 2 - 1e-6
    return states, efforts(system, states, np.random.default_rng(37))


def _measured(system: kg.System, precision: str, states: States, tau: Floats) -> Measurement:
    """Measure the errors of results that are stored in the precision in which they are computed."""
    tier = kg.Variant(precision=precision, storage=precision)
    library = kg.build(system, FORWARD, tier=tier, flags=FLAGS)
    return measure(system, library, states.rounded(precision_named("double")), tau)["forward_dynamics"]
