"""Reads the `<visual>` elements of URDF links: primitive shapes and meshes, with their colours."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from kanegen.readers.reader import ModelFile
from kanegen.readers.urdf_elements import origin_of
from kanegen.readers.visual import Color, ShapeKind, Visual, Visuals
from kanegen.readers.xml import Element

PACKAGE = "package://"
"""What the name of a file in a package of ROS begins with."""

FOLDERS_OF_PACKAGES = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")
"""Variables of the environment that list folders of packages of ROS."""

_ROUND: dict[str, ShapeKind] = {"cylinder": "cylinder", "capsule": "capsule"}


def urdf_visuals(file: ModelFile) -> Visuals:
    """Return the shapes of a URDF file, each in the frame of its link.

    Raises:
        ReadError: If the file cannot be read or is no XML.

    Example:
        urdf_visuals(ModelFile(Path("robot.urdf"))).shapes
    """
    colors = {
        material.attributes.get("name", ""): color
        for material in file.root.all("material")
        if (color := _color(material, {})) is not None
    }
    readings: list[Callable[[], Visual]] = []
    for link in file.root.all("link"):
        name = link.attributes.get("name", "").strip()
        readings += [partial(_visual, visual, name, colors, file.path) for visual in link.all("visual")]
    return Visuals.of(readings)


def _visual(element: Element, link: str, colors: Mapping[str, Color], path: Path) -> Visual:
    """Return the shape of an element; what cannot be drawn raises a `ReadError`."""
    place = origin_of(element, 0.0)
    geometry = element.child("geometry")
    color = _color(element.optional("material"), colors)
    shape = partial(
        Visual, link, position=place.position, rotation=place.rotation, color=color, where=element.where
    )
    for child in geometry.children:
        if child.tag == "box":
            x, y, z = child.numbers("size", 3)
            return shape("box", (x, y, z))
        if child.tag == "sphere":
            return shape("sphere", (child.number("radius"),))
        if child.tag in _ROUND:
            return shape(_ROUND[child.tag], (child.number("radius"), child.number("length")))
        if child.tag == "mesh":
            factors = child.numbers("scale", 3) if "scale" in child.attributes else (1.0, 1.0, 1.0)
            return shape("mesh", tuple(factors), file=located(child.text("filename"), path))
    found = ", ".join(f"<{child.shown}>" for child in geometry.children) or "nothing"
    raise geometry.error(f"<geometry> holds {found}, which is no box, sphere, cylinder, capsule or mesh.")


def _color(material: Element | None, known: Mapping[str, Color]) -> Color | None:
    """Return the colour of a material: its own, or that of its name; None where there is neither."""
    if material is None:
        return None
    color = material.optional("color")
    if color is not None:
        red, green, blue, opacity = color.numbers("rgba", 4)
        return red, green, blue, opacity
    return known.get(material.attributes.get("name", ""))


def located(name: str, model: Path) -> Path:
    """Return the file that a robot file names: in its folder, or in a package of ROS.

    A package is looked for in the folders above the robot file, with and without the name of the package,
    then in those of `FOLDERS_OF_PACKAGES`. If the file is in none of them, the path in the folder of the
    robot file is returned.

    Example:
        located("package://arm_description/meshes/link.stl", Path("arm_description/urdf/arm.urdf"))
    """
    if not name.startswith(PACKAGE):
        return model.parent / name.removeprefix("file://")
    inside = name.removeprefix(PACKAGE)
    without_package = inside.partition("/")[2]
    listed = [one for key in FOLDERS_OF_PACKAGES for one in os.environ.get(key, "").split(os.pathsep) if one]
    above = [*model.resolve().parents]
    candidates = [folder / end for folder in above for end in (inside, without_package)]
    candidates += [
        Path(folder) / end for folder in listed for end in (inside, f"share/{inside}", without_package)
    ]
    return next((one for one in candidates if one.is_file()), model.parent / inside)
