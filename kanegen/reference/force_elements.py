"""Force elements and loads on points, by the partial velocities of the notes.

A force at a point P adds [v_P,y]^T {F} to the generalized forces, a moment [omega_y]^T {M}, Eq. (37); both
are in inertial components. Beside every contribution stands the magnitude of its terms, to which rounding
errors are relative. In shapes, `...` is the batch: nothing, or (B,).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import SystemArrays
from kanegen.model.coordinates import TRANSLATIONS
from kanegen.model.expression import Expression
from kanegen.model.force_elements.elements import (
    Drive,
    End,
    JointFriction,
    JointSpring,
    PointLoad,
    Potential,
    Spring,
)
from kanegen.model.nodes import TIME
from kanegen.model.numbers import Number, value_of
from kanegen.reference import expressions
from kanegen.reference.arguments import PointInputs
from kanegen.reference.freedoms import column, orientations_and_translations
from kanegen.reference.kinematics import BodyKinematics
from kanegen.reference.matrices import Numbers, apply, length, skew, transposed

ValueAndMagnitude = tuple[Numbers, Numbers]
"""Numbers, and the magnitudes to which their rounding errors are relative."""


@dataclass(frozen=True)
class Contribution:
    """A contribution to the generalized forces, in the order of Eq. (1).

    Attributes:
        value: (..., 6N) generalized forces.
        magnitude: (..., 6N) magnitudes to which their rounding errors are relative.
    """

    value: Numbers
    magnitude: Numbers


@dataclass(frozen=True)
class PointKinematics:
    """A point of a body or of the ground, in inertial components.

    Attributes:
        position: (..., 3) position from the inertial origin (m).
        velocity: (..., 3) velocity (m/s).
        velocity_y: (..., 3, 6N) partial velocities of the point.
        omega_y: (..., 3, 6N) partial angular velocities of its body.
        path_length: (...) length of the path to it along the tree (m), to which the rounding of its position
            is relative.
    """

    position: Numbers
    velocity: Numbers
    velocity_y: Numbers
    omega_y: Numbers
    path_length: Numbers


def contributions(
    system: SystemArrays,
    bodies: Sequence[BodyKinematics],
    coordinates: tuple[Numbers, Numbers],
    speeds: Numbers,
    point_inputs: PointInputs,
) -> Iterator[Contribution]:
    """Yield the contribution of each force element and of each loaded point.

    Args:
        system: The numbers of the tree.
        bodies: Kinematics of the bodies.
        coordinates: (..., m) coordinates {x}, and (..., p) values of the prescribed freedoms.
        speeds: (..., 6N) speeds in the order of Eq. (1).
        point_inputs: Loads on points, and the time.
    """
    state = _State(system, bodies, speeds, variables(system, coordinates, speeds, point_inputs.t))
    for element in system.forces.elements:
        match element:
            case JointSpring():
                yield state.joint_spring(element)
            case Drive(freedom=name, effort=effort) | JointFriction(freedom=name, effort=effort):
                yield state.on_freedom(f"y.{name}", state.value(effort))
            case Potential(energy):
                yield from state.potential(energy)
            case Spring():
                yield state.spring(element)
            case PointLoad(name, force, moment, frame):
                load = state.vector(force), state.vector(moment)
                yield state.point_load(name, *(state.inertial(vector, frame) for vector in load))
    for number, name in enumerate(system.forces.points):
        loads = point_inputs.force[..., number, :], point_inputs.moment[..., number, :]
        frame = system.forces.load_frames[number]
        yield state.point_load(name, *(state.inertial((vector, vector), frame) for vector in loads))


def point_on_body(
    system: SystemArrays, bodies: Sequence[BodyKinematics], speeds: Numbers, k: int, arm: Numbers
) -> PointKinematics:
    """Return the kinematics of a point of a body.

    Args:
        system: The numbers of the tree.
        bodies: Kinematics of the bodies.
        speeds: (..., 6N) speeds in the order of Eq. (1).
        k: Number of the body, from 1.
        arm: (3,) position of the point from the body's origin, in body components (m).
    """
    body = bodies[k - 1]
    to_inertial = transposed(body.rotation)
    velocity_y = to_inertial @ (body.relative_rotation @ body.origin_y - skew(arm) @ body.omega_y)
    path_length = np.zeros(speeds.shape[:-1])
    while k:
        path_length = path_length + norm(bodies[k - 1].offset)
        k = int(system.connection[k - 1])
    return PointKinematics(
        position=apply(to_inertial, body.position + arm),
        velocity=apply(velocity_y, speeds),
        velocity_y=velocity_y,
        omega_y=to_inertial @ body.omega_y,
        path_length=path_length + norm(arm),
    )


def point_on_ground(position: Sequence[Number] | Numbers, speeds: Numbers) -> PointKinematics:
    """Return the kinematics of a point of the ground, at rest; parameters stand at their defaults."""
    at = np.array([value_of(value) for value in position])
    still = np.zeros((*speeds.shape[:-1], 3), speeds.dtype)
    columns = np.zeros((*still.shape, speeds.shape[-1]), speeds.dtype)
    return PointKinematics(still + at, still, columns, columns, still[..., 0].real + norm(at))


def norm(vectors: Numbers, axis: int = -1) -> Numbers:
    """Return the lengths of vectors, which may be complex where they carry derivatives."""
    return length(np.abs(vectors), axis)


def variables(
    system: SystemArrays, coordinates: tuple[Numbers, Numbers], speeds: Numbers, t: Numbers
) -> dict[str, Numbers]:
    """Return the values of all names that expressions may use.

    Args:
        system: The numbers of the tree.
        coordinates: (..., m) coordinates {x}, and (..., p) values of the prescribed freedoms.
        speeds: (..., 6N) speeds in the order of Eq. (1).
        t: (...) time (s).
    """
    orientations, translations = orientations_and_translations(system, *coordinates)
    found: dict[str, Numbers] = {TIME: t}
    for name, (k, index) in system.forces.variables.items():
        if name.startswith("y."):
            found[name] = speeds[..., column(system, k, index)]
        elif index in TRANSLATIONS:
            found[name] = translations[k - 1][..., TRANSLATIONS.index(index)]
        else:
            found[name] = orientations[k - 1][..., system.rotations[k - 1].coordinates.index(index)]
    return found


@dataclass(frozen=True)
class _State:
    """A system in a batch of states.

    Attributes:
        system: The numbers of the tree.
        bodies: Kinematics of the bodies.
        speeds: (..., 6N) speeds in the order of Eq. (1).
        variables: Values of the names in expressions.
    """

    system: SystemArrays
    bodies: Sequence[BodyKinematics]
    speeds: Numbers
    variables: Mapping[str, Numbers]

    def value(self, expression: Expression) -> ValueAndMagnitude:
        """Return the value of an expression and its magnitude."""
        return expressions.value(expression, self.variables)

    def vector(self, components: Sequence[Expression]) -> ValueAndMagnitude:
        """Return three expressions as (..., 3) values and magnitudes."""
        shape, parts = self.speeds.shape[:-1], zip(*map(self.value, components), strict=True)
        value, magnitude = (
            np.stack([np.broadcast_to(one, shape) for one in three], axis=-1) for three in parts
        )
        return value, magnitude

    def inertial(self, vector: ValueAndMagnitude, frame: str) -> ValueAndMagnitude:
        """Return a vector in inertial components, from those of a frame or, for "", from inertial ones."""
        if not frame:
            return vector
        fixed = self.system.frames[frame]
        to_inertial = transposed(fixed.rotation @ self.bodies[fixed.body - 1].rotation)
        return apply(to_inertial, vector[0]), vector[1]

    def on_freedom(self, name: str, effort: ValueAndMagnitude) -> Contribution:
        """Return the contribution of an effort on the freedom of a coordinate or speed."""
        place, (value, magnitude) = column(self.system, *self.system.forces.variables[name]), effort
        values = np.zeros(self.speeds.shape, np.result_type(self.speeds, value))
        magnitudes = np.zeros(self.speeds.shape)
        values[..., place], magnitudes[..., place] = value, magnitude
        return Contribution(values, magnitudes)

    def joint_spring(self, spring: JointSpring) -> Contribution:
        """Return the contribution of a spring and damper on a freedom."""
        stiffness, rest, damping = map(value_of, (spring.stiffness, spring.rest, spring.damping))
        stretch = self.variables[f"x.{spring.freedom}"] - rest
        drag = damping * self.variables[f"y.{spring.freedom}"]
        magnitude = abs(stiffness) * (np.abs(stretch) + abs(rest)) + np.abs(drag)
        return self.on_freedom(f"x.{spring.freedom}", (-stiffness * stretch - drag, magnitude))

    def potential(self, energy: Expression) -> Iterator[Contribution]:
        """Yield the negative derivatives of an energy by its variables."""
        for name in energy.variables:
            slope, magnitude = expressions.slope(energy, self.variables, name)
            yield self.on_freedom(name, (-slope, magnitude))

    def point_load(self, point: str, force: ValueAndMagnitude, moment: ValueAndMagnitude) -> Contribution:
        """Return the contribution of a force at a point and a moment on its body, Eq. (37)."""
        at = self._point(point)
        turning = norm(at.omega_y, -2)
        return Contribution(
            apply(transposed(at.velocity_y), force[0]) + apply(transposed(at.omega_y), moment[0]),
            norm(force[1])[..., None] * (norm(at.velocity_y, -2) + at.path_length[..., None] * turning)
            + norm(moment[1])[..., None] * turning,
        )

    def spring(self, spring: Spring) -> Contribution:
        """Return the contribution of a spring and damper between two points."""
        one, two = map(self._point, spring.between)
        stiffness, rest, damping = map(value_of, (spring.stiffness, spring.rest_length, spring.damping))
        span, rate = two.position - one.position, two.velocity - one.velocity
        distance = np.sqrt((span * span).sum(axis=-1))
        direction = span / distance[..., None]
        pull = stiffness * (distance - rest) + damping * (direction * rate).sum(axis=-1)
        velocity_y = one.velocity_y - two.velocity_y
        # The span has the rounding errors of both positions, which also change its direction.
        path_length = one.path_length + two.path_length
        turned = 1 + path_length / np.abs(distance)
        drag = abs(damping) * (np.abs(rate).sum(axis=-1) + norm(self.speeds) * path_length) * turned
        force = abs(stiffness) * (path_length + abs(rest) * turned) + drag
        arms = norm(one.velocity_y, -2) + norm(two.velocity_y, -2)
        arms = arms + path_length[..., None] * self._largest_turning
        return Contribution(
            apply(transposed(velocity_y), pull[..., None] * direction), force[..., None] * arms
        )

    @property
    def _largest_turning(self) -> Numbers:
        """(..., 6N) largest length of each freedom's partial angular velocity over all bodies."""
        turning: Numbers = np.max([norm(body.omega_y, -2) for body in self.bodies], axis=0)
        return turning

    def _point(self, end: End) -> PointKinematics:
        """Return the kinematics of an end of a spring: a point, a frame, or a position on the ground."""
        k, position = self.system.place(end) if isinstance(end, str) else (0, end)
        if not k:
            return point_on_ground(position, self.speeds)
        return point_on_body(self.system, self.bodies, self.speeds, k, np.asarray(position))
