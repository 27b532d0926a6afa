"""Which coordinates have a period, which states are the same, and which belong to one continuous family."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from kanegen.library.equilibria.balance import Balance
from kanegen.library.equilibria.search import corrected, null_space

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

ALIKE = 1e-6
"""Largest difference of places and rotations of two states that are the same."""

PROBE = 0.05
"""Displacement along a free direction by which it is told from a state that only looks free (rad, m)."""

STEPS = 80
"""Largest number of steps on the way from one state of a family to another."""


@dataclass(frozen=True)
class Families:
    """The neighbourhood of the zeros of forces.

    Attributes:
        balance: The forces.
        scale: (n,) size of each force that counts as one.
        periodic: (m,) whether the forces return after a full turn of a coordinate.
        moving: (m,) 1 for coordinates on which something depends and that do not turn by themselves, else 0.
        homogeneous: Places in {x} of each group of coordinates whose length has no meaning.
    """

    balance: Balance
    scale: Floats
    periodic: Flags
    moving: Floats
    homogeneous: tuple[tuple[int, ...], ...]

    def settled(self, x: Floats) -> Floats:
        """Return a state nearer to equilibrium, with angles within half a turn and unit quaternions."""
        x = corrected(self.balance.forces, self.balance.slopes, x, self.scale, self.moving)
        wrapped = np.remainder(x + np.pi, 2 * np.pi) - np.pi
        wrapped = np.where(wrapped <= -np.pi + 1e-9, np.pi, wrapped)
        x = np.where(self.periodic, wrapped, x)
        for places in self.homogeneous:
            part = x[list(places)]
            x[list(places)] = part / np.linalg.norm(part) * (1 if part[np.argmax(np.abs(part))] > 0 else -1)
        x[np.abs(x) < 1e-12] = 0.0
        return x

    def directions(self, x: Floats) -> Floats:
        """Return (m, k) directions of further equilibria; the length of a quaternion is none of them."""
        J = self.balance.slopes(x[None])[0] / self.scale[:, None] * self.moving
        rows = [J, np.diag(1.0 - self.moving)[self.moving == 0]]
        for places in self.homogeneous:
            row = np.zeros((1, len(x)))
            row[0, list(places)] = x[list(places)]
            rows.append(row)
        return null_space(np.concatenate(rows))

    def is_family(self, x: Floats, direction: Floats) -> bool:
        """Return whether equilibria go on along a direction, on both sides."""
        for sign in (1, -1):
            moved = x + sign * PROBE * direction
            found = corrected(self.balance.forces, self.balance.slopes, moved, self.scale, self.moving)
            left = np.abs(self.balance.forces(found[None])[0] / self.scale).max()
            if not left < 1e-9 or abs((found - x) @ direction) < PROBE / 2:
                return False
        return True

    def is_same(self, a: Floats, b: Floats) -> bool:
        """Return whether two states have all bodies at the same places, and springs as far wound up."""
        poses = self.balance.poses(np.stack([a, b]))
        wound = np.abs(a - b)[~self.periodic & (self.moving > 0)]
        free = [place for places in self.homogeneous for place in places]
        if free:
            wound = np.zeros(0)
        size = max(1.0, float(np.abs(poses).max()))
        return bool(np.abs(poses[0] - poses[1]).max() <= ALIKE * size and (wound <= ALIKE * size).all())

    def is_turned(self, a: Floats, b: Floats) -> bool:
        """Return whether a state becomes another one where only ignorable angles change.

        The angles are fitted to the poses of the bodies by the method of Gauss and Newton.
        """
        places = np.flatnonzero((self.moving == 0) & self.periodic)[:3]
        if not len(places):
            return False
        goal, step = self.balance.poses(b[None])[0], 1e-6
        for start in product((0.0, np.pi / 2, np.pi, -np.pi / 2), repeat=len(places)):
            x = a.copy()
            x[places] = start
            for _ in range(12):
                near = np.concatenate([x[None], x + step * np.eye(len(x))[places]])
                poses = self.balance.poses(near)
                slopes = (poses[1:] - poses[0]).T / step
                x[places] += np.linalg.lstsq(slopes, goal - poses[0], rcond=1e-6)[0]
            if self.is_same(x, b):
                return True
        return False

    def leads_to(self, x: Floats, goal: Floats) -> bool:
        """Return whether a family of equilibria leads from one state to another."""
        for _ in range(STEPS):
            way = goal - x
            way = np.where(self.periodic, np.remainder(way + np.pi, 2 * np.pi) - np.pi, way) * self.moving
            basis = self.directions(x)
            along = basis @ (basis.T @ way)
            if self.is_same(x, goal):
                return True
            length = float(np.linalg.norm(along))
            if length < 1e-3 * max(float(np.linalg.norm(way)), 1e-300):
                return False
            moved = x + along * min(1.0, 0.3 / length)
            x = corrected(self.balance.forces, self.balance.slopes, moved, self.scale, self.moving)
        return self.is_same(x, goal)
