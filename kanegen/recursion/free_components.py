"""The tree with free components of acceleration as its speeds, in which [A] is regular.

Where the three angles of a joint are free, their rates are replaced by the components in K of the relative
angular velocity, in which [A] is regular at gimbal lock. A body that translates freely above the ground, and
rotates, floats: nothing but gravity depends on where it is, how it is turned and how fast it travels. Its
components are those of the acceleration of its origin less gravity, in K, and of its angular acceleration; so
the tree is as if K were the ground's frame, without weight, and the derivatives by its pose vanish.

The functions here lead from {x}, {y}, {tau} to the quantities of that tree, and back to {ydot}.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sympy import Expr, S

from kanegen.recursion.angular_components import with_torques
from kanegen.recursion.constants import exact
from kanegen.recursion.coordinate_rates import angle_rates
from kanegen.recursion.joint_builder import turning_as_a_whole
from kanegen.recursion.joint_motion import AngularSpeed, JointMotion, Step
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, scale, subtract, unit
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.state_symbols import NOTES


def floats(joint: JointMotion) -> bool:
    """Return whether a joint of the ground leaves all motions of its body free."""
    rotates = joint.rotates_freely or joint.turns_freely
    return not joint.lower and joint.translates_freely and rotates


def with_free_components(tree: Tree) -> Tree:
    """Return the tree with free components as speeds; the symbols of {ydot} stand for their accelerations."""
    return replace(tree, joints=tuple(_with_free_components(joint, tree) for joint in tree.joints))


def _with_free_components(joint: JointMotion, tree: Tree) -> JointMotion:
    """Return a joint with free components as speeds."""
    if not (joint.rotates_freely or floats(joint)):
        return joint
    tree.about(joint.body, "the relative angular velocity, Eq. (8)")
    speeds = joint.angular_speeds or _speeds_of_angles(joint, tree.definitions)
    if not floats(joint):
        rotation = tree.system.bodies[joint.body - 1].joint.rotation
        return turning_as_a_whole(replace(joint, angular_speeds=speeds), rotation, tree.definitions)
    translations = tuple(
        replace(one, direction=unit(i), axis=i, rate=S.Zero, value=S.Zero)
        for i, one in enumerate(joint.translations)
    )
    return JointMotion(
        joint.body,
        0,
        arm=ZERO,
        directions=(unit(0), unit(1), unit(2)),
        offset=ZERO,
        origin=joint.origin,
        translations=translations,
        constant=(),
        angles=(),
        angular_speeds=speeds,
        to_center=joint.to_center,
        is_weightless=True,
    )


def _speeds_of_angles(joint: JointMotion, definitions: Definitions) -> tuple[AngularSpeed, ...]:
    """Return the components of the relative angular velocity of a joint with three free angles, Eq. (8)."""
    one, two, three = (step.rate for step in joint.angles)
    named = definitions.vector(f"wr_{joint.body}", angle_rates(joint, definitions).angular((one, two, three)))
    return tuple(
        AngularSpeed(
            freedom=step.freedom,
            number=step.number,
            axis=i,
            rate=rate,
            acceleration=step.acceleration,
            shares={step.freedom: S.One},
        )
        for i, (step, rate) in enumerate(zip(joint.angles, named, strict=True))
    )


def component_speeds(free: Tree, speeds: Sequence[Expr]) -> list[Expr]:
    """Return the free components of the speeds by place in {y}; floating translations stay as they are.

    Args:
        free: The tree with free components as speeds.
        speeds: {y}.
    """
    found = list(speeds)
    for joint in free.joints:
        for one in joint.angular_speeds:
            found[one.freedom] = one.rate
    return found


def component_efforts(tree: Tree, efforts: Sequence[Expr], *, about_origins: bool = False) -> list[Expr]:
    """Return the generalized forces on the free components for those on the freedoms, by place in {y}.

    Args:
        tree: The tree with {y} as speeds.
        efforts: Generalized forces by place in {y}.
        about_origins: Whether those on rotations are moments about the origins of the tree, not about O_K.
    """
    found, definitions = with_torques(tree, efforts), tree.definitions
    for joint in tree.joints:
        if floats(joint):
            tree.about(joint.body, "efforts in the body, Eq. (9)")
            force = Vector(*(found[one.freedom] for one in joint.translations))
            for step in joint.angles:
                force = definitions.vector(f"tF_{step.frame}u", step.turn.up(force))
            about = ZERO if about_origins else cross(joint.to_center, force)
            for one, along in zip(joint.translations, force, strict=True):
                found[one.freedom] = along
            for place, less in zip(joint.rotations, about, strict=True):
                found[place] = definitions.define(f"te_{place}", found[place] - less)
    return found


def speed_rates(tree: Tree, free: Tree) -> list[Expr]:
    """Return {ydot} from the free components of acceleration, for which its own symbols stand, Eq. (9).

    Args:
        tree: The tree with {y} as speeds.
        free: The same with free components as speeds.
    """
    found: list[Expr] = list(NOTES.accelerations(tree.system))
    for joint, other in zip(tree.joints, free.joints, strict=True):
        if joint.rotates_freely:
            tree.about(joint.body, "{ydot} of the joint, Eq. (9)")
            bias = _bias(joint.angles, tree.definitions)
            angular = tree.definitions.vector(f"qr_{joint.body}", subtract(other.relative_alpha, bias))
            one, two, three = (f"ydot_{step.freedom}" for step in joint.angles)
            rates = angle_rates(joint, tree.definitions).rates(angular, (one, two, three))
            for step, rate in zip(joint.angles, rates, strict=True):
                found[step.freedom] = rate
        if floats(joint):
            tree.about(joint.body, "{ydot} of the joint, Eq. (9)")
            places = [one.freedom for one in joint.translations]
            for place, rate in zip(places, _translation_rates(joint, other, tree), strict=True):
                found[place] = rate
    return found


def _bias(steps: Sequence[Step], definitions: Definitions) -> Vector:
    """Return the rate, in K, of the relative angular velocity where all second derivatives are zero."""
    omega, alpha = ZERO, ZERO
    for step in steps:
        turned, rate = step.turn.up(omega), scale(step.rate, unit(step.axis))
        alpha = definitions.vector(f"qb_{step.frame}", add(step.turn.up(alpha), cross(turned, rate)))
        omega = definitions.vector(f"wr_{step.frame}", add(turned, rate))
    return alpha


def _translation_rates(joint: JointMotion, free: JointMotion, tree: Tree) -> list[Expr]:
    """Return the second derivatives of the translations of a floating body."""
    definitions, omega, alpha = tree.definitions, free.relative_omega, free.relative_alpha
    linear = Vector(*(one.acceleration for one in free.translations))
    center = joint.to_center
    passing = definitions.vector(f"vc_{joint.body}", cross(omega, center))
    moved = add(cross(alpha, center), cross(omega, passing))
    linear = definitions.vector(f"qs_{joint.body}", subtract(linear, moved))
    for step in reversed(joint.angles):
        linear = definitions.vector(f"qs_{step.frame}", step.turn.down(linear))
    weight = Vector(*(exact(value) for value in tree.system.gravity))
    for step in joint.constant:
        weight = definitions.vector(f"gj_{step.frame}", step.turn.up(weight))
    total = add(linear, weight)
    return [definitions.define(f"ydot_{one.freedom}", total[one.axis]) for one in joint.translations]
