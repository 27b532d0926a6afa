"""[A] and {f} as CasADi expressions: composite bodies, and inverse dynamics without acceleration.

As in R. Featherstone, Rigid Body Dynamics Algorithms (2008), chapters 5 and 6.
"""

from __future__ import annotations

import casadi
from casadi import SX

from kanegen.model.arrays import Floats
from kanegen.studies.bench.peers.casadi_joints import Motion, Moved, Tree

Composite = tuple[SX, SX, SX]
"""Mass, first moment, and inertia about the origin."""


def forcing(tree: Tree, gravity: Floats, y: SX) -> SX:
    """{f}: minus the generalized forces of inverse dynamics without acceleration."""
    ground = Motion(SX(3, 1), SX(3, 1), SX(-gravity))
    motions: list[Motion] = []
    for at in tree:
        motions.append(at.outward(motions[at.parent - 1] if at.parent else ground, y[at.column]))
    loads = [_load(at, motion) for at, motion in zip(tree, motions, strict=True)]
    result = SX(len(tree), 1)
    for i in reversed(range(len(tree))):
        at, (moment, force) = tree[i], loads[i]
        result[at.column] = -at.own(moment, force)
        if at.parent:
            lower, carried = loads[at.parent - 1], at.inward(moment, force)
            loads[at.parent - 1] = (lower[0] + carried[0], lower[1] + carried[1])
    return result


def mass_matrix(tree: Tree) -> SX:
    """[A] by composite bodies."""
    bodies: list[Composite] = [(at.mass, at.moment, at.inertia) for at in tree]
    result = SX(len(tree), len(tree))
    for i in reversed(range(len(tree))):
        at, (mass, first, inertia) = tree[i], bodies[i]
        if at.angle:
            moment, force = inertia @ at.axis, casadi.cross(at.axis, first)
        else:
            moment, force = casadi.cross(first, at.axis), mass * at.axis
        result[at.column, at.column] = at.own(moment, force)
        step = at
        while step.parent:
            moment, force = step.inward(moment, force)
            step = tree[step.parent - 1]
            result[step.column, at.column] = result[at.column, step.column] = step.own(moment, force)
        if at.parent:
            lower, carried = bodies[at.parent - 1], _carried(at, mass, first, inertia)
            bodies[at.parent - 1] = (lower[0] + carried[0], lower[1] + carried[1], lower[2] + carried[2])
    return result


def _load(at: Moved, motion: Motion) -> tuple[SX, SX]:
    """Moment and force that the body beyond a joint needs."""
    velocity, first = motion.velocity, at.moment
    force = at.mass * motion.acceleration + casadi.cross(motion.rate, first)
    force += casadi.cross(velocity, casadi.cross(velocity, first))
    moment = at.inertia @ motion.rate + casadi.cross(velocity, at.inertia @ velocity)
    return moment + casadi.cross(first, motion.acceleration), force


def _carried(at: Moved, mass: SX, first: SX, inertia: SX) -> Composite:
    """A composite body seen from the frame before the joint."""
    arm, first = casadi.skew(at.position), at.rotation @ first
    cross = arm @ casadi.skew(first)
    inertia = at.rotation @ inertia @ at.rotation.T - cross - cross.T - mass * arm @ arm
    return mass, first + mass * at.position, inertia
