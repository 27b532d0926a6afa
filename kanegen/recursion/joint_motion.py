"""A joint as the recursions see it: a shift of origin, then turns from the lower frame to the body's."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, add, scale, unit
from kanegen.symbolic.definitions import Vector

NO_FREEDOM = -1
NO_ANGLE = -1


@dataclass(frozen=True)
class Step:
    """One turn of a joint.

    Attributes:
        turn: From the lower to the upper frame.
        freedom: Number in {x} of the angle that turns it, or `NO_FREEDOM`.
        axis: Basis vector about which that angle turns.
        rate: The angle's rate.
        acceleration: The angle's second derivative.
        sine: Of the angle.
        cosine: Of the angle.
        frame: Suffix for the names of quantities seen below this turn.
        angle: Which of the joint's three angles turns it, free or locked, from 0; or `NO_ANGLE`.
        number: That in {x}, or of a prescribed angle that behind {x}: `system.prescribed` go on counting.
    """

    turn: Turn
    frame: str
    freedom: int = NO_FREEDOM
    axis: int = 0
    rate: Expr = S.Zero
    acceleration: Expr = S.Zero
    sine: Expr = S.Zero
    cosine: Expr = S.One
    angle: int = NO_ANGLE
    number: int = NO_FREEDOM

    @property
    def moves(self) -> bool:
        """Whether an angle turns it, free or prescribed."""
        return self.number != NO_FREEDOM


@dataclass(frozen=True)
class Slide:
    """One translation that moves.

    Attributes:
        freedom: Its number in {x}, or `NO_FREEDOM`.
        axis: Basis vector of the joint frame along which it moves.
        direction: The same in the lower body's frame.
        rate: Its rate.
        acceleration: Its second derivative.
        number: That in {x}, or behind {x} as that of a `Step`.
    """

    freedom: int
    axis: int
    direction: Vector
    rate: Expr
    acceleration: Expr
    number: int


@dataclass(frozen=True)
class Spin:
    """One free component of the relative angular velocity, Eq. (8), in the frame of body K, above all turns.

    Attributes:
        freedom: Its number in {y}.
        axis: Basis vector along which it points.
        rate: The component itself.
        acceleration: Its derivative.
    """

    freedom: int
    axis: int
    rate: Expr
    acceleration: Expr


@dataclass(frozen=True)
class JointMotion:
    """How body K moves on its lower body J.

    Attributes:
        body: K.
        lower: J, 0 for the ground.
        arm: From O_J to O_K, in J (m): {q'_K} + [C_K]^T {s'_K}.
        directions: Of the three translations, free or locked, in J: basis vectors of the joint frame.
        offset: From the origin of J to that of K, in J (m): `arm` and what the `origin` of both adds.
        origin: From O_K to the point of K that serves as its origin, in K (m); see `_origin`.
        slides: The free translations.
        constant: The turns of [C_K], from J to the joint frame.
        angles: The turns of the angles, from the joint frame to K.
        spins: The free components of the relative angular velocity, if these are the speeds of the joint.
            The joint then turns as a whole, by one of `angles` that has neither freedom nor rate.
        behind: The turns of the angles from which that one is made; none where a quaternion makes it.
        through: `constant` and `angles` as one turn, for what passes both.
        drives: The prescribed translations.
    """

    body: int
    lower: int
    arm: Vector
    directions: tuple[Vector, Vector, Vector]
    offset: Vector
    origin: Vector
    slides: tuple[Slide, ...]
    constant: tuple[Step, ...]
    angles: tuple[Step, ...]
    spins: tuple[Spin, ...] = ()
    behind: tuple[Step, ...] = ()
    through: tuple[Step, ...] = ()
    drives: tuple[Slide, ...] = ()

    @property
    def turns(self) -> bool:
        """Whether any angle moves."""
        return bool(self.spins) or any(step.moves for step in self.angles)

    @property
    def sliding(self) -> tuple[Slide, ...]:
        """The translations that move, free or prescribed."""
        return self.slides + self.drives

    @property
    def spinning(self) -> Vector:
        """What the spins make of the relative angular velocity, in K (rad/s)."""
        return _along(self.spins, [spin.rate for spin in self.spins])

    @property
    def spinning_up(self) -> Vector:
        """What their derivatives make of the angular acceleration, in K (rad/s^2)."""
        return _along(self.spins, [spin.acceleration for spin in self.spins])

    @property
    def hinge(self) -> Step | None:
        """The one angle that moves, if nothing else does and no locked angle turns its axis in K."""
        alone = len(self.angles) == 1 and not self.sliding and not self.spins
        return self.angles[0] if alone and self.turns else None

    @property
    def steps(self) -> tuple[Step, ...]:
        """All turns, from J outward."""
        return self.through or self.constant + self.angles

    @property
    def turning(self) -> int:
        """Operations that it takes to turn a vector through all of them."""
        return sum(step.turn.cost for step in self.steps)

    def above(self, step: Step) -> str:
        """Suffix for the names of quantities seen above one of the turns."""
        return f"{self.body}" if step is self.steps[-1] and not self.spins else f"{step.frame}u"

    def below(self, step: Step, v: Vector) -> Vector:
        """A vector from the frame below one of the turns to the lower body's frame."""
        inner = self.steps[: self.steps.index(step)]
        return down(tuple(other.turn for other in inner), v)

    def down(self, v: Vector) -> Vector:
        """A vector from the frame of K to the lower body's."""
        return down(tuple(step.turn for step in self.steps), v)


def _along(spins: Iterable[Spin], values: Iterable[Expr]) -> Vector:
    total = ZERO
    for one, value in zip(spins, values, strict=True):
        total = add(total, scale(value, unit(one.axis)))
    return total


def down(turns: Iterable[Turn], v: Vector) -> Vector:
    """A vector from the frame above several turns, counted from below, to the frame below them."""
    for turn in reversed(tuple(turns)):
        v = turn.down(v)
    return v
