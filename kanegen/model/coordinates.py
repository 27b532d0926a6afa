"""Freedoms of the joints, and coordinates of a state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kanegen.model.freedoms import FREEDOMS, QUATERNION


@dataclass(frozen=True)
class Freedom:
    """One of the six freedoms of a body: `index` counts `FREEDOMS`, `body` counts bodies from 1."""

    body: int
    index: int

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle (rad) rather than a translation (m)."""
        return self.index < 3

    @property
    def axis(self) -> int:
        """0, 1 or 2: which of the three angles or translations."""
        return self.index % 3

    @property
    def unit(self) -> Literal["rad", "m"]:
        """Unit of the coordinate."""
        return "rad" if self.is_angle else "m"

    @property
    def effort(self) -> Literal["N m", "N"]:
        """Unit of its generalized force."""
        return "N m" if self.is_angle else "N"


@dataclass(frozen=True)
class Coordinate:
    """One element of {x}: of a freedom its angle or translation, or one of the four of a quaternion.

    Attributes:
        body: From 1.
        index: Counts `FREEDOMS`, and `QUATERNION` behind them.
    """

    body: int
    index: int

    @property
    def name(self) -> str:
        """Without that of the body."""
        return (*FREEDOMS, *QUATERNION)[self.index]

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle (rad)."""
        return self.index < 3

    @property
    def is_translation(self) -> bool:
        """Whether it is a translation (m)."""
        return 3 <= self.index < len(FREEDOMS)

    @property
    def unit(self) -> Literal["rad", "m", "1"]:
        """Its unit."""
        if self.is_angle:
            return "rad"
        return "m" if self.is_translation else "1"
