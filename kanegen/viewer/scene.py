"""What a picture of a system shows, as plain data: bodies with joints and shapes, coordinates, springs.

A scene has no positions over time. These follow from {x} by the joints, in the script of a page as in the
live view, and come from a `Motion` or from sliders. Positions are in m, rotations (9,) by rows and take
components of the inner thing to those of the body that holds it.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

from kanegen.viewer.joints import JointData

Kind = Literal["box", "sphere", "ellipsoid", "cylinder", "capsule", "rod", "mesh"]
"""Kinds of shapes. `Shape.size` holds three edges, a radius, three semi-axes, radius and length along axis 3
(of a capsule without its caps, of a rod with its thickness), or three factors of a mesh."""

Role = Literal["geometry", "inertia", "link", "joint"]
"""What a shape stands for: geometry of the file, an inertia ellipsoid, a line between joints, a joint."""

IDENTITY = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]


@dataclass(frozen=True)
class Shape:
    """A rigid shape that is fixed in a body.

    Attributes:
        kind: One of `Kind`.
        role: One of `Role`.
        size: Lengths of the kind (m), or factors of a mesh (1).
        position: (3,) its centre in the body (m).
        rotation: (9,) its rotation, from its own components to those of the body.
        color: Colour as "#rrggbb".
        opacity: From 0 to 1.
        mesh: Place in `Scene.meshes`; None for any other kind.
    """

    kind: Kind
    role: Role
    size: list[float]
    position: list[float]
    rotation: list[float]
    color: str
    opacity: float = 1.0
    mesh: int | None = None


@dataclass(frozen=True)
class MeshData:
    """Triangles of a mesh.

    Attributes:
        name: Name of its file, for messages.
        origin: (3,) smallest coordinates of its vertices (m, or the unit of the file).
        step: (3,) distance of neighbouring integers in `vertices`.
        vertices: Base64 of (V, 3) 16-bit unsigned integers, little-endian: the coordinates are `origin` plus
            `step` times these.
        faces: Base64 of (F, 3) 16-bit unsigned integers: vertices of the triangles.
    """

    name: str
    origin: list[float]
    step: list[float]
    vertices: str
    faces: str


@dataclass(frozen=True)
class SceneBody:
    """A body, or the ground as the first of all.

    Attributes:
        name: Name of the body.
        joint: The joint below it; None for the ground.
        joint_name: Name of this joint, "" where it has none.
        mass: Mass (kg).
        center: (3,) mass centre in the body (m).
        color: Its colour where the file says none.
        shapes: Its shapes.
    """

    name: str
    joint: JointData | None
    joint_name: str
    mass: float
    center: list[float]
    color: str
    shapes: list[Shape]


@dataclass(frozen=True)
class SceneCoordinate:
    """A coordinate, for its slider and its line in a plot.

    Attributes:
        name: Name of the coordinate.
        unit: Its unit: rad, m or 1.
        body: Number of its body.
        lower: Smallest value of the slider.
        upper: Largest value of the slider.
        neutral: Value in the neutral position.
        is_limited: Whether the ends are limits of the model, not of the slider alone.
    """

    name: str
    unit: str
    body: int
    lower: float
    upper: float
    neutral: float
    is_limited: bool


@dataclass(frozen=True)
class Place:
    """A frame or a point that is fixed in a body.

    Attributes:
        name: Its name.
        body: Number of the body, 0 for the ground.
        position: (3,) its origin in the body (m).
        rotation: (9,) its rotation, from its own components to those of the body; None for a point.
    """

    name: str
    body: int
    position: list[float]
    rotation: list[float] | None = None


@dataclass(frozen=True)
class Scene:
    """Everything that a picture of a system shows, without its motion.

    Attributes:
        name: Name of the system.
        bodies: The ground, then the bodies; a body has its number as its place.
        coordinates: The elements of {x}.
        prescribed: The prescribed freedoms, whose sliders stand below those of {x}.
        frames: All frames, those of the bodies for their users too.
        points: All points.
        springs: The two ends of each spring between points.
        meshes: Meshes of the shapes.
        gravity: (3,) inertial components (m/s^2).
        size: A length (m) that no part of the tree exceeds from the ground by much; 1 where it has none.
        start: (m,) coordinates at which a picture without motion begins.
        notes: Sentences about how the picture is made and what is left out.
    """

    name: str
    bodies: list[SceneBody]
    coordinates: list[SceneCoordinate]
    prescribed: list[SceneCoordinate]
    frames: list[Place]
    points: list[Place]
    springs: list[list[Place]]
    meshes: list[MeshData]
    gravity: list[float]
    size: float
    start: list[float]
    notes: list[str]

    def as_table(self) -> dict[str, Any]:
        """Return the scene as nested dictionaries and lists of numbers and texts.

        Example:
            scene_of(system).as_table()["bodies"][1]["name"]
        """
        return asdict(self)


def embedded_json(value: Any) -> str:
    r"""Return a value as JSON that may stand inside `<script>` of an HTML page.

    No name in it can end the script: `<` and `&` are written as escapes, and so are the two separators of
    lines that JSON allows and old scripts do not.

    Raises:
        ValueError: If a number is not finite, which JSON cannot hold.

    Example:
        embedded_json({"name": "</script>"})  # '{"name": "\u003c/script>"}'
    """
    text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    escapes = {"<": "\\u003c", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}
    for character, escape in escapes.items():
        text = text.replace(character, escape)
    return text


def rows(matrix: Any) -> list[float]:
    """Return a (3, 3) matrix as (9,) numbers by rows.

    Example:
        rows(np.eye(3))
    """
    return [float(value) for row in matrix for value in row]


def floats(vector: Sequence[Any] | Any) -> list[float]:
    """Return the numbers of a vector as floats that JSON can hold.

    Example:
        floats(np.zeros(3))  # [0.0, 0.0, 0.0]
    """
    return [float(value) for value in vector]
