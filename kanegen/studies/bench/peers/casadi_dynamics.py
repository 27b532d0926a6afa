"""{ydot} as a CasADi expression by two methods: articulated bodies, and a factorisation without fill-in.

As in R. Featherstone, Rigid Body Dynamics Algorithms (2008), chapters 7 and 8.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi
from casadi import SX

from kanegen.model.arrays import Floats
from kanegen.studies.bench.peers.casadi_joints import Motion, Moved, Tree, below


@dataclass
class Articulated:
    """An articulated body: moment = J w + H v + m, force = H^T w + M v + p, for accelerations w and v.

    Attributes:
        rotational: (3, 3) J.
        mixed: (3, 3) H.
        linear: (3, 3) M.
        moment: (3, 1) m.
        force: (3, 1) p.
    """

    rotational: SX
    mixed: SX
    linear: SX
    moment: SX
    force: SX

    def __add__(self, other: Articulated) -> Articulated:
        return Articulated(
            self.rotational + other.rotational,
            self.mixed + other.mixed,
            self.linear + other.linear,
            self.moment + other.moment,
            self.force + other.force,
        )


@dataclass(frozen=True)
class Pivot:
    """The equation of motion of one freedom of an articulated body.

    Attributes:
        moment: (3, 1) moment of a unit acceleration of the freedom.
        force: (3, 1) force of a unit acceleration of the freedom.
        size: Inertia of the freedom and its motor.
        rest: Generalized force that is left for the acceleration of the freedom.
    """

    moment: SX
    force: SX
    size: SX
    rest: SX


def articulated(tree: Tree, gravity: Floats, y: SX, tau: SX) -> SX:
    """Return {ydot} by the algorithm of articulated bodies."""
    zero = SX(3, 1)
    motions: list[Motion] = []  # of each body, if its lower body were not accelerated
    for at in tree:
        velocity = motions[at.parent - 1].velocity if at.parent else zero
        motions.append(at.outward(Motion(velocity, zero, zero), y[at.column]))
    bodies = [_alone(at, motion.velocity) for at, motion in zip(tree, motions, strict=True)]
    pivots: dict[int, Pivot] = {}
    for i in reversed(range(len(tree))):
        at = tree[i]
        pivots[i] = _pivot(at, bodies[i], tau[at.column])
        if at.parent:
            bodies[at.parent - 1] += _passed(at, bodies[i], pivots[i], motions[i])
    result = SX(len(tree), 1)
    rates: list[tuple[SX, SX]] = []
    for i, (at, motion) in enumerate(zip(tree, motions, strict=True)):
        angular, linear = rates[at.parent - 1] if at.parent else (zero, SX(-gravity))
        linear = at.rotation.T @ (linear + casadi.cross(angular, at.position)) + motion.acceleration
        angular = at.rotation.T @ angular + motion.rate
        pivot = pivots[i]
        carried = casadi.dot(pivot.moment, angular) + casadi.dot(pivot.force, linear)
        result[at.column] = value = (pivot.rest - carried) / pivot.size
        own = at.axis * value
        rates.append((angular + own, linear) if at.angle else (angular, linear + own))
    return result


def factorised(tree: Tree, matrix: SX, right: SX) -> SX:
    """Solve [A]{ydot} = {right} by L^T D L, eliminating from the leaves inward, which keeps zeros of [A]."""
    a, b = SX(matrix), SX(right)
    for at in reversed(tree):
        k, lower = at.column, [other.column for other in below(tree, at)]
        for place, i in enumerate(lower):
            share = a[k, i] / a[k, k]
            for j in lower[place:]:
                a[i, j] -= share * a[k, j]
            b[i] -= share * b[k]
    for at in tree:
        k = at.column
        for other in below(tree, at):
            b[k] -= a[k, other.column] * b[other.column]
        b[k] /= a[k, k]
    return b


def _alone(at: Moved, velocity: SX) -> Articulated:
    """Return the body beyond a joint as an articulated body with the loads of its angular velocity."""
    moment = casadi.cross(velocity, at.inertia @ velocity)
    force = casadi.cross(velocity, casadi.cross(velocity, at.moment))
    return Articulated(at.inertia, casadi.skew(at.moment), at.mass * SX.eye(3), moment, force)


def _pivot(at: Moved, body: Articulated, tau: SX) -> Pivot:
    """Return the equation of motion of the freedom of a joint."""
    if at.angle:
        moment, force = body.rotational @ at.axis, body.mixed.T @ at.axis
    else:
        moment, force = body.mixed @ at.axis, body.linear @ at.axis
    size = at.own(moment, force) + at.armature
    return Pivot(moment, force, size, tau - at.own(body.moment, body.force))


def _passed(at: Moved, body: Articulated, pivot: Pivot, motion: Motion) -> Articulated:
    """Return the articulated body that the lower body feels through a joint."""
    moment, force = pivot.moment / pivot.size, pivot.force / pivot.size
    rotational = body.rotational - moment @ pivot.moment.T
    mixed = body.mixed - moment @ pivot.force.T
    linear = body.linear - force @ pivot.force.T
    rate, acceleration = motion.rate, motion.acceleration
    carried = at.inward(
        body.moment + rotational @ rate + mixed @ acceleration + moment * pivot.rest,
        body.force + mixed.T @ rate + linear @ acceleration + force * pivot.rest,
    )
    turn, arm = at.rotation, casadi.skew(at.position)
    rotational, mixed, linear = (turn @ block @ turn.T for block in (rotational, mixed, linear))
    below_mixed = mixed + arm @ linear
    return Articulated(rotational - mixed @ arm + arm @ below_mixed.T, below_mixed, linear, *carried)
