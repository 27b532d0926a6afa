"""A system in one state, in balls: what both algorithms read.

Floats are taken exactly. Only two things are rounded, to the precision at hand: the sines and cosines of
constant joint angles, of which those beside right angles mean these, and joint orientations. A matrix of
doubles is a rotation but for its rounding; what it means is the rotation nearest to it, which is an exact
function of its entries.
"""

from __future__ import annotations

from collections.abc import Sequence
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
from kanegen.model.arrays import Floats
from kanegen.model.coordinates import NOTES, SEQUENCES, Axes, Coordinate, Freedom, QuaternionRotation
from kanegen.model.joint import Joint
from kanegen.model.numbers import Number, Parameter, map_numbers, value_of
from kanegen.model.system import System
from kanegen.program.constants import quarter_turns


@dataclass(frozen=True)
class State:
    """One state of a system: arrays of float64, all of the right shape and finite.

    Attributes:
        x: (m,) coordinates (rad, m, 1).
        y: (n,) generalized speeds.
        force: (N, 3) forces F'_K at G_K, in K (N).
        torque: (N, 3) torques M'_K, in K (N m).
        tau: (n,) generalized forces beside loads and gravity.
        ydot: (n,) accelerations, for inverse dynamics.
    """

    x: Floats
    y: Floats
    force: Floats
    torque: Floats
    tau: Floats
    ydot: Floats


@dataclass(frozen=True)
class Link:
    """A body and the joint below it; vectors are (3, 1) and matrices (3, 3).

    Attributes:
        lower: Number of the lower body J, 0 for the ground.
        places: Where each of the six freedoms stands in {y}; None where it is locked.
        mass: m_K.
        inertia: [I'_{G_K}], in K.
        center: r'_K, from O_K to G_K, in K.
        position: q'_K, from O_J to Q_K, in J.
        orientation: [C_K], from J components to joint-frame components.
        angles: The three angles, free or locked; zeros where there is a quaternion.
        quaternion: (4, 1) what stands in their place; None where nothing does.
        axes: Basis vectors about which they turn, from 0.
        translation: s'_K, in the joint frame.
        rates: Rates of the angles, 0 where locked; or the components of the relative angular velocity in K.
        speeds_are_rates: Whether they are rates of the angles.
        translation_rates: Rates of the translation.
        force: F'_K.
        torque: M'_K.
    """

    lower: int
    places: tuple[int | None, ...]
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


@dataclass(frozen=True)
class Tree:
    """The links of bodies 1 to N and what else a state holds; (n, 1) columns."""

    links: tuple[Link, ...]
    gravity: arb_mat
    speeds: arb_mat
    tau: arb_mat
    ydot: arb_mat

    @property
    def freedoms(self) -> int:
        """n."""
        return self.speeds.nrows()


def tree(system: System, state: State) -> Tree:
    """`system` in `state`, in balls of the precision at hand; parameters stand at their defaults."""
    return Tree(
        links=tuple(_link(system, k, state) for k in range(1, system.number_of_bodies + 1)),
        gravity=column(map_numbers(system.gravity, value_of)),
        speeds=column(state.y),
        tau=column(state.tau),
        ydot=column(state.ydot),
    )


def _link(system: System, k: int, state: State) -> Link:
    body = system.bodies[k - 1]
    places = tuple(system.places.get(Freedom(k, index)) for index in range(6))
    standing = tuple(system.coordinate_places.get(Coordinate(k, index)) for index in range(6))
    locked = map_numbers(body.joint.locked, value_of)
    coordinates = _filled(standing, state.x, locked)
    speeds = _filled(places, state.y, (0.0,) * 6)
    return Link(
        lower=body.lower,
        places=places,
        mass=arb(value_of(body.mass)),
        inertia=square(map_numbers(body.inertia, value_of)),
        center=column(map_numbers(body.mass_center, value_of)),
        position=column(map_numbers(body.joint.position, value_of)),
        orientation=_orientation(body.joint),
        angles=column(_angles(body.joint, standing, state)),
        quaternion=_quaternion(system, k, state),
        axes=body.joint.axes,
        translation=column(coordinates[3:]),
        rates=column(speeds[:3]),
        speeds_are_rates=body.joint.speeds_are_rates,
        translation_rates=column(speeds[3:]),
        force=column(state.force[k - 1]),
        torque=column(state.torque[k - 1]),
    )


def _filled(places: Sequence[int | None], values: Floats, locked: Sequence[float]) -> list[float]:
    """The six numbers of a joint: of `values` where free, of `locked` elsewhere."""
    return [
        other if place is None else float(values[place]) for place, other in zip(places, locked, strict=True)
    ]


def _angles(joint: Joint, places: Sequence[int | None], state: State) -> list[float | arb]:
    """The three angles of a joint."""
    pairs = zip(places[:3], joint.locked[:3], strict=True)
    return [_meant(locked) if place is None else float(state.x[place]) for place, locked in pairs]


def _quaternion(system: System, k: int, state: State) -> arb_mat | None:
    match system.bodies[k - 1].joint.rotation:
        case QuaternionRotation(coordinates=kinds):
            return column(state.x[system.coordinate_place(k, kind)] for kind in kinds)
    return None


def _meant(angle: Number) -> float | arb:
    """A constant angle; one beside a right angle, which doubles cannot say, is that."""
    if isinstance(angle, Parameter):
        return angle.value
    turns = quarter_turns(angle)
    return arb.pi() * turns / 2 if turns else angle


def _orientation(joint: Joint) -> arb_mat:
    plain = map_numbers(joint.orientation, value_of)
    if isinstance(plain[0], tuple):
        return nearest_rotation(square(plain))
    return turned(
        column(_meant(angle) for angle in joint.orientation if not isinstance(angle, tuple)), SEQUENCES[NOTES]
    )[-1]


def rotations_along(link: Link) -> tuple[arb_mat, ...]:
    """Return the rotations from the joint frame to itself and to each frame of the joint, body K last."""
    if link.quaternion is None:
        return turned(link.angles, link.axes)
    return turned_at_once(link.quaternion)


def turned(angles: arb_mat, axes: Axes) -> tuple[arb_mat, ...]:
    """Rotations from a frame to itself and to those after one, two and three turns about `axes`."""
    frames = [identity(3)]
    for axis, angle in zip(axes, angles.entries(), strict=True):
        frames.append(_turn(axis, angle) * frames[-1])
    return tuple(frames)


def turned_at_once(quaternion: arb_mat) -> tuple[arb_mat, ...]:
    """The same for a quaternion (4, 1) of any length but 0, which has no turns on the way.

    The rotation is the product of two (3, 4) matrices of its elements over their squared length (Nikravesh
    1988, section 6.3).
    """
    scalar, *elements = quaternion.entries()
    vector = column(elements)
    lower, upper = (
        beside([-vector, *_columns(identity(3) * scalar + skew(vector) * sign)]) for sign in (arb(1), arb(-1))
    )
    squared = (quaternion.transpose() * quaternion)[0, 0]
    before = identity(3)
    return before, before, before, upper * lower.transpose() * (1 / squared)


def _columns(matrix: arb_mat) -> list[arb_mat]:
    return [matrix * unit(axis) for axis in range(3)]


def _turn(axis: int, angle: arb) -> arb_mat:
    """From a frame to the one turned by `angle` about basis vector 0, 1 or 2."""
    sine, cosine = angle.sin_cos()
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rows: list[list[float | arb]] = [[0.0] * 3 for _ in range(3)]
    rows[axis][axis] = 1.0
    rows[j][j] = rows[k][k] = cosine
    rows[j][k], rows[k][j] = sine, -sine
    return square(rows)
