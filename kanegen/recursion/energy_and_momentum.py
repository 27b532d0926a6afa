"""Outputs that are sums over all bodies: energies, momentum, and the common mass centre.

Kinetic energy and momentum come from the velocities of the bodies, mass centre and energy of gravity from
first moments of mass, which are added up inward. Regrouped inertias (see `tree`) give the same sums, because
the part that passes to the lower body moves with that body.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Add, Expr, S

from kanegen.recursion.constants import exact
from kanegen.recursion.force_elements import stored_energy
from kanegen.recursion.inertia import Inertia
from kanegen.recursion.kinematics import (
    angular_velocities,
    relative_velocity,
    translation_velocity,
    velocities,
)
from kanegen.recursion.rotors import spinning_rotors
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import ZERO, add, column, cross, dot, multiply, scale, subtract
from kanegen.symbolic.definitions import AXES, Definitions, Vector


@dataclass(frozen=True)
class FirstMoments:
    """Masses and first moments of the composite bodies; inertias are regrouped as in `Tree`.

    Attributes:
        masses: Mass by body, 0 being the ground (kg).
        moments: First moment by body about its origin, in the frame of its lower body (kg m); entry 0, of the
            whole system, is about a chosen point.
    """

    masses: list[Expr]
    moments: list[Vector]


def first_moments(tree: Tree, about: Vector = ZERO) -> FirstMoments:
    """Return the first moments, with the names of composite bodies in [A], so that both outputs share them.

    Args:
        tree: The tree.
        about: The chosen point, from the inertial origin, inertial components (m).
    """
    definitions, every = tree.definitions, (tree.ground, *tree.inertias)
    masses, moments = [own.mass for own in every], [own.moment for own in every]
    moments[0] = definitions.vector("hc_0g", subtract(moments[0], scale(masses[0], about)))
    for joint in reversed(tree.joints):
        k, j = joint.body, joint.lower
        tree.about(k, "first moment of all that it carries")
        for step in reversed(joint.steps):
            moments[k] = definitions.vector(f"hc_{step.frame}", step.turn.down(moments[k]))
        arm = joint.offset if j else subtract(joint.offset, about)
        shifted = definitions.vector(f"hc_{k}j", add(moments[k], scale(masses[k], arm)))
        masses[j] = definitions.define(f"mc_{j}", masses[j] + masses[k])
        moments[j] = definitions.vector(f"hc_{j}", add(moments[j], shifted))
    return FirstMoments(masses, moments)


def total_mass(tree: Tree) -> Expr:
    """Return the mass of all bodies (kg)."""
    tree.definitions.about("Mass of all bodies")
    return tree.definitions.define("mass", Add(*(exact(body.mass) for body in tree.system.bodies)))


def mass_center(tree: Tree) -> Derived:
    """Derive the position of the mass centre of all bodies, which have mass, inertial components."""
    mass = total_mass(tree)
    return Derived(tree.definitions.vector("c_0", scale(1 / mass, first_moments(tree).moments[0])))


def potential_energy(tree: Tree) -> Derived:
    """Derive the potential energy: minus the sum of m g . p_G, plus the energy that force elements store."""
    gravity = Vector(*(exact(value) for value in tree.system.gravity))
    return Derived([stored_energy(tree) - dot(gravity, first_moments(tree).moments[0])])


def kinetic_energy(tree: Tree) -> Derived:
    """Derive the sum of the kinetic energies of the bodies and of the motors.

    The armature a of a freedom has the energy a y^2 / 2, and a rotor with the angular momentum {h} y, beside
    its reflected inertia, {h}^T {omega_C} y in its carrier C.
    """
    total: Expr = S.Zero
    omega = angular_velocities(tree)
    velocity = velocities(tree, omega)
    for k, inertia in enumerate(tree.inertias, start=1):
        tree.about(k, "kinetic energy")
        energy = _kinetic_energy(inertia, omega[k], velocity[k], tree.definitions, k)
        total = tree.definitions.define(f"KE_{k}s", total + energy)
    define = tree.definitions.define
    for joint in tree.joints:
        tree.about(joint.body, "kinetic energy of its motors")
        for one in joint.elements:
            if one.armature != 0:
                half, square = (
                    define(f"mm_{one.number}", one.armature / 2),
                    define(f"ym_{one.number}", one.rate**2),
                )
                total = define(f"KM_{one.number}", total + half * square)
    for rotor in spinning_rotors(tree):
        coupled = dot(rotor.momentum, omega[rotor.carrier]) * rotor.motion.rate
        total = define(f"KM_{rotor.motion.number}", total + coupled)
    return Derived([total])


def _kinetic_energy(inertia: Inertia, omega: Vector, v: Vector, definitions: Definitions, k: int) -> Expr:
    """Return omega . ([I] omega / 2 + h x v) + m v . v / 2, by the upper half of [I], its diagonal halved."""
    i = inertia.inertia
    xx, yy, zz = (definitions.define(f"I_{k}_h{axis}", d / 2) for axis, d in zip(AXES, i[:3], strict=True))
    upper = (Vector(xx, i.xy, i.xz), Vector(S.Zero, yy, i.yz), Vector(S.Zero, S.Zero, zz))
    coupled = definitions.vector(f"hv_{k}", cross(inertia.moment, v))
    angular = definitions.vector(f"L_{k}h", add(multiply(upper, omega), coupled))
    square = definitions.define(f"vv_{k}", dot(v, v))
    half = definitions.define(f"m_{k}h", inertia.mass / 2)
    return definitions.define(f"KE_{k}", dot(omega, angular) + half * square)


def momentum(tree: Tree) -> Derived:
    """Derive linear momentum, and angular momentum about the mass centre of all bodies, inertial components.

    The spin of rotors counts. Armature has no momentum in space, because it is at no place.

    The momenta of a composite body are first taken relative to its origin, where only rotations count; each
    step inward adds the velocity of one origin relative to the next. The last one is the origin of body 1, so
    that the angular momentum loses no digits where a floating tree is far away or fast.
    """
    definitions, omega = tree.definitions, angular_velocities(tree)
    first, drift = tree.joints[0].offset, translation_velocity(tree, tree.joints[0])
    carried, ground = first_moments(tree, first), tree.ground
    standing = definitions.vector("hc_0g", subtract(ground.moment, scale(ground.mass, first)))
    linear = [scale(-ground.mass, drift)]
    angular = [cross(drift, standing)]
    for k, inertia in enumerate(tree.inertias, start=1):
        rows = [column(inertia.inertia, axis) for axis in range(3)]
        linear.append(cross(omega[k], inertia.moment))
        angular.append(multiply(rows, omega[k]))
    for rotor in spinning_rotors(tree):
        angular[rotor.carrier] = add(angular[rotor.carrier], scale(rotor.motion.rate, rotor.momentum))
    for joint in reversed(tree.joints):
        k, j = joint.body, joint.lower
        passing, arm = relative_velocity(tree, joint, omega[j]), joint.offset
        if not j:
            passing, arm = subtract(passing, drift), subtract(arm, first)
        tree.about(k, "momentum, linear and angular")
        p, about = definitions.vector(f"P_{k}", linear[k]), definitions.vector(f"L_{k}", angular[k])
        for step in reversed(joint.steps):
            p = definitions.vector(f"P_{step.frame}", step.turn.down(p))
            about = definitions.vector(f"L_{step.frame}", step.turn.down(about))
        p = definitions.vector(f"P_{k}j", add(p, scale(carried.masses[k], passing)))
        about = add(about, add(cross(carried.moments[k], passing), cross(arm, p)))
        linear[j] = add(linear[j], p)
        angular[j] = add(angular[j], definitions.vector(f"L_{k}j", about))
    mass = total_mass(tree)
    center = scale(1 / mass, carried.moments[0]) if mass != 0 else ZERO
    center = definitions.vector("c_0h", center)
    p = definitions.vector("P_0", linear[0])
    return Derived([*add(p, scale(mass, drift)), *subtract(angular[0], cross(center, p))])
