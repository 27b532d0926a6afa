"""The scene of a system: shapes of its bodies, ranges of its sliders, frames, points and springs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import warn
from kanegen.model.arrays import SystemArrays
from kanegen.model.coordinates import COORDINATE_KINDS, FREEDOMS
from kanegen.model.description import require_system
from kanegen.model.force_elements.elements import Spring
from kanegen.model.system import System
from kanegen.model.values_by_name import finite_in_order
from kanegen.viewer.joints import joints_of
from kanegen.viewer.scene import Place, Scene, SceneBody, SceneCoordinate, floats, rows
from kanegen.viewer.skeleton import Skeleton
from kanegen.viewer.visuals import geometry_of

ELLIPSOIDS = (
    "Bodies without geometry are drawn as the uniform ellipsoids that have their mass and inertia. "
    "Semi-axes below a twenty-fifth of the largest are drawn thicker."
)
"""The note about how bodies without geometry are drawn."""


def scene_of(system: System, x: ArrayLike | Mapping[str, float] | None = None) -> Scene:
    """Return what a picture of a system shows.

    Args:
        system: The tree; parameters stand at their defaults.
        x: (m,) coordinates of a picture without motion, all or some by name (rad, m, 1); the others are
            neutral.

    Raises:
        OptionError: If `system` is none, or `x` has an unknown name or a number that is not finite.
        ArrayError: If `x` has another number of coordinates.

    Warns:
        KanegenWarning: If a shape of the file of the system cannot be drawn; the body keeps its ellipsoid.

    Example:
        scene_of(kg.load("models/eight_body.toml")).size
    """
    require_system(system)
    arrays = system.values()
    skeleton = Skeleton(system, arrays)
    geometry = geometry_of(system, arrays)
    for sentence in geometry.left_out:
        warn(f"not drawn: {sentence}")
    shapes = [[*geometry.shapes.get(k, []), *skeleton.shapes(k)] for k in range(len(system.bodies) + 1)]
    ground = SceneBody("ground", None, "", 0.0, [0.0] * 3, skeleton.color(0), shapes[0])
    joints = joints_of(system, arrays)
    bodies = [
        SceneBody(
            name=body.name,
            joint=joints[k - 1],
            joint_name=body.joint.name,
            mass=float(arrays.mass[k - 1]),
            center=floats(arrays.mass_center[k - 1]),
            color=skeleton.color(k),
            shapes=shapes[k],
        )
        for k, body in enumerate(system.bodies, start=1)
    ]
    return Scene(
        name=system.name,
        bodies=[ground, *bodies],
        coordinates=_coordinates(system, skeleton),
        prescribed=_prescribed(system, skeleton),
        frames=[
            Place(name, frame.body, floats(frame.position), rows(frame.rotation.T))
            for name, frame in arrays.frames.items()
        ],
        points=[Place(name, k, floats(place)) for name, (k, place) in arrays.forces.points.items()],
        springs=_springs(arrays),
        meshes=geometry.meshes,
        gravity=floats(arrays.gravity),
        size=skeleton.size,
        start=finite_in_order("x", x, system.coordinate_names, system.neutral_coordinates),
        notes=[
            ELLIPSOIDS,
            *geometry.notes,
            *(f"Not drawn: {_without_folder(one, system)}" for one in geometry.left_out),
        ],
    )


def _without_folder(sentence: str, system: System) -> str:
    """Return a sentence without the folder of the model, which a page for others should not name."""
    return sentence.replace(f"{system.geometry.parent}/", "") if system.geometry else sentence


def _coordinates(system: System, skeleton: Skeleton) -> list[SceneCoordinate]:
    """Return the elements of {x} with their sliders; those of a quaternion reach from -1 to 1."""
    found = []
    names, neutral = system.coordinate_names, system.neutral_coordinates
    for name, coordinate, value in zip(names, system.coordinates, neutral, strict=True):
        if coordinate.index < len(FREEDOMS):
            found.append(_slider(system, skeleton, name, (coordinate.body, coordinate.index)))
        else:
            unit = COORDINATE_KINDS[coordinate.index].unit
            found.append(SceneCoordinate(name, unit, coordinate.body, -1.0, 1.0, value, False))
    return found


def _prescribed(system: System, skeleton: Skeleton) -> list[SceneCoordinate]:
    """Return the prescribed freedoms with the ranges of their sliders."""
    places = zip(system.prescribed_names, system.prescribed, strict=True)
    return [_slider(system, skeleton, name, (one.body, one.index)) for name, one in places]


def _slider(system: System, skeleton: Skeleton, name: str, place: tuple[int, int]) -> SceneCoordinate:
    """Return the coordinate of freedom `place`: number of the body and index in `FREEDOMS`."""
    k, index = place
    limits = system.bodies[k - 1].joint.limits
    is_limited = bool(np.isfinite([limits.lower[index], limits.upper[index]]).all())
    lower, upper = skeleton.ranges(k)[index]
    return SceneCoordinate(name, COORDINATE_KINDS[index].unit, k, float(lower), float(upper), 0.0, is_limited)


def _springs(arrays: SystemArrays) -> list[list[Place]]:
    """Return the ends of each spring between points."""

    def end(value: str | Sequence[object]) -> Place:
        if isinstance(value, str):
            body, position = arrays.place(value)
            return Place(value, body, floats(position))
        return Place("ground", 0, floats(value))

    return [
        [end(one) for one in element.between]
        for element in arrays.forces.elements
        if isinstance(element, Spring)
    ]
