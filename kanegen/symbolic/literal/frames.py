"""Frames that are fixed in a body: origin and rotation, from the constants of the model."""

from __future__ import annotations

from dataclasses import dataclass

from sympy import ImmutableMatrix

from kanegen.model.body import Point
from kanegen.model.system import System
from kanegen.symbolic.literal.orientation import constant_orientation
from kanegen.symbolic.matrices import FiniteMatrix
from kanegen.symbolic.symbols import column


@dataclass(frozen=True)
class FrameEquations:
    """A frame that is fixed in body K.

    Attributes:
        position: (3, 1) position of its origin from O_K, in K components (m).
        rotation: (3, 3) rotation from components of K to components of the frame.
    """

    position: ImmutableMatrix
    rotation: ImmutableMatrix


def frame_equations(system: System, name: str) -> FrameEquations:
    """Return a frame by its name, "" for the frame of the model of a body."""
    position, rotation = FiniteMatrix.zeros(3, 1), FiniteMatrix.eye(3)
    for frame in system.frame_path(name):
        position += rotation.T * column(frame.position)
        rotation = constant_orientation(frame.orientation) * rotation
    return FrameEquations(position, rotation)


def point_position(system: System, point: Point) -> ImmutableMatrix:
    """Return the (3, 1) position of a point of body K from O_K, in K components (m)."""
    frame = frame_equations(system, point.frame)
    return frame.position + frame.rotation.T * column(point.position)
