"""{ydot} from the generalized forces, by articulated bodies.

Inward, every free component of a joint's acceleration is eliminated; outward, each is solved for. A joint
whose three angles are free is solved in angular acceleration, where it is regular, and only the result is
mapped to the angles by Eq. (9), unless its speeds are the angular velocity itself; so is one whose three
translations are free, in the body's own frame. A joint with all six freedoms passes nothing inward but its
efforts: the body behind it moves as if it were free.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sympy import Expr, S

from kanegen.recursion.articulated import Articulated, Elimination, rigid
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.joint_path import (
    STILL,
    TURNS,
    Free,
    Shifted,
    Stop,
    Turned,
    slides_freely,
    stops,
    turns_freely,
)
from kanegen.recursion.loads import efforts
from kanegen.recursion.motion import Requirement
from kanegen.recursion.rates import angle_rates
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import column
from kanegen.symbolic.definitions import Vector
from kanegen.symbolic.symbols import generalized_force


class ArticulatedBodies:
    """The eliminations of a tree, which solve [A]{ydot} = {b} for any right side.

    Attributes:
        tree: What was eliminated.
        ways: By body the stops of its joint. Its free components are what is solved for.
        pivots: By freedom; positive where the free components follow from the forces.
    """

    def __init__(self, tree: Tree) -> None:
        """Eliminate every free component, from the outermost body inward."""
        self.tree = tree
        self.ways: Mapping[int, tuple[Stop, ...]] = {
            motion.body: stops(motion, together=True) for motion in tree.motions
        }
        self._eliminations: dict[int, Elimination] = {}
        bodies = [rigid(own) for own in tree.inertias]
        for motion in reversed(tree.motions):
            k, j = motion.body, motion.lower
            tree.about(k, "articulated body, Eq. (42)")
            passed = self._eliminate(motion, bodies[k - 1])
            if j:
                bodies[j - 1] = bodies[j - 1].plus(passed, f"{j}", tree.definitions)
        self.pivots: Sequence[Expr] = [self._eliminations[i].pivot for i in range(len(tree.system.freedoms))]

    def _eliminate(self, motion: JointMotion, body: Articulated) -> Articulated:
        """What body K passes to its lower body, about the lower body's origin."""
        definitions = self.tree.definitions
        for stop in self.ways[motion.body]:
            match stop:
                case Free(index, freedom):
                    body, found = body.eliminated(index, f"{freedom}", definitions)
                    self._eliminations[freedom] = found
                case Turned(turn, name):
                    body = body.down(turn, name, definitions)
                case Shifted(offset, name):
                    body = body.shifted(offset, name, definitions)
        return body

    def solve(self, needs: Sequence[Requirement], name: str) -> list[Expr]:
        """The free components of the accelerations that the efforts cause.

        Args:
            needs: What each body needs for anything else.
            name: For names.
        """
        tree, definitions, efforts = self.tree, self.tree.definitions, self._efforts()
        free: dict[int, Expr] = {}
        carried = list(needs)
        for motion in reversed(tree.motions):
            k, j = motion.body, motion.lower
            tree.about(k, "forces on the articulated body, Eq. (42)")
            need = carried[k - 1]
            for stop in self.ways[k]:
                if isinstance(stop, Free):
                    elimination = self._eliminations[stop.freedom]
                    need, free[stop.freedom] = elimination.passed(need, efforts[stop.freedom], definitions)
                else:
                    need = stop.inward(need, definitions)
            if j:
                carried[j - 1] = carried[j - 1].plus(need, f"{j}", definitions)
        return self._outward(free, name)

    def _outward(self, free: dict[int, Expr], name: str) -> list[Expr]:
        """The free components, each from what it is where the others are zero."""
        found: dict[int, Expr] = {}
        accelerations = {0: STILL}
        for motion in self.tree.motions:
            self.tree.about(motion.body, "accelerations, Eq. (42)")
            a = accelerations[motion.lower]
            for stop in reversed(self.ways[motion.body]):
                if isinstance(stop, Free):
                    i, freedom = stop.index, stop.freedom
                    solution = self._eliminations[freedom].solve(free[freedom], a)
                    total = self.tree.definitions.define(f"q_{freedom}", solution)
                    # What the lower body does not carry along is the coordinate's.
                    found[freedom] = self.tree.definitions.define(f"{name}_{freedom}", total - a[i])
                    a = (*a[:i], total, *a[i + 1 :])
                else:
                    a = stop.outward(a, self.tree.definitions)
            accelerations[motion.body] = a
        return [found[i] for i in range(len(found))]

    def coordinates(self, found: Sequence[Expr], name: str) -> list[Expr]:
        """{ydot} behind free components."""
        result, definitions = dict(enumerate(found)), self.tree.definitions
        for motion in self.tree.motions:
            self.tree.about(motion.body, "{ydot} of the joint, Eq. (9)")
            if turns_freely(motion):
                freedoms = [step.freedom for step in motion.angles]
                one, two, three = (f"{name}_{freedom}" for freedom in freedoms)
                spin = Vector(*(found[freedom] for freedom in freedoms))
                values = angle_rates(motion, definitions).rates(spin, (one, two, three))
                result |= dict(zip(freedoms, values, strict=True))
            if slides_freely(motion):
                sliding = Vector(*(found[slide.freedom] for slide in motion.slides))
                for step in reversed(motion.angles):
                    sliding = definitions.vector(f"qs_{step.frame}", step.turn.down(sliding))
                result |= {slide.freedom: sliding[slide.axis] for slide in motion.slides}
        return [result[i] for i in range(len(found))]

    def _efforts(self) -> list[Expr]:
        """{tau} and the efforts of force elements, as forces and torques along the free components."""
        tree, definitions, acting = self.tree, self.tree.definitions, efforts(self.tree)
        result: dict[int, Expr] = {}
        for i, f in enumerate(tree.system.freedoms):
            effort = generalized_force(f.body, f.index) + acting.get((f.body, f.index), S.Zero)
            result[i] = definitions.define(f"te_{i}", effort)
        for motion in tree.motions:
            tree.about(motion.body, "efforts in the body, Eq. (9)")
            if slides_freely(motion):
                push = Vector(*(result[slide.freedom] for slide in motion.slides))
                for step in motion.angles:
                    push = definitions.vector(f"tF_{step.frame}u", step.turn.up(push))
                result |= {slide.freedom: push[slide.axis] for slide in motion.slides}
            if turns_freely(motion):
                freedoms = [step.freedom for step in motion.angles]
                one, two, three = (result[freedom] for freedom in freedoms)
                torque = angle_rates(motion, definitions).torque((one, two, three))
                result |= dict(zip(freedoms, torque, strict=True))
        return [result[i] for i in range(len(result))]

    @property
    def positive(self) -> list[Expr]:
        """By freedom what is positive where [A] is regular."""
        result = list(self.pivots)
        for motion in self.tree.motions:
            # Where the angles' axes lie in a plane, [A] is singular though the body is not.
            if turns_freely(motion):
                first, across = motion.angles[0].freedom, angle_rates(motion, self.tree.definitions).across
                weakened = result[first] * across * across
                result[first] = self.tree.definitions.define(f"Dc_{motion.body}", weakened)
        return result

    @property
    def diagonal(self) -> list[Expr]:
        """By freedom what the pivot would be if everything else stood still: of the composite body."""
        tree, definitions = self.tree, self.tree.definitions
        result: dict[int, Expr] = {}
        bodies = list(tree.inertias)
        for motion in reversed(tree.motions):
            k, j = motion.body, motion.lower
            tree.about(k, "composite body, Eq. (43)")
            composite = bodies[k - 1]
            for stop in self.ways[k]:
                match stop:
                    case Free(index, freedom):
                        inertia = column(composite.inertia, index % 3)[index % 3]
                        result[freedom] = inertia if index in TURNS else composite.mass
                    case Turned(turn, name):
                        composite = composite.down(turn, name, definitions)
                    case Shifted(offset, name):
                        composite = composite.shifted(offset, name, definitions)
            if j:
                bodies[j - 1] = bodies[j - 1].plus(composite, str(j), definitions)
        return [result[i] for i in range(len(result))]
