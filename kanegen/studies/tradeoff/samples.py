"""States with generalized forces: what a variant is judged by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.reference.states import States

UNIFORM = "uniform"
"""The stratum of states anywhere in the domain, all equally likely."""


@dataclass(frozen=True)
class Sample:
    """B states.

    Attributes:
        states: Coordinates, speeds and loads.
        tau: (B, n) generalized forces beside loads and gravity.
        strata: B names, where each comes from.
    """

    states: States
    tau: Floats
    strata: tuple[str, ...]

    def __len__(self) -> int:
        """B."""
        return len(self.strata)

    def __getitem__(self, rows: slice) -> Sample:
        """Some of the states."""
        first, last, _ = rows.indices(len(self))
        return Sample(self.states.part(first, last), self.tau[rows], self.strata[rows])

    def of(self, stratum: str) -> list[int]:
        """Places of the states of one stratum."""
        return [place for place, name in enumerate(self.strata) if name == stratum]

    def bits(self) -> list[bytes]:
        """Every state as bytes, by which it is found again."""
        return [row.tobytes() for row in self.flat()]

    def flat(self) -> Floats:
        """(B, m): x, y, tau, and where there are loads forces and torques, side by side."""
        parts = [self.states.x, self.states.y, self.tau]
        if self.states.force is not None and self.states.torque is not None:
            parts += [load.reshape(len(self), -1) for load in (self.states.force, self.states.torque)]
        return np.concatenate(parts, axis=1)


def joined(samples: Sequence[Sample]) -> Sample:
    """All states of several samples of one system, in order."""
    states = [sample.states for sample in samples]
    return Sample(
        States(
            x=np.concatenate([part.x for part in states]),
            y=np.concatenate([part.y for part in states]),
            force=_joined([part.force for part in states]),
            torque=_joined([part.torque for part in states]),
        ),
        np.concatenate([sample.tau for sample in samples]),
        tuple(name for sample in samples for name in sample.strata),
    )


def _joined(loads: Sequence[Floats | None]) -> Floats | None:
    present = [load for load in loads if load is not None]
    return np.concatenate(present) if present else None
