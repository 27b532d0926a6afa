"""{ydot} from the generalized forces, by articulated bodies.

Inward, every free component of a joint's acceleration is eliminated; outward, each is solved for. A joint
whose three angles are free is solved in angular acceleration, where it is regular, and only the result is
mapped to the angles by Eq. (9); so is one whose three translations are free, in the body's own frame. A joint
with all six freedoms passes nothing inward but its efforts: the body behind it moves as if it were free.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from sympy import Expr

from kanegen.recursion.articulated import Articulated, Elimination, rigid
from kanegen.recursion.derived import Derived
from kanegen.recursion.joints import NO_FREEDOM, JointMotion, Slide, Step
from kanegen.recursion.motion import outward, required
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, subtract
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.symbols import generalized_force

TURNS, SLIDES = (0, 1, 2), (3, 4, 5)


@dataclass
class _Solution:
    """What a joint's eliminations leave for the way outward.

    Attributes:
        coordinates: By freedom, where a component is a coordinate's own.
        body: In the order of elimination, where three components are free in the body's frame.
    """

    coordinates: dict[int, Elimination] = field(default_factory=dict)
    body: list[Elimination] = field(default_factory=list)


def forward_dynamics(tree: Tree) -> Derived:
    """The entries of {ydot}, and for each a pivot that is positive where [A] is regular."""
    freedoms = tree.system.freedoms
    efforts = [generalized_force(freedom.body, freedom.index) for freedom in freedoms]
    recursion = _Recursion(tree.definitions, efforts)
    moved = outward(tree, accelerated=False)
    bodies = [rigid(own, required(tree, k, moved[k])) for k, own in enumerate(tree.inertias, start=1)]
    solutions: dict[int, _Solution] = {}
    for motion in reversed(tree.motions):
        k, j = motion.body, motion.lower
        tree.about(k, "articulated body, Eq. (42)")
        passed, solutions[k] = recursion.inward(motion, bodies[k - 1])
        if j:
            bodies[j - 1] = bodies[j - 1].plus(passed, f"{j}", tree.definitions)
    accelerations = {0: (ZERO, ZERO)}
    for motion in tree.motions:
        tree.about(motion.body, "accelerations, Eq. (42)")
        lower = accelerations[motion.lower]
        accelerations[motion.body] = recursion.outward(motion, solutions[motion.body], *lower)
    places = range(len(freedoms))
    return Derived([recursion.result[i] for i in places], [recursion.pivots[i] for i in places])


@dataclass
class _Recursion:
    """The inward and outward step over one joint, and what they have found."""

    definitions: Definitions
    efforts: list[Expr]
    result: dict[int, Expr] = field(default_factory=dict)
    pivots: dict[int, Expr] = field(default_factory=dict)

    def inward(self, motion: JointMotion, body: Articulated) -> tuple[Articulated, _Solution]:
        """What body K passes to its lower body, about the lower body's origin."""
        solution = _Solution()
        if _slides_freely(motion):
            body = self._eliminate_all(body, SLIDES, self._push(motion), motion.slides, solution)
        if _turns_freely(motion):
            body = self._eliminate_all(body, TURNS, self._torque(motion), motion.angles, solution)
            self._weaken_pivot(motion)
        for step in reversed(motion.angles):
            if step.freedom != NO_FREEDOM and not _turns_freely(motion):
                body = self._eliminate(body, step.axis, step.freedom, solution)
            body = body.down(step.turn, step.frame, self.definitions)
        if not _slides_freely(motion):
            for slide in motion.slides:
                body = self._eliminate(body, 3 + slide.axis, slide.freedom, solution)
        for step in reversed(motion.constant):
            body = body.down(step.turn, step.frame, self.definitions)
        return body.shifted(motion.offset, f"{motion.body}j", self.definitions), solution

    def _eliminate(self, body: Articulated, index: int, freedom: int, solution: _Solution) -> Articulated:
        """A component that is a coordinate's own."""
        effort = self.efforts[freedom]
        left, found = body.eliminated(index, effort, f"{freedom}", self.definitions)
        solution.coordinates[freedom] = found
        self.pivots[freedom] = found.pivot
        return left

    def _eliminate_all(
        self,
        body: Articulated,
        indices: Sequence[int],
        efforts: Vector,
        behind: Sequence[Step | Slide],
        solution: _Solution,
    ) -> Articulated:
        """Three components that the coordinates `behind` them make free together."""
        for index, effort, coordinate in zip(indices, efforts, behind, strict=True):
            body, found = body.eliminated(index, effort, f"{coordinate.freedom}", self.definitions)
            solution.body.append(found)
            self.pivots[coordinate.freedom] = found.pivot
        return body

    def _weaken_pivot(self, motion: JointMotion) -> None:
        """Where the angles' axes lie in a plane, [A] is singular though the body is not."""
        first, second, _ = motion.angles
        weakened = self.pivots[first.freedom] * second.cosine * second.cosine
        self.pivots[first.freedom] = self.definitions.define(f"Dc_{motion.body}", weakened)

    def outward(
        self, motion: JointMotion, solution: _Solution, alpha: Vector, a: Vector
    ) -> tuple[Vector, Vector]:
        """Angular acceleration of body K and acceleration of O_K, from those of its lower body."""
        k, define = motion.body, self.definitions
        a = define.vector(f"qa_{k}j", add(a, cross(alpha, motion.offset)))
        for step in motion.constant:
            alpha = define.vector(f"qw_{step.frame}u", step.turn.up(alpha))
            a = define.vector(f"qa_{step.frame}u", step.turn.up(a))
        for slide in reversed(motion.slides):
            if slide.freedom in solution.coordinates:
                a = _set(a, slide.axis, self._solve(slide.freedom, solution, alpha, a))
        for step in motion.angles:
            alpha = define.vector(f"qw_{step.frame}u", step.turn.up(alpha))
            a = define.vector(f"qa_{step.frame}u", step.turn.up(a))
            if step.freedom in solution.coordinates:
                alpha = _set(alpha, step.axis, self._solve(step.freedom, solution, alpha, a))
        return self._solve_body(motion, solution.body, alpha, a)

    def _solve_body(
        self, motion: JointMotion, eliminations: list[Elimination], alpha: Vector, a: Vector
    ) -> tuple[Vector, Vector]:
        """The components that are free in the body's own frame, and the coordinates behind them."""
        total = [*alpha, *a]
        for elimination in reversed(eliminations):
            name = f"q_{motion.body}_{elimination.index}"
            total[elimination.index] = self.definitions.define(name, elimination.solve(total))
        turned, moved = Vector(*total[:3]), Vector(*total[3:])
        if _turns_freely(motion):
            self._angles(motion, subtract(turned, alpha))
        if _slides_freely(motion):
            sliding = self.definitions.vector(f"qs_{motion.body}", subtract(moved, a))
            for step in reversed(motion.angles):
                sliding = self.definitions.vector(f"qs_{step.frame}", step.turn.down(sliding))
            self.result |= {slide.freedom: sliding[slide.axis] for slide in motion.slides}
        return turned, moved

    def _solve(self, freedom: int, solution: _Solution, alpha: Vector, a: Vector) -> Expr:
        """The total of a free component; what the lower body does not carry along is the coordinate's."""
        carried = [*alpha, *a]
        elimination = solution.coordinates[freedom]
        total = self.definitions.define(f"q_{freedom}", elimination.solve(carried))
        self.result[freedom] = self.definitions.define(f"ydot_{freedom}", total - carried[elimination.index])
        return total

    def _push(self, motion: JointMotion) -> Vector:
        """The force, in the body, that works on the translations as their efforts do."""
        push = Vector(*(self.efforts[slide.freedom] for slide in motion.slides))
        for step in motion.angles:
            push = self.definitions.vector(f"tF_{step.frame}u", step.turn.up(push))
        return push

    def _torque(self, motion: JointMotion) -> Vector:
        """The torque, in the body, that works on the angle rates as their efforts do: [P]^T {T} = {tau}."""
        one, two, three = (self.efforts[step.freedom] for step in motion.angles)
        _, second, third = motion.angles
        name = f"T_{motion.body}"
        q = self.definitions.define(f"{name}_q", (one - second.sine * three) * self._reciprocal(second))
        torque = Vector(third.cosine * q + third.sine * two, third.cosine * two - third.sine * q, three)
        return self.definitions.vector(name, torque)

    def _angles(self, motion: JointMotion, spin: Vector) -> None:
        """Second derivatives of the angles behind a relative angular acceleration, Eq. (9)."""
        first, second, third = motion.angles
        define = self.definitions.define
        spin = self.definitions.vector(f"qr_{motion.body}", spin)
        across = define(f"qq_{motion.body}", third.cosine * spin.x - third.sine * spin.y)
        one = define(f"ydot_{first.freedom}", across * self._reciprocal(second))
        two = define(f"ydot_{second.freedom}", third.sine * spin.x + third.cosine * spin.y)
        three = define(f"ydot_{third.freedom}", spin.z - second.sine * one)
        self.result |= {first.freedom: one, second.freedom: two, third.freedom: three}

    def _reciprocal(self, step: Step) -> Expr:
        return self.definitions.define(f"Ci_{step.frame}", 1 / step.cosine)


def _turns_freely(motion: JointMotion) -> bool:
    return sum(step.freedom != NO_FREEDOM for step in motion.angles) == len(TURNS)


def _slides_freely(motion: JointMotion) -> bool:
    return len(motion.slides) == len(SLIDES)


def _set(v: Vector, axis: int, value: Expr) -> Vector:
    return Vector(*(value if i == axis else component for i, component in enumerate(v)))
