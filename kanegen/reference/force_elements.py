"""Force elements and loads on points by the notes' partial velocities, to check generated code against.

A force at a point P adds [v_P,y]^T {F} to the generalized forces, a moment [omega_y]^T {M}, Eq. (37); all in
inertial components.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import SystemArrays
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.force_elements.elements import Drive, End, JointSpring, PointLoad, Potential, Spring
from kanegen.model.force_elements.expression import TIME, Expression
from kanegen.model.numbers import Number, value_of
from kanegen.reference import expressions
from kanegen.reference.arguments import Acting
from kanegen.reference.freedoms import by_body, column
from kanegen.reference.kinematics import BodyKinematics
from kanegen.reference.matrices import Numbers, apply, length, skew, transposed

Sized = tuple[Numbers, Numbers]
"""Numbers, and the size of what they are rounded by."""


@dataclass(frozen=True)
class Contribution:
    """A part of {F_y}, (..., 6N) in the order of Eq. (1), and the size of what it is rounded by."""

    value: Numbers
    size: Numbers


def contributions(
    system: SystemArrays,
    bodies: Sequence[BodyKinematics],
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
    scene = _Scene(system, bodies, speeds, _variables(system, coordinates, speeds, acting.t))
    for element in system.forces.elements:
        match element:
            case JointSpring():
                yield scene.hinged(element)
            case Drive(name, effort):
                yield scene.on_freedom(f"y.{name}", scene.value(effort))
            case Potential(energy):
                yield from scene.falling(energy)
            case Spring():
                yield scene.tied(element)
            case PointLoad(name, force, moment):
                yield scene.loaded(name, scene.vector(force), scene.vector(moment))
    for number, name in enumerate(system.forces.points):
        push, twist = acting.force[..., number, :], acting.moment[..., number, :]
        yield scene.loaded(name, (push, push), (twist, twist))


def _variables(
    system: SystemArrays, coordinates: tuple[Numbers, Numbers], speeds: Numbers, t: Numbers
) -> dict[str, Numbers]:
    """The values of all names."""
    orientations, translations = by_body(system, *coordinates)
    found: dict[str, Numbers] = {TIME: t}
    for name, (k, index) in system.forces.variables.items():
        if name.startswith("y."):
            found[name] = speeds[..., column(system, k, index)]
        elif index in range(3, len(FREEDOMS)):
            found[name] = translations[k - 1][..., index - 3]
        else:  # the elements of a quaternion are counted behind all freedoms
            found[name] = orientations[k - 1][..., index % len(FREEDOMS)]
    return found


@dataclass(frozen=True)
class _Scene:
    """A system in some states.

    Attributes:
        system: The numbers of the tree.
        bodies: Their kinematics.
        speeds: (..., 6N) in the order of Eq. (1).
        variables: What the names in expressions stand for.
    """

    system: SystemArrays
    bodies: Sequence[BodyKinematics]
    speeds: Numbers
    variables: Mapping[str, Numbers]

    def value(self, expression: Expression) -> Sized:
        """An expression."""
        return expressions.value(expression, self.variables)

    def vector(self, components: Sequence[Expression]) -> Sized:
        """Three expressions as (..., 3)."""
        shape, parts = self.speeds.shape[:-1], zip(*map(self.value, components), strict=True)
        value, size = (np.stack([np.broadcast_to(one, shape) for one in three], axis=-1) for three in parts)
        return value, size

    def on_freedom(self, name: str, effort: Sized) -> Contribution:
        """An effort at the freedom of a coordinate or a speed."""
        place, (value, size) = column(self.system, *self.system.forces.variables[name]), effort
        values = np.zeros(self.speeds.shape, np.result_type(self.speeds, value))
        sizes = np.zeros(self.speeds.shape)
        values[..., place], sizes[..., place] = value, size
        return Contribution(values, sizes)

    def hinged(self, spring: JointSpring) -> Contribution:
        """A spring on a freedom."""
        stiffness, rest, damping = map(value_of, (spring.stiffness, spring.rest, spring.damping))
        stretch = self.variables[f"x.{spring.freedom}"] - rest
        drag = damping * self.variables[f"y.{spring.freedom}"]
        size = abs(stiffness) * (np.abs(stretch) + abs(rest)) + np.abs(drag)
        return self.on_freedom(f"x.{spring.freedom}", (-stiffness * stretch - drag, size))

    def falling(self, energy: Expression) -> Iterator[Contribution]:
        """The negative gradient of an energy."""
        for name in energy.variables:
            slope, size = expressions.slope(energy, self.variables, name)
            yield self.on_freedom(name, (-slope, size))

    def loaded(self, point: str, force: Sized, moment: Sized) -> Contribution:
        """A force at a point and a moment on its body."""
        at = self._place(point)
        turning = norm(at.omega_y, -2)
        return Contribution(
            apply(transposed(at.velocity_y), force[0]) + apply(transposed(at.omega_y), moment[0]),
            norm(force[1])[..., None] * (norm(at.velocity_y, -2) + at.reach[..., None] * turning)
            + norm(moment[1])[..., None] * turning,
        )

    def tied(self, spring: Spring) -> Contribution:
        """A spring between two points."""
        one, two = map(self._place, spring.between)
        stiffness, rest, damping = map(value_of, (spring.stiffness, spring.rest_length, spring.damping))
        way, rate = two.position - one.position, two.velocity - one.velocity
        distance = np.sqrt((way * way).sum(axis=-1))
        direction = way / distance[..., None]
        pull = stiffness * (distance - rest) + damping * (direction * rate).sum(axis=-1)
        velocity_y = one.velocity_y - two.velocity_y
        # The way is off by the roundoff of both positions, which also turns it.
        off = one.reach + two.reach
        turned = 1 + off / np.abs(distance)
        drag = abs(damping) * (np.abs(rate).sum(axis=-1) + norm(self.speeds) * off) * turned
        force = abs(stiffness) * (off + abs(rest) * turned) + drag
        arms = norm(one.velocity_y, -2) + norm(two.velocity_y, -2) + off[..., None] * self._turning
        return Contribution(
            apply(transposed(velocity_y), pull[..., None] * direction), force[..., None] * arms
        )

    @property
    def _turning(self) -> Numbers:
        """(..., 6N) how much each freedom turns any body at most."""
        turning: Numbers = np.max([norm(body.omega_y, -2) for body in self.bodies], axis=0)
        return turning

    def _place(self, end: End) -> Place:
        if not isinstance(end, str):
            return on_ground(end, self.speeds)
        return on_body(self.system, self.bodies, self.speeds, *self.system.forces.points[end])


@dataclass(frozen=True)
class Place:
    """A point and what carries it.

    Attributes:
        position: (..., 3) from the inertial origin (m).
        velocity: (..., 3) of it (m/s).
        velocity_y: (..., 3, 6N) its partial velocities.
        omega_y: (..., 3, 6N) the partial angular velocities of its body.
        reach: (...) the way to it along the tree (m), by which its position is rounded.
    """

    position: Numbers
    velocity: Numbers
    velocity_y: Numbers
    omega_y: Numbers
    reach: Numbers


def on_body(
    system: SystemArrays, bodies: Sequence[BodyKinematics], speeds: Numbers, k: int, arm: Numbers
) -> Place:
    """A point of a body.

    Args:
        system: The numbers of the tree.
        bodies: Their kinematics.
        speeds: (..., 6N) in the order of Eq. (1).
        k: Number of the body, from 1.
        arm: (3,) from its origin, in its components (m).
    """
    body = bodies[k - 1]
    out = transposed(body.rotation)
    velocity_y = out @ (body.relative_rotation @ body.origin_y - skew(arm) @ body.omega_y)
    reach = np.zeros(speeds.shape[:-1])
    while k:
        reach = reach + norm(bodies[k - 1].offset)
        k = int(system.connection[k - 1])
    return Place(
        position=apply(out, body.position + arm),
        velocity=apply(velocity_y, speeds),
        velocity_y=velocity_y,
        omega_y=out @ body.omega_y,
        reach=reach + norm(arm),
    )


def on_ground(position: Sequence[Number], speeds: Numbers) -> Place:
    """A place of the ground, where nothing moves; its parameters stand at their defaults."""
    at = np.array([value_of(value) for value in position])
    still = np.zeros((*speeds.shape[:-1], 3), speeds.dtype)
    columns = np.zeros((*still.shape, speeds.shape[-1]), speeds.dtype)
    return Place(still + at, still, columns, columns, still[..., 0].real + norm(at))


def norm(vectors: Numbers, axis: int = -1) -> Numbers:
    """Lengths, of complex vectors too, which carry derivatives."""
    return length(np.abs(vectors), axis)
