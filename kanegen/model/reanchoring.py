"""Re-anchoring: a change of a joint frame and its coordinates that leaves the body far from gimbal lock.

Where the axes of a joint's three angles lie almost in a plane, the rates of the angles grow without bound.
The angles at which this happens depend on the joint frame. With [C'] = [R][C] as its constant orientation the
same joint has the angles zero in the same position, with the same angular velocity, and the motion can go on
from there. Proper Euler sequences are singular at zero, and get a middle angle of pi/2 instead.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kanegen.choices import chosen, did_you_mean, is_among
from kanegen.errors import ArrayError, OptionError, quoted
from kanegen.model.arguments import floats
from kanegen.model.arrays import Floats
from kanegen.model.coordinates import ANGLES, TRANSLATIONS, AxisRotations, Freedom
from kanegen.model.description import require_system
from kanegen.model.joint import Joint
from kanegen.model.numbers import map_numbers, value_of
from kanegen.model.reanchorable import orientation_parameters, require_free_frame
from kanegen.model.rotations import (
    UNIT,
    Square,
    Triple,
    angles_123,
    apply,
    dot,
    nearest_rotation,
    planar,
    product,
    rotation_123,
    transpose,
)
from kanegen.model.system import System

MARGIN = 0.1
"""Default bound of the cosine or sine of theta2 below which a joint is re-anchored: forward dynamics in angle
rates loses up to the square of its inverse in accuracy."""


class Anchored(NamedTuple):
    """A physical state with other joint frames.

    Attributes:
        system: The system with the new joint frames.
        x: (m,) coordinates (rad, m, 1).
        y: (n,) generalized speeds.
    """

    system: System
    x: Floats
    y: Floats

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the run-time parameters, for `Library.with_parameters`."""
        return {parameter.name: parameter.value for parameter in self.system.parameters}


def reanchored(
    system: System,
    x: ArrayLike,
    y: ArrayLike,
    bodies: str | int | Iterable[str | int] | None = None,
    margin: float = MARGIN,
) -> Anchored:
    """Return the same physical state with the frames of some joints turned to where their bodies stand.

    Bodies, their velocities and, under the same loads, their accelerations stay as they are; generalized
    forces on the joints that were turned have the meaning of the new angles. A joint whose orientation is
    three parameters gets new values of these, so that a compiled library remains usable.

    Args:
        system: The tree.
        x: (m,) coordinates (rad, m, 1).
        y: (n,) generalized speeds.
        bodies: Names, or numbers from 1, of one or several bodies whose three angles are free; by default all
            bodies whose |cos(theta2)|, or |sin(theta2)| for proper Euler sequences, is below `margin`.
        margin: Bound from 0 to 1 on the distance from gimbal lock.

    Raises:
        ArrayError: If `x` or `y` has the wrong shape or is not finite.
        OptionError: If `system` is no System, there is no such body, its joint does not have three free
            angles, or other freedoms or parameters refer to its joint frame.

    Example:
        system, x, y = kg.reanchored(system, x, y)
    """
    require_system(system)
    coordinates = _copied(x, len(system.coordinates), "x")
    speeds = _copied(y, len(system.freedoms), "y")
    chosen = _near_gimbal_lock(system, coordinates, margin) if bodies is None else _numbers(system, bodies)
    for k in chosen:
        require_free_frame(system, k)
    for k in chosen:
        system = _turned(system, k, coordinates, speeds)
    return Anchored(system, coordinates, speeds)


def _copied(value: ArrayLike, n: int, label: str) -> Floats:
    """Return a copy of (n,) finite numbers."""
    array = floats(label, value, np.dtype(np.float64)).astype(np.float64)
    if array.shape != (n,) or not np.isfinite(array).all():
        raise ArrayError(f"{label}: expected {n} finite numbers, got shape {array.shape}.")
    return array


def _near_gimbal_lock(system: System, x: Floats, margin: float) -> list[int]:
    """Return the numbers of the bodies whose three free angles are near gimbal lock."""
    if not isinstance(margin, int | float) or not 0 <= margin <= 1:
        raise OptionError(f"margin is {quoted(margin)}; it must lie between 0 and 1.")
    found = []
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.gimbal_lock:
            middle = x[system.coordinate_place(k, 1)]
            vanishing = math.sin(middle) if body.joint.gimbal_lock == "sin" else math.cos(middle)
            if abs(vanishing) < margin:
                found.append(k)
    return found


def _numbers(system: System, bodies: str | int | Iterable[str | int]) -> list[int]:
    """Return the numbers of bodies that are chosen by name or number, each once."""
    names = [body.name for body in system.bodies]
    found: dict[int, None] = {}
    several = chosen(bodies)
    for body in (bodies,) if several is None else several:
        if not is_among(body, [*names, *range(1, len(names) + 1)]):
            hint = system.whereabouts(body) or did_you_mean(body, names)
            raise OptionError(f"there is no body {quoted(body)}. {hint}")
        found[names.index(body) + 1 if isinstance(body, str) else int(body)] = None
    return list(found)


def _turned(system: System, k: int, x: Floats, y: Floats) -> System:
    """Return the system with the joint of body `k` re-anchored at the present orientation of the body.

    Args:
        system: The tree.
        k: Number of the body, from 1.
        x: (m,) coordinates; changed in place to those of the new system.
        y: (n,) generalized speeds; changed in place to those of the new system.
    """
    joint = system.bodies[k - 1].joint
    rotations = joint.rotation
    assert isinstance(rotations, AxisRotations)
    angles, rates = _places(system, k, ANGLES)
    first, second, third = (
        planar(axis, math.sin(angle), math.cos(angle))
        for axis, angle in zip(rotations.axes, x[angles], strict=True)
    )
    regular = planar(rotations.axes[1], 1.0, 0.0) if rotations.is_proper_euler else UNIT
    before = _orientation(joint)
    standing = product(product(third, product(second, first)), before)
    if joint.speeds_are_rates:
        omega = _angular_velocity(rotations, second, third, y[rates].tolist())
        y[rates] = _regular_rates(rotations, regular, omega)
    x[angles] = (0.0, math.pi / 2 if rotations.is_proper_euler else 0.0, 0.0)
    system, after = _with_orientation(system, k, nearest_rotation(product(transpose(regular), standing)))
    return _with_same_translation(system, k, (before, after), x, y)


def _places(system: System, k: int, indices: tuple[int, ...]) -> tuple[list[int], list[int]]:
    """Return the places of freedoms of body `k` in {x} and in {y}."""
    return (
        [system.coordinate_place(k, index) for index in indices],
        [system.places[Freedom(k, index)] for index in indices],
    )


def _angular_velocity(
    rotations: AxisRotations, second: Square, third: Square, rates: Sequence[float]
) -> Triple:
    """Return the relative angular velocity in the body, Eq. (8)."""
    one, two, three = (_scaled(rate, UNIT[axis]) for rate, axis in zip(rates, rotations.axes, strict=True))
    return _sum(apply(third, _sum(apply(second, one), two)), three)


def _regular_rates(rotations: AxisRotations, regular: Square, omega: Triple) -> Triple:
    """Return the angle rates for an angular velocity, where the three axes are orthogonal."""
    first, second, third = rotations.axes
    return dot(apply(regular, UNIT[first]), omega), omega[second], omega[third]


def _with_same_translation(
    system: System, k: int, frames: tuple[Square, Square], x: Floats, y: Floats
) -> System:
    """Return the system with the translation of body `k` resolved in the second of two frames."""
    before, after = frames

    def resolved(translation: Sequence[float]) -> Triple:
        one, two, three = translation
        return apply(after, apply(transpose(before), (one, two, three)))

    joint = system.bodies[k - 1].joint
    if joint.free[3]:
        places, rates = _places(system, k, TRANSLATIONS)
        x[places], y[rates] = resolved(x[places].tolist()), resolved(y[rates].tolist())
        return system
    locked = (*joint.locked[:3], *resolved([value_of(value) for value in joint.locked[3:]]))
    return _with_joint(system, k, replace(joint, locked=locked))


def _with_orientation(system: System, k: int, matrix: Square) -> tuple[System, Square]:
    """Return the system with another [C_K], and [C_K] as the system stores it: a matrix or parameters."""
    joint = system.bodies[k - 1].joint
    names = orientation_parameters(joint)
    if not names:
        return _with_joint(system, k, replace(joint, orientation=matrix)), matrix
    angles = angles_123(matrix)
    return system.with_parameters(dict(zip(names, angles, strict=True))), rotation_123(angles)


def _with_joint(system: System, k: int, joint: Joint) -> System:
    """Return the system with another joint at body `k`."""
    bodies = list(system.bodies)
    bodies[k - 1] = replace(bodies[k - 1], joint=joint)
    return replace(system, bodies=tuple(bodies))


def _orientation(joint: Joint) -> Square:
    """Return [C_K] as a matrix, parameters at their defaults."""
    plain = map_numbers(joint.orientation, value_of)
    matrix: Square = plain if isinstance(plain[0], tuple) else rotation_123(plain)
    return matrix


def _scaled(factor: float, a: Triple) -> Triple:
    """Return a vector times a factor."""
    return factor * a[0], factor * a[1], factor * a[2]


def _sum(a: Triple, b: Triple) -> Triple:
    """Return the sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]
