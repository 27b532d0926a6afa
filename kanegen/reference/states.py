"""Random states in which every term of [A] and {f} counts.

A wrong term shows only where it is not much smaller than the others. So translations, speeds and loads have
the scale of the model: each body has a length, and gravity turns the length into a time and a force. The same
seed always gives the same states.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from kanegen.model.arrays import Flags, Floats, SystemArrays
from kanegen.model.coordinates import ANGLES
from kanegen.model.limits import SystemLimits
from kanegen.model.nodes import TIME
from kanegen.model.system import System
from kanegen.program.precision import Precision
from kanegen.reference.freedoms import free_columns, prescribed_columns
from kanegen.reference.matrices import length

PERIODS = 8
"""Largest time, in units of the time in which gravity moves a body by its length."""

STANDARD_GRAVITY = 9.80665
"""Gravity of the Earth (m/s^2)."""


@dataclass(frozen=True)
class States:
    """B states of a system.

    Attributes:
        x: (B, m) coordinates (rad, m, 1).
        y: (B, n) generalized speeds (rad/s, m/s).
        force: (B, N, 3) forces on the bodies (N), zero where a body takes no loads; None if no body does.
        torque: (B, N, 3) torques on the bodies (N m), zero where a body takes no loads; None if no body does.
        inputs: Further inputs that only some systems have, by name: "point_force" and "point_moment" (B, P,
            3) (N, N m), the time "t" (B,) (s), and "prescribed" (B, 3, p), the values, rates and second
            derivatives of the prescribed freedoms.
    """

    x: Floats
    y: Floats
    force: Floats | None = None
    torque: Floats | None = None
    inputs: Mapping[str, Floats] = field(default_factory=dict)

    def __len__(self) -> int:
        """Return the number of states B."""
        return len(self.x)

    @property
    def prescribed(self) -> Floats:
        """(B, 3, p) motion of the prescribed freedoms; p is 0 where there are none."""
        return self.inputs.get("prescribed", np.zeros((len(self), 3, 0)))

    def part(self, start: int, stop: int) -> Self:
        """Return the states with the indices `start` to `stop` - 1."""
        return self._mapped(lambda values: values[start:stop])

    def chosen(self, flags: Flags) -> Self:
        """Return the states whose flags (B,) are set."""
        return self._mapped(lambda values: values[flags])

    def repeated(self, count: int) -> Self:
        """Return the states, each of them `count` times in a row."""
        return self._mapped(lambda values: np.repeat(values, count, axis=0))

    def rounded(self, precision: Precision) -> Self:
        """Return the nearest states that `precision` can hold."""
        return self._mapped(lambda values: values.astype(precision.dtype).astype(np.float64))

    def _mapped(self, function: Callable[[Floats], Floats]) -> Self:
        """Return the states with `function` applied to every array."""
        arrays = {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        changed: dict[str, Any] = {name: function(value) for name, value in arrays.items()}
        inputs = {name: function(values) for name, values in self.inputs.items()}
        return replace(self, **changed, inputs=inputs)


def joined(parts: Sequence[States]) -> States:
    """Return the states of several parts of the same system, one after the other."""
    first = parts[0]
    arrays = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in ("x", "y", "force", "torque")
        if getattr(first, name) is not None
    }
    inputs = {name: np.concatenate([part.inputs[name] for part in parts]) for name in first.inputs}
    return replace(first, **arrays, inputs=inputs)


@dataclass(frozen=True)
class ActuatedStates(States):
    """B states with generalized forces.

    Attributes:
        tau: (B, n) generalized forces beside loads and gravity (N m, N).
    """

    tau: Floats = field(kw_only=True)


@dataclass(frozen=True)
class Ranges:
    """Largest magnitudes of the numbers in random states.

    Attributes:
        x: (m,) coordinates (rad, m, 1).
        size: (n,) large changes of the freedoms: a radian, or the length of the body (m).
        y: (n,) generalized speeds (rad/s, m/s).
        force: (N, 3) forces on the bodies (N); 0 where a body takes no loads.
        torque: (N, 3) torques on the bodies (N m); 0 where a body takes no loads.
        inputs: Further inputs by name, as in `States` without B.
    """

    x: Floats
    size: Floats
    y: Floats
    force: Floats
    torque: Floats
    inputs: Mapping[str, Floats]


def ranges(system: System | SystemArrays) -> Ranges:
    """Return the ranges of a system: half a turn for angles, 1 for quaternions, else the scale of a body."""
    arrays = system.values() if isinstance(system, System) else system
    size, acceleration, mass = _lengths(arrays), _acceleration(arrays), _masses(arrays)
    rate = np.sqrt(acceleration / size)
    free = free_columns(arrays)
    lengths = np.repeat(size, 3)[arrays.free[:, 3:].ravel()]
    turning = [
        np.full(free[:3].sum(), np.pi)
        if rotation.coordinates == ANGLES
        else np.ones(len(rotation.coordinates))
        for rotation, free in zip(arrays.rotations, arrays.free, strict=True)
    ]
    weight = np.where(arrays.loads, mass, 0.0) * acceleration
    of_points = [k - 1 for k, _ in arrays.forces.points.values()]
    at_points = np.where(arrays.forces.loaded, mass[of_points] * acceleration, 0.0)
    columns = prescribed_columns(arrays)
    moved = [np.concatenate([np.full_like(size, np.pi), size])]
    moved += [np.concatenate([rate**power, rate**power * size]) for power in (1, 2)]
    inputs = {
        "point_force": np.tile(at_points[:, None], 3),
        "point_moment": np.tile((at_points * size[of_points])[:, None], 3),
        "t": np.array(PERIODS * np.sqrt(size.max() / acceleration)),
        "prescribed": np.stack([np.repeat(each, 3)[columns] for each in moved]),
    }
    return Ranges(
        x=np.concatenate([*turning, lengths]),
        size=np.concatenate([np.ones(arrays.free[:, :3].sum()), lengths]),
        y=np.repeat(np.concatenate([rate, rate * size]), 3)[free],
        force=np.tile(weight[:, None], 3),
        torque=np.tile((weight * size)[:, None], 3),
        inputs={name: inputs[name] for name in _input_names(arrays)},
    )


def _input_names(arrays: SystemArrays) -> Iterator[str]:
    """Yield the names of the further inputs that a system has."""
    if arrays.forces.loaded.any():
        yield from ("point_force", "point_moment")
    if any(
        TIME in expression.variables
        for element in arrays.forces.elements
        for expression in element.expressions()
    ):
        yield "t"
    if arrays.prescribed.any():
        yield "prescribed"


def random_states(
    system: System | SystemArrays, count: int, seed: int = 0, limits: SystemLimits | None = None
) -> States:
    """Return `count` random states.

    Angles are uniform over (-pi, pi), elements of quaternions over (-1, 1), and everything else over (-1,
    1) times the scale of its body. States near gimbal lock are not avoided: [A] is singular there, but [A]
    and {f} are smooth. A program that solves with [A] needs other states.

    Args:
        system: The tree; parameters stand at their defaults.
        count: Number of states B.
        seed: Seed of the generator.
        limits: Limits within which coordinates and speeds stay, uniform over their ranges; None for none.

    Example:
        >>> states = random_states(kg.load("models/double_pendulum.toml"), 100)
        >>> states.x.shape
        (100, 2)
    """
    arrays = system.values() if isinstance(system, System) else system
    rng, largest = np.random.default_rng(seed), ranges(arrays)
    x, y = _uniform(rng, count, largest.x), _uniform(rng, count, largest.y)
    if limits is not None:
        x, y = _within(limits, x, largest.x), y * (limits.speeds(largest.y) / largest.y)
    force = torque = None
    if arrays.loads.any():
        force, torque = _uniform(rng, count, largest.force), _uniform(rng, count, largest.torque)
    inputs = {name: _uniform(rng, count, scale) for name, scale in largest.inputs.items()}
    return States(x, y, force, torque, inputs)


def states_away_from_gimbal_lock(system: System, count: int, seed: int = 0) -> ActuatedStates:
    """Return `count` random states in which the accelerations of different programs can be compared.

    Coordinates, speeds and efforts with limits are uniform over their ranges, other angles of hinges over
    (-pi, pi), all other numbers over (-1, 1). Where a body has three free angles without limits, these stay
    away from gimbal lock, in which [A] is singular.

    Args:
        system: The tree, without loads.
        count: Number of states B.
        seed: Seed of the generator.
    """
    rng = np.random.default_rng(seed)
    x, y, tau = rng.uniform(-1, 1, (3, count, len(system.freedoms)))
    joints = [system.bodies[freedom.body - 1].joint for freedom in system.freedoms]
    pairs = list(zip(system.freedoms, joints, strict=True))
    hinges = [freedom.is_angle and not joint.has_free_orientation for freedom, joint in pairs]
    bent = [freedom.index == 1 and joint.gimbal_lock == "sin" for freedom, joint in pairs]
    half = np.where(hinges, np.pi, 1.0)
    limits, one = system.limits, np.ones(len(system.freedoms))
    x = _within(limits, x * half, half, np.pi / 2 * np.array(bent))
    return ActuatedStates(x, limits.speeds(one) * y, tau=limits.efforts(one) * tau)


def _uniform(rng: np.random.Generator, count: int, scale: Floats) -> Floats:
    """Return `count` arrays of numbers that are uniform over (-1, 1) times `scale`."""
    values: Floats = rng.uniform(-1.0, 1.0, (count, *scale.shape)) * scale
    return values


def _within(limits: SystemLimits, x: Floats, half: Floats, middle: Floats | float = 0.0) -> Floats:
    """Return coordinates, uniform over the ranges of limits where there are some, else about `middle`.

    Args:
        limits: The limits.
        x: (B, m) numbers that are uniform over -`half` to `half`.
        half: (m,) half of the ranges.
        middle: (m,) middles of the ranges without limits.
    """
    low, high = limits.positions(middle - half, middle + half)
    limited = np.isfinite(limits.lower) | np.isfinite(limits.upper)
    inside = np.clip((low + high) / 2 + x / half * ((high - low) / 2), low, high)
    return np.where(limited, inside, x + middle)


def _lengths(arrays: SystemArrays) -> Floats:
    """Return the (N,) lengths of the bodies: the largest of the arms and the radius of gyration (m).

    A body without length has the mean of the others, or 1 m. The place at which a body is joined to the
    ground does not matter to the motion, so it does not count.
    """
    on_a_body = arrays.connection[:, None] > 0
    arms = [arrays.mass_center, on_a_body * arrays.joint_position, on_a_body * arrays.locked[:, 3:]]
    trace = np.trace(arrays.inertia, axis1=1, axis2=2)
    gyration = np.sqrt(trace / np.where(arrays.mass > 0, arrays.mass, np.inf))
    return _filled(np.max([gyration, *(length(arm) for arm in arms)], axis=0))


def _masses(arrays: SystemArrays) -> Floats:
    """Return the (N,) masses; a body without mass has the mean of the others, or 1 kg."""
    return _filled(arrays.mass)


def _filled(values: Floats) -> Floats:
    """Return `values` with zeros replaced by the mean of the others, or by 1 if all are zero."""
    positive = values[values > 0]
    filled: Floats = np.where(values > 0, values, positive.mean() if positive.size else 1.0)
    return filled


def _acceleration(arrays: SystemArrays) -> float:
    """Return the magnitude of gravity (m/s^2), that of the Earth where the system has none."""
    return float(length(arrays.gravity) or STANDARD_GRAVITY)
