"""What needs no more than first moments of mass, collected inward: mass centre and energy of gravity."""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Add, Expr

from kanegen.errors import ModelError
from kanegen.recursion.derived import Derived
from kanegen.recursion.joints import exact
from kanegen.recursion.loads import stored_energy
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, dot, scale, subtract
from kanegen.symbolic.definitions import Vector


@dataclass(frozen=True)
class Moments:
    """Masses and first moments of bodies with all that they carry; inertias are regrouped as in `Tree`.

    Attributes:
        masses: By body, 0 being the ground (kg).
        moments: By body about its origin, in the frame of its lower body; of the ground about a chosen point
            (kg m).
    """

    masses: list[Expr]
    moments: list[Vector]


def first_moments(tree: Tree, about: Vector = ZERO) -> Moments:
    """First moments, through the composite bodies of [A], so that the two outputs share them.

    Args:
        tree: The tree.
        about: The chosen point, from the inertial origin, inertial components (m).
    """
    definitions, every = tree.definitions, (tree.ground, *tree.inertias)
    masses, moments = [own.mass for own in every], [own.moment for own in every]
    moments[0] = definitions.vector("hc_0g", subtract(moments[0], scale(masses[0], about)))
    for motion in reversed(tree.motions):
        k, j = motion.body, motion.lower
        tree.about(k, "first moment of all that it carries")
        for step in reversed(motion.steps):
            moments[k] = definitions.vector(f"hc_{step.frame}", step.turn.down(moments[k]))
        arm = motion.offset if j else subtract(motion.offset, about)
        shifted = definitions.vector(f"hc_{k}j", add(moments[k], scale(masses[k], arm)))
        masses[j] = definitions.define(f"mc_{j}", masses[j] + masses[k])
        moments[j] = definitions.vector(f"hc_{j}", add(moments[j], shifted))
    return Moments(masses, moments)


def total_mass(tree: Tree) -> Expr:
    """Mass of all bodies (kg)."""
    tree.definitions.about("Mass of all bodies")
    return tree.definitions.define("mass", Add(*(exact(body.mass) for body in tree.system.bodies)))


def mass_center(tree: Tree) -> Derived:
    """Position of the mass centre of all bodies, inertial components.

    Raises:
        ModelError: If there is no mass.
    """
    mass = total_mass(tree)
    if mass == 0:
        raise ModelError(f"system {tree.system.name!r}: no body has mass, so there is no mass centre.")
    return Derived(tree.definitions.vector("c_0", scale(1 / mass, first_moments(tree).moments[0])))


def potential_energy(tree: Tree) -> Derived:
    """Minus the work of gravity from the inertial origin, m g . p_G, and what force elements store."""
    gravity = Vector(*(exact(value) for value in tree.system.gravity))
    return Derived([stored_energy(tree) - dot(gravity, first_moments(tree).moments[0])])
