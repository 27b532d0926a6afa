"""First algorithm: [A] and {f} by partial velocities, with all vectors in inertial components.

Every freedom is an axis in space. An angle turns a body about its axis: the partial angular velocity of the
body is the axis itself, and the partial velocity of its mass centre is the cross product of the axis and the
arm from it. A translation has no partial angular velocity, and its partial velocity is the axis. These and
their time derivatives go into Eqs. (36)-(44) as they stand in the notes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from kanegen.measure.truth.balls import arb, arb_mat, beside, cross, identity, stacked, unit, zeros
from kanegen.measure.truth.tree import Link, Spin, Tree, rotations_along


@dataclass(frozen=True)
class Axis:
    """The axis of a freedom in space that {y} moves; vectors are (3, 1), in inertial components.

    Attributes:
        shares: Indices in {y} with the factors by which those speeds move the freedom.
        direction: Unit vector along the axis.
        direction_dot: Time derivative of the unit vector.
        point: Origin O_K, through which the axis of an angle passes; None for a translation.
        point_dot: Velocity of this origin.
    """

    shares: Mapping[int, arb]
    direction: arb_mat
    direction_dot: arb_mat
    point: arb_mat | None
    point_dot: arb_mat


@dataclass(frozen=True)
class Frame:
    """A body in space; vectors are (3, 1), in inertial components.

    Attributes:
        rotation: (3, 3) rotation from inertial to body components.
        omega: Angular velocity of the body.
        origin: Position of its origin O_K.
        origin_dot: Velocity of this origin.
        axes: Axes of all freedoms that move the body and are not locked.
    """

    rotation: arb_mat
    omega: arb_mat
    origin: arb_mat
    origin_dot: arb_mat
    axes: tuple[Axis, ...]


@dataclass(frozen=True)
class Equations:
    """[A] and the parts of {f}, in balls.

    Attributes:
        A: (n, n) mass matrix, Eq. (43).
        loads: (n, 1) part of {f} from applied forces and torques.
        gravity: (n, 1) part of {f} from gravity.
        velocity: (n, 1) part of {f} from inertia forces at constant generalized speeds.
    """

    A: arb_mat
    loads: arb_mat
    gravity: arb_mat
    velocity: arb_mat

    @property
    def f(self) -> arb_mat:
        """(n, 1) forcing {f}, Eq. (44)."""
        return self.loads + self.gravity + self.velocity


def equations(tree: Tree) -> Equations:
    """Return [A] and {f} of a tree in its state."""
    nothing, n = zeros(3, 1), tree.freedoms
    frames = [Frame(identity(3), nothing, nothing, nothing, ())]
    matrix, forces = zeros(n, n), zeros(n, 3)
    for link in tree.links:
        frame = _frame(link, frames[link.lower])
        frames.append(frame)
        own_matrix, own_forces = _contribution(link, frame, tree)
        matrix += own_matrix
        forces += own_forces
        for shares, armature in zip(link.shares, link.armature, strict=True):
            for i, share in shares.items():
                for j, other in shares.items():
                    matrix[i, j] += share * other * armature
    for spin in tree.spins:
        own_matrix, own_forces = _contribution_of_rotor(spin, frames[spin.carrier], tree)
        matrix += own_matrix
        forces += beside([zeros(n, 1), zeros(n, 1), own_forces])
    loads, gravity, velocity = (arb_mat(n, 1, forces.entries()[i::3]) for i in range(3))
    return Equations(matrix, loads, gravity, velocity)


def _frame(link: Link, lower: Frame) -> Frame:
    """Return body K in space, from its lower body by the translation and the rotations of its joint."""
    joint = link.orientation * lower.rotation
    arm = lower.rotation.transpose() * link.position + joint.transpose() * link.translation
    origin = lower.origin + arm
    slide = joint.transpose() * link.translation_rates
    origin_dot = lower.origin_dot + cross(lower.omega, arm) + slide
    axes = [*lower.axes]
    for i in range(3):
        direction, shares = joint.transpose() * unit(i), link.shares[3 + i]
        if shares:
            axes.append(Axis(shares, direction, cross(lower.omega, direction), None, zeros(3, 1)))
    rotations = [rotation * joint for rotation in rotations_along(link)]
    directions, carriers = _directions(link, rotations, lower.omega)
    for direction, carrier, shares in zip(directions, carriers, link.shares, strict=False):
        if shares:
            axes.append(Axis(shares, direction, cross(carrier, direction), origin, origin_dot))
    return Frame(rotations[3], carriers[3], origin, origin_dot, tuple(axes))


def _directions(link: Link, rotations: list[arb_mat], omega: arb_mat) -> tuple[list[arb_mat], list[arb_mat]]:
    """Return three axes about which body K turns relative to its lower body, and four angular velocities.

    The first three angular velocities are those of the frames in which the axes are fixed, the last one is
    that of body K. The axis of an angle is fixed in the frame after the rotations before it; the axis of a
    component of the relative angular velocity is fixed in body K.

    Args:
        link: Body K and its joint.
        rotations: (3, 3) rotations from inertial components to those of the four frames of the joint.
        omega: (3, 1) angular velocity of the lower body, in inertial components.
    """
    frames = [0, 1, 2] if link.speeds_are_rates else [3, 3, 3]
    units = link.axes if link.speeds_are_rates else [0, 1, 2]
    directions = [rotations[f].transpose() * unit(axis) for f, axis in zip(frames, units, strict=True)]
    carriers = [omega]
    for direction, rate in zip(directions, link.rates.entries(), strict=True):
        carriers.append(carriers[-1] + direction * rate)
    return directions, [carriers[f] for f in (*frames, 3)]


def _contribution(link: Link, frame: Frame, tree: Tree) -> tuple[arb_mat, arb_mat]:
    """Return body K's parts of Eqs. (43) and (44): (n, n), and (n, 3) of loads, gravity and velocity."""
    outward = frame.rotation.transpose()
    arm = outward * link.center
    center, center_dot = frame.origin + arm, frame.origin_dot + cross(frame.omega, arm)
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


def _contribution_of_rotor(spin: Spin, frame: Frame, tree: Tree) -> tuple[arb_mat, arb_mat]:
    """Return what a rotor adds to its carrier in Eqs. (43) and (44): (n, n), and (n, 1) of velocity.

    The rotor has its own partial angular velocities about its axis, those of its carrier and `ratio` more at
    its freedom. Its inertia torque across the axis turns its axis along with the carrier.
    """
    n, axis = tree.freedoms, frame.rotation.transpose() * spin.axis
    _, _, w_y, w_y_dot = _partials(frame, frame.origin, frame.origin_dot, n)
    relative = zeros(1, n)
    for place, share in spin.shares.items():
        relative[0, place] = spin.ratio * share
    standing = axis.transpose() * w_y
    spinning = standing + relative
    matrix = (spinning.transpose() * spinning - standing.transpose() * standing) * spin.inertia
    axis_dot = cross(frame.omega, axis)
    speed = (relative * tree.speeds)[0, 0]
    along = (axis.transpose() * w_y_dot + axis_dot.transpose() * w_y) * tree.speeds
    turned = w_y.transpose() * axis_dot * (spin.inertia * speed)
    return matrix, -(relative.transpose() * along * spin.inertia) - turned


def _partials(
    frame: Frame, center: arb_mat, center_dot: arb_mat, freedoms: int
) -> tuple[arb_mat, arb_mat, arb_mat, arb_mat]:
    """Return four (3, n) matrices: partial velocities of G_K, partial angular velocities, and their rates.

    The order is [v_y], [dv_y/dt], [omega_y], [domega_y/dt].
    """
    rows = {name: [zeros(1, 3)] * freedoms for name in ("v", "v_dot", "w", "w_dot")}
    for axis in frame.axes:
        v, v_dot, w, w_dot = axis.direction, axis.direction_dot, zeros(3, 1), zeros(3, 1)
        if axis.point is not None:
            arm, arm_dot = center - axis.point, center_dot - axis.point_dot
            w, w_dot = v, v_dot
            v, v_dot = cross(w, arm), cross(w_dot, arm) + cross(w, arm_dot)
        for name, vector in (("v", v), ("v_dot", v_dot), ("w", w), ("w_dot", w_dot)):
            for place, share in axis.shares.items():
                rows[name][place] = rows[name][place] + vector.transpose() * share
    v_y, v_y_dot, w_y, w_y_dot = (stacked(rows[name]).transpose() for name in rows)
    return v_y, v_y_dot, w_y, w_y_dot
