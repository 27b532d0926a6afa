"""The rows of constraints of contacts: points and frames of bodies that do not accelerate.

Where a contact holds in all three directions, its rows are along the axes of the body, whose unit loads have
most zeros; otherwise they are along inertial axes, as the contact names them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, groupby

from sympy import Expr

from kanegen.model.contact import Contact
from kanegen.recursion.attached import Attached, BodyVector, acceleration, inertial, path
from kanegen.recursion.body_motion import BodyMotion, body_motions
from kanegen.recursion.constants import exact
from kanegen.recursion.constraints import ConstraintRow
from kanegen.recursion.frames import position_of
from kanegen.recursion.kinematics import poses
from kanegen.recursion.solver import Solver
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, Wrench, add, cross, dot, scale, unit
from kanegen.symbolic.definitions import Vector


@dataclass(frozen=True)
class HeldDirections:
    """Rows of one contact that hold against turning, or the point.

    Attributes:
        contact: The contact.
        place: What is held.
        is_moment: Whether the rows hold against turning.
        is_along_body: Whether they are along the axes of the body instead of inertial axes.
        axes: Directions of the rows, in components of the body.
    """

    contact: Contact
    place: Attached
    is_moment: bool
    is_along_body: bool
    axes: tuple[Vector, ...]

    def rows(self, tree: Tree, motion: BodyMotion, gravity: Vector, damping: Expr) -> list[ConstraintRow]:
        """Return the rows.

        Args:
            tree: The tree of the solver.
            motion: Motion of the body where all free components are zero.
            gravity: What the accelerations of the motion lack of gravity, in components of the body (m/s^2).
            damping: Damping of the contact.
        """
        k, arm = self.place.body, self.place.arm(tree)
        moved = motion.alpha
        if not self.is_moment:
            moved = add(acceleration(tree, self.place, motion).value, gravity)
            moved = tree.definitions.vector(f"cg_{self.place.number}", moved)
        loads = [
            Wrench(ZERO, axis) if self.is_moment else Wrench(axis, cross(arm, axis)) for axis in self.axes
        ]
        return [
            ConstraintRow({k: load}, dot(axis, moved), damping)
            for axis, load in zip(self.axes, loads, strict=True)
        ]

    def vector(self, loads: Sequence[Expr]) -> BodyVector:
        """Return the load of the rows as a vector of the body."""
        letter = "M" if self.is_moment else "F"
        total = ZERO
        for axis, load in zip(self.axes, loads, strict=True):
            total = add(total, scale(load, axis))
        what = "moment" if self.is_moment else "force"
        return BodyVector(
            self.place.body, f"c{letter}_{self.place.number}", f"{what} of {self.place.label}", total
        )


class HeldContacts:
    """The contacts of a system as rows of constraints, and the loads of their rows as the system names them.

    Attributes:
        rows: The rows.

    Args:
        solver: The solver of [A]{ydot} = {b}.
    """

    def __init__(self, solver: Solver) -> None:
        self._tree = tree = solver.tree
        self._held = [
            held
            for place, contact in enumerate(tree.system.contacts, start=1)
            for held in _held(tree, contact, place)
        ]
        motions = body_motions(tree, accelerated=False, weightless=True, released=solver.released)
        self.rows: list[ConstraintRow] = []
        for held in self._held:
            tree.about(held.place.body, f"acceleration of {held.place.label}")
            gravity = _lacking_gravity(tree, held.place.body, solver)
            damping = exact(held.contact.damping)
            self.rows += held.rows(tree, motions[held.place.body], gravity, damping)

    def named_loads(self, loads: Sequence[Expr]) -> list[Expr]:
        """Return the loads in the inertial directions that contacts name, from those of the rows."""
        rest = iter(loads)
        own = [[next(rest) for _ in held.axes] for held in self._held]
        turned = [held for held in self._held if held.is_along_body]
        vectors = [
            held.vector(values) for held, values in zip(self._held, own, strict=True) if held in turned
        ]
        found = iter(inertial(self._tree, vectors))
        named = (
            next(found) if held.is_along_body else values
            for held, values in zip(self._held, own, strict=True)
        )
        return list(chain.from_iterable(named))


def _held(tree: Tree, contact: Contact, number: int) -> list[HeldDirections]:
    """Return the directions of a contact: those against turning, if any, then those of the point."""
    k, point = tree.system.held(contact)
    place = Attached("contact", number, k, position_of(tree, k, point))
    found = []
    for is_moment, grouped in groupby(contact.rows(), key=lambda row: row.is_moment):
        rows = list(grouped)
        is_along_body = rows[0].is_along_body
        basis = [unit(axis) for axis in range(3)] if is_along_body else poses(tree)[k].columns
        axes = tuple(basis[row.axis] for row in rows)
        found.append(HeldDirections(contact, place, is_moment, is_along_body, axes))
    return found


def _lacking_gravity(tree: Tree, k: int, solver: Solver) -> Vector:
    """Return the gravity that accelerations of body `k` lack in the solution of a solver, in K (m/s^2).

    Behind three free translations that a solver solves for together, its free components are accelerations
    less gravity, of which the motion for zero components knows nothing.
    """
    joints = path(tree, k)
    if not any(
        joint.translates_freely and all(one.freedom in solver.released for one in joint.translations)
        for joint in joints
    ):
        return ZERO
    gravity = Vector(*(exact(value) for value in tree.system.gravity))
    for joint in reversed(joints):
        for step in joint.steps:
            name = f"ga_{joint.above(step)}"
            gravity = tree.definitions.vector(name, step.turn.up(gravity))
    return gravity
