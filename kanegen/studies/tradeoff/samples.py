"""States with generalized forces in which the variants of a program are evaluated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.reference.states import ActuatedStates

UNIFORM = "uniform"
"""Name of the states that are uniform over the whole domain."""


@dataclass(frozen=True)
class Sample(ActuatedStates):
    """B states of a domain.

    Attributes:
        strata: B names of the groups of states from which the states come.
    """

    strata: tuple[str, ...] = field(kw_only=True)

    def __getitem__(self, rows: slice) -> Self:
        """Return some of the states."""
        first, last, _ = rows.indices(len(self))
        return self.part(first, last)

    def part(self, start: int, stop: int) -> Self:
        """Return the states with the indices `start` to `stop` - 1."""
        return replace(super().part(start, stop), strata=self.strata[start:stop])

    def of(self, stratum: str) -> list[int]:
        """Return the indices of the states of one group."""
        return [index for index, name in enumerate(self.strata) if name == stratum]

    def bits(self) -> list[bytes]:
        """Return every state as bytes, by which it is found again."""
        return [row.tobytes() for row in self.flat()]

    def flat(self) -> Floats:
        """Return (B, k) rows of x, y and tau, followed by forces and torques where there are loads."""
        parts = [self.x, self.y, self.tau]
        if self.force is not None and self.torque is not None:
            parts += [load.reshape(len(self), -1) for load in (self.force, self.torque)]
        return np.concatenate(parts, axis=1)


def joined(samples: Sequence[Sample]) -> Sample:
    """Return all states of several samples of one system, in order."""
    return Sample(
        x=np.concatenate([sample.x for sample in samples]),
        y=np.concatenate([sample.y for sample in samples]),
        force=_joined([sample.force for sample in samples]),
        torque=_joined([sample.torque for sample in samples]),
        tau=np.concatenate([sample.tau for sample in samples]),
        strata=tuple(name for sample in samples for name in sample.strata),
    )


def _joined(loads: Sequence[Floats | None]) -> Floats | None:
    """Return the loads of several samples as one array; None where there are none."""
    present = [load for load in loads if load is not None]
    return np.concatenate(present) if present else None
