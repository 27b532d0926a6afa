"""The results of a search for states of rest and steady motions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import counted
from kanegen.linear import LinearModel, Stability
from kanegen.pictures.html import sentence, shown, table

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A state of rest or a steady motion.

    Attributes:
        coordinates: Values of the coordinates by name (rad, m, 1).
        speeds: Values of the generalized speeds by name (rad/s, m/s).
        x: (m,) coordinates in order.
        y: (n,) generalized speeds in order.
        residual: Largest acceleration that is left by rounding (rad/s^2, m/s^2).
        free_directions: Directions in which the state may be displaced and stays in equilibrium, each by the
            shares of the coordinates; the state is one of a continuous family then.
        stability: What is known of stability, in words.
        model: Linear model of small deviations.
    """

    coordinates: Mapping[str, float]
    speeds: Mapping[str, float]
    x: Floats
    y: Floats
    residual: float
    free_directions: tuple[Mapping[str, float], ...]
    stability: Stability
    model: LinearModel

    def __str__(self) -> str:
        """Coordinates, speeds that are not zero, free directions and stability."""
        lines = [self.state, f"  {self.stability}"]
        if self.free_directions:
            lines.append(f"  free: {self.free}")
        lines.append(f"  residual {self.residual:.1e} in SI units")
        return "\n".join(lines)

    @property
    def state(self) -> str:
        """Coordinates, and speeds that are not zero, in words."""
        values = [f"{name} = {value + 0.0:.9g}" for name, value in self.coordinates.items()]
        values += [f"d/dt {name} = {value:.9g}" for name, value in self.speeds.items() if value]
        return ", ".join(values)

    @property
    def free(self) -> str:
        """The free directions in words, "" for none."""
        return "; ".join(map(_direction, self.free_directions))

    def as_dict(self) -> dict[str, Any]:
        """Return the state, what is free, and stability as plain data."""
        return {
            "coordinates": dict(self.coordinates),
            "speeds": dict(self.speeds),
            "residual": self.residual,
            "free_directions": [dict(one) for one in self.free_directions],
            "stability": {"verdict": self.stability.verdict, "reason": self.stability.reason},
            "eigenvalues": [[value.real, value.imag] for value in self.model.eigenvalues],
        }


@dataclass(frozen=True, eq=False)
class Equilibria:
    """What a search found: a sequence of equilibria, by potential energy from the lowest.

    Attributes:
        name: Name of the system.
        found: The equilibria; of a continuous family one.
        starts: Number of states from which the search began.
        converged: Number of these from which it reached an equilibrium.
        singular: Number of states left out because accelerations do not exist there, as in gimbal lock.
        smallest_residual: Smallest largest acceleration of all starts, where none converged (SI units).
    """

    name: str
    found: tuple[Equilibrium, ...]
    starts: int
    converged: int
    singular: int
    smallest_residual: float

    def __len__(self) -> int:
        return len(self.found)

    def __getitem__(self, place: int) -> Equilibrium:
        return self.found[place]

    def __iter__(self) -> Iterator[Equilibrium]:
        return iter(self.found)

    def __str__(self) -> str:
        """All equilibria, and how the search went."""
        first, *others = self._search()
        return "\n".join([f"{self.name}: {first}", *others, *map(str, self.found)]) + "\n"

    def __repr__(self) -> str:
        """Name of the system and the number of equilibria; `print` shows them."""
        return f"<Equilibria of {self.name}: {len(self.found)}>"

    def _repr_html_(self) -> str:
        """All equilibria, and how the search went, for a notebook."""
        first, *others = self._search()
        rows = [
            (place, one.state, one.free, str(one.stability), f"{one.residual:.1e}")
            for place, one in enumerate(self.found)
        ]
        head = ("", "state", "free", "stability", "residual")
        lines = (sentence("{}", line) for line in others)
        return shown(sentence("{}", first, strong=self.name), *lines, table(head, rows, "found[place]"))

    def _search(self) -> Iterator[str]:
        """Yield sentences on how the search went."""
        count = counted(len(self.found), "equilibrium", "equilibria")
        yield f"{count}; {self.converged} of {self.starts} starts converged"
        if self.singular:
            yield f"{counted(self.singular, 'state')} without accelerations left out, as in gimbal lock"
        if not self.found:
            yield f"smallest acceleration in all searches: {self.smallest_residual:.3g} in SI units"

    def as_dict(self) -> dict[str, Any]:
        """Return all results as plain data."""
        return {
            "system": self.name,
            "starts": self.starts,
            "converged": self.converged,
            "singular": self.singular,
            "equilibria": [one.as_dict() for one in self.found],
        }


def _direction(shares: Mapping[str, float]) -> str:
    """Return a direction as a sum of coordinates."""
    if len(shares) == 1:
        return next(iter(shares))
    return " ".join(f"{share:+.3g} {name}" for name, share in shares.items())
