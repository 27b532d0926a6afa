"""The states in which motions of a page begin, where a user names none: away from rest, within all limits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kanegen.model.system import System
from kanegen.model.values_by_name import finite_in_order
from kanegen.viewer.scene import Scene

TURN = 0.6
"""Angle by which joints without limits are turned from their neutral position (rad)."""

SHARE = 0.4
"""Part of the way from the neutral position to the nearer limit."""

SPIN = (0.3, 2.0, 0.2)
"""Speeds of a body that turns in all directions (rad/s)."""


@dataclass(frozen=True)
class State:
    """A state as the script of a page reads it.

    Attributes:
        x: (m,) coordinates (rad, m, 1).
        y: (n,) speeds (rad/s, m/s).
    """

    x: list[float]
    y: list[float]


def start_of(
    system: System,
    scene: Scene,
    x: ArrayLike | Mapping[str, float] | None = None,
    y: ArrayLike | Mapping[str, float] | None = None,
) -> State:
    """Return the state in which motions begin.

    Args:
        system: The tree.
        scene: Its picture, which has the ranges of its coordinates.
        x: (m,) coordinates, or some of them by name (rad, m, 1); the others are neutral.
        y: (n,) speeds, or some of them by name (rad/s, m/s); the others are 0. Without `x` and `y` the joints
            are turned away from their neutral position, so that something moves.

    Raises:
        OptionError: If a name does not exist, or a value is no finite number.
        ArrayError: If there are more or fewer values.
    """
    is_given = x is not None or y is not None
    moved = system.neutral_coordinates if is_given else _moved(system, scene)
    turning = [0.0] * len(system.freedoms) if is_given else _turning(system)
    return State(
        finite_in_order("x", x, system.coordinate_names, moved),
        finite_in_order("y", y, system.speed_names, turning),
    )


def _moved(system: System, scene: Scene) -> list[float]:
    """Return coordinates away from the neutral position, and the middle one of three angles from its zero.

    Where the first and the last angle turn about the same axis, zero is gimbal lock.
    """
    found = []
    for one, coordinate in zip(scene.coordinates, system.coordinates, strict=True):
        angles = sum(system.bodies[coordinate.body - 1].joint.moving[:3])
        is_alone = angles == 1 or (angles == 3 and coordinate.index == 1)
        if one.unit != "rad" or not is_alone:
            found.append(one.neutral)
        elif one.is_limited:
            room = max(one.upper - one.neutral, one.lower - one.neutral, key=abs)
            found.append(one.neutral + SHARE * room)
        else:
            found.append(one.neutral + TURN)
    return found


def _turning(system: System) -> list[float]:
    """Return speeds of bodies that turn in all directions; all others are 0."""
    found = np.zeros(len(system.freedoms))
    for place, freedom in enumerate(system.freedoms):
        joint = system.bodies[freedom.body - 1].joint
        if freedom.index < 3 and all(joint.moving[:3]):
            found[place] = SPIN[freedom.index]
    return [float(value) for value in found]
