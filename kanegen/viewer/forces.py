"""Forces over time as arrows: those that a caller passes, the loads of a trajectory, and its reactions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import quoted
from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.system import System
from kanegen.viewer.numbers import checked, doubles, encoded

REACTIONS = "reaction_loads"
"""The output whose forces are drawn where a trajectory has it."""


@dataclass(frozen=True)
class Force:
    """A force over time that is drawn as an arrow.

    Attributes:
        name: Name of the point, frame or body on which it acts.
        body: Number of the body in which its place is fixed, 0 for the ground.
        position: (3,) where it acts, in the body (m).
        rotation: (9,) rotation by rows from its components to those of the body; None for inertial
        components.
        values: Base64 of (T, 3) components in single precision, little-endian (N).
    """

    name: str
    body: int
    position: list[float]
    rotation: list[float] | None
    values: str


@dataclass(frozen=True)
class _Applied:
    """A force before it is encoded.

    Attributes:
        name: As in `Force`.
        body: As in `Force`.
        position: (3,) as in `Force`.
        rotation: (3, 3) as in `Force`, or None.
        values: (T, 3) components (N).
    """

    name: str
    body: int
    position: Floats
    rotation: Floats | None
    values: Floats


def forces_of(
    system: System, trajectory: Any, forces: Mapping[str, ArrayLike], count: int, kept: Any
) -> list[Force]:
    """Return the forces that a picture draws; those that are zero all the time are left out.

    Args:
        system: The tree.
        trajectory: The trajectory, whose loads on bodies and points are drawn, and its output
            `reaction_loads` if it has that.
        forces: (T, 3), or (3,) where it does not change, inertial components (N) by name of the point, body
        or frame.
        count: Number T of times.
        kept: Indices of the times that the page holds.

    Raises:
        ArrayError: If an array has another shape, or a number is not finite.
        ModelError: If there is no point, frame or body of a name.

    Example:
        forces_of(system, trajectory, {"tip": (0.0, 0.0, 5.0)}, len(trajectory.times), slice(None))
    """
    arrays = system.values()
    applied = [_given(system, arrays, str(name), values, count) for name, values in forces.items()]
    applied += _loads(system, arrays, getattr(trajectory, "inputs", {}), count)
    if REACTIONS in getattr(trajectory, "outputs", ()):
        applied += _reactions(system, arrays, checked(REACTIONS, trajectory.output(REACTIONS), None))
    return [
        Force(
            one.name,
            one.body,
            one.position.tolist(),
            None if one.rotation is None else one.rotation.ravel().tolist(),
            encoded(f"force {quoted(one.name)}", one.values[kept], "<f4"),
        )
        for one in applied
        if one.values.any()
    ]


def _given(system: System, arrays: SystemArrays, name: str, values: ArrayLike, count: int) -> _Applied:
    """Return a force that a caller passes: at a point, a mass centre, or the origin of a frame."""
    label = f"force {quoted(name)}"
    array = doubles(label, values)
    whole = np.broadcast_to(array, (count, 3)) if array.shape == (3,) else array
    checked(label, whole, (count, 3))
    bodies = [body.name for body in system.bodies]
    if name not in arrays.forces.points and name in bodies:
        k = bodies.index(name) + 1
        return _Applied(name, k, arrays.mass_center[k - 1], None, whole)
    if name not in arrays.forces.points:
        system.frame(name, "force")
    body, position = arrays.place(name)
    return _Applied(name, body, position, None, whole)


def _loads(
    system: System, arrays: SystemArrays, inputs: Mapping[str, Floats], count: int
) -> Iterator[_Applied]:
    """Yield the loads on bodies, at their mass centres, and on points, that a trajectory has as inputs."""
    force = inputs.get("force")
    if force is not None:
        checked("force", force, (count, len(system.bodies), 3))
        for k, body in enumerate(system.bodies, start=1):
            turn = arrays.load_rotation[k - 1].T
            yield _Applied(body.name, k, arrays.mass_center[k - 1], turn, force[:, k - 1])
    force = inputs.get("point_force")
    if force is not None:
        checked("point_force", force, (count, len(system.points), 3))
        places = zip(arrays.forces.points.items(), arrays.forces.load_frames, strict=True)
        for i, ((name, (k, position)), frame) in enumerate(places):
            turn = arrays.frames[frame].rotation.T if frame else None
            yield _Applied(name, k, position, turn, force[:, i])


def _reactions(system: System, arrays: SystemArrays, loads: Floats) -> Iterator[_Applied]:
    """Yield the forces that lower bodies exert, from (T, R) rows of `reaction_loads`.

    Along locked directions they have components of the joint frame, which is fixed in the lower body, and
    stand at the joint point; a direction that is not among the rows counts as zero. In a frame they stand at
    its origin.
    """
    gathered: dict[tuple[int, str], Floats] = {}
    for i, row in enumerate(system.reaction_rows):
        if row.index >= 3:
            values = gathered.setdefault((row.body, row.frame), np.zeros((len(loads), 3)))
            values[:, row.index - 3] = loads[:, i]
    for (k, frame), values in gathered.items():
        name = f"reaction on {system.bodies[k - 1].name}"
        if frame:
            place = arrays.frames[frame]
            yield _Applied(name, place.body, place.position, place.rotation.T, values)
        else:
            turn = arrays.joint_orientation[k - 1].T
            lower = int(arrays.connection[k - 1])
            yield _Applied(name, lower, arrays.joint_position[k - 1], turn, values)
