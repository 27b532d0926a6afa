"""Energies, momenta and poses from the reference's kinematics: sums over the bodies as textbooks do."""

from __future__ import annotations

from typing import Any

import numpy as np

from kanegen.model.arrays import SystemArrays
from kanegen.reference.kinematics import kinematics
from kanegen.reference.matrices import transposed

Values = dict[str, Any]

READS_SPEEDS = {
    "kinetic_energy": True,
    "potential_energy": False,
    "momentum": True,
    "mass_center": False,
    "body_poses": False,
}
"""The outputs, and which of them need {y}."""


def expected(system: SystemArrays, x: Any, y: Any) -> Values:
    """Every output of one state, or of a batch of them, in the arithmetic of `x` and `y`."""
    bodies = kinematics(system, x, y)
    up = [transposed(body.rotation) for body in bodies]
    origins = [_turned(r, body.position) for r, body in zip(up, bodies, strict=True)]
    centers = [_turned(r, body.center_position) for r, body in zip(up, bodies, strict=True)]
    velocities = [_turned(r, body.center_velocity) for r, body in zip(up, bodies, strict=True)]
    spins = [
        _turned(r, _turned(inertia, body.omega))
        for r, inertia, body in zip(up, system.inertia, bodies, strict=True)
    ]
    kinetic = sum(
        (m * _dot(v, v) + _dot(_turned(r, body.omega), spin)) / 2
        for m, v, r, body, spin in zip(system.mass, velocities, up, bodies, spins, strict=True)
    )
    weight = sum(m * c for m, c in zip(system.mass, centers, strict=True))
    linear = sum(m * v for m, v in zip(system.mass, velocities, strict=True))
    whole = weight / system.mass.sum()
    angular = sum(
        spin + np.cross(c - whole, m * v)
        for m, c, v, spin in zip(system.mass, centers, velocities, spins, strict=True)
    )
    batch = x.shape[:-1]
    poses = [
        np.concatenate(
            [
                np.broadcast_to(body.rotation, (*batch, 3, 3)),
                np.broadcast_to(origin, (*batch, 3))[..., None, :],
            ],
            axis=-2,
        )
        for body, origin in zip(bodies, origins, strict=True)
    ]
    return {
        "kinetic_energy": kinetic,
        "potential_energy": -_dot(weight, system.gravity),
        "momentum": np.concatenate([linear, angular], axis=-1),
        "mass_center": whole,
        "body_poses": np.stack(poses, axis=-3),
    }


def _turned(matrix: Any, vector: Any) -> Any:
    return (matrix @ vector[..., None])[..., 0]


def _dot(a: Any, b: Any) -> Any:
    return (a * b).sum(axis=-1)
