"""Samples of states, and the domains from which they are drawn.

A domain is a box in the space of states. A state is a row of numbers: x, y, tau and, where bodies take loads,
forces and torques. All numbers are rounded to single precision, the ends of the box as well, so that variants
of every precision solve the same problem and the rounding of a state is no error of any variant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from kanegen.errors import OptionError
from kanegen.model.arrays import Floats
from kanegen.model.description import require_unprescribed
from kanegen.model.system import System
from kanegen.program.precision import FLOAT, Precision
from kanegen.reference import equations as reference
from kanegen.reference.states import ActuatedStates, Ranges, random_states, ranges

GRID = FLOAT
"""The precision of all numbers of a state."""

UNIFORM = "uniform"
"""The kind of states that are uniformly distributed over a domain."""

_FORCING_STATES = 64
"""Number of random states whose {f} determines the default range of tau."""

_ATTEMPTS = 10_000
"""Number of attempts after which the part of a box away from gimbal lock counts as empty."""


@dataclass(frozen=True)
class Sample(ActuatedStates):
    """B states of a domain.

    Attributes:
        kinds: Kind of each state, such as `UNIFORM`.
    """

    kinds: tuple[str, ...] = field(kw_only=True)

    def __getitem__(self, rows: slice) -> Self:
        """Return the states of a range of rows."""
        first, last, _ = rows.indices(len(self))
        return self.part(first, last)

    def part(self, start: int, stop: int) -> Self:
        """Return the states with the indices `start` to `stop` - 1."""
        return replace(super().part(start, stop), kinds=self.kinds[start:stop])

    def rows_of(self, kind: str) -> list[int]:
        """Return the indices of the states of one kind."""
        return [row for row, name in enumerate(self.kinds) if name == kind]

    def bits(self) -> list[bytes]:
        """Return the bytes of each state, which identify it."""
        return [row.tobytes() for row in self.flat()]

    def flat(self) -> Floats:
        """Return the states as rows (B, m) of x, y, tau and, where there are loads, forces and torques."""
        parts = [self.x, self.y, self.tau]
        if self.force is not None and self.torque is not None:
            parts += [load.reshape(len(self), -1) for load in (self.force, self.torque)]
        return np.concatenate(parts, axis=1)


def joined(samples: Sequence[Sample]) -> Sample:
    """Return all states of several samples of one system, in order."""
    return Sample(
        x=np.concatenate([sample.x for sample in samples]),
        y=np.concatenate([sample.y for sample in samples]),
        force=_joined_loads([sample.force for sample in samples]),
        torque=_joined_loads([sample.torque for sample in samples]),
        tau=np.concatenate([sample.tau for sample in samples]),
        kinds=tuple(name for sample in samples for name in sample.kinds),
    )


def _joined_loads(loads: Sequence[Floats | None]) -> Floats | None:
    """Return forces or torques (B, N, 3) one after the other; None if there are none."""
    present = [load for load in loads if load is not None]
    return np.concatenate(present) if present else None


@dataclass(frozen=True)
class Domain:
    """A box of states, without the states that lie too near to gimbal lock.

    Attributes:
        system: The system whose states these are.
        low: (m,) smallest numbers of a state.
        high: (m,) largest numbers of a state.
        clearance: Smallest distance from gimbal lock of a joint with three free angles: the least
            |cos(theta2)| or, if the first and the last angle turn about the same axis, the least
            |sin(theta2)|.
    """

    system: System
    low: Floats
    high: Floats
    clearance: float = 0.0

    def __post_init__(self) -> None:
        """Check the box and round its ends.

        Raises:
            OptionError: If the box is empty, not finite, of another size than a state, or leaves nothing away
                from gimbal lock, or if a freedom is prescribed.
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
        """Number of components of all forces, and of all torques: 3 N, or 0 if no body takes loads."""
        takes = any(body.loads for body in self.system.bodies)
        return 3 * self.system.number_of_bodies if takes else 0

    @property
    def size(self) -> int:
        """Number of numbers m of a state."""
        return self.first["torque"] + self.loads

    @cached_property
    def first(self) -> dict[str, int]:
        """Index of the first number of x, y, tau, force and torque in a state."""
        m, n = len(self.system.coordinates), len(self.system.freedoms)
        return {"x": 0, "y": m, "tau": m + n, "force": m + 2 * n, "torque": m + 2 * n + self.loads}

    @cached_property
    def elements(self) -> dict[str, dict[str, str]]:
        """Names of the elements of x, y and tau, each with the unit of its coordinate or freedom."""
        system = self.system
        units = [coordinate.unit for coordinate in system.coordinates]
        own: dict[str, str] = {
            name: freedom.unit for name, freedom in zip(system.freedom_names, system.freedoms, strict=True)
        }
        return {"x": dict(zip(system.coordinate_names, units, strict=True)), "y": own, "tau": own}

    @cached_property
    def gimbal_lock_angles(self) -> dict[int, float]:
        """Angle of gimbal lock (rad), up to half turns, by the index of the angle theta2 in x."""
        joints = [body.joint for body in self.system.bodies]
        return {
            place: 0.0 if joints[coordinate.body - 1].gimbal_lock == "sin" else np.pi / 2
            for place, coordinate in enumerate(self.system.coordinates)
            if coordinate.index == 1 and joints[coordinate.body - 1].gimbal_lock
        }

    def sample(self, count: int, seed: int | Sequence[int]) -> Sample:
        """Return `count` random states that are uniformly distributed over the domain."""
        return self.states(self.uniform(count, np.random.default_rng(seed)))

    def uniform(self, count: int, rng: np.random.Generator) -> Floats:
        """Return (count, m) rows in single precision that are uniformly distributed over the domain.

        Raises:
            OptionError: If almost nothing of the box has the distance `clearance` from gimbal lock.
        """
        rows = rounded(rng.uniform(self.low, self.high, (count, self.size)))
        for place, lock in self.gimbal_lock_angles.items():
            for _ in range(_ATTEMPTS):
                close = np.abs(np.sin(rows[:, place] - lock)) < self.clearance
                if not close.any():
                    break
                angles = rng.uniform(self.low[place], self.high[place], int(close.sum()))
                rows[close, place] = rounded(angles)
            else:
                raise OptionError(f"domain: at clearance {self.clearance:g} nothing of the box is left.")
        return rows

    def states(self, rows: Floats, kind: str = UNIFORM) -> Sample:
        """Return rows (B, m) as a sample, moved into the box and rounded to single precision.

        Args:
            rows: The numbers of the states.
            kind: Kind of the states.
        """
        loads = self.loads
        inside = rounded(np.clip(rows, self.low, self.high))
        x, y, tau, force, torque = np.split(inside, [*self.first.values()][1:], axis=1)
        shape = (len(rows), loads // 3, 3)
        both = (force.reshape(shape), torque.reshape(shape)) if loads else (None, None)
        return Sample(x, y, *both, tau=tau, kinds=(kind,) * len(rows))

    def contains(self, sample: Sample) -> bool:
        """Return whether all states of a sample lie in the domain."""
        rows, locks = sample.flat(), np.array(list(self.gimbal_lock_angles.values()))
        distance = np.abs(np.sin(sample.x[:, list(self.gimbal_lock_angles)] - locks))
        inside = (rows >= self.low) & (rows <= self.high)
        return bool(inside.all() and (distance >= self.clearance).all())

    def as_dict(self) -> dict[str, Any]:
        """Return the ranges as plain data, by the names of elements and bodies."""
        pairs = np.stack([self.low, self.high], axis=1).tolist()
        parts: dict[str, Any] = {
            argument: dict(zip(names, pairs[self.first[argument] :], strict=False))
            for argument, names in self.elements.items()
        }
        if self.loads:
            bodies = [body.name for body in self.system.bodies]
            for argument in ("force", "torque"):
                start = self.first[argument]
                ranges_of = [pairs[start + 3 * row : start + 3 * row + 3] for row in range(len(bodies))]
                parts[argument] = dict(zip(bodies, ranges_of, strict=True))
        return {**parts, "clearance": self.clearance, "rounded_to": GRID.name}


def default_domain(
    system: System, angle: float = np.pi, speed: float = 1.0, effort: float = 1.0, clearance: float = 0.0
) -> Domain:
    """Return the box of states that a study uses if no other one is given.

    Coordinates, speeds and efforts with limits range over these. Other angles range over a whole turn, other
    translations, speeds and loads over the ranges of `reference.states`. The range of tau without a limit
    follows from some states of that box. It is the largest {f}, so that tau can hold the tree, or the force
    that changes the speed of a freedom by its range in the time scale of this freedom, whichever is larger.

    Args:
        system: The system; its parameters stand at their defaults.
        angle: Largest magnitude of an angle without limits (rad).
        speed: Factor on the ranges of the speeds.
        effort: Factor on the ranges of tau and of the loads.
        clearance: Smallest distance from gimbal lock; see `Domain`.

    Raises:
        OptionError: As `Domain`.
    """
    require_unprescribed(system, "domain")
    largest, limits = ranges(system), system.limits
    states = random_states(system, _FORCING_STATES, limits=limits)
    forcing = reference.forcing(system, states.x, states.y, states.force, states.torque)
    inertia = np.diagonal(reference.mass_matrix(system, states.x), axis1=1, axis2=2)
    is_angle = np.array([coordinate.is_angle for coordinate in system.coordinates])
    rate = largest.y / largest.size
    tau = np.maximum(np.abs(forcing).max(axis=0), inertia.max(axis=0) * largest.y * rate)
    x = np.where(is_angle, angle, largest.x)
    low, high = limits.positions(-x, x)
    others = [speed * limits.speeds(largest.y), effort * limits.efforts(tau)]
    if states.force is not None:
        others += _largest_loads(largest, effort)
    ends = np.concatenate(others)
    return Domain(system, np.concatenate([low, -ends]), np.concatenate([high, ends]), clearance)


def _largest_loads(largest: Ranges, effort: float) -> list[Floats]:
    """Return the largest components of all forces (3 N,) and of all torques (3 N,)."""
    return [effort * largest.force.ravel(), effort * largest.torque.ravel()]


def rounded(values: Floats, precision: Precision = GRID) -> Floats:
    """Return the nearest numbers with the digits of a precision; its range of exponents is not limited."""
    fraction, exponent = np.frexp(values)
    bits = precision.significand_bits
    whole: Floats = np.ldexp(np.rint(np.ldexp(fraction, bits)), exponent - bits)
    return whole
