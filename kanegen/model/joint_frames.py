"""A joint frame turned to where its body stands, and the state seen from there; see `reanchoring`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from kanegen.model.arrays import Floats
from kanegen.model.coordinates import Freedom
from kanegen.model.joint import Joint
from kanegen.model.numbers import map_numbers, value_of
from kanegen.model.reanchorable import orientation_parameters
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


def turned(system: System, k: int, x: Floats, y: Floats) -> System:
    """The system with another frame at the joint of body `k`.

    Args:
        system: The tree.
        k: Number of the body, from 1.
        x: (m,) coordinates; they become those of the new system.
        y: (n,) generalized speeds, likewise.
    """
    joint = system.bodies[k - 1].joint
    angles, rates = _places(system, k, range(3))
    first, second, third = (
        planar(axis, math.sin(angle), math.cos(angle))
        for axis, angle in zip(joint.axes, x[angles], strict=True)
    )
    regular = planar(joint.axes[1], 1.0, 0.0) if joint.ends_alike else UNIT
    before = _orientation(joint)
    standing = product(product(third, product(second, first)), before)
    if not joint.spins:
        y[rates] = _regular_rates(joint, regular, _omega(joint, second, third, y[rates].tolist()))
    x[angles] = (0.0, math.pi / 2 if joint.ends_alike else 0.0, 0.0)
    system, after = _with_orientation(system, k, nearest_rotation(product(transpose(regular), standing)))
    return _slid(system, k, (before, after), x, y)


def _places(system: System, k: int, indices: range) -> tuple[list[int], list[int]]:
    """Of freedoms of body `k`, in {x} and in {y}."""
    return (
        [system.coordinate_place(k, index) for index in indices],
        [system.places[Freedom(k, index)] for index in indices],
    )


def _omega(joint: Joint, second: Square, third: Square, rates: Sequence[float]) -> Triple:
    """Relative angular velocity in the body, Eq. (8)."""
    one, two, three = (_scaled(rate, UNIT[axis]) for rate, axis in zip(rates, joint.axes, strict=True))
    return _sum(apply(third, _sum(apply(second, one), two)), three)


def _regular_rates(joint: Joint, regular: Square, omega: Triple) -> Triple:
    """Rates of the angles behind an angular velocity where the three axes are perpendicular to each other."""
    first, second, third = joint.axes
    return dot(apply(regular, UNIT[first]), omega), omega[second], omega[third]


def _slid(system: System, k: int, frames: tuple[Square, Square], x: Floats, y: Floats) -> System:
    """The system whose joint frame was the first and is the second, with translations that mean the same."""
    before, after = frames

    def seen(slide: Sequence[float]) -> Triple:
        one, two, three = slide
        return apply(after, apply(transpose(before), (one, two, three)))

    joint = system.bodies[k - 1].joint
    if joint.free[3]:
        slides, rates = _places(system, k, range(3, 6))
        x[slides], y[rates] = seen(x[slides].tolist()), seen(y[rates].tolist())
        return system
    locked = (*joint.locked[:3], *seen([value_of(value) for value in joint.locked[3:]]))
    return _with_joint(system, k, replace(joint, locked=locked))


def _with_orientation(system: System, k: int, matrix: Square) -> tuple[System, Square]:
    """The system with [C_K] as it can hold it, and that."""
    joint = system.bodies[k - 1].joint
    names = orientation_parameters(joint)
    if not names:
        return _with_joint(system, k, replace(joint, orientation=matrix)), matrix
    angles = angles_123(matrix)
    return system.with_parameters(dict(zip(names, angles, strict=True))), rotation_123(angles)


def _with_joint(system: System, k: int, joint: Joint) -> System:
    bodies = list(system.bodies)
    bodies[k - 1] = replace(bodies[k - 1], joint=joint)
    return replace(system, bodies=tuple(bodies))


def _orientation(joint: Joint) -> Square:
    plain = map_numbers(joint.orientation, value_of)
    matrix: Square = plain if isinstance(plain[0], tuple) else rotation_123(plain)
    return matrix


def _scaled(factor: float, a: Triple) -> Triple:
    return factor * a[0], factor * a[1], factor * a[2]


def _sum(a: Triple, b: Triple) -> Triple:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]
