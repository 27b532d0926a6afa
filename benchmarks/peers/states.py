"""The states that everybody computes, and the file in which drivers find them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import kanegen as kg
from kanegen.arrays import Floats


@dataclass(frozen=True)
class States:
    """B states: coordinates, speeds and generalized forces, (B, n) each, SI units."""

    x: Floats
    y: Floats
    tau: Floats

    def write(self, path: Path) -> Path:
        """As drivers/contest.h describes it."""
        with path.open("wb") as file:
            np.array(self.x.shape, dtype=np.int64).tofile(file)
            for values in (self.x, self.y, self.tau):
                np.ascontiguousarray(values).tofile(file)
        return path


def random_states(system: kg.System, count: int, seed: int = 0) -> States:
    """`count` random states.

    Hinges take any angle. Where a body has three angles these stay below 1 rad: [A] is singular at a second
    angle of a quarter turn, and the accelerations of different programs could not be compared near there.
    """
    rng = np.random.default_rng(seed)
    x, y, tau = rng.uniform(-1, 1, (3, count, len(system.freedoms)))
    hinges = [f.is_angle and not all(system.bodies[f.body - 1].joint.free[:3]) for f in system.freedoms]
    return States(np.where(hinges, np.pi * x, x), y, tau)
