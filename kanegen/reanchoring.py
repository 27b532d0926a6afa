"""Away from the singularity of three angles: a joint frame turned so that the body stands at regular angles.

Where the axes of a joint's three angles lie almost in a plane, the rates of the angles say little and grow
without bound. But where this happens depends on where the angles begin. With [C'] = [R][C] as its constant
orientation the same joint stands at the angles zero, in the same place and with the same angular velocity,
and can go on from there. Sequences that end with the axis they begin with are singular at zero, and stand at
a middle angle of pi/2 instead.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kanegen import rotations
from kanegen.anchors import orientation_parameters, require_free_frame
from kanegen.arrays import Floats
from kanegen.body import Joint
from kanegen.errors import ArrayError, OptionError
from kanegen.native.arguments import floats
from kanegen.numbers import map_numbers, value_of
from kanegen.rotations import (
    UNIT,
    Square,
    Triple,
    angles_123,
    apply,
    nearest_rotation,
    planar,
    product,
    transpose,
)
from kanegen.suggest import did_you_mean
from kanegen.system import Freedom, System

MARGIN = 0.1
"""Of the middle cosine, or sine: forward dynamics in rates of angles loses up to its square."""


class Anchored(NamedTuple):
    """A physical state, seen from other joint frames.

    Attributes:
        system: With the new joint frames.
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
    """The same physical state with the frames of joints turned to where their bodies stand.

    Bodies, their velocities and, under the same loads, their accelerations stay as they are; generalized
    forces on the joints that were turned take on the meaning of the new angles. A joint whose orientation is
    three parameters gets new values of these, so that a compiled library serves on.

    Args:
        system: The tree.
        x: (m,) coordinates (rad, m, 1).
        y: (n,) generalized speeds.
        bodies: Name, or number from 1, of a body or of several whose three angles are free; by default all
            whose middle cosine, or sine in sequences that end as they begin, is below `margin`.
        margin: From 0 to 1.

    Raises:
        ArrayError: If `x` or `y` has the wrong shape or is not finite.
        OptionError: If there is no such body, its joint has no three free angles, or other freedoms or
            parameters hold its joint frame.
    """
    coordinates = _vector(x, len(system.coordinates), "x")
    speeds = _vector(y, len(system.freedoms), "y")
    chosen = _near(system, coordinates, margin) if bodies is None else _numbers(system, bodies)
    for k in chosen:
        require_free_frame(system, k)
    for k in chosen:
        system = _turned(system, k, coordinates, speeds)
    return Anchored(system, coordinates, speeds)


def _vector(value: ArrayLike, n: int, what: str) -> Floats:
    """A copy."""
    array = floats(what, value, np.dtype(np.float64)).astype(np.float64)
    if array.shape != (n,) or not np.isfinite(array).all():
        raise ArrayError(f"{what}: expected {n} finite numbers, got shape {array.shape}.")
    return array


def _near(system: System, x: Floats, margin: float) -> list[int]:
    """Bodies near the singularity of their angles."""
    if not isinstance(margin, int | float) or not 0 <= margin <= 1:
        raise OptionError(f"margin is {margin!r}; it must lie between 0 and 1.")
    found = []
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.turns_freely and not body.joint.is_quaternion:
            middle = x[system.coordinate_place(k, 1)]
            across = math.sin(middle) if body.joint.ends_alike else math.cos(middle)
            if abs(across) < margin:
                found.append(k)
    return found


def _numbers(system: System, bodies: str | int | Iterable[str | int]) -> list[int]:
    """Numbers of the bodies, each once."""
    names = [body.name for body in system.bodies]
    found: dict[int, None] = {}
    for body in bodies if isinstance(bodies, Iterable) and not isinstance(bodies, str) else [bodies]:
        if body not in names and body not in range(1, len(names) + 1):
            raise OptionError(f"there is no body {body!r}. {did_you_mean(body, names)}")
        found[names.index(body) + 1 if isinstance(body, str) else int(body)] = None
    return list(found)


def _turned(system: System, k: int, x: Floats, y: Floats) -> System:
    """The system with another frame at the joint of body `k`; the state becomes that of the new system."""
    joint = system.bodies[k - 1].joint
    angles = [system.coordinate_place(k, index) for index in range(3)]
    turning = [system.places[Freedom(k, index)] for index in range(3)]
    first, second, third = (
        planar(axis, math.sin(angle), math.cos(angle))
        for axis, angle in zip(joint.axes, x[angles], strict=True)
    )
    regular = planar(joint.axes[1], 1.0, 0.0) if joint.ends_alike else UNIT
    before = _orientation(joint)
    standing = product(product(third, product(second, first)), before)
    after = nearest_rotation(product(transpose(regular), standing))
    if not joint.spins:
        y[turning] = _regular_rates(joint, regular, _omega(joint, second, third, y[turning].tolist()))
    x[angles] = (0.0, math.pi / 2 if joint.ends_alike else 0.0, 0.0)
    system, after = _with_orientation(system, k, after)

    def seen(slide: Sequence[float]) -> Triple:
        one, two, three = slide
        return apply(after, apply(transpose(before), (one, two, three)))

    if joint.free[3]:
        slides = [system.coordinate_place(k, index) for index in range(3, 6)]
        sliding = [system.places[Freedom(k, index)] for index in range(3, 6)]
        x[slides], y[sliding] = seen(x[slides].tolist()), seen(y[sliding].tolist())
        return system
    locked = (*joint.locked[:3], *seen([value_of(value) for value in joint.locked[3:]]))
    return _with_joint(system, k, replace(system.bodies[k - 1].joint, locked=locked))


def _omega(joint: Joint, second: Square, third: Square, rates: Sequence[float]) -> Triple:
    """Relative angular velocity in the body, Eq. (8)."""
    one, two, three = (_scaled(rate, UNIT[axis]) for rate, axis in zip(rates, joint.axes, strict=True))
    return _sum(apply(third, _sum(apply(second, one), two)), three)


def _scaled(factor: float, a: Triple) -> Triple:
    return factor * a[0], factor * a[1], factor * a[2]


def _sum(a: Triple, b: Triple) -> Triple:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _regular_rates(joint: Joint, regular: Square, omega: Triple) -> Triple:
    """Rates of the angles behind an angular velocity where the three axes are perpendicular to each other."""
    first, second, third = joint.axes
    return rotations.dot(apply(regular, UNIT[first]), omega), omega[second], omega[third]


def _with_orientation(system: System, k: int, matrix: Square) -> tuple[System, Square]:
    """The system with [C_K] as it can hold it, and that."""
    joint = system.bodies[k - 1].joint
    names = orientation_parameters(joint)
    if not names:
        return _with_joint(system, k, replace(joint, orientation=matrix)), matrix
    angles = angles_123(matrix)
    return system.with_parameters(dict(zip(names, angles, strict=True))), rotations.rotation_123(angles)


def _with_joint(system: System, k: int, joint: Joint) -> System:
    bodies = list(system.bodies)
    bodies[k - 1] = replace(bodies[k - 1], joint=joint)
    return replace(system, bodies=tuple(bodies))


def _orientation(joint: Joint) -> Square:
    plain = map_numbers(joint.orientation, value_of)
    matrix: Square = plain if isinstance(plain[0], tuple) else rotations.rotation_123(plain)
    return matrix
