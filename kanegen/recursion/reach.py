"""Where the mass centre of a body can be, seen from the joints inward of it.

Turns by constant angles, and translations, leave the position of the mass centre an explicit expression in
{x}. A turn by an angle that moves leaves its distance from the axis of the turn, and its place along it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import sympy
from sympy import Expr, Rational, S

from kanegen.program.constants import MULTIPRECISION
from kanegen.recursion.constants import exact, rational
from kanegen.recursion.joint_motion import JointMotion, Step
from kanegen.recursion.tree import Tree
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, add, dot, scale, unit
from kanegen.symbolic.definitions import Definitions, Vector


@dataclass(frozen=True)
class Square:
    """The square of a distance: a constant, and multiples of squares of numbers that translations change.

    Attributes:
        constant: The constant (m^2).
        moving: The numbers that translations change (m), with the factors of their squares.
    """

    constant: Expr = S.Zero
    moving: tuple[tuple[Expr, Expr], ...] = ()


NO_DISTANCE = Square()


@dataclass(frozen=True)
class Reach:
    """The points at which a mass centre can be, in some frame, from the origin of a body.

    No point is farther from `center`, with the translations of the state, than `radius` and all `excursions`
    together.

    Attributes:
        definitions: Definitions that the intermediates are added to.
        center: Centre where all translations are zero (m).
        radius: Constant distance (m).
        translations: Coordinates of translations (m), with their directions.
        excursions: Squares of distances that translations change.
        turns: Constant turns between the frame and that of the body, the outermost first; None if some of
            the turns in between move.
    """

    definitions: Definitions
    center: Vector
    radius: Expr = S.Zero
    translations: tuple[tuple[Expr, Vector], ...] = ()
    excursions: tuple[Square, ...] = ()
    turns: tuple[Turn, ...] | None = ()

    def below(self, step: Step) -> Reach:
        """Return the points in the frame below a turn."""
        if not step.moves:
            center = self.definitions.vector("cw", step.turn.down(self.center))
            turned = tuple((s, step.turn.down(direction)) for s, direction in self.translations)
            turns = None if self.turns is None else (*self.turns, step.turn)
            return replace(self, center=center, translations=turned, turns=turns)
        radius, excursions = self.distance(step.axis)
        along, axis = scale(self.center[step.axis], unit(step.axis)), step.axis
        kept = tuple((s, scale(d[axis], unit(axis))) for s, d in self.translations if d[axis] != 0)
        return Reach(self.definitions, along, radius, kept, excursions, None)

    def below_any_rotation(self) -> Reach:
        """Return the points below a rotation about any axis through the origin."""
        radius, excursions = self.distance()
        return Reach(self.definitions, ZERO, radius, (), excursions, None)

    def below_joint(self, tree: Tree, joint: JointMotion) -> Reach:
        """Return points of the frame of a joint in the frame of the lower body, from its point O_J."""
        reach = self
        for step in reversed(joint.constant):
            reach = reach.below(step)
        described = tree.system.bodies[joint.body - 1].joint
        center = add(reach.center, Vector(*(exact(value) for value in described.position)))
        translations = list(reach.translations)
        translations += [(one.value, one.direction) for one in joint.moving_translations]
        for axis, direction in enumerate(joint.directions):
            if not described.moving[3 + axis]:
                center = add(center, scale(exact(described.locked[3 + axis]), direction))
        center = self.definitions.vector("cw", center)
        return replace(reach, center=center, translations=tuple(translations))

    def upward(self, axis: int) -> Vector | None:
        """Return a basis vector of the frame in components of the body, if no turn in between moves."""
        direction = unit(axis)
        for turn in reversed(self.turns or ()):
            direction = turn.up(direction)
        return None if self.turns is None else direction

    def distance(self, axis: int | None = None) -> tuple[Expr, tuple[Square, ...]]:
        """Return how far the points can be from an axis through the origin, or from the origin.

        Returns:
            The constant part of the distance (m), and the squares of the others.
        """
        square = self.square(axis)
        if square.moving:
            return self.radius, (*self.excursions, square)
        return self.definitions.define("dw", self.radius + _root(square.constant)), self.excursions

    def square(self, axis: int | None = None) -> Square:
        """Return the square of the distance of the centre from an axis through the origin, or the origin."""
        center, translations = _across(self.center, axis), self.across(axis)
        pairs = combinations((direction for _, direction in translations), 2)
        if any(one.free_symbols for _, direction in translations for one in direction) or any(
            dot(one, other) != 0 for one, other in pairs
        ):
            return self._square_by_components(center, translations)
        constant, moving = dot(center, center), []
        for s, direction in translations:
            factor, along = dot(direction, direction), dot(center, direction)
            constant -= along**2 / factor
            moving.append((self.definitions.define("cs", s + along / factor), factor))
        return Square(constant, tuple(moving))

    def across(self, axis: int | None) -> tuple[tuple[Expr, Vector], ...]:
        """Return the translations that move the centre across an axis, with their directions across it."""
        across = ((s, _across(direction, axis)) for s, direction in self.translations)
        return tuple((s, direction) for s, direction in across if any(one != 0 for one in direction))

    def _square_by_components(self, center: Vector, translations: tuple[tuple[Expr, Vector], ...]) -> Square:
        """Return the squared length of `center` with the translations of the state, by components."""
        constant, moving = S.Zero, []
        for i in range(3):
            moved = [s * direction[i] for s, direction in translations if direction[i] != 0]
            if moved:
                moving.append((self.definitions.define("cs", sum(moved, center[i])), S.One))
            else:
                constant += center[i] ** 2
        return Square(constant, tuple(moving))


def _across(v: Vector, axis: int | None) -> Vector:
    """Return a vector without its component along a basis vector."""
    return Vector(*(S.Zero if i == axis else one for i, one in enumerate(v)))


def _root(square: Expr) -> Expr:
    """Return the square root of an expression, rounded where it is a number."""
    if not square.is_Rational:
        return sympy.sqrt(square)
    return rational(MULTIPRECISION.sqrt(MULTIPRECISION.mpf(square.p) / square.q)) if square else Rational(0)
