"""Chains of bodies whose joints all have the same kind of freedoms."""

from __future__ import annotations

import numpy as np

import kanegen as kg
from kanegen.model.coordinates import FREEDOMS
from tests.support import systems


def bushes(bodies: int) -> kg.System:
    """Return a chain of bodies with six freedoms each and identity orientations."""
    free = systems.flags(bodies, FREEDOMS)
    rng = np.random.default_rng(1)
    return systems.random_system(
        rng,
        bodies,
        connection=range(bodies),
        free=free,
        loads=False,
        orientations=False,
        gravity=(0, 0, -9.81),
    )


def gimbals(bodies: int) -> kg.System:
    """Return a chain of bodies with three free angles each."""
    rng = np.random.default_rng(1)
    return systems.random_system(
        rng, bodies, connection=range(bodies), free=systems.flags(bodies, FREEDOMS[:3]), loads=False,
        orientations=False, locked=False, gravity=(0, 0, -9.81),
    )  # fmt: skip


def hinges(bodies: int) -> kg.System:
    """Return a chain of hinges about axes 1, 2, 3, 1, ..."""
    free = np.eye(6, dtype=bool)[[k % 3 for k in range(bodies)]]
    rng = np.random.default_rng(1)
    return systems.random_system(
        rng, bodies, connection=range(bodies), free=free, loads=False, orientations=False, locked=False,
        gravity=(0, 0, -9.81),
    )  # fmt: skip
