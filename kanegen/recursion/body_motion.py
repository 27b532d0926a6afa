"""The motion of bodies for some {ydot}, by a recursion outward.

The motion of a body is its angular velocity, its angular acceleration and the acceleration of its origin for
some {ydot}; gravity enters as an upward acceleration of the ground. For {ydot} = 0 these are the terms of
Eqs. (20) and (33) without {ydot}.

A joint with three free translations transmits no force but the efforts on them, whatever the acceleration of
its origin. So a solver for {ydot} starts behind it from an origin without acceleration, and neither gravity
nor the motion of the lower bodies causes forces there, which would only cancel. Three free rotations likewise
start from no angular acceleration. In the end this is subtracted from the solution; see `Carried`.
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass, replace

from sympy import Expr

from kanegen.recursion.constants import exact
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, Rows, add, cross, multiply, negate, scale, unit
from kanegen.symbolic.definitions import AXES, Definitions, Vector


@dataclass(frozen=True)
class Carried:
    """Accelerations with which a body would be carried along without an acceleration of its own joint.

    Attributes:
        alpha: Angular acceleration, in K; zero unless all rotations of the joint are solved for together
            (rad/s^2).
        acceleration: Acceleration of O_K less gravity, in the joint frame; zero unless all translations of
            the joint are free (m/s^2).
        to_center: Second derivative of the vector from O_K to the origin of K, in K (m/s^2).
    """

    alpha: Vector = ZERO
    acceleration: Vector = ZERO
    to_center: Vector = ZERO

    def plus(self, other: Carried) -> Carried:
        """Return the sum of two parts of the accelerations."""
        return Carried(
            add(self.alpha, other.alpha),
            add(self.acceleration, other.acceleration),
            add(self.to_center, other.to_center),
        )


NOT_CARRIED = Carried()


@dataclass(frozen=True)
class FrameAcceleration:
    """The motion of a frame on the path through the joint of body K, with the origin of K as its origin.

    Attributes:
        omega: Angular velocity (rad/s).
        alpha: Angular acceleration (rad/s^2).
        acceleration: Acceleration of the origin, less gravity (m/s^2).
    """

    omega: Vector
    alpha: Vector
    acceleration: Vector


@dataclass(frozen=True)
class BodyMotion:
    """Motion of a body, in its frame.

    Attributes:
        omega: Angular velocity {omega'_K} (rad/s).
        alpha: Angular acceleration (rad/s^2).
        acceleration: Acceleration of the origin, less gravity (m/s^2).
        squares: Products omega_i omega_j by pair of axes.
        field: [alpha~] + [omega~][omega~], the matrix that maps a body-fixed vector to its second derivative.
        carried: Accelerations that are left out.
        path: Motion of the frame below each turn of the joint, then of the frame above all turns. This is the
            frame of the body; but where speeds are an angular velocity it turns with J, and that of the body
            comes last.
    """

    omega: Vector
    alpha: Vector
    acceleration: Vector
    squares: dict[tuple[int, int], Expr]
    field: Rows
    carried: Carried = NOT_CARRIED
    path: tuple[FrameAcceleration, ...] = ()


def body_motions(
    tree: Tree, *, accelerated: bool, weightless: bool = False, released: Container[int] = ()
) -> dict[int, BodyMotion]:
    """Return the motion of the ground, under the key 0, and of every body.

    Args:
        tree: The tree.
        accelerated: Whether {ydot} is symbols instead of zeros. Prescribed freedoms accelerate in either
            case.
        weightless: Whether to leave gravity out of the accelerations.
        released: Places in {y} of freedoms; where all three translations, or all three rotations, of a joint
            are among them, the acceleration behind the joint starts from zero.
    """
    gravity = ZERO if weightless else Vector(*(exact(value) for value in tree.system.gravity))
    still = {(i, j): exact(0.0) for i in range(3) for j in range(3)}
    moved = {0: BodyMotion(ZERO, ZERO, negate(gravity), still, (ZERO, ZERO, ZERO))}
    for joint in tree.joints:
        tree.about(joint.body, "angular velocity and acceleration, Eqs. (11), (20)")
        moved[joint.body] = _outward(moved[joint.lower], joint, tree.definitions, accelerated, released)
    return moved


def _outward(
    lower: BodyMotion,
    joint: JointMotion,
    definitions: Definitions,
    accelerated: bool,
    released: Container[int],
) -> BodyMotion:
    """Return the motion of body K from that of J: Eqs. (11), (20), (33), one turn at a time."""
    k = joint.body
    omega, alpha, carried = lower.omega, lower.alpha, NOT_CARRIED
    acceleration = _origin_acceleration(lower, joint, definitions, accelerated)
    if joint.translates_freely and all(one.freedom in released for one in joint.translations):
        for step in joint.constant:
            acceleration = definitions.vector(f"a_{joint.above(step)}", step.turn.up(acceleration))
        carried, acceleration = Carried(acceleration=acceleration), ZERO
    path = [FrameAcceleration(omega, alpha, acceleration)]
    for step in joint.steps:
        above = joint.above(step)
        turned = step.turn.up(omega)
        rate = scale(step.rate, unit(step.axis))
        alpha = add(step.turn.up(alpha), cross(turned, rate))
        own = step.acceleration if accelerated else step.prescribed_acceleration
        alpha = add(alpha, scale(own, unit(step.axis)))
        alpha = definitions.vector(f"alpha_{above}", alpha)
        omega = definitions.vector(f"omega_{above}", add(turned, rate))
        acceleration = definitions.vector(f"a_{above}", step.turn.up(acceleration))
        path.append(FrameAcceleration(omega, alpha, acceleration))
    if joint.angular_speeds:
        alpha = add(alpha, cross(omega, joint.relative_omega))
        if accelerated:
            alpha = add(alpha, joint.relative_alpha)
        alpha = definitions.vector(f"alpha_{k}", alpha)
        omega = definitions.vector(f"omega_{k}", add(omega, joint.relative_omega))
        path.append(FrameAcceleration(omega, alpha, acceleration))
    if joint.rotations and all(freedom in released for freedom in joint.rotations):
        carried, alpha = replace(carried, alpha=alpha), ZERO
    squares, field = products_and_field(f"{k}", omega, alpha, definitions)
    carried = replace(carried, to_center=multiply(field, joint.to_center))
    return BodyMotion(omega, alpha, acceleration, squares, field, carried, tuple(path))


def _origin_acceleration(
    lower: BodyMotion, joint: JointMotion, definitions: Definitions, accelerated: bool
) -> Vector:
    """Return the acceleration of the origin of body K less gravity, in J, Eq. (33)."""
    sliding = carried = ZERO
    if not joint.is_weightless:
        carried = add(lower.acceleration, multiply(lower.field, joint.offset))
    for translation in joint.moving_translations:
        sliding = add(sliding, scale(translation.rate, translation.direction))
        own = translation.acceleration if accelerated else translation.prescribed_acceleration
        carried = add(carried, scale(own, translation.direction))
    twice = definitions.vector(f"w_{joint.lower}", scale(exact(2.0), lower.omega))
    sliding = definitions.vector(f"v_{joint.body}", sliding)
    return definitions.vector(f"a_{joint.body}j", add(carried, cross(twice, sliding)))


def products_and_field(
    frame: str, omega: Vector, alpha: Vector, definitions: Definitions
) -> tuple[dict[tuple[int, int], Expr], Rows]:
    """Return `squares` and `field` of `BodyMotion`, in components of a frame.

    Args:
        frame: Suffix of the names of quantities in the frame.
        omega: Angular velocity (rad/s).
        alpha: Angular acceleration (rad/s^2).
        definitions: Definitions that the intermediates are added to.
    """
    squares: dict[tuple[int, int], Expr] = {}
    for i in range(3):
        for j in range(i, 3):
            name = f"ww_{frame}_{AXES[i]}{AXES[j]}"
            squares[i, j] = squares[j, i] = definitions.define(name, omega[i] * omega[j])
    w = squares
    field = (
        Vector(-(w[1, 1] + w[2, 2]), w[0, 1] - alpha.z, w[0, 2] + alpha.y),
        Vector(w[0, 1] + alpha.z, -(w[0, 0] + w[2, 2]), w[1, 2] - alpha.x),
        Vector(w[0, 2] - alpha.y, w[1, 2] + alpha.x, -(w[0, 0] + w[1, 1])),
    )
    named = tuple(definitions.vector(f"W_{frame}_{axis}", row) for axis, row in zip(AXES, field, strict=True))
    return squares, (named[0], named[1], named[2])
