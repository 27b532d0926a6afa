"""Shapes of a file as shapes of a scene, with a note for everything that cannot be drawn."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kanegen.errors import KanegenError, MissingError, ModelError, ReadError, counted, quoted
from kanegen.model.arrays import SystemArrays
from kanegen.model.system import System
from kanegen.readers import visuals_of
from kanegen.readers.visual import Color, Visual
from kanegen.viewer.meshes import MeshFile, read_mesh
from kanegen.viewer.scene import MeshData, Shape, floats, rows

UNCOLORED: Color = (0.78, 0.80, 0.83, 1.0)
"""Colour of shapes for which neither the model nor the mesh says one."""


@dataclass
class Geometry:
    """The shapes of the file of a system, by body, as they are collected.

    Attributes:
        shapes: Shapes by number of the body, 0 for the ground.
        meshes: Meshes to which the shapes refer.
        notes: Sentences about what is drawn with fewer triangles.
        left_out: A sentence for each shape that is not drawn.
    """

    shapes: dict[int, list[Shape]] = field(default_factory=dict)
    meshes: list[MeshData] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)


def geometry_of(system: System, arrays: SystemArrays) -> Geometry:
    """Return the shapes of the file of a system.

    Args:
        system: The tree, whose `geometry` names the file.
        arrays: Its numbers.

    Example:
        geometry_of(system, system.values()).left_out
    """
    found = Geometry()
    if system.geometry is None:
        return found
    try:
        visuals = visuals_of(system.geometry)
    except KanegenError as error:
        found.left_out.append(f"The shapes of the model cannot be read: {error}")
        return found
    found.left_out += visuals.left_out
    files: dict[str, tuple[MeshFile, list[int]] | None] = {}
    for visual in visuals.shapes:
        try:
            frame = arrays.frames[system.frame(visual.frame).name] if visual.frame != "ground" else None
        except ModelError:
            found.left_out.append(f"{visual.where}: there is no frame {quoted(visual.frame)} in the system.")
            continue
        turn, origin, body = (
            (frame.rotation.T, frame.position, frame.body) if frame else (np.eye(3), np.zeros(3), 0)
        )
        position = floats(origin + turn @ np.array(visual.position))
        rotation = rows(turn @ np.array(visual.rotation))
        found.shapes.setdefault(body, []).extend(_shapes(visual, position, rotation, found, files))
    _note_thinned(found, files)
    return found


def _shapes(
    visual: Visual,
    position: list[float],
    rotation: list[float],
    found: Geometry,
    files: dict[str, tuple[MeshFile, list[int]] | None],
) -> list[Shape]:
    """Return the shapes of a visual in its body; those of a mesh are one for each colour."""
    if visual.file is None:
        color, opacity = _hex(visual.color or UNCOLORED)
        return [Shape(visual.kind, "geometry", list(visual.size), position, rotation, color, opacity)]
    key = str(visual.file)
    if key not in files:
        files[key] = _loaded(visual, found)
    loaded = files[key]
    shapes = []
    for part, place in zip(loaded[0].parts, loaded[1], strict=True) if loaded else ():
        color, opacity = _hex(visual.color or part.color or UNCOLORED)
        size = list(visual.size)
        shapes.append(Shape("mesh", "geometry", size, position, rotation, color, opacity, mesh=place))
    return shapes


def _loaded(visual: Visual, found: Geometry) -> tuple[MeshFile, list[int]] | None:
    """Return the mesh of a visual and the places of its parts; None, with a note, if it cannot be read."""
    if visual.file is None:
        return None
    try:
        file = read_mesh(visual.file)
    except ReadError as error:
        found.left_out.append(f"{visual.where}: {error}")
        return None
    except MissingError as error:
        sentence = f"the meshes of {visual.file.suffix} files, because {error}"
        if sentence not in found.left_out:  # one for all meshes
            found.left_out.append(sentence)
        return None
    places = list(range(len(found.meshes), len(found.meshes) + len(file.parts)))
    found.meshes.extend(part.mesh for part in file.parts)
    return file, places


def _note_thinned(found: Geometry, files: dict[str, tuple[MeshFile, list[int]] | None]) -> None:
    """Add a note about meshes that are drawn with fewer triangles than their files hold."""
    thinned = [one[0] for one in files.values() if one and one[0].drawn < 0.98 * one[0].triangles]
    if thinned:
        drawn, held = sum(one.drawn for one in thinned), sum(one.triangles for one in thinned)
        files_ = counted(len(thinned), "file")
        found.notes.append(f"Meshes of {files_} are drawn with {drawn} of their {held} triangles.")


def _hex(color: tuple[float, ...]) -> tuple[str, float]:
    """Return a colour as "#rrggbb" and its opacity."""
    red, green, blue, opacity = (min(1.0, max(0.0, value)) for value in color)
    return "#" + "".join(f"{round(255 * value):02x}" for value in (red, green, blue)), opacity
