"""Files of meshes as triangles of bounded number, with their colours.

trimesh reads the files (STL, OBJ, DAE, PLY, GLB), from the extra `viewer`. Vertices are kept as 16-bit
integers in the box of the mesh, which is finer than a pixel. A mesh with too many triangles is thinned by
fast-simplification, which collapses edges where the surface changes least (Garland and Heckbert 1997).
"""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen import extras
from kanegen.errors import ReadError
from kanegen.model.arrays import Floats
from kanegen.viewer.scene import MeshData, floats

EXTRA = "viewer"
"""The extra that installs trimesh and viser."""

SUFFIXES = (".stl", ".obj", ".dae", ".ply", ".glb")
"""Suffixes of the files that are read."""

MOST_TRIANGLES = 8000
"""Triangles that a file is drawn with at the most."""

FINEST = 65535
"""Cells of the grid of vertices along each axis."""

Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Part:
    """The triangles of one colour in a file.

    Attributes:
        mesh: The triangles.
        color: (4,) red, green, blue and opacity from 0 to 1; None where the file says none.
    """

    mesh: MeshData
    color: tuple[float, ...] | None


@dataclass(frozen=True)
class MeshFile:
    """What a file of a mesh holds.

    Attributes:
        parts: Its triangles by colour, in m where the file has a unit.
        triangles: Number of triangles in the file.
        drawn: Number of triangles that are left.
    """

    parts: tuple[Part, ...]
    triangles: int
    drawn: int


def read_mesh(path: Path) -> MeshFile:
    """Return the triangles of a file.

    Raises:
        ReadError: If there is no such file, it is of another kind, or it cannot be read.
        MissingError: If trimesh, or pycollada for a DAE file, is not installed.

    Example:
        read_mesh(Path("link0.stl")).drawn
    """
    if path.suffix.lower() not in SUFFIXES:
        raise ReadError(f"{path}: pictures show meshes in {', '.join(SUFFIXES)} files.")
    if not path.is_file():
        raise ReadError(f"{path}: there is no such file.")
    trimesh = extras.module("trimesh", *(["collada"] if path.suffix.lower() == ".dae" else []), extra=EXTRA)
    try:
        scene = trimesh.load_scene(str(path), process=False)
        pieces = [
            (np.asarray(v, np.float64), np.asarray(f, np.int64), c) for v, f, c in _pieces(trimesh, scene)
        ]
    except Exception as error:  # whatever a reader of a foreign format raises
        raise ReadError(f"{path}: this mesh cannot be read: {_one_line(error)}.") from None
    pieces = [piece for piece in pieces if len(piece[1]) and np.isfinite(piece[0]).all()]
    if not pieces:
        raise ReadError(f"{path}: this file holds no triangles.")
    total = sum(len(faces) for _, faces, _ in pieces)
    parts = []
    for vertices, faces, color in pieces:
        share = max(12, MOST_TRIANGLES * len(faces) // total)
        parts.append(Part(_data(path.name, vertices, faces, share), color))
    drawn = sum(len(base64.b64decode(part.mesh.faces)) // 6 for part in parts)
    return MeshFile(tuple(parts), total, drawn)


def _pieces(trimesh: Any, scene: Any) -> Iterator[tuple[Any, Any, tuple[float, ...] | None]]:
    """Yield vertices (m), faces and colour of each mesh in a scene of trimesh, placed as the scene says."""
    unit = scene.units if scene.units and "*" in str(scene.units) else None
    factor = trimesh.units.unit_conversion(unit, "meters") if unit else 1.0
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not hasattr(mesh, "faces"):
            continue
        vertices = factor * (mesh.vertices @ transform[:3, :3].T + transform[:3, 3])
        faces = mesh.faces if np.linalg.det(transform[:3, :3]) > 0 else mesh.faces[:, ::-1]
        yield vertices, faces, _color(mesh)


def _color(mesh: Any) -> tuple[float, ...] | None:
    """Return the colour of a mesh of trimesh; None where its file says none."""
    visual = mesh.visual
    material = getattr(visual, "material", None)
    if material is None and not getattr(visual, "defined", False):
        return None
    color = material.main_color if material is not None else visual.main_color
    return None if color is None else tuple(float(value) / 255 for value in color)


def _data(name: str, vertices: Floats, faces: Integers, most: int) -> MeshData:
    """Return a mesh with at most about `most` triangles."""
    origin = vertices.min(axis=0)
    step = max(float(np.ptp(vertices, axis=0).max()), np.finfo(np.float64).tiny) / FINEST
    grid, kept = _welded((vertices - origin) / step, faces)
    if len(kept) > most:
        simplify = extras.module("fast_simplification", extra=EXTRA).simplify
        grid, kept = _welded(*simplify(grid.astype(np.float64), kept.astype(np.int32), target_count=most))
    return MeshData(
        name=name,
        origin=floats(origin),
        step=[step] * 3,
        vertices=base64.b64encode(grid.astype("<u2").tobytes()).decode("ascii"),
        faces=base64.b64encode(kept.astype("<u2").tobytes()).decode("ascii"),
    )


def _welded(vertices: Floats, faces: Integers) -> tuple[Integers, Integers]:
    """Return the vertices of a mesh rounded to integers, each once, and the triangles that keep an area."""
    rounded = np.clip(np.rint(vertices), 0, FINEST).astype(np.int64)
    unique, place = np.unique(rounded, axis=0, return_inverse=True)
    corners = place.reshape(-1)[faces]
    a, b, c = corners.T
    return unique, corners[(a != b) & (b != c) & (c != a)]


def _one_line(error: Exception) -> str:
    """Return the message of an error in one line, without a full stop at its end."""
    return " ".join(str(error).split())[:200].rstrip(".") or type(error).__name__
