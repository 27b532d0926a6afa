"""The geoms of MJCF models as shapes: primitives, and the files of meshes where the compiler put them."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

from kanegen.errors import ReadError, quoted
from kanegen.readers.mjcf_compiled import Compiled, compiled, rotation, triple
from kanegen.readers.mjcf_tree import body_names
from kanegen.readers.reader import ModelFile
from kanegen.readers.visual import Visual, Visuals
from kanegen.readers.welding import Frame

SHOWN_GROUPS = 3
"""Geoms of the groups 0, 1 and 2 are shown, as in MuJoCo's viewer; those for collisions are in group 3."""

UNCOLORED = (0.5, 0.5, 0.5, 1.0)
"""Colour of geoms for which a file says none."""


def mjcf_visuals(file: ModelFile) -> Visuals:
    """Return the geoms of an MJCF file that MuJoCo's viewer shows, each in the frame of its body.

    Planes are left out, because pictures have a ground of their own.

    Raises:
        ReadError: If MuJoCo refuses the file.
        MissingError: If MuJoCo is not installed.

    Example:
        mjcf_visuals(ModelFile(Path("robot.xml"))).shapes
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # reading the system has given them already
        model = compiled(file)
    names = body_names(model)
    plane = int(model.mujoco.mjtGeom.mjGEOM_PLANE)
    readings: list[Callable[[], Visual]] = [
        partial(_visual, model, geom, names)
        for geom in range(int(model.model.ngeom))
        if int(model.model.geom_group[geom]) < SHOWN_GROUPS and int(model.model.geom_type[geom]) != plane
    ]
    return Visuals.of(readings)


def _visual(model: Compiled, geom: int, names: list[str]) -> Visual:
    """Return the shape of a geom; what cannot be drawn raises a `ReadError`."""
    data, types = model.model, model.mujoco.mjtGeom
    where = f"{model.path}: geom {quoted(model.name('geom', geom))}"
    place = Frame(triple(data.geom_pos[geom]), rotation(data.geom_quat[geom]))
    a, b, c = (float(value) for value in data.geom_size[geom])
    material = int(data.geom_matid[geom])
    color = tuple(float(value) for value in data.geom_rgba[geom])
    if material >= 0 and color == UNCOLORED:
        color = tuple(float(value) for value in data.mat_rgba[material])
    red, green, blue, opacity = color
    shape = partial(
        Visual,
        names[int(data.geom_bodyid[geom])],
        color=None if color == UNCOLORED else (red, green, blue, opacity),
        where=where,
    )
    kind = int(data.geom_type[geom])
    if kind == int(types.mjGEOM_MESH):
        file, factors, inside = _mesh(model, int(data.geom_dataid[geom]), where)
        place = place.then(inside)
        return shape("mesh", factors, place.position, place.rotation, file=file)
    primitives = {
        int(types.mjGEOM_BOX): partial(shape, "box", (2 * a, 2 * b, 2 * c)),
        int(types.mjGEOM_SPHERE): partial(shape, "sphere", (a,)),
        int(types.mjGEOM_CYLINDER): partial(shape, "cylinder", (a, 2 * b)),
        int(types.mjGEOM_CAPSULE): partial(shape, "capsule", (a, 2 * b)),
        int(types.mjGEOM_ELLIPSOID): partial(shape, "ellipsoid", (a, b, c)),
    }
    if kind not in primitives:
        raise ReadError(f"{where} is no primitive shape and no mesh.")
    return primitives[kind](place.position, place.rotation)


def _mesh(model: Compiled, mesh: int, where: str) -> tuple[Path, tuple[float, ...], Frame]:
    """Return the file of a mesh, its factors, and the frame of the file in the frame of the compiled mesh.

    The compiler moves the vertices into the principal frame of the mesh, whose place in the file it keeps.
    """
    data = model.model
    start = int(data.mesh_pathadr[mesh])
    if start < 0:
        raise ReadError(f"{where} is a mesh whose vertices stand in the model, not in a file.")
    name = bytes(data.paths[start:]).split(b"\0", 1)[0].decode("utf-8", "replace")
    principal = Frame(triple(data.mesh_pos[mesh]), rotation(data.mesh_quat[mesh]))
    factors = tuple(float(value) for value in data.mesh_scale[mesh])
    return model.path.parent / name, factors, principal.inverse()
