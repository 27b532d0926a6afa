"""The outputs {f} and [A]{ydot} - {f}, and the part of {f} that motion causes, by a recursion of forces.

An outward pass computes the motion of every body (`body_motion`), an inward pass the force and moment about
its origin that this motion requires, less the loads. Their component along a freedom is the generalized force
that the freedom requires; for {ydot} = 0 this is minus its entry of {f} (Luh, Walker and Paul 1980;
Featherstone 2008, section 5.3). Prescribed freedoms require such a force too. That of a coupled freedom adds
to those of the freedoms that it follows, times its factors.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from sympy import Add, Expr, S

from kanegen.recursion.body_motion import BodyMotion, body_motions
from kanegen.recursion.constants import exact
from kanegen.recursion.force_elements import applied_wrenches, element_efforts
from kanegen.recursion.frames import fixed_frame
from kanegen.recursion.inertia import Inertia
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.rotors import rotor_efforts, rotor_moments, spinning_rotors
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import Wrench, add, cross, dot, multiply, negate, scale, subtract
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.symbols import force as force_symbol
from kanegen.symbolic.symbols import torque as torque_symbol


def forcing(tree: Tree) -> Derived:
    """Derive the entries of {f}, Eq. (44)."""
    return Derived([-needed for needed in required_efforts(tree, _required(tree, accelerated=False))])


def velocity_forces(tree: Tree) -> Derived:
    """Derive the part of {f} that {y} and prescribed motion cause, without weights, loads and elements."""
    moved = body_motions(tree, accelerated=False, weightless=True)
    needed = required(tree, moved, accelerated=False, loaded=False)
    return Derived([-effort for effort in at_free(tree, _along_freedoms(tree, needed))])


def inverse_dynamics(tree: Tree) -> Derived:
    """Derive the entries of [A]{ydot} - {f}, the generalized forces for {ydot} beside loads and gravity."""
    return Derived(required_efforts(tree, _required(tree, accelerated=True)))


def prescribed_efforts(tree: Tree) -> Derived:
    """Derive the generalized forces at the prescribed freedoms, beside loads and gravity."""
    found = _all_required_efforts(tree, _required(tree, accelerated=True))
    return Derived(found[len(tree.system.freedoms) :])


@dataclass(frozen=True)
class Requirement:
    """What a motion requires of the bodies and of the motors, less loads.

    Attributes:
        wrenches: Force and moment about its origin for each body.
        efforts: Generalized forces that the armature of motors and the rotors take, by number of the freedom,
            as in `Step.number`.
    """

    wrenches: Sequence[Wrench]
    efforts: Mapping[int, Expr]


def _required(tree: Tree, *, accelerated: bool) -> Requirement:
    """Return what the motion of the system requires; `accelerated` as for `body_motions`."""
    return required(tree, body_motions(tree, accelerated=accelerated), accelerated=accelerated)


def required(
    tree: Tree, moved: Mapping[int, BodyMotion], *, accelerated: bool, loaded: bool = True
) -> Requirement:
    """Return what a motion requires.

    Args:
        tree: The tree.
        moved: Motion of every body, by number.
        accelerated: Whether the freedoms have accelerations, as for `body_motions`.
        loaded: Whether loads and springs on the bodies are subtracted.
    """
    rotors = spinning_rotors(tree)
    efforts = _armature_efforts(tree, accelerated)
    alpha = {k: motion.alpha for k, motion in moved.items()}
    for number, effort in rotor_efforts(rotors, alpha).items():
        efforts[number] = tree.definitions.define(f"fr_{number}", efforts.get(number, S.Zero) + effort)
    omega = {k: motion.omega for k, motion in moved.items()}
    moments = rotor_moments(rotors, omega, accelerated=accelerated)
    applied = _less_moments(applied_wrenches(tree) if loaded else {}, moments)
    return Requirement(required_wrenches(tree, moved, applied, loaded=loaded), efforts)


def required_by_elements(tree: Tree, moved: Mapping[int, BodyMotion], *, accelerated: bool) -> list[Expr]:
    """Return what force elements, loads on points and rotors contribute to the required generalized forces.

    The other part is what the bodies require, less loads on bodies, and what accelerates armature.

    Args:
        tree: The tree.
        moved: Motion of every body, by number.
        accelerated: Whether the freedoms have accelerations, as for `body_motions`.
    """
    return required_efforts(tree, _requirement_of_elements(tree, moved, accelerated))


def required_by_wrenches(tree: Tree, moved: Mapping[int, BodyMotion], *, accelerated: bool) -> list[Expr]:
    """Return the same without the efforts that force elements exert along freedoms (`efforts_of_elements`).

    Args:
        tree: The tree.
        moved: Motion of every body, by number.
        accelerated: Whether the freedoms have accelerations, as for `body_motions`.
    """
    return at_free(tree, _along_freedoms(tree, _requirement_of_elements(tree, moved, accelerated)))


def efforts_of_elements(tree: Tree) -> list[Expr]:
    """Return the efforts that force elements exert along freedoms, by place in {y}."""
    acting = element_efforts(tree)
    along = {
        number: acting.get((freedom.body, freedom.index), S.Zero)
        for freedom, number in tree.system.moving_places.items()
    }
    return at_free(tree, along)


def _requirement_of_elements(tree: Tree, moved: Mapping[int, BodyMotion], accelerated: bool) -> Requirement:
    """Return the wrenches and efforts that springs, loads on points and rotors require."""
    rotors = spinning_rotors(tree)
    efforts = rotor_efforts(rotors, {k: motion.alpha for k, motion in moved.items()})
    omega = {k: motion.omega for k, motion in moved.items()}
    moments = rotor_moments(rotors, omega, accelerated=accelerated)
    applied = _less_moments(applied_wrenches(tree), moments)
    wrenches = [_opposite(applied.get(joint.body, Wrench())) for joint in tree.joints]
    return Requirement(wrenches, efforts)


def required_by_bodies(tree: Tree, moved: Mapping[int, BodyMotion], *, accelerated: bool) -> list[Expr]:
    """Return the other part of the required generalized forces: that of bodies, loads on them and armature.

    Args:
        tree: The tree.
        moved: Motion of every body, by number.
        accelerated: Whether the freedoms have accelerations, as for `body_motions`.
    """
    wrenches = required_wrenches(tree, moved, {})
    return at_free(tree, _along_freedoms(tree, Requirement(wrenches, _armature_efforts(tree, accelerated))))


def _armature_efforts(tree: Tree, accelerated: bool) -> dict[int, Expr]:
    """Return the generalized forces that accelerate the armature of motors, by number of the freedom."""
    found: dict[int, Expr] = {}
    for joint in tree.joints:
        for one in joint.elements:
            rate = one.acceleration if accelerated else one.prescribed_acceleration
            if one.armature != 0 and rate != 0:
                found[one.number] = tree.definitions.define(f"fm_{one.number}", one.armature * rate)
    return found


def _less_moments(applied: Mapping[int, Wrench], moments: Mapping[int, Vector]) -> dict[int, Wrench]:
    """Return applied wrenches by body, less the moments that the spin of rotors requires of their carriers.

    Args:
        applied: Wrenches by number of the body.
        moments: Moments by number of the carrier, in its frame.
    """
    found = dict(applied)
    for k, moment in moments.items():
        load = found.get(k, Wrench())
        found[k] = replace(load, moment=subtract(load.moment, moment))
    return found


def _opposite(wrench: Wrench) -> Wrench:
    """Return a wrench with its sign changed."""
    return Wrench(negate(wrench.force), negate(wrench.moment))


def required_wrenches(
    tree: Tree, moved: Mapping[int, BodyMotion], applied: Mapping[int, Wrench], *, loaded: bool = True
) -> list[Wrench]:
    """Return for each body the force and moment about its origin that its motion requires, less its loads.

    Args:
        tree: The tree.
        moved: Motion of every body, by number.
        applied: Further wrenches that act on bodies, by number.
        loaded: Whether loads on bodies are subtracted.
    """
    return [
        _required_wrench(tree, joint.body, moved[joint.body], applied.get(joint.body, Wrench()), loaded)
        for joint in tree.joints
    ]


def _required_wrench(tree: Tree, k: int, motion: BodyMotion, applied: Wrench, loaded: bool) -> Wrench:
    """Return the wrench that the motion of body `k` requires, less its loads, Eqs. (38), (44)."""
    body, inertia, definitions = tree.system.bodies[k - 1], tree.inertias[k - 1], tree.definitions
    tree.about(k, "force and moment about its origin, Eq. (44)")
    m, h = inertia.mass, inertia.moment
    force = add(scale(m, motion.acceleration), multiply(motion.field, h))
    moment = add(_rotational_moment(inertia, motion, definitions, k), cross(h, motion.acceleration))
    if body.loads and loaded:
        load, torque = (
            _in_body(tree, k, Vector(*(symbol(k, axis) for axis in range(3))), name)
            for symbol, name in ((force_symbol, "Fl"), (torque_symbol, "Ml"))
        )
        center = Vector(*(exact(value) for value in body.mass_center))
        arm = definitions.vector(f"r_{k}", subtract(center, tree.joints[k - 1].origin))
        force = subtract(force, load)
        moment = subtract(subtract(moment, torque), cross(arm, load))
    named = definitions.vector(f"F_{k}own", subtract(force, applied.force))
    return Wrench(named, definitions.vector(f"M_{k}own", subtract(moment, applied.moment)))


def _in_body(tree: Tree, k: int, load: Vector, name: str) -> Vector:
    """Return a load on body `k` in body components, from those of the frame that users of the body see."""
    frame = fixed_frame(tree, tree.system.bodies[k - 1].name, k)
    return tree.definitions.vector(f"{name}_{k}", frame.inward(load)) if frame.is_turned else load


def _rotational_moment(inertia: Inertia, motion: BodyMotion, definitions: Definitions, k: int) -> Vector:
    """Return [I] {alpha} + [omega~] [I] {omega}, from the products of speeds that `field` already holds."""
    i, w, field = inertia.inertia, motion.squares, motion.field
    diagonal = (i.xx, i.yy, i.zz)
    product = {(0, 1): i.xy, (1, 0): i.xy, (0, 2): i.xz, (2, 0): i.xz, (1, 2): i.yz, (2, 1): i.yz}
    components = []
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        difference = definitions.define(f"I_{k}_d{a}", diagonal[c] - diagonal[b])
        spread = definitions.define(f"ww_{k}_d{a}", w[b, b] - w[c, c])
        components.append(
            diagonal[a] * motion.alpha[a]
            - product[a, b] * field[c][a]
            + product[a, c] * field[b][a]
            + difference * w[b, c]
            + product[b, c] * spread
        )
    return Vector(*components)


@dataclass(frozen=True)
class CarriedWrench:
    """The wrench that a joint transmits: force and moment for its body and all bodies outward.

    Attributes:
        joint: The joint of body K.
        path: Force and moment about the origin of K, in the frame below each turn of the joint, then in K.
    """

    joint: JointMotion
    path: tuple[Wrench, ...]

    @property
    def above(self) -> Wrench:
        """Force and moment about the origin of K, in its frame."""
        return self.path[-1]

    @property
    def below(self) -> Wrench:
        """Force and moment about the origin of K, in the frame of J."""
        return self.path[0]


def carried_wrenches(tree: Tree, wrenches: Sequence[Wrench]) -> Iterator[CarriedWrench]:
    """Yield the wrench that each joint transmits, joint by joint inward.

    Args:
        tree: The tree.
        wrenches: Wrench that each body requires, less its loads.
    """
    definitions = tree.definitions
    carried = [Wrench() for _ in tree.joints]
    for joint in reversed(tree.joints):
        k, j, own = joint.body, joint.lower, wrenches[joint.body - 1]
        tree.about(k, "force and moment about its origin, Eq. (44)")
        force = definitions.vector(f"F_{k}", add(own.force, carried[k - 1].force))
        moment = definitions.vector(f"M_{k}", add(own.moment, carried[k - 1].moment))
        path = [Wrench(force, moment)]
        for step in reversed(joint.steps):
            force = definitions.vector(f"F_{step.frame}", step.turn.down(force))
            moment = definitions.vector(f"M_{step.frame}", step.turn.down(moment))
            path.append(Wrench(force, moment))
        yield CarriedWrench(joint, tuple(reversed(path)))
        if j:
            shifted = definitions.vector(f"M_{k}j", add(moment, cross(joint.offset, force)))
            carried[j - 1] = Wrench(
                definitions.vector(f"F_{k}s", add(carried[j - 1].force, force)),
                definitions.vector(f"M_{k}s", add(carried[j - 1].moment, shifted)),
            )


def required_efforts(tree: Tree, needed: Requirement) -> list[Expr]:
    """Return the generalized forces that are required, less those of force elements, by freedom."""
    return _all_required_efforts(tree, needed)[: len(tree.system.freedoms)]


def _all_required_efforts(tree: Tree, needed: Requirement) -> list[Expr]:
    """Return required generalized forces at the freedoms, then at the prescribed freedoms."""
    along, acting = _along_freedoms(tree, needed), element_efforts(tree)
    for freedom, number in tree.system.moving_places.items():
        along[number] -= acting.get((freedom.body, freedom.index), S.Zero)
    return _at_speeds(tree, along)


def _along_freedoms(tree: Tree, needed: Requirement) -> dict[int, Expr]:
    """Return required generalized forces by number of the freedom, without those of force elements."""
    along: dict[int, Expr] = {}
    for carried in carried_wrenches(tree, needed.wrenches):
        joint = carried.joint
        along |= {one.number: carried.above.moment[one.axis] for one in joint.angular_speeds}
        for step, above in zip(joint.steps, carried.path[1:], strict=True):
            if step.moves:
                along[step.number] = above.moment[step.axis]
        for translation in joint.moving_translations:
            work = dot(translation.direction, carried.below.force)
            along[translation.number] = tree.definitions.define(f"f_{translation.number}", work)
    return {number: work + needed.efforts.get(number, S.Zero) for number, work in along.items()}


def at_free(tree: Tree, along: Mapping[int, Expr]) -> list[Expr]:
    """Return generalized forces in the order of {y}: those of coupled freedoms add to those they follow.

    Args:
        tree: The tree.
        along: Generalized force by number of the freedom, as in `FreedomMotion.number`.
    """
    return _at_speeds(tree, along)[: len(tree.system.freedoms)]


def _at_speeds(tree: Tree, along: Mapping[int, Expr]) -> list[Expr]:
    """Return the generalized forces of `at_free`, then those at the prescribed freedoms."""
    motions = {one.number: one for joint in tree.joints for one in joint.elements}
    n = len(tree.system.freedoms)
    sums: list[list[Expr]] = [[] for _ in range(n + len(tree.system.prescribed))]
    for number in tree.system.moving_places.values():
        one, effort = motions[number], along[number]
        if one.is_coupled:
            effort = tree.definitions.define(f"fn_{number}", effort)
        for i, share in one.shares.items():
            sums[i].append(share * effort)
        for i, share in one.prescribed_shares.items():
            sums[n + i].append(share * effort)
    return [Add(*parts) for parts in sums]
