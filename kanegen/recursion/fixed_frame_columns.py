"""Columns of [A] on long ways: seen from one frame near the ground, they need no turning.

A column that passes many joints can keep its components in a frame that stands still, and take its entries
from the axes of the joints seen from there. Moments are still about one origin after the other, so that no
digits are lost to a far one. Whether this saves operations is counted beforehand, body by body.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from sympy import Expr

from kanegen.recursion import fixed_frame_choice as routes
from kanegen.recursion.columns import Wrench
from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion, Step
from kanegen.recursion.tree import Tree
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, dot, unit
from kanegen.symbolic.definitions import Definitions, Vector


@dataclass(frozen=True)
class View:
    """The basis vectors of the frame at home, seen from another frame."""

    basis: tuple[Vector, Vector, Vector]

    def home(self, v: Vector) -> Vector:
        """A vector's components at home."""
        return Vector(*(dot(direction, v) for direction in self.basis))

    def up(self, turn: Turn, frame: str, definitions: Definitions) -> View:
        """The view from above a turn."""
        x, y, z = (
            definitions.vector(f"E_{frame}_{i + 1}", turn.up(direction))
            for i, direction in enumerate(self.basis)
        )
        return View((x, y, z))


@dataclass(frozen=True)
class Station:
    """A body and its joint, seen from home.

    Attributes:
        body: K.
        view: From the frame of K.
        axes: Of the free angles and spins, by freedom.
        directions: Of the free translations, by freedom.
        offset: From the origin of the lower body to that of K.
    """

    body: int
    view: View
    axes: dict[int, Vector]
    directions: dict[int, Vector]
    offset: Vector

    def taken(self, col: Wrench, definitions: Definitions) -> Wrench:
        """A column in the frame of K, seen from home."""
        force = definitions.vector(f"F_{col.label}_{self.body}h", self.view.home(col.force))
        moment = definitions.vector(f"M_{col.label}_{self.body}h", self.view.home(col.moment))
        return replace(col, force=force, moment=moment, shares={})

    def entries(self, col: Wrench, definitions: Definitions) -> dict[int, Expr]:
        """The column's entries of [A] with the freedoms of the joint."""
        values = {freedom: dot(axis, col.moment) for freedom, axis in self.axes.items()}
        values |= {freedom: dot(direction, col.force) for freedom, direction in self.directions.items()}
        return {b: definitions.define(f"A_{col.freedom}_{b}", value) for b, value in values.items()}


def stations(tree: Tree) -> dict[int, Station]:
    """The bodies where columns change to the view from home."""
    found: dict[int, Station] = {}
    chosen = routes.chosen(tree)
    for motion in tree.motions:
        if motion.body in chosen:
            tree.about(motion.body, "the joint seen from the frame of long columns of [A]")
            if motion.lower:
                found[motion.body] = _next(motion, found[motion.lower].view, tree.definitions)
            else:
                found[motion.body] = _first(motion, tree)
    return found


def _first(motion: JointMotion, tree: Tree) -> Station:
    """Home is above the innermost angle, where two angles' axes are basis vectors; with spins in the body."""
    free = [i for i, step in enumerate(motion.steps) if step.freedom != NO_FREEDOM]
    below = motion.steps if motion.spins else motion.steps[: free[0] + 1] if free else ()
    directions = {slide.freedom: slide.direction for slide in motion.slides}
    for step in below:
        for freedom, direction in directions.items():
            name = f"u_{freedom}_{step.frame}"
            directions[freedom] = tree.definitions.vector(name, step.turn.up(direction))
    axes = {step.freedom: unit(step.axis) for step in below if step.freedom != NO_FREEDOM}
    station = Station(motion.body, View((unit(0), unit(1), unit(2))), axes, directions, ZERO)
    return _outward(station, motion, motion.steps[len(below) :], tree.definitions)


def _next(motion: JointMotion, view: View, definitions: Definitions) -> Station:
    """The view passes outward with the joints."""
    k = motion.body
    directions = {
        slide.freedom: definitions.vector(f"u_{slide.freedom}h", view.home(slide.direction))
        for slide in motion.slides
    }
    offset = definitions.vector(f"d_{k}h", view.home(motion.offset))
    return _outward(Station(k, view, {}, directions, offset), motion, motion.steps, definitions)


def _outward(
    station: Station, motion: JointMotion, steps: Iterable[Step], definitions: Definitions
) -> Station:
    """Through turns of the joint, up to its body."""
    axes, view = dict(station.axes), station.view
    for step in steps:
        if step.freedom != NO_FREEDOM:
            axes[step.freedom] = view.home(unit(step.axis))
        view = view.up(step.turn, f"{step.frame}u", definitions)
    axes |= {spin.freedom: view.home(unit(spin.axis)) for spin in motion.spins}
    return replace(station, axes=axes, view=view)
