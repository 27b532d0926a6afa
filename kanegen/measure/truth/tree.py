"""A system in one state, in balls: the numbers that both algorithms read.

Floats are taken exactly. Three things are rounded, to the working precision: expressions of numbers and
parameters, sines and cosines of constant joint angles, and joint orientations. A constant angle next to a
right angle means the right angle, which no double can express. A joint orientation that is a matrix of
doubles is a rotation but for its rounding; it means the rotation nearest to it, which is an exact function of
its entries.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from kanegen.measure.truth.balls import (
    arb,
    arb_mat,
    beside,
    column,
    identity,
    nearest_rotation,
    skew,
    square,
    unit,
)
from kanegen.measure.truth.numbers import ball
from kanegen.model.arrays import Floats
from kanegen.model.coordinates import NOTES, SEQUENCES, Axes, Coordinate, Freedom, QuaternionRotation
from kanegen.model.numbers import Matrix, Number, Vector, map_numbers
from kanegen.model.system import System
from kanegen.program.constants import quarter_turns


@dataclass(frozen=True)
class State:
    """One state of a system: arrays of float64, all of the right shape and finite.

    Attributes:
        x: (m,) coordinates (rad, m, 1).
        y: (n,) generalized speeds.
        force: (N, 3) forces at G_K, in the frame that users of K see (N).
        torque: (N, 3) torques, in the same frame (N m).
        tau: (n,) generalized forces beside loads and gravity.
        ydot: (n,) generalized accelerations, for inverse dynamics.
    """

    x: Floats
    y: Floats
    force: Floats
    torque: Floats
    tau: Floats
    ydot: Floats


@dataclass(frozen=True)
class Link:
    """Body K and the joint to its lower body J; vectors are (3, 1) and matrices (3, 3), in SI units.

    Attributes:
        lower: Number of the lower body J, 0 for the ground.
        shares: For each of the six freedoms, indices in {y} with the factors by which those speeds move it;
            one index with the factor 1 for a free freedom, none for a locked one.
        mass: Mass m_K.
        inertia: Central inertia [I'_{G_K}], in K.
        center: Mass centre {r'_K} from O_K, in K.
        position: Joint position {q'_K} from O_J, in J.
        orientation: Joint orientation [C_K], from J components to joint-frame components.
        angles: The three angles, free or locked; zeros where there is a quaternion.
        quaternion: (4, 1) Euler parameters in the place of the angles; None where there are angles.
        axes: Indices of the basis vectors about which the angles turn.
        translation: Translation {s'_K}, in the joint frame.
        rates: Rates of the angles, 0 where locked, or components of the relative angular velocity in K.
        speeds_are_rates: Whether `rates` are rates of the angles.
        translation_rates: Rates of the translation.
        force: Force {F'_K}, in K.
        torque: Torque {M'_K}, in K.
        armature: Reflected inertia of the motor of each of the six freedoms.
    """

    lower: int
    shares: tuple[dict[int, arb], ...]
    mass: arb
    inertia: arb_mat
    center: arb_mat
    position: arb_mat
    orientation: arb_mat
    angles: arb_mat
    quaternion: arb_mat | None
    axes: Axes
    translation: arb_mat
    rates: arb_mat
    speeds_are_rates: bool
    translation_rates: arb_mat
    force: arb_mat
    torque: arb_mat
    armature: tuple[arb, ...]


@dataclass(frozen=True)
class Spin:
    """A rotor that spins in body C at a multiple of the rate of a freedom.

    Attributes:
        carrier: Number of C, 0 for the ground.
        shares: Indices in {y} with the factors by which those speeds move the freedom.
        axis: (3, 1) unit vector along its axis, in C.
        inertia: Moment of inertia about the axis.
        ratio: Angular velocity in C by rate of the freedom.
    """

    carrier: int
    shares: Mapping[int, arb]
    axis: arb_mat
    inertia: arb
    ratio: arb


@dataclass(frozen=True)
class Tree:
    """A system in one state.

    Attributes:
        links: Bodies 1 to N with their joints.
        spins: Rotors.
        gravity: (3, 1) gravity, in inertial components.
        speeds: (n, 1) generalized speeds {y}.
        tau: (n, 1) generalized forces beside loads and gravity.
        ydot: (n, 1) generalized accelerations {ydot}, for inverse dynamics.
    """

    links: tuple[Link, ...]
    spins: tuple[Spin, ...]
    gravity: arb_mat
    speeds: arb_mat
    tau: arb_mat
    ydot: arb_mat

    @property
    def freedoms(self) -> int:
        """Number of free freedoms n."""
        return self.speeds.nrows()


def tree(system: System, state: State) -> Tree:
    """Return `system` in `state`, in balls of the working precision; parameters stand at their defaults."""
    return Tree(
        links=tuple(_link(system, k, state) for k in range(1, system.number_of_bodies + 1)),
        spins=tuple(_spins(system)),
        gravity=column(map_numbers(system.gravity, ball)),
        speeds=column(state.y),
        tau=column(state.tau),
        ydot=column(state.ydot),
    )


def _link(system: System, k: int, state: State) -> Link:
    """Return body K and its joint."""
    body = system.bodies[k - 1]
    functions = [_function(system, Freedom(k, index)) for index in range(6)]
    coordinates = [_coordinate(system, Freedom(k, index), state) for index in range(6)]
    speeds = [_sum(shares, state.y) for shares, _ in functions]
    inward = _inward(system, body.name)
    return Link(
        lower=body.lower,
        shares=tuple(shares for shares, _ in functions),
        mass=ball(body.mass),
        inertia=square(map_numbers(body.inertia, ball)),
        center=column(map_numbers(body.mass_center, ball)),
        position=column(map_numbers(body.joint.position, ball)),
        orientation=constant_orientation(body.joint.orientation),
        angles=column(coordinates[:3]),
        quaternion=_quaternion(system, k, state),
        axes=body.joint.axes,
        translation=column(coordinates[3:]),
        rates=column(speeds[:3]),
        speeds_are_rates=body.joint.speeds_are_rates,
        translation_rates=column(speeds[3:]),
        force=inward * column(state.force[k - 1]),
        torque=inward * column(state.torque[k - 1]),
        armature=tuple(ball(value) for value in body.joint.armature),
    )


def _spins(system: System) -> Iterator[Spin]:
    """Yield the rotors, each with what drives it."""
    for one in system.mounted_rotors:
        axis = _inward(system, one.frame) * column(one.rotor.direction)
        inertia, ratio = ball(one.rotor.inertia), ball(one.rotor.ratio)
        yield Spin(one.body, _function(system, one.freedom)[0], axis, inertia, ratio)


def _inward(system: System, frame: str) -> arb_mat:
    """Return the (3, 3) rotation from components of a frame to those of its body."""
    inward = identity(3)
    for one in system.frame_path(frame):
        inward = inward * constant_orientation(one.orientation).transpose()
    return inward


def _function(system: System, freedom: Freedom) -> tuple[dict[int, arb], arb]:
    """Return the factors by index in {y}, and the offset, of the linear function that moves a freedom.

    A coupled freedom follows other freedoms; where these are coupled themselves, so do they.
    """
    if freedom in system.places:
        return {system.places[freedom]: arb(1)}, arb(0)
    shares: dict[int, arb] = {}
    offset = arb(0)
    for one in system.coupled:
        if one.freedom == freedom:
            offset += ball(one.offset)
            for other, factor in one.terms:
                inner, constant = _function(system, other)
                offset += ball(factor) * constant
                for place, share in inner.items():
                    shares[place] = shares.get(place, arb(0)) + ball(factor) * share
    return shares, offset


def _coordinate(system: System, freedom: Freedom, state: State) -> float | arb:
    """Return the coordinate of a freedom, moving or locked; 0 for an angle that a quaternion stands for."""
    joint = system.bodies[freedom.body - 1].joint
    place = system.coordinate_places.get(Coordinate(freedom.body, freedom.index))
    if place is not None:
        return float(state.x[place])
    if joint.coupled[freedom.index]:
        shares, value = _function(system, freedom)
        for i, share in shares.items():
            followed = system.freedoms[i]
            value += share * float(state.x[system.coordinate_place(followed.body, followed.index)])
        return value
    locked = joint.locked[freedom.index]
    return _constant_angle(locked) if freedom.is_angle else ball(locked)


def _sum(shares: Mapping[int, arb], speeds: Floats) -> arb:
    """Return the rate of a freedom from the speeds that move it."""
    return sum((share * float(speeds[place]) for place, share in shares.items()), arb(0))


def _quaternion(system: System, k: int, state: State) -> arb_mat | None:
    """Return the (4, 1) quaternion of body K; None where its orientation has angles."""
    match system.bodies[k - 1].joint.rotation:
        case QuaternionRotation(coordinates=kinds):
            return column(state.x[system.coordinate_place(k, kind)] for kind in kinds)
    return None


def _constant_angle(angle: Number) -> float | arb:
    """Return a constant angle (rad); an angle next to a right angle is the right angle."""
    if not isinstance(angle, float):
        return ball(angle)
    turns = quarter_turns(angle)
    return arb.pi() * turns / 2 if turns else angle


def constant_orientation(given: Matrix | Vector) -> arb_mat:
    """Return a (3, 3) constant orientation, such as [C_K], given as a matrix or as three angles 1-2-3."""
    if isinstance(given[0], tuple):
        return nearest_rotation(square(map_numbers(given, ball)))
    return rotations_by_angles(
        column(_constant_angle(angle) for angle in given if not isinstance(angle, tuple)),
        SEQUENCES[NOTES],
    )[-1]


def rotations_along(link: Link) -> tuple[arb_mat, ...]:
    """Return the rotations from the joint frame to itself and to each frame of the joint, body K last."""
    if link.quaternion is None:
        return rotations_by_angles(link.angles, link.axes)
    return rotations_by_quaternion(link.quaternion)


def rotations_by_angles(angles: arb_mat, axes: Axes) -> tuple[arb_mat, ...]:
    """Return the rotations from a frame to itself and to the frames after one, two and three turns."""
    frames = [identity(3)]
    for axis, angle in zip(axes, angles.entries(), strict=True):
        frames.append(_rotation(axis, angle) * frames[-1])
    return tuple(frames)


def rotations_by_quaternion(quaternion: arb_mat) -> tuple[arb_mat, ...]:
    """Return three times the identity and the rotation by a (4, 1) quaternion of any length but 0.

    The rotation is the product of two (3, 4) matrices of its elements over their squared length (Nikravesh
    1988, section 6.3).
    """
    scalar, *elements = quaternion.entries()
    vector = column(elements)
    lower, upper = (
        beside([-vector, *_columns(identity(3) * scalar + skew(vector) * sign)]) for sign in (arb(1), arb(-1))
    )
    squared = (quaternion.transpose() * quaternion)[0, 0]
    still = identity(3)
    return still, still, still, upper * lower.transpose() * (1 / squared)


def _columns(matrix: arb_mat) -> list[arb_mat]:
    """Return the three columns of a (3, 3) matrix."""
    return [matrix * unit(axis) for axis in range(3)]


def _rotation(axis: int, angle: arb) -> arb_mat:
    """Return the rotation from a frame to the one turned by `angle` about basis vector 0, 1 or 2."""
    sine, cosine = angle.sin_cos()
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rows: list[list[float | arb]] = [[0.0] * 3 for _ in range(3)]
    rows[axis][axis] = 1.0
    rows[j][j] = rows[k][k] = cosine
    rows[j][k], rows[k][j] = sine, -sine
    return square(rows)
