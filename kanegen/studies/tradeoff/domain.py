"""The states for which a variant is judged: a box, and how it is sampled.

A state is drawn as a row of numbers: x, y, tau and, where bodies take loads, forces and torques. All numbers
are rounded to single precision, the ends of the box as well, so that variants of every precision solve the
same problem and the rounding of a state is no error of any.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from kanegen.errors import OptionError
from kanegen.model.arrays import Floats
from kanegen.model.prescribed import require_unprescribed
from kanegen.model.system import System
from kanegen.program.precision import FLOAT, Precision
from kanegen.reference import equations as reference
from kanegen.reference.states import Ranges, random_states, ranges
from kanegen.studies.tradeoff.samples import UNIFORM, Sample

GRID = FLOAT
"""The precision that all states have."""

_EFFORTS = 64
"""Random states whose {f} says how large tau may be."""

_ATTEMPTS = 10_000
"""Draws after which the rest of a box is called empty."""


@dataclass(frozen=True)
class Domain:
    """A box of states, without what lies too near to gimbal lock.

    Attributes:
        system: The tree.
        low: (m,) least numbers of a state.
        high: (m,) largest ones.
        clearance: How near joints with three free angles come to gimbal lock: |cos(theta2)|, or |sin(theta2)|
            where the first and the last angle turn about one axis, is at least this.
    """

    system: System
    low: Floats
    high: Floats
    clearance: float = 0.0

    def __post_init__(self) -> None:
        """Round the ends of the box.

        Raises:
            OptionError: If the box is empty, not finite, of another size than states are, or leaves nothing
                beside what is too near to gimbal lock, or if a freedom is prescribed.
        """
        require_unprescribed(self.system, "domain")
        for name in ("low", "high"):
            value = np.asarray(getattr(self, name), dtype=np.float64)
            if value.shape != (self.size,) or not np.isfinite(value).all():
                raise OptionError(f"domain: {name} must hold {self.size} finite numbers.")
            object.__setattr__(self, name, rounded(value))
        if (self.low > self.high).any():
            raise OptionError(f"domain: low exceeds high at number {int((self.low > self.high).argmax())}.")
        if not 0 <= self.clearance < 1:
            raise OptionError(f"domain: the clearance is {self.clearance}; it must lie in [0, 1).")

    @cached_property
    def loads(self) -> int:
        """Numbers of all forces, and of all torques: 3 N, or 0 where no body takes any."""
        takes = any(body.loads for body in self.system.bodies)
        return 3 * self.system.number_of_bodies if takes else 0

    @property
    def size(self) -> int:
        """m, numbers of a state."""
        return self.first["torque"] + self.loads

    @cached_property
    def first(self) -> dict[str, int]:
        """Where x, y, tau, force and torque begin in a state."""
        m, n = len(self.system.coordinates), len(self.system.freedoms)
        return {"x": 0, "y": m, "tau": m + n, "force": m + 2 * n, "torque": m + 2 * n + self.loads}

    @cached_property
    def elements(self) -> dict[str, dict[str, str]]:
        """What stands in x, y and tau: by name the unit of the coordinate, or of what the freedom changes."""
        system = self.system
        units = [coordinate.unit for coordinate in system.coordinates]
        own: dict[str, str] = {
            name: freedom.unit for name, freedom in zip(system.freedom_names, system.freedoms, strict=True)
        }
        return {"x": dict(zip(system.coordinate_names, units, strict=True)), "y": own, "tau": own}

    @cached_property
    def locking(self) -> dict[int, float]:
        """Where joints with three free angles lock: by place of theta2 in {x} the angle, up to half turns."""
        joints = [body.joint for body in self.system.bodies]
        return {
            place: 0.0 if joints[coordinate.body - 1].ends_alike else np.pi / 2
            for place, coordinate in enumerate(self.system.coordinates)
            if coordinate.index == 1 and joints[coordinate.body - 1].turns_freely
        }

    def sample(self, count: int, seed: int | Sequence[int]) -> Sample:
        """`count` states, uniform over the domain; other seeds give other states."""
        return self.states(self.uniform(count, np.random.default_rng(seed)))

    def uniform(self, count: int, rng: np.random.Generator) -> Floats:
        """(count, m) rows on the grid, uniform over the domain.

        Raises:
            OptionError: If next to nothing of the box is clear of gimbal lock.
        """
        rows = rounded(rng.uniform(self.low, self.high, (count, self.size)))
        for place, lock in self.locking.items():
            for _ in range(_ATTEMPTS):
                close = np.abs(np.sin(rows[:, place] - lock)) < self.clearance
                if not close.any():
                    break
                drawn = rng.uniform(self.low[place], self.high[place], int(close.sum()))
                rows[close, place] = rounded(drawn)
            else:
                raise OptionError(f"domain: at clearance {self.clearance:g} nothing of the box is left.")
        return rows

    def states(self, rows: Floats, stratum: str = UNIFORM) -> Sample:
        """Rows (B, m) as states, on the grid and inside the box."""
        loads = self.loads
        inside = rounded(np.clip(rows, self.low, self.high))
        x, y, tau, force, torque = np.split(inside, [*self.first.values()][1:], axis=1)
        shape = (len(rows), loads // 3, 3)
        both = (force.reshape(shape), torque.reshape(shape)) if loads else (None, None)
        return Sample(x, y, *both, tau=tau, strata=(stratum,) * len(rows))

    def contains(self, sample: Sample) -> bool:
        """Whether all states of a sample lie in the domain."""
        rows, locks = sample.flat(), np.array(list(self.locking.values()))
        clear = np.abs(np.sin(sample.x[:, list(self.locking)] - locks)) >= self.clearance
        return bool(((rows >= self.low) & (rows <= self.high)).all() and clear.all())

    def as_dict(self) -> dict[str, Any]:
        """The ranges as plain data."""
        pairs = np.stack([self.low, self.high], axis=1).tolist()
        parts: dict[str, Any] = {
            what: dict(zip(names, pairs[self.first[what] :], strict=False))
            for what, names in self.elements.items()
        }
        if self.loads:
            bodies = [body.name for body in self.system.bodies]
            for what in ("force", "torque"):
                start = self.first[what]
                ranges_of = [pairs[start + 3 * row : start + 3 * row + 3] for row in range(len(bodies))]
                parts[what] = dict(zip(bodies, ranges_of, strict=True))
        return {**parts, "clearance": self.clearance, "rounded_to": GRID.name}


def default_domain(
    system: System, angle: float = np.pi, speed: float = 1.0, effort: float = 1.0, clearance: float = 0.0
) -> Domain:
    """The box that is studied unless another is asked for.

    Angles range over a whole turn; translations, speeds and loads over the scales of `check.states`. The
    range of tau follows from some states of that box: the largest {f}, so that tau can hold the tree, or
    where that is larger, what changes the speed of a freedom by its range in the time that goes with it.

    Args:
        system: The tree; parameters stand at their defaults.
        angle: Largest magnitude of an angle, rad.
        speed: Factor on the ranges of the speeds.
        effort: Factor on the ranges of tau and of the loads.
        clearance: See `Domain`.

    Raises:
        OptionError: As `Domain`.
    """
    require_unprescribed(system, "domain")
    largest = ranges(system)
    states = random_states(system, _EFFORTS)
    forcing = reference.forcing(system, states.x, states.y, states.force, states.torque)
    inertia = np.diagonal(reference.mass_matrix(system, states.x), axis1=1, axis2=2)
    is_angle = np.array([coordinate.is_angle for coordinate in system.coordinates])
    rate = largest.y / largest.size
    tau = np.maximum(np.abs(forcing).max(axis=0), inertia.max(axis=0) * largest.y * rate)
    high = [np.where(is_angle, angle, largest.x), speed * largest.y, effort * tau]
    if states.force is not None:
        high += _loads(largest, effort)
    ends = np.concatenate(high)
    return Domain(system, -ends, ends, clearance)


def _loads(largest: Ranges, effort: float) -> list[Floats]:
    return [effort * largest.force.ravel(), effort * largest.torque.ravel()]


def rounded(values: Floats, precision: Precision = GRID) -> Floats:
    """The nearest numbers with as many digits; beyond the range of `precision` its variants are refused."""
    fraction, exponent = np.frexp(values)
    whole: Floats = np.ldexp(
        np.rint(np.ldexp(fraction, precision.significand_bits)), exponent - precision.significand_bits
    )
    return whole
