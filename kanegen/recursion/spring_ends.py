"""The ends of springs between points: where they are, in parts that do not cancel.

The vector between two ends is small where they nearly touch, and the difference of two positions would have
the rounding errors of both. So a position is a constant plus a displacement. Constants are exact, and so is
the difference of two; translations displace by themselves. Where the ends of a spring meet at {x} = {0}, a
rotation displaces by ([R] - [1]){c}, which is formed without cancellation: 1 - cos is 2 sin^2 of half the
angle. What remains are ends that meet in other states: there the vector between them has the rounding error
of their positions, at most 8 roundoffs of the lengths on the way for every turn and joint of the way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy
from sympy import Expr, Rational, S

from kanegen.recursion.constants import exact
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.tree import Tree
from kanegen.recursion.turns import ComposedTurn, MatrixTurn, PlanarTurn, Turn
from kanegen.recursion.vectors import ZERO, add, cross, dot, scale, subtract, unit
from kanegen.symbolic.definitions import Definitions, Vector

HALF = Rational(1, 2)

TOUCHING = Rational(1, 1000)
"""Ends meet at {x} = {0} if their distance there is below this share of their distances from the frame."""


@dataclass(frozen=True)
class Place:
    """A position, in parts whose sum it is.

    Attributes:
        constant: The exact part (m).
        displacement: The part that depends on {x} (m).
    """

    constant: Vector
    displacement: Vector = ZERO

    @property
    def position(self) -> Vector:
        """Position of the end: its place at {x} = {0} plus the displacement from there (m)."""
        return add(self.constant, self.displacement)


@dataclass(frozen=True)
class End:
    """One end of a spring, seen from the body that carries both.

    Attributes:
        place: Where the end is (m).
        velocity: Its velocity (m/s).
    """

    place: Place
    velocity: Vector


def ends(
    tree: Tree, frame: int, bodies: Sequence[int], positions: Sequence[Vector], names: Sequence[str]
) -> tuple[End, End]:
    """Return both ends of a spring in the frame of the body `frame`.

    Args:
        tree: The tree.
        frame: Number of the outermost body that carries both ends.
        bodies: Numbers of the bodies of the two ends, 0 for the ground.
        positions: Positions of the two ends from the O of their bodies, in the frames of these bodies (m).
        names: Prefixes of the names of intermediates, for each end.
    """
    paths = [joints_between(tree, k, frame) for k in bodies]
    start, end = (_at_zero(tree, path, one) for path, one in zip(paths, positions, strict=True))
    touching = _touch(start, end)
    first, second = (
        _seen(tree, path, Place(one), name, touching)
        for path, one, name in zip(paths, positions, names, strict=True)
    )
    return first, second


def separation(first: Place, second: Place) -> Vector:
    """Return the vector between two places; the difference of their constants is exact (m)."""
    moved = subtract(second.displacement, first.displacement)
    return add(moved, subtract(second.constant, first.constant))


def joints_between(tree: Tree, k: int, frame: int) -> list[JointMotion]:
    """Return the joints from body `k` inward to the body `frame`, which carries it."""
    found: list[JointMotion] = []
    while k != frame:
        found.append(tree.joints[k - 1])
        k = found[-1].lower
    return found


def _touch(start: Vector, end: Vector) -> bool:
    """Return whether two constant positions are known numbers, and much closer than they are far away."""
    if not all(value.is_Number for value in (*start, *end)):
        return False
    apart = subtract(end, start)
    far = max(dot(start, start), dot(end, end))
    return bool(dot(apart, apart) <= TOUCHING**2 * far)


def _at_zero(tree: Tree, path: Sequence[JointMotion], position: Vector) -> Vector:
    """Return where a point is at {x} = {0}, with zero values of prescribed freedoms, too."""
    for joint in path:
        for step in reversed(joint.steps):
            position = _constant_below(step.turn, position)
        position = add(_constant_arm(tree, joint), position)
    return position


def _seen(tree: Tree, path: Sequence[JointMotion], place: Place, name: str, touching: bool) -> End:
    """Return an end of a spring from the body of the path's last joint inward."""
    define, velocity = tree.definitions.vector, ZERO
    for joint in path:
        tree.about(joint.body, "an end of a spring, Eqs. (22), (25)")
        velocity = add(velocity, cross(joint.relative_omega, place.position))
        for step in reversed(joint.steps):
            velocity = add(velocity, cross(scale(step.rate, unit(step.axis)), place.position))
            velocity = define(f"{name}v_{step.frame}", step.turn.down(velocity))
            if touching or not _moves(step.turn):
                place = _displaced(step.turn, place, f"{name}d_{step.frame}", tree.definitions)
            else:
                place = Place(ZERO, define(f"{name}_{step.frame}", step.turn.down(place.position)))
        sliding = ZERO
        for translation in joint.moving_translations:
            velocity = add(velocity, scale(translation.rate, translation.direction))
            sliding = add(sliding, scale(translation.value, translation.direction))
        velocity = define(f"{name}v_{joint.body}j", velocity)
        displacement = define(f"{name}d_{joint.body}j", add(place.displacement, sliding))
        place = Place(add(_constant_arm(tree, joint), place.constant), displacement)
    return End(place, velocity)


def _constant_arm(tree: Tree, joint: JointMotion) -> Vector:
    """Return the vector from O_J to O_K at zero free and prescribed translations, in J (m)."""
    described = tree.system.bodies[joint.body - 1].joint
    arm = Vector(*(exact(value) for value in described.position))
    for axis, direction in enumerate(joint.directions):
        if not described.moving[3 + axis]:
            arm = add(arm, scale(exact(described.locked[3 + axis]), direction))
    return arm


def _moves(turn: Turn) -> bool:
    """Return whether a turn depends on {x}."""
    match turn:
        case ComposedTurn(parts=parts):
            return any(_moves(part) for part in parts)
        case PlanarTurn(angle=angle):
            return angle is not None
        case MatrixTurn(change=change):
            return change is not None
    raise TypeError(turn)


def _constant_below(turn: Turn, v: Vector) -> Vector:
    """Return a vector below a turn at {x} = {0}."""
    if isinstance(turn, ComposedTurn):
        for part in reversed(turn.parts):
            v = _constant_below(part, v)
        return v
    return v if _moves(turn) else turn.down(v)


def _displaced(turn: Turn, place: Place, name: str, definitions: Definitions) -> Place:
    """Return a place below a turn, whose constant part stays that of {x} = {0}."""
    if isinstance(turn, ComposedTurn):
        for part in reversed(turn.parts):
            place = _displaced(part, place, name, definitions)
        return place
    moved = turn.down(place.displacement)
    if _moves(turn):
        moved = add(_change(turn, place.constant, definitions), moved)
    return Place(_constant_below(turn, place.constant), definitions.vector(name, moved))


def _change(turn: Turn, v: Vector, definitions: Definitions) -> Vector:
    """Return a vector below a turn less its components above."""
    match turn:
        case PlanarTurn(angle=Expr() as angle):
            return _planar_change(turn, angle, v, definitions)
        case MatrixTurn(change=(x, y, z)):
            return Vector(*(dot((x[j], y[j], z[j]), v) for j in range(3)))
    raise TypeError(turn)


def _planar_change(turn: PlanarTurn, angle: Expr, v: Vector, definitions: Definitions) -> Vector:
    """Return a vector below a planar turn less its components above, without cancellation at small angles."""
    j, k = (turn.axis + 1) % 3, (turn.axis + 2) % 3
    label = str(turn.sine).partition("_")[2]
    half = definitions.define(f"H_{label}", sympy.sin(HALF * angle))
    versine = definitions.define(f"V_{label}", 2 * half * half)
    change = [S.Zero, S.Zero, S.Zero]
    change[j] = -versine * v[j] - turn.sine * v[k]
    change[k] = turn.sine * v[j] - versine * v[k]
    return Vector(*change)
