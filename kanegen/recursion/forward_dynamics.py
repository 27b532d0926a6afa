"""{ydot} from the generalized forces, by articulated bodies.

Inward, every free component of a joint's acceleration is eliminated; outward, each is solved for. A joint
whose three angles are free is solved in angular acceleration, where it is regular, and only the result is
mapped to the angles by Eq. (9); so is one whose three translations are free, in the body's own frame. A joint
with all six freedoms passes nothing inward but its efforts: the body behind it moves as if it were free.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from sympy import Expr

from kanegen.recursion.articulated import Articulated, Elimination, rigid
from kanegen.recursion.derived import Derived
from kanegen.recursion.joints import NO_FREEDOM, JointMotion
from kanegen.recursion.motion import outward, required
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, subtract, unit
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.symbols import generalized_force

TURNS, SLIDES = (0, 1, 2), (3, 4, 5)


@dataclass
class _Solution:
    """What a joint's eliminations leave for the way outward, in the order of elimination."""

    angles: dict[int, Elimination] = field(default_factory=dict)
    slides: dict[int, Elimination] = field(default_factory=dict)
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
        """What body K passes to its lower body, about O_J."""
        k, solution = motion.body, _Solution()
        if _slides_freely(motion):
            along = Vector(*(self.efforts[slide.freedom] for slide in motion.slides))
            for step in motion.angles:
                along = self.definitions.vector(f"tF_{step.frame}u", step.turn.up(along))
            for index, effort in zip(SLIDES, along, strict=True):
                body = self._eliminate(body, index, effort, f"{k}s{index - 2}", solution.body)
            self._pivots([slide.freedom for slide in motion.slides], solution.body[:3])
        if _turns_freely(motion):
            before = len(solution.body)
            for index, effort in zip(TURNS, self._torque(motion), strict=True):
                body = self._eliminate(body, index, effort, f"{k}t{index + 1}", solution.body)
            self._pivots([step.freedom for step in motion.angles], solution.body[before:])
            first = motion.angles[0].freedom
            cosine = _cosine(motion, 1)
            self.pivots[first] = self.definitions.define(f"D_{k}", self.pivots[first] * cosine * cosine)
        for step in reversed(motion.angles):
            if step.freedom != NO_FREEDOM and not _turns_freely(motion):
                found: list[Elimination] = []
                body = self._eliminate(body, step.axis, self.efforts[step.freedom], f"{step.frame}t", found)
                self._pivots([step.freedom], found)
                solution.angles[step.freedom] = found[0]
            body = body.down(step.turn, step.frame, self.definitions)
        if not _slides_freely(motion):
            for slide in motion.slides:
                found = []
                effort = self.efforts[slide.freedom]
                body = self._eliminate(body, 3 + slide.axis, effort, f"{k}s{slide.axis + 1}", found)
                self._pivots([slide.freedom], found)
                solution.slides[slide.freedom] = found[0]
        for step in reversed(motion.constant):
            body = body.down(step.turn, step.frame, self.definitions)
        return body.shifted(motion.offset, f"{k}j", self.definitions), solution

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
            if slide.freedom in solution.slides:
                a = _set(a, slide.axis, self._solve(slide.freedom, solution.slides[slide.freedom], alpha, a))
        for step in motion.angles:
            alpha = define.vector(f"qw_{step.frame}u", step.turn.up(alpha))
            a = define.vector(f"qa_{step.frame}u", step.turn.up(a))
            if step.freedom in solution.angles:
                total = self._solve(step.freedom, solution.angles[step.freedom], alpha, a)
                alpha = _set(alpha, step.axis, total)
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

    def _eliminate(
        self, body: Articulated, index: int, effort: Expr, name: str, found: list[Elimination]
    ) -> Articulated:
        left, elimination = body.eliminated(index, effort, name, self.definitions)
        found.append(elimination)
        return left

    def _pivots(self, freedoms: list[int], eliminations: list[Elimination]) -> None:
        self.pivots |= {f: e.pivot for f, e in zip(freedoms, eliminations, strict=True)}

    def _solve(self, freedom: int, elimination: Elimination, alpha: Vector, a: Vector) -> Expr:
        """The total of a free component; what the lower body does not carry along is the coordinate's."""
        carried = [*alpha, *a]
        total = self.definitions.define(f"q_{freedom}", elimination.solve(carried))
        self.result[freedom] = self.definitions.define(f"ydot_{freedom}", total - carried[elimination.index])
        return total

    def _torque(self, motion: JointMotion) -> Vector:
        """The torque, in the body, that works on the angle rates as their efforts do: [P]^T {T} = {tau}."""
        one, two, three = (self.efforts[step.freedom] for step in motion.angles)
        sine2 = _sine(motion, 1)
        sine3, cosine3 = _sine(motion, 2), _cosine(motion, 2)
        name = f"T_{motion.body}"
        q = self.definitions.define(f"{name}_q", (one - sine2 * three) * self._reciprocal(motion))
        torque = Vector(cosine3 * q + sine3 * two, cosine3 * two - sine3 * q, three)
        return self.definitions.vector(name, torque)

    def _angles(self, motion: JointMotion, spin: Vector) -> None:
        """Second derivatives of the angles behind a relative angular acceleration, Eq. (9)."""
        spin = self.definitions.vector(f"qr_{motion.body}", spin)
        sine3, cosine3 = _sine(motion, 2), _cosine(motion, 2)
        one, two, three = (step.freedom for step in motion.angles)
        define = self.definitions.define
        across = define(f"qq_{motion.body}", cosine3 * spin.x - sine3 * spin.y)
        self.result[one] = define(f"ydot_{one}", across * self._reciprocal(motion))
        self.result[two] = define(f"ydot_{two}", sine3 * spin.x + cosine3 * spin.y)
        self.result[three] = define(f"ydot_{three}", spin.z - _sine(motion, 1) * self.result[one])

    def _reciprocal(self, motion: JointMotion) -> Expr:
        return self.definitions.define(f"Ci_{motion.body}_2", 1 / _cosine(motion, 1))


def _turns_freely(motion: JointMotion) -> bool:
    return sum(step.freedom != NO_FREEDOM for step in motion.angles) == len(TURNS)


def _slides_freely(motion: JointMotion) -> bool:
    return len(motion.slides) == len(SLIDES)


def _sine(motion: JointMotion, axis: int) -> Expr:
    return motion.angles[axis].turn.up(unit((axis + 1) % 3))[(axis + 2) % 3] * -1


def _cosine(motion: JointMotion, axis: int) -> Expr:
    j = (axis + 1) % 3
    return motion.angles[axis].turn.up(unit(j))[j]


def _set(v: Vector, axis: int, value: Expr) -> Vector:
    return Vector(*(value if i == axis else component for i, component in enumerate(v)))
