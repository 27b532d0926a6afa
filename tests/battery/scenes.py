"""The trees of the battery, and numbers in the text of a model."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kanegen as kg
from kanegen.model.coordinates import FREEDOMS

Floats = NDArray[np.float64]

NUMBER = re.compile(r"(?<![\w.\"])(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)(?![\w.\"])")
"""Pattern of a number in the text of a model."""


def flags(bodies: int, *names: str) -> NDArray[np.bool_]:
    """Return (N, 6) flags with the same free freedoms at every body."""
    return np.tile([freedom in names for freedom in FREEDOMS], (bodies, 1))


def planar(masses: Sequence[float], lengths: Sequence[float] | None = None, **changes: Any) -> kg.System:
    """Return a chain of slender rods on parallel hinges, which is straight at zero coordinates."""
    mass = np.array(masses, dtype=float)
    length = np.ones(len(mass)) if lengths is None else np.array(lengths, dtype=float)
    along = np.array([1.0, 0.0, 0.0])
    numbers: dict[str, Any] = {
        "connection": range(len(mass)),
        "mass": mass,
        "inertia": [
            m * r * r * np.diag([1 / 512, 1 / 12, 1 / 12]) for m, r in zip(mass, length, strict=True)
        ],
        "mass_center": 0.5 * length[:, None] * along,
        "joint_position": np.append(0.0, length[:-1])[:, None] * along,
        "free": flags(len(mass), "theta3"),
        "gravity": (0.0, -9.81, 0.0),
        "name": "planar",
    }
    return kg.System.from_arrays(**(numbers | changes))


def straight(bodies: int) -> kg.System:
    """Return a chain of equal rods."""
    return planar(np.ones(bodies).tolist())


def tree(
    rng: np.random.Generator,
    connection: Sequence[int],
    free: NDArray[np.bool_] | None = None,
    masses: Sequence[float] | None = None,
    **changes: Any,
) -> kg.System:
    """Return a tree with random orientations, arms and inertias of order one; by default hinges on random
    axes."""
    bodies = len(connection)
    hinges = np.eye(6, dtype=bool)[rng.integers(0, 3, bodies)]
    mass = rng.uniform(0.5, 2.0, bodies) if masses is None else np.array(masses, dtype=float)
    numbers: dict[str, Any] = {
        "connection": connection,
        "mass": mass,
        "inertia": [inertia(rng, m) for m in mass],
        "mass_center": rng.uniform(-0.5, 0.5, (bodies, 3)),
        "joint_position": rng.uniform(-1.0, 1.0, (bodies, 3)),
        "joint_orientation": [rotation(rng) for _ in range(bodies)],
        "free": hinges if free is None else free,
        "gravity": (0.0, 0.0, -9.81),
        "name": "tree",
    }
    return kg.System.from_arrays(**(numbers | changes))


def rotation(rng: np.random.Generator) -> Floats:
    """Return a (3, 3) rotation, uniform over all rotations."""
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    turned: Floats = q * np.linalg.det(q).round()
    return turned


def inertia(rng: np.random.Generator, mass: float) -> Floats:
    """Return the (3, 3) inertia of a body whose points lie about 0.5 m from its mass centre."""
    points = rng.uniform(-0.5, 0.5, (6, 3))
    points -= points.mean(axis=0)
    second = points.T @ points * (mass / 6)
    central: Floats = np.trace(second) * np.eye(3) - second
    return central


def mixed(bodies: int = 3, free: NDArray[np.bool_] | None = None, **changes: Any) -> kg.System:
    """Return a short chain of alternating hinges and slides."""
    turns = np.eye(6, dtype=bool)[[(0, 4, 2, 3, 1, 5)[k % 6] for k in range(bodies)]]
    turns[0, 2] = True
    return tree(np.random.default_rng(3), range(bodies), turns if free is None else free, **changes)


SHAPES: dict[str, Callable[[int], list[int]]] = {
    "binary": lambda n: [k // 2 for k in range(1, n + 1)],
    "star": lambda n: [0] + [1] * (n - 1),
    "caterpillar": lambda n: [0] + [k - 1 if k % 2 else k for k in range(1, n)],
}
"""Functions from the number of bodies to the connection array, by name of the shape."""
