"""The regressor [Y] of [A]{ydot} - {f} = [Y]{pi}, for the inertial parameters {pi} of the bodies.

The force and the moment that the motion of a body requires are linear in its mass, first moment and inertia
about the origin of its frame (Atkeson, An and Hollerbach 1986). An entry of [Y] is the work of the wrench for
a unit of one parameter on the partial velocities of the body by one freedom: for the mass, of the
acceleration of the origin; for the first moment, of a column of [alpha~] + [omega~][omega~] and of the moment
of the acceleration; for the inertia, of a couple. The partial velocities pass outward, from the freedom to
all bodies that it carries, as the motion of the bodies does. So the entries of other bodies are zero by
structure, freedoms with parallel axes share all that depends on their direction alone, and no number of {pi}
occurs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.model.identification.base_parameters import base_parameters
from kanegen.model.identification.inertial_parameters import INERTIAL_PARAMETERS, UPPER
from kanegen.recursion.body_motion import BodyMotion, body_motions, products_and_field
from kanegen.recursion.frames import FixedFrame, fixed_frame
from kanegen.recursion.joint_motion import FreedomMotion, JointMotion
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import ZERO, Rows, add, cross, dot, multiply, subtract, unit
from kanegen.symbolic.definitions import Vector

WIDTH = len(INERTIAL_PARAMETERS)
"""Number of the inertial parameters of a body."""


def regressor(tree: Tree) -> Derived:
    """Derive the (n, 10 N) entries of [Y], row-major."""
    return _regressor(tree, range(WIDTH * tree.system.number_of_bodies))


def base_regressor(tree: Tree) -> Derived:
    """Derive the (n, b) entries of [Y_b], the columns of the base parameters, row-major."""
    return _regressor(tree, base_parameters(tree.described).columns)


def _regressor(tree: Tree, columns: Iterable[int]) -> Derived:
    """Derive some columns of [Y], row-major."""
    columns, rows = tuple(columns), range(len(tree.system.freedoms))
    moved = body_motions(tree, accelerated=True)
    seen = {joint.body: _UserFrame.of(tree, joint, moved[joint.body]) for joint in tree.joints}
    entries: dict[tuple[int, int], Expr] = {}
    for k, partial in _partial_velocities(tree):
        own = [place for place in columns if place // WIDTH == k - 1]
        for place, effort in zip(own, seen[k].efforts(tree, partial, own), strict=True):
            for row, share in partial.motion.shares.items():
                entries[row, place] = entries.get((row, place), S.Zero) + share * effort
    return Derived([entries.get((row, place), S.Zero) for row in rows for place in columns])


@dataclass(frozen=True)
class _PartialVelocity:
    """The motion of a frame for unit speed of a freedom.

    Attributes:
        motion: Motion of the freedom.
        angular: Partial angular velocity, Eq. (15) (1, 1/m).
        linear: Partial velocity of the origin, Eq. (28) (m, 1).
    """

    motion: FreedomMotion
    angular: Vector
    linear: Vector


def _partial_velocities(tree: Tree) -> Iterator[tuple[int, _PartialVelocity]]:
    """Yield, body by body outward, the partial velocities of its frame, about its origin and in K."""
    found: list[list[_PartialVelocity]] = [[]]
    for joint in tree.joints:
        tree.about(joint.body, "partial velocities, Eqs. (15), (28)")
        found.append(_outward(tree, joint, found[joint.lower]))
        yield from ((joint.body, partial) for partial in found[joint.body])


def _outward(tree: Tree, joint: JointMotion, below: Iterable[_PartialVelocity]) -> list[_PartialVelocity]:
    """Return the partial velocities above a joint, from those of the lower body."""
    found = [
        _named(tree, one.motion, f"{joint.body}j", one.angular, _shifted(one, joint.offset)) for one in below
    ]
    found += [_PartialVelocity(one, ZERO, one.direction) for one in joint.moving_translations if one.shares]
    for step in joint.steps:
        above, up = joint.above(step), step.turn.up
        found = [_named(tree, one.motion, above, up(one.angular), up(one.linear)) for one in found]
        if step.shares:
            found.append(_PartialVelocity(step, unit(step.axis), ZERO))
    return found + [_PartialVelocity(one, unit(one.axis), ZERO) for one in joint.angular_speeds]


def _named(
    tree: Tree, motion: FreedomMotion, frame: str, angular: Vector, linear: Vector
) -> _PartialVelocity:
    """Return a partial velocity with a symbol for every component."""
    vector, number = tree.definitions.vector, motion.number
    angular = vector(f"wy_{number}_{frame}", angular)
    return _PartialVelocity(motion, angular, vector(f"vy_{number}_{frame}", linear))


def _shifted(partial: _PartialVelocity, arm: Vector) -> Vector:
    """Return the partial velocity of the point at `arm` from the origin."""
    return add(partial.linear, cross(partial.angular, arm))


@dataclass(frozen=True)
class _UserFrame:
    """The motion of the frame of a body that its users see, in its components.

    Attributes:
        body: Number of the body.
        frame: The frame.
        arm: Vector from the origin of the recursions to that of the frame, in the body (m).
        acceleration: Acceleration of its origin less gravity (m/s^2).
        alpha: Angular acceleration (rad/s^2).
        squares: Products of the components of the angular velocity by pair of axes.
        field: [alpha~] + [omega~][omega~].
    """

    body: int
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
            return cls(k, frame, arm, acceleration, motion.alpha, motion.squares, motion.field)
        acceleration, omega, alpha = (
            definitions.vector(f"{name}_{k}f", frame.outward(v))
            for name, v in (("Ya", acceleration), ("Yw", motion.omega), ("Ye", motion.alpha))
        )
        squares, field = products_and_field(f"{k}f", omega, alpha, definitions)
        return cls(k, frame, arm, acceleration, alpha, squares, field)

    def efforts(self, tree: Tree, partial: _PartialVelocity, columns: Iterable[int]) -> Iterator[Expr]:
        """Yield the generalized force of a freedom for a unit of each parameter.

        Args:
            tree: The tree.
            partial: Partial velocity of the body by the freedom, about its origin and in K.
            columns: Columns of parameters of the body.
        """
        tree.about(self.body, "generalized forces for unit inertial parameters")
        angular, linear = partial.angular, _shifted(partial, self.arm)
        seen = partial
        if self.frame.is_turned or linear != partial.linear:
            outward = self.frame.outward
            linear = tree.definitions.vector(f"vy_{partial.motion.number}_{self.body}r", linear)
            seen = _named(tree, partial.motion, f"{self.body}f", outward(angular), outward(linear))
        for place in (column % WIDTH for column in columns):
            if place == 0:
                yield dot(seen.linear, self.acceleration)
            elif place < 4:
                yield self._of_first_moment(tree, seen, place - 1)
            else:
                yield dot(seen.angular, self._couple(tree, *UPPER[place - 4]))

    def _of_first_moment(self, tree: Tree, seen: _PartialVelocity, axis: int) -> Expr:
        """Return the generalized force for unit first moment along an axis."""
        couple = dot(seen.angular, cross(unit(axis), self.acceleration))
        couple = tree.definitions.define(f"Yh_{seen.motion.number}_{self.body}_{axis}", couple)
        return couple + dot(seen.linear, [row[axis] for row in self.field])

    def _couple(self, tree: Tree, i: int, j: int) -> Vector:
        """Return [I]{alpha} + {omega} x [I]{omega} for unit entries (i, j) and (j, i) of the inertia."""
        w, field, moment = self.squares, self.field, [S.Zero] * 3
        if i == j:
            p, q, r = i, (i + 1) % 3, (i + 2) % 3
            moment[p], moment[q], moment[r] = self.alpha[p], w[p, r], -w[p, q]
        else:
            p, q = (i, j) if j == (i + 1) % 3 else (j, i)
            r = 3 - i - j
            spread = tree.definitions.define(f"ww_{self.body}_d{r}", w[p, p] - w[q, q])
            moment[p], moment[q], moment[r] = -field[r][p], field[r][q], spread
        return Vector(*moment)
