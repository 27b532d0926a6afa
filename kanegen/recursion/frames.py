"""Frames that are fixed in a body: origin and basis vectors in the body, from the constants of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sympy import Expr

from kanegen.model.body import Point
from kanegen.model.frame import Frame
from kanegen.model.numbers import Number
from kanegen.recursion.constants import exact
from kanegen.recursion.joint_builder import orientation_turns
from kanegen.recursion.joint_motion import down
from kanegen.recursion.tree import Tree
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, Rows, add, multiply, unit
from kanegen.symbolic.definitions import Vector


@dataclass(frozen=True)
class FixedFrame:
    """A frame that is fixed in a body, or in the ground.

    Attributes:
        body: Number of the body, 0 for the ground.
        origin: Position of its origin from O_K, in K (m).
        rows: Its basis vectors, in K.
    """

    body: int
    origin: Vector
    rows: Rows

    @property
    def is_turned(self) -> bool:
        """Whether its axes are not those of the body."""
        return self.rows != (unit(0), unit(1), unit(2))

    def inward(self, v: Vector) -> Vector:
        """Return a vector in components of the body, from those of the frame."""
        columns = (Vector(*(row[j] for row in self.rows)) for j in range(3))
        return multiply(tuple(columns), v)

    def outward(self, v: Vector) -> Vector:
        """Return a vector in components of the frame, from those of the body."""
        return multiply(self.rows, v)


def fixed_frame(tree: Tree, name: str, body: int) -> FixedFrame:
    """Return a frame by its name, "" for the frame of the model of body `body`."""
    origin, turns = _placed(tree, tree.system.frame_path(name), body)
    rows = [tree.definitions.vector(f"fb_{body}_{i + 1}", down(turns, unit(i))) for i in range(3)]
    return FixedFrame(body, tree.definitions.vector(f"fo_{body}", origin), (rows[0], rows[1], rows[2]))


def position_of(tree: Tree, body: int, point: Point) -> Vector:
    """Return the position of a point of body K from O_K, in K (m)."""
    path = tree.system.frame_path(point.frame)
    if not path:
        return _exact(point.position)
    origin, turns = _placed(tree, path, body)
    return tree.definitions.vector(f"fp_{body}", add(origin, down(turns, _exact(point.position))))


def _placed(tree: Tree, path: Sequence[Frame], body: int) -> tuple[Vector, tuple[Turn, ...]]:
    """Return the origin of the last frame of a path from O_K, in K, and the turns from K to it."""
    if path:
        tree.about(body, "frames")
    origin, turns = ZERO, tuple[Turn, ...]()
    for frame in path:
        origin = add(origin, down(turns, _exact(frame.position)))
        turns += orientation_turns(frame.orientation, f"{body}_f", tree.definitions)
    return origin, turns


def _exact(position: Sequence[Number]) -> Vector:
    """Return a position as exact numbers and symbols."""
    entries: list[Expr] = [exact(value) for value in position]
    return Vector(*entries)
