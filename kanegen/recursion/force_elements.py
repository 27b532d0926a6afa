"""Force elements and loads on points: efforts on freedoms, wrenches on bodies, and stored energy.

The ends of a spring between two points are expressed in the frame of the outermost body that carries both,
because the motion of that body changes no length. A spring between neighbours thus costs one joint, wherever
in the tree they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain

import sympy
from sympy import Add, Expr, Rational

from kanegen.model.force_elements.elements import (
    Drive,
    JointFriction,
    JointSpring,
    PointLoad,
    Potential,
    Spring,
)
from kanegen.model.force_elements.names import Place, coordinate_places, speed_places
from kanegen.recursion.constants import exact
from kanegen.recursion.frames import fixed_frame, position_of
from kanegen.recursion.spring_ends import ends, joints_between, separation
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import Wrench, add, cross, dot, negate, scale, subtract
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.expressions import ExpressionTranslator
from kanegen.symbolic.symbols import point_force, point_moment

HALF = Rational(1, 2)


def element_efforts(tree: Tree) -> dict[Place, Expr]:
    """Return the generalized forces of joint springs, drives and potentials, also on locked directions."""
    found: dict[Place, list[Expr]] = {}
    tree.definitions.about("Efforts of force elements")
    for place, effort in _efforts(tree):
        found.setdefault(place, []).append(effort)
    define = tree.definitions.define
    return {(k, index): define(f"fe_{k}_{index + 1}", Add(*parts)) for (k, index), parts in found.items()}


def _efforts(tree: Tree) -> Iterator[tuple[Place, Expr]]:
    """Yield the place (body and freedom) and the effort of every force element on freedoms."""
    bodies, translator = tree.system.bodies, ExpressionTranslator(tree.system, exact, tree.definitions)
    coordinates, speeds = coordinate_places(bodies), speed_places(bodies)
    for element in tree.system.force_elements:
        match element:
            case JointSpring(name, stiffness, rest, damping):
                pull = exact(stiffness) * (translator.coordinate(name) - exact(rest))
                yield coordinates[name], -pull - exact(damping) * translator.speed(name)
            case Drive(freedom=name, effort=effort) | JointFriction(freedom=name, effort=effort):
                yield speeds[name], translator.value(effort)
            case Potential(energy):
                for place, slope in translator.gradient(energy).items():
                    yield place, -slope


def applied_wrenches(tree: Tree) -> dict[int, Wrench]:
    """Return the force and moment of springs and of loads on points, by body."""
    found: dict[int, Wrench] = {}
    for k, load in chain(_spring_wrenches(tree), _point_loads(tree)):
        both = found.get(k, Wrench())
        found[k] = Wrench(add(both.force, load.force), add(both.moment, load.moment))
    return found


def _spring_wrenches(tree: Tree) -> Iterator[tuple[int, Wrench]]:
    """Yield the body and the wrench at either end of every spring between points."""
    for spring in attached_springs(tree):
        pull = spring.pull(tree.definitions)
        for k, position, force in zip(spring.bodies, spring.positions, (pull, negate(pull)), strict=True):
            if k:
                tree.about(k, f"force of spring {spring.number}")
                seen = _outward(tree, k, spring.frame, force, f"ks_{spring.number}")
                yield k, _force_at(tree, k, position, seen)


def _point_loads(tree: Tree) -> Iterator[tuple[int, Wrench]]:
    """Yield the body and the wrench of every load on a point, by force elements and by the caller."""
    translator = ExpressionTranslator(tree.system, exact, tree.definitions)
    for number, element in enumerate(tree.system.force_elements, start=1):
        if isinstance(element, PointLoad):
            tree.definitions.about(f"Load element {number}")
            force, moment = (
                Vector(*map(translator.value, values)) for values in (element.force, element.moment)
            )
            if element.frame:
                yield _load_in_frame(tree, *_place(tree, element.point), force, moment, element.frame)
            else:
                yield _inertial_load(tree, *_place(tree, element.point), force, moment, f"pl_{number}")
    for number, (k, point) in enumerate(tree.system.points, start=1):
        if point.loads:
            force, moment = (
                Vector(*(symbol(number, axis) for axis in range(3))) for symbol in (point_force, point_moment)
            )
            position = position_of(tree, k, point)
            if point.load_frame:
                yield _load_in_frame(tree, k, position, force, moment, point.load_frame)
            else:
                yield _inertial_load(tree, k, position, force, moment, f"pi_{number}")


def _place(tree: Tree, name: str) -> tuple[int, Vector]:
    """Return the body of a point or frame, 0 for the ground, and its position from O_K, in K (m)."""
    k, point = tree.system.place(name)
    return k, position_of(tree, k, point)


def _inertial_load(
    tree: Tree, k: int, position: Vector, force: Vector, moment: Vector, name: str
) -> tuple[int, Wrench]:
    """Return body `k` with the wrench of a force at a point and a moment, given in inertial components."""
    tree.about(k, "load on a point")
    load = _force_at(tree, k, position, _outward(tree, k, 0, force, f"{name}F"))
    return k, Wrench(load.force, add(load.moment, _outward(tree, k, 0, moment, f"{name}M")))


def _load_in_frame(
    tree: Tree, k: int, position: Vector, force: Vector, moment: Vector, name: str
) -> tuple[int, Wrench]:
    """Return body `k` with the wrench of a force at a point and a moment, given in a frame of the body."""
    tree.about(k, "load on a point")
    frame = fixed_frame(tree, name, k)
    load = _force_at(tree, k, position, frame.inward(force))
    return k, Wrench(load.force, add(load.moment, frame.inward(moment)))


def _force_at(tree: Tree, k: int, position: Vector, force: Vector) -> Wrench:
    """Return the wrench of a force at a point of body `k`, in its frame."""
    arm = tree.definitions.vector(f"r_{k}l", subtract(position, tree.joints[k - 1].origin))
    return Wrench(force, cross(arm, force))


def stored_energy(tree: Tree) -> Expr:
    """Return the energy that springs and potentials store (J)."""
    parts: list[Expr] = []
    translator = ExpressionTranslator(tree.system, exact, tree.definitions)
    for element in tree.system.force_elements:
        if isinstance(element, JointSpring):
            stretch = translator.coordinate(element.freedom) - exact(element.rest)
            stretch = tree.definitions.define("kx", stretch)
            parts.append(HALF * exact(element.stiffness) * stretch**2)
        elif isinstance(element, Potential):
            parts.append(translator.value(element.energy))
    parts += [spring.energy(tree.definitions) for spring in attached_springs(tree)]
    return Add(*parts)


@dataclass(frozen=True)
class AttachedSpring:
    """A spring and damper between points of two bodies.

    Attributes:
        spring: The element.
        number: Number of the spring, from 1.
        bodies: Bodies of the two ends, 0 for the ground.
        positions: Positions of the two ends from the O of their bodies, in the frames of these bodies (m).
        frame: Number of the outermost body that carries both ends.
        separation: Vector from the first end to the second, in that frame (m).
        rate: Rate of `separation` in that frame (m/s).
    """

    spring: Spring
    number: int
    bodies: tuple[int, int]
    positions: tuple[Vector, Vector]
    frame: int
    separation: Vector
    rate: Vector

    def pull(self, definitions: Definitions) -> Vector:
        """Return the force on the first end, in `frame` (N)."""
        definitions.about(f"Spring {self.number}: force")
        spring, n = self.spring, self.number
        stiffness, rest, damping = (exact(v) for v in (spring.stiffness, spring.rest_length, spring.damping))
        factor = stiffness
        if rest != 0 and stiffness != 0:
            share = definitions.define(f"kr_{n}", rest / self._length(definitions))
            factor = stiffness * definitions.define(f"ku_{n}", 1 - share)
        if damping != 0:
            closing = definitions.define(f"kd_{n}", dot(self.separation, self.rate))
            factor += damping * definitions.define(f"kv_{n}", closing / self._squared_length(definitions))
        return definitions.vector(f"kF_{n}", scale(definitions.define(f"kf_{n}", factor), self.separation))

    def energy(self, definitions: Definitions) -> Expr:
        """Return the energy that the spring stores (J)."""
        definitions.about(f"Spring {self.number}: energy")
        stiffness, rest = exact(self.spring.stiffness), exact(self.spring.rest_length)
        if rest == 0 or stiffness == 0:
            return HALF * stiffness * self._squared_length(definitions)
        stretch = definitions.define(f"kx_{self.number}", self._length(definitions) - rest)
        return HALF * stiffness * stretch**2

    def _squared_length(self, definitions: Definitions) -> Expr:
        """Return the squared distance of the two ends (m^2)."""
        return definitions.define(f"kq_{self.number}", dot(self.separation, self.separation))

    def _length(self, definitions: Definitions) -> Expr:
        """Return the distance of the two ends (m)."""
        return definitions.define(f"kl_{self.number}", sympy.sqrt(self._squared_length(definitions)))


def attached_springs(tree: Tree) -> Iterator[AttachedSpring]:
    """Yield the springs between points of a tree.

    Raises:
        ModelError: If a spring whose direction matters has no length in any state.
    """
    springs = [element for element in tree.system.force_elements if isinstance(element, Spring)]
    for number, spring in enumerate(springs, start=1):
        (a, first), (b, second) = (
            _place(tree, end) if isinstance(end, str) else (0, Vector(*map(exact, end)))
            for end in spring.between
        )
        frame = _carrier_of_both(tree, a, b)
        start, end = ends(tree, frame, (a, b), (first, second), (f"k{number}a", f"k{number}b"))
        tree.definitions.about(f"Spring {number}: the way between its ends, and its rate")
        between = tree.definitions.vector(f"kw_{number}", separation(start.place, end.place))
        if spring.may_be_undefined and all(part == 0 for part in between):
            raise spring.without_length(number)
        rate = tree.definitions.vector(f"kwd_{number}", subtract(end.velocity, start.velocity))
        yield AttachedSpring(spring, number, (a, b), (first, second), frame, between, rate)


def _carrier_of_both(tree: Tree, a: int, b: int) -> int:
    """Return the outermost body that carries the bodies `a` and `b`."""
    while a != b:
        # A lower body has the lower number.
        a, b = min(a, b), tree.joints[max(a, b) - 1].lower
    return a


def _outward(tree: Tree, k: int, frame: int, v: Vector, name: str) -> Vector:
    """Return a vector in components of body `k`, from those of the body `frame`, which carries `k`."""
    for joint in reversed(joints_between(tree, k, frame)):
        for step in joint.steps:
            v = tree.definitions.vector(f"{name}_{joint.above(step)}", step.turn.up(v))
    return v
