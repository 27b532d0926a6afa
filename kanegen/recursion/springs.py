"""Springs and dampers between points of two bodies.

Both ends are followed inward to the first body that carries both, and seen from there: what that body does
itself changes no length. So a spring between neighbours costs one joint, wherever in the tree they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import sympy
from sympy import Expr, Rational

from kanegen.model.force_elements.elements import Spring
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.joints import exact
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, dot, scale, subtract, unit
from kanegen.symbolic.definitions import Definitions, Vector

HALF = Rational(1, 2)


@dataclass(frozen=True)
class Tie:
    """A spring and what holds its ends.

    Attributes:
        spring: The element.
        number: From 1, for names.
        bodies: Of both ends, 0 for the ground.
        positions: Of both ends, each from O of its body, in its frame (m).
        frame: The body from which both are seen.
        way: From the first end to the second, in that frame (m).
        rate: Of `way`, as seen there (m/s).
    """

    spring: Spring
    number: int
    bodies: tuple[int, int]
    positions: tuple[Vector, Vector]
    frame: int
    way: Vector
    rate: Vector

    def pull(self, definitions: Definitions) -> Vector:
        """The force on the first end, in `frame`."""
        definitions.about(f"Spring {self.number}: force")
        spring, n = self.spring, self.number
        stiffness, rest, damping = (exact(v) for v in (spring.stiffness, spring.rest_length, spring.damping))
        factor = stiffness
        if rest != 0 and stiffness != 0:
            share = definitions.define(f"kr_{n}", rest / self._length(definitions))
            factor = stiffness * definitions.define(f"ku_{n}", 1 - share)
        if damping != 0:
            closing = definitions.define(f"kd_{n}", dot(self.way, self.rate))
            factor += damping * definitions.define(f"kv_{n}", closing / self._square(definitions))
        return definitions.vector(f"kF_{n}", scale(definitions.define(f"kf_{n}", factor), self.way))

    def energy(self, definitions: Definitions) -> Expr:
        """What the spring stores (J)."""
        definitions.about(f"Spring {self.number}: energy")
        stiffness, rest = exact(self.spring.stiffness), exact(self.spring.rest_length)
        if rest == 0 or stiffness == 0:
            return HALF * stiffness * self._square(definitions)
        stretch = definitions.define(f"kx_{self.number}", self._length(definitions) - rest)
        return HALF * stiffness * stretch**2

    def _square(self, definitions: Definitions) -> Expr:
        return definitions.define(f"kq_{self.number}", dot(self.way, self.way))

    def _length(self, definitions: Definitions) -> Expr:
        return definitions.define(f"kl_{self.number}", sympy.sqrt(self._square(definitions)))


def ties(tree: Tree) -> Iterator[Tie]:
    """The springs of a tree."""
    places = {point.name: (k, point.position) for k, point in tree.system.points}
    springs = [element for element in tree.system.force_elements if isinstance(element, Spring)]
    for number, spring in enumerate(springs, start=1):
        (a, one), (b, two) = (places[end] if isinstance(end, str) else (0, end) for end in spring.between)
        first, second = Vector(*map(exact, one)), Vector(*map(exact, two))
        frame = _common(tree, a, b)
        start, left = _seen(tree, a, first, frame, f"k{number}a")
        stop, reached = _seen(tree, b, second, frame, f"k{number}b")
        tree.definitions.about(f"Spring {number}: the way between its ends, and its rate")
        way = tree.definitions.vector(f"kw_{number}", subtract(stop, start))
        rate = tree.definitions.vector(f"kwd_{number}", subtract(reached, left))
        yield Tie(spring, number, (a, b), (first, second), frame, way, rate)


def joints_to(tree: Tree, k: int, frame: int) -> list[JointMotion]:
    """The joints from body `k` inward to the body `frame`."""
    found: list[JointMotion] = []
    while k != frame:
        found.append(tree.motions[k - 1])
        k = found[-1].lower
    return found


def outward(tree: Tree, k: int, frame: int, v: Vector, name: str) -> Vector:
    """A vector of the body `frame` in components of body `k`, which it carries."""
    for motion in reversed(joints_to(tree, k, frame)):
        for step in motion.steps:
            v = tree.definitions.vector(f"{name}_{motion.above(step)}", step.turn.up(v))
    return v


def _common(tree: Tree, a: int, b: int) -> int:
    """The outermost body that carries both."""
    while a != b:
        # A lower body has the lower number.
        a, b = min(a, b), tree.motions[max(a, b) - 1].lower
    return a


def _seen(tree: Tree, k: int, position: Vector, frame: int, name: str) -> tuple[Vector, Vector]:
    """A point of body `k` from O of the body `frame`, and how it moves there."""
    define, velocity = tree.definitions.vector, ZERO
    for motion in joints_to(tree, k, frame):
        tree.about(motion.body, "an end of a spring, Eqs. (22), (25)")
        velocity = add(velocity, cross(motion.spinning, position))
        for step in reversed(motion.steps):
            velocity = add(velocity, cross(scale(step.rate, unit(step.axis)), position))
            velocity = define(f"{name}v_{step.frame}", step.turn.down(velocity))
            position = define(f"{name}_{step.frame}", step.turn.down(position))
        for slide in motion.sliding:
            velocity = add(velocity, scale(slide.rate, slide.direction))
        velocity = define(f"{name}v_{motion.body}j", velocity)
        position = define(f"{name}_{motion.body}j", add(motion.arm, position))
    return position, velocity
