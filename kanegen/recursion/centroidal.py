"""The centroidal momentum matrix [A_G] and its bias (Orin, Goswami and Lee 2013).

A column of [A_G] is the momentum of all bodies for unit speed of one freedom: linear, and angular about the
mass centre C of all bodies. As in [A], everything outward of the freedom moves as one composite body, so that
its linear momentum and its angular momentum about its own origin are entries of first and second moments. The
vector from C to the origin adds the moment of the linear momentum; it is passed outward from body to body, in
their frames. Only then the column is turned into inertial components, by the rotation of the lower body,
which the freedom does not move.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kanegen.recursion.body_motion import body_motions
from kanegen.recursion.columns import RotationColumn
from kanegen.recursion.composites import CompositeBodies, composite_bodies
from kanegen.recursion.energy_and_momentum import total_mass
from kanegen.recursion.inertia import Inertia
from kanegen.recursion.inverse_dynamics import carried_wrenches, required
from kanegen.recursion.joint_motion import FreedomMotion, JointMotion, Step
from kanegen.recursion.kinematics import Pose, poses
from kanegen.recursion.rotors import spinning_rotors
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import ZERO, add, column, cross, negate, scale, unit
from kanegen.symbolic.definitions import Vector


@dataclass(frozen=True)
class UnitMomentum:
    """The momentum for unit speed of a freedom, in the frame of a body.

    Attributes:
        motion: Motion of the freedom.
        body: Number of the body, 0 for the ground.
        linear: Linear momentum (kg, kg m).
        angular: Angular momentum about the mass centre of all bodies (kg m, kg m^2).
    """

    motion: FreedomMotion
    body: int
    linear: Vector
    angular: Vector


def centroidal_momentum_matrix(tree: Tree) -> Derived:
    """Derive the (6, n) entries of [A_G]: momentum by {y}, linear rows first, inertial components."""
    n, seen = len(tree.system.freedoms), poses(tree)
    columns = [(ZERO, ZERO)] * n
    for one in _unit_momenta(tree):
        linear, angular = _inertial(tree, one, seen[one.body])
        for place, share in one.motion.shares.items():
            p, about = columns[place]
            columns[place] = add(p, scale(share, linear)), add(about, scale(share, angular))
    return Derived([col[part][i] for part in range(2) for i in range(3) for col in columns])


def centroidal_momentum_bias(tree: Tree) -> Derived:
    """Derive the rate of the momentum for {ydot} = 0: the force and the moment that the motion requires.

    The velocity of the mass centre adds nothing to the rate of the angular momentum about it, because it is
    along the linear momentum. The weight of the bodies is no part of the rate; prescribed accelerations are.
    """
    arms = _arms(tree, composite_bodies(tree))
    moved = body_motions(tree, accelerated=False, weightless=True)
    needed = required(tree, moved, accelerated=False, loaded=False)
    linear = angular = ZERO
    for carried in carried_wrenches(tree, needed.wrenches):
        if not carried.joint.lower:
            below = carried.below
            linear = add(linear, below.force)
            about = add(below.moment, cross(arms.below[carried.joint.body], below.force))
            angular = add(angular, about)
    for rotor in spinning_rotors(tree):
        if not rotor.carrier:
            angular = add(angular, rotor.moment(ZERO, accelerated=False))
    return Derived([*linear, *angular])


def _inertial(tree: Tree, one: UnitMomentum, pose: Pose) -> tuple[Vector, Vector]:
    """Return a momentum in inertial components."""
    tree.about(one.body, "momentum for unit speeds of joints, inertial components")
    number, vector = one.motion.number, tree.definitions.vector
    linear, angular = vector(f"PB_{number}", one.linear), vector(f"LB_{number}", one.angular)
    return (
        vector(f"PG_{number}", pose.inertial(linear)),
        vector(f"LG_{number}", pose.inertial(angular)),
    )


def _unit_momenta(tree: Tree) -> Iterator[UnitMomentum]:
    """Yield the momentum for unit speed of every freedom that {y} moves, and that of the spin of rotors."""
    composites = composite_bodies(tree)
    arms = _arms(tree, composites)
    for joint in tree.joints:
        tree.about(joint.body, "momentum for unit speeds of its joint")
        yield from _of_angles(tree, joint, composites.in_frames[joint.body], arms.below[joint.body])
        yield from _of_angular_speeds(joint, composites.in_frames[joint.body][-1], arms.above[joint.body])
        yield from _of_translations(tree, joint, composites, arms)
    for rotor in spinning_rotors(tree):
        if rotor.motion.shares:
            yield UnitMomentum(rotor.motion, rotor.carrier, ZERO, rotor.momentum)


@dataclass(frozen=True)
class Arms:
    """The vectors from the mass centre of all bodies to the origin of each body; entry 0 is the ground (m).

    Attributes:
        below: In components of the lower body.
        above: In components of the body.
        sole: Number of the body on the ground that carries all mass, or 0 if there is none.
    """

    below: list[Vector]
    above: list[Vector]
    sole: int


def _arms(tree: Tree, composites: CompositeBodies) -> Arms:
    """Return the vectors from the mass centre of all bodies to the origins, passed outward.

    Where one body carries all mass, the mass centre is that of its composite body, wherever its joint puts
    it.
    """
    definitions, sole, mass = tree.definitions, _carrier_of_all(tree, composites), total_mass(tree)
    center = scale(1 / mass, composites.on_lower[0].moment) if mass != 0 else ZERO
    below, above = [ZERO], [ZERO if sole else negate(definitions.vector("c_0", center))]
    for joint in tree.joints:
        k = joint.body
        tree.about(k, "origin from the mass centre of all bodies")
        if k == sole:
            arm = scale(-1 / mass, composites.in_frames[k][0].moment)
        else:
            arm = add(above[joint.lower], joint.offset)
        below.append(arm := definitions.vector(f"ra_{k}j", arm))
        for step in joint.steps:
            arm = definitions.vector(f"ra_{joint.above(step)}", step.turn.up(arm))
        above.append(arm)
    return Arms(below, above, sole)


def _carrier_of_all(tree: Tree, composites: CompositeBodies) -> int:
    """Return the number of the body on the ground that carries all mass; 0 if there is none."""
    heavy = [one.body for one in tree.joints if not one.lower and composites.on_lower[one.body].mass != 0]
    return heavy[0] if len(heavy) == 1 and tree.ground.mass == 0 else 0


def _of_angles(
    tree: Tree, joint: JointMotion, composite: tuple[Inertia, ...], arm: Vector
) -> Iterator[UnitMomentum]:
    """Yield the momenta of the angles of a joint, in the frame of the lower body.

    Args:
        tree: The tree.
        joint: The joint.
        composite: The composite body in the frame below each turn.
        arm: Vector from the mass centre of all bodies to its origin, in the lower body (m).
    """
    for place, step in enumerate(joint.steps):
        if step.shares:
            col = _angle_column(step, composite[place])
            for inner in reversed(joint.steps[:place]):
                col = col.down(inner.turn, inner.frame, tree.definitions)
            yield UnitMomentum(step, joint.lower, col.force, add(col.moment, cross(arm, col.force)))


def _angle_column(step: Step, below: Inertia) -> RotationColumn:
    """Return the momentum of an angle about the origin of its body, in the frame below its turn."""
    force = cross(unit(step.axis), below.moment)
    moment = column(below.inertia, step.axis)
    return RotationColumn(step.number, step.shares, step.frame, force, moment)


def _of_angular_speeds(joint: JointMotion, composite: Inertia, arm: Vector) -> Iterator[UnitMomentum]:
    """Yield the momenta of the components of a relative angular velocity, in the frame of the body.

    Args:
        joint: The joint.
        composite: The composite body in its own frame.
        arm: Vector from the mass centre of all bodies to its origin, in its frame (m).
    """
    for speed in joint.angular_speeds:
        linear = cross(unit(speed.axis), composite.moment)
        angular = add(column(composite.inertia, speed.axis), cross(arm, linear))
        yield UnitMomentum(speed, joint.body, linear, angular)


def _of_translations(
    tree: Tree, joint: JointMotion, composites: CompositeBodies, arms: Arms
) -> Iterator[UnitMomentum]:
    """Yield the momenta of the translations of a joint, in the frame of the lower body.

    Their angular momentum is zero where the joint moves all mass.
    """
    k, carried = joint.body, composites.in_frames[joint.body][0]
    about = ZERO
    if joint.translations and k != arms.sole:
        about = add(carried.moment, scale(carried.mass, arms.below[k]))
        about = tree.definitions.vector(f"hG_{k}", about)
    for one in joint.translations:
        linear = scale(carried.mass, one.direction)
        yield UnitMomentum(one, joint.lower, linear, cross(about, one.direction))
