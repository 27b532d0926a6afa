"""Rotors in the recursions: the angular momentum that each has beside that of its carrier.

A rotor that a freedom with the rate y drives has the angular momentum {h} y along its axis, fixed in its
carrier C, beside what it would have if it stood still in C. So the motion of C and of the rotor requires the
moment {h} {ydot} + {omega_C} x {h} y on C, and beside the reflected inertia, which counts as armature, the
effort {h}^T {alpha_C} on the freedom.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from sympy import Expr, S

from kanegen.model.system import System
from kanegen.recursion.constants import exact
from kanegen.recursion.frames import fixed_frame
from kanegen.recursion.joint_motion import NO_FREEDOM, FreedomMotion, JointMotion
from kanegen.recursion.joint_path import ROTATIONS, FrameChange, FreeComponent, PathElement
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, dot, scale
from kanegen.symbolic.definitions import Definitions, Vector


@dataclass(frozen=True)
class SpinningRotor:
    """A rotor that a freedom drives which moves.

    Attributes:
        carrier: Number of its carrier C, 0 for the ground.
        joint: Number of the body on whose joint the freedom is.
        motion: Motion of the freedom.
        momentum: Angular momentum {h} for unit rate of the freedom, in C (kg m^2, kg m).
    """

    carrier: int
    joint: int
    motion: FreedomMotion
    momentum: Vector

    def moment(self, omega: Vector, accelerated: bool) -> Vector:
        """Return the moment on the carrier that the spin requires, in C.

        Args:
            omega: Angular velocity of C, in C (rad/s).
            accelerated: Whether {ydot} counts; prescribed accelerations always do.
        """
        rate = self.motion.acceleration if accelerated else self.motion.prescribed_acceleration
        turning = scale(self.motion.rate, cross(omega, self.momentum))
        return add(turning, scale(rate, self.momentum))


def spinning_rotors(tree: Tree) -> tuple[SpinningRotor, ...]:
    """Return the rotors of a tree whose freedoms move."""
    found = []
    for place, one in enumerate(tree.system.mounted_rotors, start=1):
        number = tree.system.moving_places.get(one.freedom)
        if number is None:
            continue
        joint = tree.joints[one.freedom.body - 1]
        tree.about(one.body, f"rotor {place} ({one.rotor.name})")
        size = exact(one.rotor.inertia) * exact(one.rotor.ratio)
        axis = fixed_frame(tree, one.frame, one.body).inward(Vector(*map(exact, one.direction)))
        momentum = tree.definitions.vector(f"rh_{place}", scale(size, axis))
        motion = next(element for element in joint.elements if element.number == number)
        found.append(SpinningRotor(one.body, joint.body, motion, momentum))
    return tuple(found)


def rotor_moments(
    rotors: Iterable[SpinningRotor], omega: Mapping[int, Vector], *, accelerated: bool
) -> dict[int, Vector]:
    """Return the moment on each carrier that the spin of its rotors requires, in its frame.

    Args:
        rotors: The rotors.
        omega: Angular velocity of every body, in its frame (rad/s).
        accelerated: Whether free freedoms have accelerations.
    """
    found: dict[int, Vector] = {}
    for rotor in rotors:
        moment = rotor.moment(omega[rotor.carrier], accelerated)
        found[rotor.carrier] = add(found.get(rotor.carrier, ZERO), moment)
    return found


def rotor_efforts(rotors: Iterable[SpinningRotor], alpha: Mapping[int, Vector]) -> dict[int, Expr]:
    """Return the efforts that turn rotors with the angular accelerations of their carriers.

    Args:
        rotors: The rotors.
        alpha: Angular acceleration of every body, in its frame (rad/s^2).

    Returns:
        Efforts by number of the freedom.
    """
    found: dict[int, Expr] = {}
    for rotor in rotors:
        number, effort = rotor.motion.number, dot(rotor.momentum, alpha[rotor.carrier])
        found[number] = found.get(number, S.Zero) + effort
    return found


def articulated_bodies_take(system: System) -> bool:
    """Return whether the solver by articulated bodies takes all rotors of a system.

    The acceleration of a freedom must be eliminated where the angular acceleration of the carrier is that
    just below or just above it: the carrier is the lower body, and no free rotation of the joint lies
    between, or it is the body of the joint itself, and none lies between on that side.
    No coupling may name the freedom.
    """
    for one in system.mounted_rotors:
        if one.freedom in system.in_couplings:
            return False
        joint = system.bodies[one.freedom.body - 1].joint
        rotations, index = joint.free[:3], one.freedom.index
        if not joint.free[index]:
            continue
        inner, outer = (
            (any(rotations[:index]), any(rotations[index + 1 :])) if index < 3 else (False, any(rotations))
        )
        on_lower = one.body == system.connection[one.freedom.body - 1] and not inner
        if not on_lower and not (one.body == one.freedom.body and not outer):
            return False
    return True


def with_rotors(
    path: Sequence[PathElement], joint: JointMotion, rotors: Iterable[SpinningRotor], definitions: Definitions
) -> tuple[PathElement, ...]:
    """Return the path through a joint with the rotors that its freedoms drive, as components of their frames.

    Args:
        path: The path from body K inward.
        joint: The joint of K.
        rotors: The rotors of the tree, which `articulated_bodies_take`.
        definitions: Definitions that the intermediates are added to.
    """
    elements = list(path)
    for rotor in rotors:
        if rotor.joint == joint.body and rotor.motion.freedom != NO_FREEDOM:
            place = next(
                i
                for i, e in enumerate(elements)
                if isinstance(e, FreeComponent) and e.freedom == rotor.motion.freedom
            )
            component, momentum = elements[place], rotor.momentum
            assert isinstance(component, FreeComponent)
            if rotor.carrier == joint.body:
                turns = [e for e in elements[:place] if isinstance(e, FrameChange)]
                for element in turns:
                    momentum = element.turn.down(momentum)
            else:
                turns = [e for e in elements[place:] if isinstance(e, FrameChange)]
                for element in reversed(turns):
                    momentum = element.turn.up(momentum)
            momentum = definitions.vector(f"rc_{rotor.motion.freedom}", momentum)
            armature, index = component.armature, component.index
            if rotor.carrier == joint.body and index in ROTATIONS:
                armature = definitions.define(f"ar_{rotor.motion.freedom}", armature + 2 * momentum[index])
            elements[place] = replace(
                component, armature=armature, momentum=add(component.momentum, momentum)
            )
    return tuple(elements)
