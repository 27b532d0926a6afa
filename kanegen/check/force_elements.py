"""Force elements and loads on points by the notes' partial velocities, to check generated code against.

A force at a point P adds [v_P,y]^T {F} to the generalized forces, a moment [omega_y]^T {M}, Eq. (37); all in
inertial components.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.arrays import SystemArrays
from kanegen.body import FREEDOMS
from kanegen.check.expressions import Dual, Rounded, evaluate
from kanegen.check.kinematics import BodyKinematics, by_body
from kanegen.check.matrices import Numbers, apply, length, skew, transposed
from kanegen.force_elements import Drive, Expression, JointSpring, PointLoad, Potential, Spring
from kanegen.force_elements.expression import TIME
from kanegen.numbers import value_of


@dataclass(frozen=True)
class Acting:
    """What acts on the points, and the time.

    Attributes:
        force: (..., P, 3) inertial components (N).
        moment: (..., P, 3) inertial components (N m).
        t: (...) s.
    """

    force: Numbers
    moment: Numbers
    t: Numbers


@dataclass(frozen=True)
class Contribution:
    """A part of {F_y}, (..., 6N) in the order of Eq. (1), and the size of what it is rounded by."""

    value: Numbers
    size: Numbers


@dataclass(frozen=True)
class _Seen:
    """A point in inertial components: position (m), velocity (m/s), partial velocities (..., 3, 6N)."""

    position: Numbers
    velocity: Numbers
    velocity_y: Numbers
    reach: Numbers


def contributions(
    system: SystemArrays,
    bodies: tuple[BodyKinematics, ...],
    coordinates: tuple[Numbers, Numbers],
    speeds: Numbers,
    acting: Acting,
) -> Iterator[Contribution]:
    """What each element and each loaded point adds.

    Args:
        system: The numbers of the tree.
        bodies: Their kinematics.
        coordinates: (..., m) those in {x}, and (..., p) those that are prescribed.
        speeds: (..., 6N) in the order of Eq. (1).
        acting: Loads on points, and the time.
    """
    scene = _Scene(system, bodies, _variables(system, coordinates, speeds, acting.t), speeds)
    for element in system.forces.elements:
        match element:
            case JointSpring(name, stiffness, rest, damping):
                stretch = scene.variables[f"x.{name}"] - value_of(rest)
                rate = scene.variables[f"y.{name}"]
                pull, drag = value_of(stiffness) * stretch, value_of(damping) * rate
                size = abs(value_of(stiffness)) * (np.abs(stretch) + abs(value_of(rest))) + np.abs(drag)
                yield scene.on_freedom(f"x.{name}", -pull - drag, size)
            case Drive(name, effort):
                yield scene.on_freedom(f"y.{name}", *scene.value(effort))
            case Potential(energy):
                yield from scene.slopes(energy)
            case Spring():
                yield scene.tied(element)
            case PointLoad(name, force, moment):
                yield scene.loaded(name, *(scene.vector(of) for of in (force, moment)))
    for number, name in enumerate(system.forces.points):
        yield scene.loaded(name, *((v[..., number, :],) * 2 for v in (acting.force, acting.moment)))


@dataclass(frozen=True)
class _Scene:
    """A system in some states."""

    system: SystemArrays
    bodies: tuple[BodyKinematics, ...]
    variables: Mapping[str, Numbers]
    speeds: Numbers

    def value(self, expression: Expression) -> tuple[Numbers, Numbers]:
        """An expression, and the size of its rounding."""
        rounded = {name: Rounded(value, 0 * np.abs(value)) for name, value in self.variables.items()}
        found = evaluate(expression, rounded, lambda number: Rounded(number, 0.0))
        exact = evaluate(expression, self.variables, lambda number: number)
        return exact, found.error

    def vector(self, components: tuple[Expression, ...]) -> tuple[Numbers, Numbers]:
        """Three expressions as (..., 3), and the size of their rounding."""
        shape, values = self.speeds.shape[:-1], [self.value(component) for component in components]
        value, size = (
            np.stack([np.broadcast_to(part, shape) for part in parts], axis=-1)
            for parts in zip(*values, strict=True)
        )
        return value, size

    def slopes(self, energy: Expression) -> Iterator[Contribution]:
        """The negative gradient of an energy."""
        for name in energy.variables:
            exact = {n: Dual(v, 1.0 * (n == name)) for n, v in self.variables.items()}
            found = evaluate(energy, exact, lambda number: Dual(number, 0.0)).slope
            rounded = {
                n: Dual(Rounded(v, 0.0), Rounded(1.0 * (n == name), 0.0)) for n, v in self.variables.items()
            }
            size = evaluate(energy, rounded, _steady).slope.error
            yield self.on_freedom(name, -found, size)

    def on_freedom(self, name: str, effort: Numbers, size: Numbers) -> Contribution:
        """An effort at a coordinate or a speed."""
        k, index = self.system.forces.variables[name]
        kind, axis = divmod(index, 3)
        place = 3 * (kind * len(self.bodies) + k - 1) + axis
        value, sizes = np.zeros_like(self.speeds), np.zeros(self.speeds.shape)
        value = value.astype(np.result_type(value, effort))
        value[..., place], sizes[..., place] = effort, size
        return Contribution(value, sizes)

    def loaded(
        self, point: str, force: tuple[Numbers, Numbers], moment: tuple[Numbers, Numbers]
    ) -> Contribution:
        """A force at a point and a moment on its body, each with the size of its rounding."""
        k, arm = self.system.forces.points[point]
        seen, omega_y = self._seen(k, arm), self._turning(k)
        value = apply(transposed(seen.velocity_y), force[0]) + apply(transposed(omega_y), moment[0])
        size = _size(force[1])[..., None] * (
            _size(seen.velocity_y, -2) + seen.reach[..., None] * _size(omega_y, -2)
        )
        return Contribution(value, size + _size(moment[1])[..., None] * _size(omega_y, -2))

    def tied(self, spring: Spring) -> Contribution:
        """A spring between two points."""
        one, two = (
            self._seen(*self.system.forces.points[end]) if isinstance(end, str) else self._fixed(end)
            for end in spring.between
        )
        stiffness, rest, damping = map(value_of, (spring.stiffness, spring.rest_length, spring.damping))
        way, rate = two.position - one.position, two.velocity - one.velocity
        distance = np.sqrt((way * way).sum(axis=-1))
        direction = way / distance[..., None]
        pull = stiffness * (distance - rest) + damping * (direction * rate).sum(axis=-1)
        velocity_y = one.velocity_y - two.velocity_y
        value = apply(transposed(velocity_y), pull[..., None] * direction)
        # The way is off by the roundoff of both positions, which also turns it.
        off = one.reach + two.reach
        drag = (
            abs(damping)
            * (np.abs(rate).sum(axis=-1) + _size(self.speeds) * off)
            * (1 + off / np.abs(distance))
        )
        size = abs(stiffness) * (off + abs(rest) * (1 + off / np.abs(distance))) + drag
        lengths = _size(one.velocity_y, -2) + _size(two.velocity_y, -2)
        return Contribution(value, size[..., None] * (lengths + off[..., None] * self._turned))

    @property
    def _turned(self) -> Numbers:
        """(..., 6N) how much each freedom turns any body at most."""
        turned: Numbers = np.max([_size(body.omega_y, -2) for body in self.bodies], axis=0)
        return turned

    def _turning(self, k: int) -> Numbers:
        body = self.bodies[k - 1]
        turning: Numbers = transposed(body.rotation) @ body.omega_y
        return turning

    def _seen(self, k: int, arm: Numbers) -> _Seen:
        """A point of body `k`."""
        body = self.bodies[k - 1]
        out = transposed(body.rotation)
        velocity_y = out @ (body.relative_rotation @ body.origin_y - skew(arm) @ body.omega_y)
        position = apply(out, body.position + arm)
        return _Seen(position, apply(velocity_y, self.speeds), velocity_y, self._reach(k) + _size(arm))

    def _reach(self, k: int) -> Numbers:
        """How far it is to O of body `k` along the tree."""
        reach = np.zeros(self.speeds.shape[:-1])
        while k:
            reach = reach + _size(self.bodies[k - 1].offset)
            k = int(self.system.connection[k - 1])
        return reach

    def _fixed(self, position: Any) -> _Seen:
        """A place of the ground."""
        at = np.array([value_of(value) for value in position])
        still = np.zeros((*self.speeds.shape[:-1], 3), self.speeds.dtype)
        columns = np.zeros((*still.shape, self.speeds.shape[-1]), self.speeds.dtype)
        return _Seen(still + at, still, columns, still[..., 0].real + _size(at))


def _size(vectors: Numbers, axis: int = -1) -> Numbers:
    """Lengths, of complex vectors too, which carry derivatives."""
    return length(np.abs(vectors), axis)


def _steady(number: float) -> Dual:
    return Dual(Rounded(number, 0.0), Rounded(0.0, 0.0))


def _variables(
    system: SystemArrays, coordinates: tuple[Numbers, Numbers], speeds: Numbers, t: Numbers
) -> dict[str, Numbers]:
    """The values of all names."""
    orientations, translations = by_body(system, *coordinates)
    found: dict[str, Numbers] = {TIME: t}
    for name, (k, index) in system.forces.variables.items():
        kind, axis = divmod(index, 3) if index < len(FREEDOMS) else (0, index - len(FREEDOMS))
        if name.startswith("x."):
            found[name] = (orientations, translations)[kind][k - 1][..., axis]
        else:
            found[name] = speeds[..., 3 * (kind * len(system.mass) + k - 1) + axis]
    return found
