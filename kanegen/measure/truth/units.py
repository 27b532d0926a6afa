"""Factors that take the units from accelerations and forces, so that they can be put into one norm.

Between angles and translations stands a length. The one that the tree has in the state is the root of the
mean moment of inertia that an angle moves over the mean mass that a translation moves: both stand on the
diagonal of [A]. Where there are only angles, or only translations, nothing depends on it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Flags, Floats
from kanegen.model.system import System


@dataclass(frozen=True)
class Units:
    """(n,) factors: `acceleration` gives m/s^2 for all, `force` N, and its products with itself kg."""

    acceleration: Floats

    @property
    def force(self) -> Floats:
        """Of generalized forces."""
        return 1 / self.acceleration

    def of(self, output: str) -> Floats:
        """Of an output, in its shape."""
        if output == "mass_matrix":
            return np.outer(self.force, self.force)
        return self.acceleration if output == "forward_dynamics" else self.force


def units(system: System, diagonal: Floats) -> Units:
    """The factors where [A] has this `diagonal` (n,)."""
    angles = np.array([freedom.is_angle for freedom in system.freedoms])
    length = np.sqrt(_mean(diagonal, angles) / _mean(diagonal, ~angles))
    return Units(np.where(angles, length if 0 < length < np.inf else 1.0, 1.0))


def _mean(values: Floats, chosen: Flags) -> float:
    """Mean of the `chosen`; 1 where there is none."""
    return float(np.mean(values[chosen])) if chosen.any() else 1.0
