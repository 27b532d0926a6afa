"""The regressor [Y] of [A]{ydot} - {f} = [Y]{pi}, column by column of the inertial parameters {pi}.

The force and the moment that the motion of a body requires are linear in its mass, first moment and inertia
about the origin of its frame (Atkeson, An and Hollerbach 1986). So a column of [Y] is the wrench for a unit
parameter: of the mass, the acceleration of the origin; of the first moment, a column of [alpha~] +
[omega~][omega~] and the moment of the acceleration; of the inertia, a pure couple, which no offset changes.
The wrench passes inward joint by joint, and its component along each freedom is an entry. A freedom that does
not carry the body has no entry, and no number of {pi} occurs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.model.identification.inertial_parameters import INERTIAL_PARAMETERS
from kanegen.recursion.body_motion import BodyMotion, body_motions, products_and_field
from kanegen.recursion.frames import FixedFrame, fixed_frame
from kanegen.recursion.joint_motion import FreedomMotion, JointMotion
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import Rows, Wrench, add, cross, dot, multiply, subtract, unit
from kanegen.symbolic.definitions import Vector

WIDTH = len(INERTIAL_PARAMETERS)
"""Number of the inertial parameters of a body."""

PRODUCTS = {5: (0, 1, 2), 7: (2, 0, 1), 8: (1, 2, 0)}
"""Axes (p, q, r), in cyclic order, of the products of inertia I_pq, by place among the parameters."""

DIAGONAL = {4: 0, 6: 1, 9: 2}
"""Axis of the moments of inertia, by place among the parameters."""


def regressor(tree: Tree) -> Derived:
    """Derive the (n, 10 N) entries of [Y], row-major."""
    return _regressor(tree, range(WIDTH * tree.system.number_of_bodies))


def _regressor(tree: Tree, columns: Iterable[int]) -> Derived:
    """Derive some columns of [Y], row-major."""
    moved = body_motions(tree, accelerated=True)
    frames = [_UserFrame.of(tree, joint, moved[joint.body]) for joint in tree.joints]
    found = [_column(tree, place, frames[place // WIDTH]) for place in columns]
    rows = range(len(tree.system.freedoms))
    return Derived([col.get(row, S.Zero) for row in rows for col in found])


@dataclass(frozen=True)
class _UserFrame:
    """The motion of the frame of a body that its users see, in its components.

    Attributes:
        joint: Joint of the body.
        frame: The frame.
        arm: Vector from the origin of the recursions to that of the frame, in the body (m).
        acceleration: Acceleration of its origin less gravity (m/s^2).
        alpha: Angular acceleration (rad/s^2).
        squares: Products of the components of the angular velocity by pair of axes.
        field: [alpha~] + [omega~][omega~].
    """

    joint: JointMotion
    frame: FixedFrame
    arm: Vector
    acceleration: Vector
    alpha: Vector
    squares: dict[tuple[int, int], Expr]
    field: Rows

    @classmethod
    def of(cls, tree: Tree, joint: JointMotion, motion: BodyMotion) -> _UserFrame:
        """Return the motion of the frame of the body of `joint`."""
        k, definitions = joint.body, tree.definitions
        frame = fixed_frame(tree, tree.system.bodies[k - 1].name, k)
        tree.about(k, "motion of its frame")
        arm = definitions.vector(f"Yr_{k}", subtract(frame.origin, joint.origin))
        acceleration = add(motion.acceleration, multiply(motion.field, arm))
        acceleration = definitions.vector(f"Ya_{k}", acceleration)
        if not frame.is_turned:
            return cls(joint, frame, arm, acceleration, motion.alpha, motion.squares, motion.field)
        acceleration, omega, alpha = (
            definitions.vector(f"{name}_{k}f", frame.outward(v))
            for name, v in (("Ya", acceleration), ("Yw", motion.omega), ("Ye", motion.alpha))
        )
        squares, field = products_and_field(f"{k}f", omega, alpha, definitions)
        return cls(joint, frame, arm, acceleration, alpha, squares, field)

    def wrench(self, place: int) -> Wrench:
        """Return force and moment about its origin for a unit parameter, in its components.

        Args:
            place: Place among `INERTIAL_PARAMETERS`.
        """
        w, field = self.squares, self.field
        if place == 0:
            return Wrench(force=self.acceleration)
        if place < 4:
            axis = place - 1
            force = Vector(*(row[axis] for row in field))
            return Wrench(force, cross(unit(axis), self.acceleration))
        moment = [S.Zero] * 3
        if place in DIAGONAL:
            p = DIAGONAL[place]
            q, r = (p + 1) % 3, (p + 2) % 3
            moment[p], moment[q], moment[r] = self.alpha[p], w[p, r], -w[p, q]
        else:
            p, q, r = PRODUCTS[place]
            moment[p], moment[q], moment[r] = -field[r][p], field[r][q], w[p, p] - w[q, q]
        return Wrench(moment=Vector(*moment))


def _column(tree: Tree, place: int, seen: _UserFrame) -> dict[int, Expr]:
    """Return the entries of a column of [Y] that are not zero by structure, by place in {y}."""
    found: dict[int, Expr] = {}
    for motion, effort in _efforts(tree, place, seen):
        for row, share in motion.shares.items():
            found[row] = found.get(row, S.Zero) + share * effort
    return found


def _efforts(tree: Tree, place: int, seen: _UserFrame) -> Iterator[tuple[FreedomMotion, Expr]]:
    """Yield the generalized force of a unit parameter at every freedom from its body inward.

    Args:
        tree: The tree.
        place: Column of the parameter.
        seen: Motion of the frame of its body.
    """
    k, definitions = seen.joint.body, tree.definitions
    tree.about(k, f"force and moment for a unit of parameter {INERTIAL_PARAMETERS[place % WIDTH]}")
    wrench = seen.wrench(place % WIDTH)
    force = definitions.vector(f"Yf_{place}_{k}f", seen.frame.inward(wrench.force))
    moment = definitions.vector(f"Ym_{place}_{k}f", seen.frame.inward(wrench.moment))
    moment = definitions.vector(f"Ym_{place}_{k}", add(moment, cross(seen.arm, force)))
    for joint in tree.inward(seen.joint):
        yield from ((speed, moment[speed.axis]) for speed in joint.angular_speeds)
        for step in reversed(joint.steps):
            if step.moves:
                yield step, moment[step.axis]
            force = definitions.vector(f"Yf_{place}_{step.frame}", step.turn.down(force))
            moment = definitions.vector(f"Ym_{place}_{step.frame}", step.turn.down(moment))
        for one in joint.moving_translations:
            yield one, definitions.define(f"Ys_{place}_{one.number}", dot(one.direction, force))
        moment = definitions.vector(f"Ym_{place}_{joint.body}j", add(moment, cross(joint.offset, force)))
