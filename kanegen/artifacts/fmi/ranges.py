"""Start values and ranges of what an FMU is told from outside."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kanegen.model.parameter_sets import least_values
from kanegen.model.system import System
from kanegen.program.ir import PARAMETERS

Numbers = Mapping[str, Sequence[float]]
"""Numbers for the elements of arrays, by name of the array in C."""


@dataclass(frozen=True)
class Ranges:
    """The values at which an instance starts, and those between which it is meant to be.

    Attributes:
        start: First values of arrays; those of other arrays are 0.
        least: Smallest values of arrays; other arrays have none.
        largest: Largest values of arrays; other arrays have none.
    """

    start: Numbers
    least: Numbers
    largest: Numbers

    @classmethod
    def of(cls, system: System) -> Ranges:
        """Return the ranges of a system: its limits, and the parameters that must not be negative.

        Motion starts at rest in the neutral position, or within the limits as near to it as can be.
        """
        start: dict[str, Sequence[float]] = {PARAMETERS: [one.value for one in system.parameters]}
        below = least_values(system)
        least = {PARAMETERS: [below.get(one.name, -math.inf) for one in system.parameters]}
        largest: dict[str, Sequence[float]] = {}
        start["x"] = system.neutral_coordinates
        if limits := system.limits:
            least |= {"x": list(limits.lower), "y": list(-limits.speed), "tau": list(-limits.effort)}
            largest |= {"x": list(limits.upper), "y": list(limits.speed), "tau": list(limits.effort)}
            start["x"] = [
                min(max(neutral, low), high)
                for neutral, low, high in zip(start["x"], least["x"], largest["x"], strict=True)
            ]
        return cls(start, least, largest)

    def of_element(self, array: str, place: int) -> tuple[float, float, float]:
        """Return start value, smallest and largest value of an element of an array."""
        start, least, largest = (one.get(array) for one in (self.start, self.least, self.largest))
        return (
            start[place] if start else 0.0,
            least[place] if least else -math.inf,
            largest[place] if largest else math.inf,
        )
