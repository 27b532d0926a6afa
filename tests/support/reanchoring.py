"""Chains of bodies near gimbal lock, whose joints tests re-anchor."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import kanegen as kg
from kanegen.model.coordinates import FREEDOMS
from tests.support import systems


def near_gimbal_lock(
    sequence: str, seed: int, distance: float, bodies: int = 3
) -> tuple[kg.System, Any, Any]:
    """Return a chain of free bodies, its coordinates at a distance from gimbal lock, and its speeds."""
    rng = np.random.default_rng(seed)
    drawn = systems.random_system(rng, bodies, free=systems.flags(bodies, FREEDOMS), loads=False)
    system = systems.from_values(replace(drawn.values(), sequence=(sequence,) * bodies))
    x, y = rng.normal(size=(2, 6 * bodies))
    alike = sequence[0] == sequence[-1]
    middle = np.array([freedom.index == 1 for freedom in system.freedoms])
    x[middle] = rng.choice([0, np.pi] if alike else [-np.pi / 2, np.pi / 2], bodies) + distance
    return system, x, y


def with_orientation_parameters(system: kg.System, seed: int = 1) -> kg.System:
    """Return the system with three parameters as every constant orientation."""
    values = np.random.default_rng(seed).uniform(-3, 3, (system.number_of_bodies, 3))
    bodies = [
        replace(
            body,
            joint=replace(
                body.joint, orientation=[kg.Parameter(f"c{k}_{i}", v) for i, v in enumerate(values[k])]
            ),
        )
        for k, body in enumerate(system.bodies)
    ]
    return replace(system, bodies=tuple(bodies))
