"""A point mass on a hinge, whose motion from level and at rest is an elliptic function."""

from __future__ import annotations

import functools

import numpy as np

import kanegen as kg

GRAVITY = 9.81
OUTPUTS = ("forward_dynamics", "kinetic_energy", "potential_energy", "momentum")


@functools.cache
def pendulum(precision: str = "double", outputs: tuple[str, ...] = OUTPUTS) -> kg.Library:
    """Return a point mass of 1 kg, 1 m from a hinge; it hangs at theta3 = -pi/2."""
    system = kg.System.from_arrays(
        connection=[0],
        mass=[1.0],
        inertia=np.zeros((1, 3, 3)),
        mass_center=[[1.0, 0.0, 0.0]],
        joint_position=[[0.0, 0.0, 0.0]],
        free=[[False, False, True, False, False, False]],
        gravity=(0.0, -GRAVITY, 0.0),
        name="pendulum",
    )
    return kg.build(system, outputs, precision=precision)
