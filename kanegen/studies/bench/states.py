"""The model and the states that all programs compute, and the file from which drivers read the states."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.numbers import value_of
from kanegen.model.system import System


@dataclass(frozen=True)
class States:
    """B states in SI units.

    Attributes:
        x: (B, m) coordinates.
        y: (B, n) generalized speeds.
        tau: (B, n) generalized forces.
    """

    x: Floats
    y: Floats
    tau: Floats

    def write(self, path: Path) -> Path:
        """Write the states into a file, in the format of drivers/driver.h, and return its path."""
        with path.open("wb") as file:
            np.array([*self.x.shape, self.y.shape[1]], dtype=np.int64).tofile(file)
            for values in (self.x, self.y, self.tau):
                np.ascontiguousarray(values).tofile(file)
        return path

    @classmethod
    def read(cls, path: Path) -> States:
        """Read states from a file that `write` wrote."""
        count, m, n = np.fromfile(path, dtype=np.int64, count=3)
        x, y, tau = np.split(np.fromfile(path, offset=24), [count * m, count * (m + n)])
        return cls(x.reshape(count, m), y.reshape(count, n), tau.reshape(count, n))


def random_states(system: System, count: int, seed: int = 0) -> States:
    """Return `count` random states.

    Hinges take any angle. Where a body has three free angles, these stay away from gimbal lock, where [A] is
    singular and the accelerations of different programs cannot be compared.
    """
    rng = np.random.default_rng(seed)
    x, y, tau = rng.uniform(-1, 1, (3, count, len(system.freedoms)))
    joints = [system.bodies[f.body - 1].joint for f in system.freedoms]
    pairs = list(zip(system.freedoms, joints, strict=True))
    hinges = [f.is_angle and not joint.turns_freely for f, joint in pairs]
    bent = [f.index == 1 and joint.turns_freely and joint.ends_alike for f, joint in pairs]
    return States(np.where(hinges, np.pi * x, x) + np.pi / 2 * np.array(bent), y, tau)


def without_loads_and_parameters(system: System) -> tuple[System, tuple[str, ...]]:
    """Return the system without loads, force elements and run-time parameters, and notes on what was changed.

    Not every peer takes loads, and none takes run-time parameters as kanegen does.
    """
    notes = []
    if any(body.loads for body in system.bodies):
        notes.append("loads are switched off: not everything that is timed takes them")
    if system.force_elements or any(point.loads for _, point in system.points):
        notes.append("force elements and loads on points are left out: not everything that is timed has them")
    if system.parameters:
        names = ", ".join(parameter.name for parameter in system.parameters)
        notes.append(f"run-time parameters are constants, at their defaults: {names}")
    fixed = system.changed(value_of)
    bodies = tuple(body.unloaded() for body in fixed.bodies)
    return replace(fixed, bodies=bodies, force_elements=()), tuple(notes)
