"""First algorithm: [A] and {f} by partial velocities, in the inertial frame.

Every freedom is an axis in space. The partial angular velocity of a body that an angle turns is the axis
itself, and the partial velocity of its mass centre is the axis times the arm from it; a translation has no
partial angular velocity, and its axis is the partial velocity. These and their time derivatives go into
Eqs. (36)-(44) as they stand, with all vectors resolved in the inertial frame.
"""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.measure.truth.balls import arb_mat, beside, cross, identity, stacked, unit, zeros
from kanegen.measure.truth.tree import Link, Tree, rotations_along


@dataclass(frozen=True)
class Axis:
    """A free freedom in space; vectors are (3, 1), inertial components.

    Attributes:
        place: In {x}.
        direction: Unit vector.
        direction_dot: Its rate.
        point: O_K, about which an angle turns; None for a translation.
        point_dot: Its velocity.
    """

    place: int
    direction: arb_mat
    direction_dot: arb_mat
    point: arb_mat | None
    point_dot: arb_mat


@dataclass(frozen=True)
class Frame:
    """A body in space: rotation from inertial to body components, origin, and the axes that move it."""

    rotation: arb_mat
    omega: arb_mat
    origin: arb_mat
    origin_dot: arb_mat
    axes: tuple[Axis, ...]


@dataclass(frozen=True)
class Equations:
    """[A] and the parts of {f}, in balls.

    Attributes:
        A: (n, n) Eq. (43).
        loads: (n, 1) what applied forces and torques add to {f}.
        gravity: (n, 1) what gravity adds.
        velocity: (n, 1) what is left: inertia at constant speeds, with its sign in {f}.
    """

    A: arb_mat
    loads: arb_mat
    gravity: arb_mat
    velocity: arb_mat

    @property
    def f(self) -> arb_mat:
        """(n, 1) Eq. (44)."""
        return self.loads + self.gravity + self.velocity


def equations(tree: Tree) -> Equations:
    """[A] and {f} of a tree in its state."""
    nothing, n = zeros(3, 1), tree.freedoms
    frames = [Frame(identity(3), nothing, nothing, nothing, ())]
    matrix, forces = zeros(n, n), zeros(n, 3)
    for link in tree.links:
        frame = _frame(link, frames[link.lower])
        frames.append(frame)
        own_matrix, own_forces = _contribution(link, frame, tree)
        matrix += own_matrix
        forces += own_forces
    loads, gravity, velocity = (arb_mat(n, 1, forces.entries()[i::3]) for i in range(3))
    return Equations(matrix, loads, gravity, velocity)


def _frame(link: Link, lower: Frame) -> Frame:
    """Body K from its lower body: first the translation, then one turn after the other."""
    joint = link.orientation * lower.rotation
    arm = lower.rotation.transpose() * link.position + joint.transpose() * link.translation
    origin = lower.origin + arm
    slide = joint.transpose() * link.translation_rates
    origin_dot = lower.origin_dot + cross(lower.omega, arm) + slide
    axes = [*lower.axes]
    for i in range(3):
        direction, place = joint.transpose() * unit(i), link.places[3 + i]
        if place is not None:
            axes.append(Axis(place, direction, cross(lower.omega, direction), None, zeros(3, 1)))
    turns = rotations_along(link)
    rotations = [turn * joint for turn in turns]
    directions, carriers = _directions(link, rotations, lower.omega)
    for direction, carrier, place in zip(directions, carriers, link.places, strict=False):
        if place is not None:
            axes.append(Axis(place, direction, cross(carrier, direction), origin, origin_dot))
    return Frame(rotations[3], carriers[3], origin, origin_dot, tuple(axes))


def _directions(link: Link, rotations: list[arb_mat], omega: arb_mat) -> tuple[list[arb_mat], list[arb_mat]]:
    """Three axes about which body K turns on its lower body, and angular velocities.

    These are of what carries each axis, and last of the body. An angle's axis is carried by the turns before
    it; the axis of a component of the relative angular velocity by the body.
    """
    frames = [0, 1, 2] if link.speeds_are_rates else [3, 3, 3]
    units = link.axes if link.speeds_are_rates else [0, 1, 2]
    directions = [rotations[f].transpose() * unit(axis) for f, axis in zip(frames, units, strict=True)]
    carriers = [omega]
    for direction, rate in zip(directions, link.rates.entries(), strict=True):
        carriers.append(carriers[-1] + direction * rate)
    return directions, [carriers[f] for f in (*frames, 3)]


def _contribution(link: Link, frame: Frame, tree: Tree) -> tuple[arb_mat, arb_mat]:
    """Body K's parts of Eqs. (43) and (44): (n, n), and (n, 3) of loads, gravity and velocities."""
    outward = frame.rotation.transpose()
    lever = outward * link.center
    center, center_dot = frame.origin + lever, frame.origin_dot + cross(frame.omega, lever)
    v_y, v_y_dot, w_y, w_y_dot = _partials(frame, center, center_dot, tree.freedoms)
    inertia = outward * link.inertia * frame.rotation
    momentum = inertia * frame.omega
    matrix = v_y.transpose() * v_y * link.mass + w_y.transpose() * (inertia * w_y)  # (43)
    force = beside(
        [outward * link.force, tree.gravity * link.mass, -(v_y_dot * tree.speeds) * link.mass]  # (37), (39)
    )
    gyroscopic = inertia * (w_y_dot * tree.speeds) + cross(frame.omega, momentum)  # (40), (41)
    torque = beside([outward * link.torque, zeros(3, 1), -gyroscopic])
    return matrix, v_y.transpose() * force + w_y.transpose() * torque  # (44)


def _partials(
    frame: Frame, center: arb_mat, center_dot: arb_mat, freedoms: int
) -> tuple[arb_mat, arb_mat, arb_mat, arb_mat]:
    """(3, n) partial velocities of G_K, their rates, partial angular velocities, their rates."""
    rows = {name: [zeros(1, 3)] * freedoms for name in ("v", "v_dot", "w", "w_dot")}
    for axis in frame.axes:
        v, v_dot, w, w_dot = axis.direction, axis.direction_dot, zeros(3, 1), zeros(3, 1)
        if axis.point is not None:
            arm, arm_dot = center - axis.point, center_dot - axis.point_dot
            w, w_dot = v, v_dot
            v, v_dot = cross(w, arm), cross(w_dot, arm) + cross(w, arm_dot)
        for name, vector in (("v", v), ("v_dot", v_dot), ("w", w), ("w_dot", w_dot)):
            rows[name][axis.place] = vector.transpose()
    v_y, v_y_dot, w_y, w_y_dot = (stacked(rows[name]).transpose() for name in rows)
    return v_y, v_y_dot, w_y, w_y_dot
