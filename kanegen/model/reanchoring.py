"""Away from the singularity of three angles: a joint frame turned so that the body stands at regular angles.

Where the axes of a joint's three angles lie almost in a plane, the rates of the angles say little and grow
without bound. But where this happens depends on where the angles begin. With [C'] = [R][C] as its constant
orientation the same joint stands at the angles zero, in the same place and with the same angular velocity,
and can go on from there. Sequences that end with the axis they begin with are singular at zero, and stand at
a middle angle of pi/2 instead.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, OptionError
from kanegen.model.arguments import floats
from kanegen.model.arrays import Floats
from kanegen.model.joint_frames import turned
from kanegen.model.reanchorable import require_free_frame
from kanegen.model.system import System

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
        system = turned(system, k, coordinates, speeds)
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
