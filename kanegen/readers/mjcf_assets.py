"""MJCF models whose files of meshes or textures are missing, where the equations do not depend on them.

The shape of a geom gives inertia to its body only if the body has no `<inertial>`. A body that has one, as in
models made from URDF files, needs no mesh, and no body needs textures or materials.
"""

from __future__ import annotations

from typing import Any


def compiled_without_assets(mujoco: Any, path: str) -> Any | None:
    """Return the compiled model of a file without meshes, height fields, materials, textures and skins.

    Args:
        mujoco: The module `mujoco`.
        path: The file, which MuJoCo can parse.

    Returns:
        The `mujoco.MjModel`, or None if a moving body has its inertia from a mesh, or something else in the
        model needs what is left out.
    """
    spec = mujoco.MjSpec.from_file(path)
    shapes = (mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_SDF, mujoco.mjtGeom.mjGEOM_HFIELD)
    for geom in list(spec.geoms):
        if geom.type in shapes or geom.meshname:
            if not _has_own_inertia(mujoco, spec, geom.parent):
                return None
            spec.delete(geom)
        else:
            geom.material = ""
    for part in (*spec.sites, *spec.tendons):
        part.material = ""
    for kind in ("skins", "materials", "textures", "hfields", "meshes"):
        for part in list(getattr(spec, kind)):
            spec.delete(part)
    try:
        return spec.compile()
    except ValueError:
        return None


def _has_own_inertia(mujoco: Any, spec: Any, body: Any) -> bool:
    """Return whether the inertia of a body does not come from its geoms, or does not matter."""
    from_geoms = spec.compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
    return body.name == "world" or (bool(body.explicitinertial) and not from_geoms)
