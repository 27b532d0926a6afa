"""Bounds of the pivots of a solver that hold in every state, from the constants of a model.

The pivot of a freedom is twice the least kinetic energy of the bodies that it carries, at unit speed of the
freedom, over all speeds of the freedoms outward of it. This is never less than the energy of the body of the
joint alone: `least_pivots`. The sums that make up a pivot consist of inertias of carried bodies about the
axis of the freedom. None of them is larger than that of a body as far away as its path allows:
`CompositeInertias`. Rounding changes a pivot by a few unit roundoffs of the latter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy
from sympy import Expr, Rational, S

from kanegen.model.body import Body
from kanegen.program.constants import MULTIPRECISION
from kanegen.recursion.constants import exact, rational
from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion, Step
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, scale, unit
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.symbols import coordinate


@dataclass(frozen=True)
class Reach:
    """The points at which a mass centre can be, in some frame, from the origin of a body.

    They lie in a ball that translations carry with them.

    Attributes:
        definitions: Definitions that the intermediates are added to.
        center: Centre of the ball where all translations are zero (m).
        radius: Radius of the ball (m).
        translations: Coordinates of translations (m), with their directions.
        excursions: Coordinates of translations (m) whose directions moving turns may change to any other.
    """

    definitions: Definitions
    center: Vector
    radius: Expr = S.Zero
    translations: tuple[tuple[Expr, Vector], ...] = ()
    excursions: tuple[Expr, ...] = ()

    def below(self, step: Step) -> Reach:
        """Return the points in the frame below a turn."""
        if not step.moves:
            center = self.definitions.vector("cw", step.turn.down(self.center))
            turned = tuple((s, step.turn.down(direction)) for s, direction in self.translations)
            return replace(self, center=center, translations=turned)
        radius, excursions = self.distance(step.axis)
        kept = tuple(one for one in self.translations if one[0] not in excursions)
        return Reach(
            self.definitions, scale(self.center[step.axis], unit(step.axis)), radius, kept, excursions
        )

    def below_any_rotation(self) -> Reach:
        """Return the points below a rotation about any axis through the origin."""
        radius, excursions = self.distance()
        return Reach(self.definitions, ZERO, radius, (), excursions)

    def distance(self, axis: int | None = None) -> tuple[Expr, tuple[Expr, ...]]:
        """Return how far the points can be from an axis through the origin, or from the origin.

        Returns:
            The largest distance where all translations are zero, and the coordinates that can add to it.
        """
        across = [i for i in range(3) if i != axis]
        squares = sum((self.center[i] ** 2 for i in across), S.Zero)
        added = [s for s, direction in self.translations if any(direction[i] != 0 for i in across)]
        radius = self.definitions.define("dw", self.radius + _root(squares))
        return radius, (*self.excursions, *added)


class CompositeInertias:
    """Bounds of the inertias that freedoms carry, by freedom (kg m^2, kg).

    Args:
        tree: The tree.
        together: Whether three free angles or translations are eliminated as components in the body's frame;
            the mass of a body that translates freely then does not load the lower body.
    """

    def __init__(self, tree: Tree, *, together: bool) -> None:
        self._tree, self._together = tree, together
        n = len(tree.system.freedoms)
        self._constants = [S.Zero] * n
        self._squares: list[dict[Expr, Expr]] = [{} for _ in range(n)]
        for joint in tree.joints:
            tree.about(joint.body, "bound of its inertia about freedoms that carry it")
            self._carry(joint)

    def bound(self, freedom: int, share: Rational = S.One) -> Expr:
        """Return a share of the bound of a freedom."""
        define = self._tree.definitions.define
        constant = define(f"U_{freedom}", share * self._constants[freedom])
        squares = [
            define(f"U{s}", share * factor * define(f"s{s}", s * s))
            for s, factor in self._squares[freedom].items()
        ]
        return define(f"Ut_{freedom}", sum(squares, constant))

    def depends_on_state(self, freedom: int) -> bool:
        """Return whether the bound of a freedom grows with translations."""
        return bool(self._squares[freedom])

    def _carry(self, joint: JointMotion) -> None:
        """Add the inertia of the body of a joint to the bounds of all freedoms that carry it."""
        body = self._tree.system.bodies[joint.body - 1]
        mass = exact(body.mass)
        inertias = [exact(body.inertia[i][i]) for i in range(3)]
        largest = sum(inertias, S.Zero)
        reach = Reach(self._tree.definitions, Vector(*(exact(value) for value in body.mass_center)))
        for below in self._tree.inward(joint):
            freely = self._together and below.translates_freely
            if not below.angular_speeds:
                for step in reversed(below.angles):
                    if step.freedom != NO_FREEDOM:
                        about = None if self._together and below.rotates_freely else step.axis
                        alone = below is joint and step is below.hinge
                        inertia = inertias[step.axis] if alone else largest
                        self._add(step.freedom, inertia, mass, *reach.distance(about))
                    reach = reach.below(step)
            for speed in below.angular_speeds:
                self._add(speed.freedom, largest, mass, *reach.distance())
            if below.angular_speeds:
                reach = reach.below_any_rotation()
            for one in below.translations:
                self._add(one.freedom, mass, S.Zero)
            if freely and (below.angular_speeds or below.rotates_freely):
                return
            if freely:
                # Whatever the distance, the moment of the mass about the axes of inward turns vanishes.
                mass = S.Zero
            reach = _below_joint(self._tree, below, reach)

    def _add(
        self, freedom: int, inertia: Expr, mass: Expr, distance: Expr = S.Zero, added: tuple[Expr, ...] = ()
    ) -> None:
        """Add the inertia of a body about an axis at a distance, to which translations add, to a bound.

        The square of a sum is at most the number of its terms times the sum of their squares.
        """
        terms, squares = (2 if added else 1), self._squares[freedom]
        self._constants[freedom] += inertia + terms * mass * distance * distance
        if mass != 0:
            squares |= {s: squares.get(s, S.Zero) + terms * len(added) * mass for s in added}


def least_pivots(tree: Tree, *, together: bool) -> list[Expr]:
    """Return by freedom a lower bound of its pivot (kg m^2, kg); zero where none is known.

    The arguments are those of `CompositeInertias`.
    """
    found: dict[int, Expr] = {}
    for joint in tree.joints:
        tree.about(joint.body, "lower bound of its pivots")
        least = _least_of_joint(tree.system.bodies[joint.body - 1], joint, together)
        found |= {i: tree.definitions.define(f"Dl_{i}", value) for i, value in least.items()}
    return [found[i] for i in range(len(found))]


def _below_joint(tree: Tree, joint: JointMotion, reach: Reach) -> Reach:
    """Return points of the joint frame in the frame of the lower body, from its point O_J."""
    for step in reversed(joint.constant):
        reach = reach.below(step)
    described = tree.system.bodies[joint.body - 1].joint
    center = add(reach.center, Vector(*(exact(value) for value in described.position)))
    translations = list(reach.translations)
    for axis, direction in enumerate(joint.directions):
        if described.moving[3 + axis]:
            translations.append((coordinate(joint.body, 3 + axis), direction))
        else:
            center = add(center, scale(exact(described.locked[3 + axis]), direction))
    center = tree.definitions.vector("cw", center)
    return replace(reach, center=center, translations=tuple(translations))


def _least_of_joint(body: Body, joint: JointMotion, together: bool) -> dict[int, Expr]:
    """Return lower bounds of the pivots of a joint by freedom, from its own body."""
    mass, center = exact(body.mass), [exact(value) for value in body.mass_center]
    angles = [step for step in joint.angles if step.freedom != NO_FREEDOM]
    rotations = [step.freedom for step in angles] + [speed.freedom for speed in joint.angular_speeds]
    least = _least_inertia(body)
    found = dict.fromkeys(rotations, least if _are_orthogonal(angles, together) else S.Zero)
    if joint.hinge and angles:
        axis = joint.hinge.axis
        distance = sum((one**2 for i, one in enumerate(center) if i != axis), S.Zero)
        found[rotations[0]] = exact(body.inertia[axis][axis]) + mass * distance
    carried = mass
    if rotations and not (together and joint.translates_freely):
        # The body may turn instead of following with its mass centre.
        offset = mass * sum((one**2 for one in center), S.Zero)
        carried = mass if offset == 0 else S.Zero
        if least != 0 and not offset.free_symbols:
            carried = mass * least / (least + offset)
    return found | {one.freedom: carried for one in joint.translations}


def _are_orthogonal(angles: list[Step], together: bool) -> bool:
    """Return whether the free angles of a joint turn about orthogonal axes in every state."""
    if len(angles) == 3:
        return together
    return len(angles) < 2 or angles[1].angle - angles[0].angle == 1


def _least_inertia(body: Body) -> Expr:
    """Return a lower bound of the smallest principal inertia: 4 det[I] / trace[I]^2.

    The product of the two other principal inertias is not larger than the square of half their sum. Where
    the inertia depends on parameters, zero.
    """
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = ([exact(value) for value in row] for row in body.inertia)
    trace = xx + yy + zz
    if trace == 0 or trace.free_symbols:
        return S.Zero  # a parameter may become zero
    determinant = xx * (yy * zz - yz**2) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return 4 * determinant / trace**2


def _root(square: Expr) -> Expr:
    """Return the square root of an expression, rounded where it is a number."""
    if not square.is_Rational:
        return sympy.sqrt(square)
    return rational(MULTIPRECISION.sqrt(MULTIPRECISION.mpf(square.p) / square.q)) if square else Rational(0)
