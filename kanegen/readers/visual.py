"""What a file says about how its bodies look: shapes in frames of the system, for pictures alone.

The equations do not depend on it, and reading a system passes it over. `visuals_of` reads it from the file
when a picture is drawn. What cannot be read there is left out, with a sentence that says so; it is no error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from kanegen.errors import ReadError
from kanegen.model.rotations import UNIT, ZERO, Square, Triple

ShapeKind = Literal["box", "sphere", "cylinder", "capsule", "ellipsoid", "mesh"]

Color = tuple[float, float, float, float]
"""Red, green, blue and opacity from 0 to 1."""


@dataclass(frozen=True)
class Visual:
    """A shape that is fixed in a frame of the system.

    Attributes:
        frame: Name of the frame, "ground" for the inertial one.
        kind: Kind of the shape.
        size: Three edges of a box, radius of a sphere, radius and length along axis 3 of a cylinder or of a
            capsule without its caps, three semi-axes of an ellipsoid (m), or three factors of a mesh (1).
        position: (3,) its centre in the frame (m).
        rotation: (3, 3) rotation from its own components to those of the frame.
        color: Its colour; None where the file says none.
        file: File of a mesh as it is named in the model, resolved against its folder; None for other kinds.
        where: File and line, or file and name, for messages.
    """

    frame: str
    kind: ShapeKind
    size: tuple[float, ...]
    position: Triple = ZERO
    rotation: Square = UNIT
    color: Color | None = None
    file: Path | None = None
    where: str = ""


@dataclass(frozen=True)
class Visuals:
    """The shapes of a file.

    Attributes:
        shapes: The shapes that can be drawn.
        left_out: A sentence for each shape that cannot.
    """

    shapes: tuple[Visual, ...] = ()
    left_out: tuple[str, ...] = ()

    @classmethod
    def of(cls, readings: list[Callable[[], Visual]]) -> Visuals:
        """Return the shapes that functions read, and what errors say of the others.

        Example:
            Visuals.of([lambda: Visual("hand", "sphere", (0.1,))]).shapes
        """
        shapes, left_out = [], []
        for read in readings:
            try:
                shapes.append(read())
            except ReadError as error:
                left_out.append(str(error))
        return cls(tuple(shapes), tuple(left_out))
