"""A joint as the recursions see it: a shift of origin, then turns from the lower frame to the body's."""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy
from sympy import Expr, S

from kanegen.angles import sine_cosine
from kanegen.body import Body
from kanegen.numbers import Number, Parameter
from kanegen.recursion.turns import Turn, constant_turns, planar
from kanegen.recursion.vectors import ZERO, add, dot, scale, subtract, unit
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.symbols import acceleration, coordinate, speed
from kanegen.system import Freedom, System

NO_FREEDOM = -1


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
    """

    turn: Turn
    frame: str
    freedom: int = NO_FREEDOM
    axis: int = 0
    rate: Expr = S.Zero
    acceleration: Expr = S.Zero
    sine: Expr = S.Zero
    cosine: Expr = S.One


@dataclass(frozen=True)
class Slide:
    """One free translation.

    Attributes:
        freedom: Its number in {x}.
        axis: Basis vector of the joint frame along which it moves.
        direction: The same in the lower body's frame.
        rate: Its rate.
        acceleration: Its second derivative.
    """

    freedom: int
    axis: int
    direction: Vector
    rate: Expr
    acceleration: Expr


@dataclass(frozen=True)
class JointMotion:
    """How body K moves on its lower body J.

    Attributes:
        body: K.
        lower: J, 0 for the ground.
        arm: From O_J to O_K, in J (m): {q'_K} + [C_K]^T {s'_K}.
        offset: From the origin of J to that of K, in J (m): `arm` and what the `origin` of both adds.
        origin: From O_K to the point of K that serves as its origin, in K (m); see `_origin`.
        slides: The free translations.
        constant: The turns of [C_K], from J to the joint frame.
        angles: The turns of the angles, from the joint frame to K.
    """

    body: int
    lower: int
    arm: Vector
    offset: Vector
    origin: Vector
    slides: tuple[Slide, ...]
    constant: tuple[Step, ...]
    angles: tuple[Step, ...]

    @property
    def turns(self) -> bool:
        """Whether any angle is free."""
        return any(step.freedom != NO_FREEDOM for step in self.angles)

    @property
    def hinge(self) -> Step | None:
        """The one free angle, if nothing else moves and no locked angle turns its axis in K."""
        alone = len(self.angles) == 1 and not self.slides
        return self.angles[0] if alone and self.turns else None

    @property
    def steps(self) -> tuple[Step, ...]:
        """All turns, from J outward."""
        return self.constant + self.angles

    @property
    def turning(self) -> int:
        """Operations that it takes to turn a vector through all of them."""
        return sum(step.turn.cost for step in self.steps)

    def above(self, step: Step) -> str:
        """Suffix for the names of quantities seen above one of the turns."""
        return f"{self.body}" if step is self.steps[-1] else f"{step.frame}u"

    def below(self, step: Step, v: Vector) -> Vector:
        """A vector from the frame below one of the turns to the lower body's frame."""
        inner = self.steps[: self.steps.index(step)]
        return _down(tuple(other.turn for other in inner), v)


def exact(value: Number) -> Expr:
    """A parameter's symbol, or the rational number that a float is, so that folding rounds only once."""
    return sympy.Symbol(value.name, real=True) if isinstance(value, Parameter) else sympy.Rational(value)


def joint_motion(system: System, k: int, below: Vector, definitions: Definitions) -> JointMotion:
    """The motion of body `k` on its lower body, sines and cosines defined.

    Args:
        system: The tree.
        k: Number of the body.
        below: `origin` of the lower body, zero for the ground.
        definitions: Take the intermediates.
    """
    body = system.bodies[k - 1]
    number = system.places
    definitions.about(f"Body {k} ({body.name}): the joint, Eqs. (4), (22)")
    constant = _orientation(body, k, definitions)
    directions = [definitions.vector(f"u_{k}_{i + 1}", _down(constant, unit(i))) for i in range(3)]
    arm = Vector(*(exact(value) for value in body.joint.position))
    slides: list[Slide] = []
    for axis in range(3):
        free = body.joint.free[3 + axis]
        s = coordinate(k, 3 + axis) if free else exact(body.joint.locked[3 + axis])
        arm = add(arm, scale(s, directions[axis]))
        if free:
            place = number[Freedom(k, 3 + axis)]
            slides.append(Slide(place, axis, directions[axis], speed(k, 3 + axis), acceleration(k, 3 + axis)))
    fixed = [Step(turn, f"{k}c{i + 1}") for i, turn in enumerate(constant)]
    angles = [_angle_step(body, k, axis, number, definitions) for axis in range(3)]
    offset = subtract(arm, below)
    motion = JointMotion(k, body.lower, arm, offset, ZERO, tuple(slides), _moving(fixed), _moving(angles))
    return _with_origin(motion, body, definitions)


def _with_origin(motion: JointMotion, body: Body, definitions: Definitions) -> JointMotion:
    """Choose the point of K that serves as its origin so that constants vanish; [A] and {f} do not change.

    A body that only slides takes its mass centre, so that it has no first moment. A hinge takes the point of
    its axis opposite the lower body's origin, where the axis is a basis vector of J and the offset thus loses
    a component.
    """
    origin, offset, hinge = ZERO, motion.offset, motion.hinge
    if motion.slides and not motion.turns:
        origin = Vector(*(exact(value) for value in body.mass_center))
        offset = add(offset, _down(tuple(step.turn for step in motion.steps), origin))
    elif hinge:
        axis = unit(hinge.axis)
        direction = _down(tuple(step.turn for step in motion.constant), axis)
        if all(component in (-1, 0, 1) for component in direction):
            along = -dot(direction, offset)
            origin, offset = scale(along, axis), add(offset, scale(along, direction))
    return replace(
        motion,
        origin=definitions.vector(f"o_{motion.body}", origin),
        offset=definitions.vector(f"d_{motion.body}", offset),
        arm=definitions.vector(f"q_{motion.body}", motion.arm),
    )


def _moving(steps: list[Step]) -> tuple[Step, ...]:
    """Those that change anything."""
    return tuple(step for step in steps if step.freedom != NO_FREEDOM or not _is_identity(step.turn))


def _orientation(body: Body, k: int, definitions: Definitions) -> tuple[Turn, ...]:
    orientation = body.joint.orientation
    if not isinstance(orientation[0], tuple):
        return tuple(
            _locked_turn(f"{k}_c{i + 1}", i, angle, definitions) for i, angle in enumerate(orientation)
        )
    return constant_turns([[exact(entry) for entry in row] for row in orientation])


def _angle_step(body: Body, k: int, axis: int, number: dict[Freedom, int], definitions: Definitions) -> Step:
    frame = f"{k}a{axis + 1}"
    if not body.joint.free[axis]:
        locked = body.joint.locked[axis]
        return Step(_locked_turn(f"{k}_{axis + 1}", axis, locked, definitions), frame)
    angle = coordinate(k, axis)
    sine = definitions.define(f"S_{k}_{axis + 1}", sympy.sin(angle))
    cosine = definitions.define(f"C_{k}_{axis + 1}", sympy.cos(angle))
    return Step(
        planar(axis, sine, cosine),
        frame,
        number[Freedom(k, axis)],
        axis,
        speed(k, axis),
        acceleration(k, axis),
        sine,
        cosine,
    )


def _locked_turn(name: str, axis: int, angle: Number, definitions: Definitions) -> Turn:
    if isinstance(angle, Parameter):
        symbol = exact(angle)
        sine = definitions.define(f"S_{name}", sympy.sin(symbol))
        return planar(axis, sine, definitions.define(f"C_{name}", sympy.cos(symbol)))
    sine, cosine = (sympy.Rational(value) for value in sine_cosine(angle))
    return planar(axis, sine, cosine)


def _is_identity(turn: Turn) -> bool:
    return all(turn.up(unit(axis)) == unit(axis) for axis in range(3))


def _down(turns: tuple[Turn, ...], v: Vector) -> Vector:
    for turn in reversed(turns):
        v = turn.down(v)
    return v
