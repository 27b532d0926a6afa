"""The motion of a joint in the recursions: a shift of origin, then turns from the lower frame outward."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from sympy import Expr, S

from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, add, scale, unit
from kanegen.symbolic.definitions import Vector

NO_FREEDOM = -1
"""Value of `freedom` where nothing in {y} moves the element of a joint."""

NO_ANGLE = -1
"""Number of the angle of a constant turn."""


@dataclass(frozen=True, kw_only=True)
class FreedomMotion:
    """The motion of a freedom: its rate is a linear function of {y} and of prescribed rates.

    Attributes:
        freedom: Place in {y}; `NO_FREEDOM` where the freedom is prescribed, coupled or locked.
        number: Number among the freedoms that move: `freedom`, or n plus the place in `system.prescribed`, or
            n + p plus the place in `system.coupled`; `NO_FREEDOM` where it is locked.
        axis: Basis vector about or along which the freedom moves.
        value: The coordinate (rad, m).
        rate: The rate (rad/s, m/s).
        acceleration: Second derivative (rad/s^2, m/s^2).
        prescribed_acceleration: The part of it that prescribed accelerations cause.
        shares: Factors of the entries of {y} in the rate, by place in {y}.
        prescribed_shares: Factors of the prescribed rates in the rate, by place in `system.prescribed`.
        is_coupled: Whether the freedom is coupled, or a coupled freedom follows it.
        armature: Reflected inertia of the motor of the freedom (kg m^2, kg).
    """

    freedom: int = NO_FREEDOM
    number: int = NO_FREEDOM
    axis: int = 0
    value: Expr = S.Zero
    rate: Expr = S.Zero
    acceleration: Expr = S.Zero
    prescribed_acceleration: Expr = S.Zero
    shares: Mapping[int, Expr] = field(default_factory=dict)
    prescribed_shares: Mapping[int, Expr] = field(default_factory=dict)
    is_coupled: bool = False
    armature: Expr = S.Zero

    @property
    def moves(self) -> bool:
        """Whether the freedom is free, prescribed or coupled."""
        return self.number != NO_FREEDOM


@dataclass(frozen=True)
class Step(FreedomMotion):
    """One turn of a joint, with the motion of its angle.

    Attributes:
        turn: Turn from the lower to the upper frame.
        frame: Suffix of the names of quantities in the frame below the turn.
        sine: Sine of the angle.
        cosine: Cosine of the angle.
        angle: Number of the angle of the turn, 0 to 2, free or locked; or `NO_ANGLE`.
    """

    turn: Turn
    frame: str
    sine: Expr = S.Zero
    cosine: Expr = S.One
    angle: int = NO_ANGLE


@dataclass(frozen=True)
class Translation(FreedomMotion):
    """A free, prescribed or coupled translation of a joint, along a basis vector of the joint frame.

    Attributes:
        direction: The same vector in the lower body's frame.
    """

    direction: Vector


@dataclass(frozen=True)
class AngularSpeed(FreedomMotion):
    """One component of the relative angular velocity, Eq. (8), that is a speed, in the frame of body K."""


@dataclass(frozen=True)
class JointMotion:
    """The motion of body K on its lower body J.

    A joint whose speeds are components of the relative angular velocity has one turn in `angles`, the whole
    rotation, with neither freedom nor rate.

    Attributes:
        body: Number of K.
        lower: Number of J, 0 for the ground.
        arm: Vector from O_J to O_K, in J (m): {q'_K} + [C_K]^T {s'_K}.
        directions: Directions of the three translations, free or locked, in J.
        offset: Vector from the origin of J to that of K, in J (m): `arm`, changed by the `origin` of both
            joints; but to O_K where `to_center` is not zero.
        origin: Vector from O_K to the point of K that serves as its origin, in K (m).
        translations: The translations that {y} moves.
        constant: The turns of [C_K], from J to the joint frame.
        angles: The turns of the angles, from the joint frame to K.
        angular_speeds: The components of the relative angular velocity, if these are the speeds of the joint.
        composed_of: The turns of the single angles of a whole rotation; empty for a quaternion.
        merged: `constant` and `angles` as one turn, for vectors that pass both; or empty.
        prescribed_translations: The translations that only prescribed motion moves.
        to_center: Vector from O_K to the origin of K, in K (m), where the origin is the mass centre of a body
            that both translates and rotates; zero elsewhere. See `tree.about_mass_centers`.
        is_weightless: Whether the origin has no acceleration but that of the translations, not even that of
            gravity. See `free_components`.
    """

    body: int
    lower: int
    arm: Vector
    directions: tuple[Vector, Vector, Vector]
    offset: Vector
    origin: Vector
    translations: tuple[Translation, ...]
    constant: tuple[Step, ...]
    angles: tuple[Step, ...]
    angular_speeds: tuple[AngularSpeed, ...] = ()
    composed_of: tuple[Step, ...] = ()
    merged: tuple[Step, ...] = ()
    prescribed_translations: tuple[Translation, ...] = ()
    to_center: Vector = ZERO
    is_weightless: bool = False

    @property
    def freedoms(self) -> tuple[FreedomMotion, ...]:
        """The freedoms of the joint that {y} moves."""
        return tuple(one for one in self.elements if one.shares)

    @property
    def rotates(self) -> bool:
        """Whether any angle or angular velocity moves."""
        return bool(self.angular_speeds) or any(step.moves for step in self.angles)

    @property
    def rotates_freely(self) -> bool:
        """Whether the rates of three free angles are speeds, and only efforts are transmitted as a moment.

        A motor with armature transmits a moment that depends on the acceleration of its angle, and so does a
        freedom that follows an angle.
        """
        free = [step for step in self.angles if step.freedom != NO_FREEDOM]
        return len(free) == 3 and not any(step.armature or step.is_coupled for step in free)

    @property
    def turns_freely(self) -> bool:
        """Whether the speeds are an angular velocity, and only efforts are transmitted as a moment."""
        return bool(self.angular_speeds) and not any(speed.armature for speed in self.angular_speeds)

    @property
    def translates_freely(self) -> bool:
        """Whether all three translations are free, and only efforts are transmitted as a force."""
        return len(self.translations) == 3 and not any(
            one.armature or one.is_coupled for one in self.translations
        )

    @property
    def elements(self) -> tuple[FreedomMotion, ...]:
        """The angles, components of the angular velocity and translations that move."""
        return (
            *(step for step in self.angles if step.moves),
            *self.angular_speeds,
            *self.moving_translations,
        )

    @property
    def rotations(self) -> tuple[int, ...]:
        """Places in {y} of the angles or components of angular velocity that are speeds."""
        angles = (step.freedom for step in self.angles if step.freedom != NO_FREEDOM)
        return (*angles, *(speed.freedom for speed in self.angular_speeds))

    @property
    def moving_translations(self) -> tuple[Translation, ...]:
        """The translations that move."""
        return self.translations + self.prescribed_translations

    @property
    def relative_omega(self) -> Vector:
        """The relative angular velocity from `angular_speeds`, in K (rad/s); zero if there are none."""
        return _along_axes(self.angular_speeds, [speed.rate for speed in self.angular_speeds])

    @property
    def relative_alpha(self) -> Vector:
        """The time derivative of `relative_omega`, in K (rad/s^2)."""
        return _along_axes(self.angular_speeds, [speed.acceleration for speed in self.angular_speeds])

    @property
    def hinge(self) -> Step | None:
        """The one angle that moves, if nothing else does and no locked angle turns its axis in K."""
        alone = len(self.angles) == 1 and not self.moving_translations and not self.angular_speeds
        return self.angles[0] if alone and self.rotates else None

    @property
    def steps(self) -> tuple[Step, ...]:
        """All turns, from J outward."""
        return self.merged or self.constant + self.angles

    @property
    def turn_cost(self) -> int:
        """Number of operations that pass a vector through all turns."""
        return sum(step.turn.cost for step in self.steps)

    def above(self, step: Step) -> str:
        """Return the suffix of the names of quantities in the frame above one of the turns."""
        is_last = step is self.steps[-1] and not self.angular_speeds
        return f"{self.body}" if is_last else f"{step.frame}u"

    def down_from(self, step: Step, v: Vector) -> Vector:
        """Return a vector of the frame below one of the turns in components of the lower body."""
        inner = self.steps[: self.steps.index(step)]
        return down(tuple(other.turn for other in inner), v)

    def down(self, v: Vector) -> Vector:
        """Return a vector of K in components of the lower body."""
        return down(tuple(step.turn for step in self.steps), v)


def _along_axes(speeds: Iterable[AngularSpeed], values: Iterable[Expr]) -> Vector:
    """Return the vector with these components along the axes of the speeds."""
    total = ZERO
    for speed, value in zip(speeds, values, strict=True):
        total = add(total, scale(value, unit(speed.axis)))
    return total


def down(turns: Iterable[Turn], v: Vector) -> Vector:
    """Return a vector in components below several turns, listed from below, from its components above."""
    for turn in reversed(tuple(turns)):
        v = turn.down(v)
    return v
