"""The way between a body and its lower body, stop by stop, for pairs of vectors that pass along it.

Inward pass forces with their moments, outward accelerations: a turn changes their frame, a shift their
origin, and at a free component of the acceleration the joint itself has a say. Both solvers of [A]{ydot} go
this way, so that what accelerations need can be found again from these alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion
from kanegen.recursion.motion import Requirement
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import add, cross
from kanegen.symbolic.definitions import Definitions, Vector

STILL = (S.Zero,) * 6
"""The acceleration of the ground."""

TURNS, SLIDES = (0, 1, 2), (3, 4, 5)


@dataclass(frozen=True)
class Free:
    """A component of the acceleration that the joint leaves free.

    Attributes:
        index: 0-2 for turning about a basis vector, 3-5 for moving along one.
        freedom: Its place in {y}.
    """

    index: int
    freedom: int


@dataclass(frozen=True)
class Turned:
    """A change of frame; `name` is that of the frame below it."""

    turn: Turn
    name: str

    def inward(self, need: Requirement, definitions: Definitions) -> Requirement:
        """Force and moment seen from below."""
        return Requirement(self.turn.down(need.force), self.turn.down(need.moment)).named(
            self.name, definitions
        )

    def outward(self, a: tuple[Expr, ...], definitions: Definitions) -> tuple[Expr, ...]:
        """Accelerations seen from above."""
        turning = definitions.vector(f"qw_{self.name}u", self.turn.up(Vector(*a[:3])))
        return (*turning, *definitions.vector(f"qa_{self.name}u", self.turn.up(Vector(*a[3:]))))


@dataclass(frozen=True)
class Shifted:
    """A change of origin, outward by {offset}, in the lower body's frame."""

    offset: Vector
    name: str

    def inward(self, need: Requirement, definitions: Definitions) -> Requirement:
        """Force and moment about the lower body's origin."""
        moment = add(need.moment, cross(self.offset, need.force))
        return Requirement(need.force, moment).named(self.name, definitions)

    def outward(self, a: tuple[Expr, ...], definitions: Definitions) -> tuple[Expr, ...]:
        """Accelerations of the upper body's origin."""
        moved = add(Vector(*a[3:]), cross(Vector(*a[:3]), self.offset))
        return (*a[:3], *definitions.vector(f"qa_{self.name}", moved))


Stop = Free | Turned | Shifted


def stops(motion: JointMotion, *, together: bool) -> tuple[Stop, ...]:
    """From body K inward.

    Args:
        motion: The joint.
        together: Three free angles, or translations, count as free components in the frame of K. For those
            of angles this is regular everywhere; their own rates are not.
    """
    return tuple(_stops(motion, together))


def _stops(motion: JointMotion, together: bool) -> Iterator[Stop]:
    slides, turns = together and slides_freely(motion), together and turns_freely(motion)
    if slides:
        yield from (Free(i, slide.freedom) for i, slide in zip(SLIDES, motion.slides, strict=True))
    yield from (Free(spin.axis, spin.freedom) for spin in motion.spins)
    if turns:
        yield from (Free(i, step.freedom) for i, step in zip(TURNS, motion.angles, strict=True))
    for step in reversed(motion.angles):
        if step.freedom != NO_FREEDOM and not turns:
            yield Free(step.axis, step.freedom)
        yield Turned(step.turn, step.frame)
    if not slides:
        for slide in motion.slides:
            yield Free(3 + slide.axis, slide.freedom)
    for step in reversed(motion.constant):
        yield Turned(step.turn, step.frame)
    yield Shifted(motion.offset, f"{motion.body}j")


def turns_freely(motion: JointMotion) -> bool:
    """Whether the rates of three free angles are speeds."""
    return sum(step.freedom != NO_FREEDOM for step in motion.angles) == len(TURNS)


def slides_freely(motion: JointMotion) -> bool:
    """Whether all three translations are free."""
    return len(motion.slides) == len(SLIDES)
