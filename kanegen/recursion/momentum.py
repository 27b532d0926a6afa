"""Kinetic energy and momentum, from the velocities of the bodies.

Both stay what they are when inertias are regrouped (see `tree`): what passes to the lower body moves with it.
"""

from __future__ import annotations

from sympy import Expr, S

from kanegen.recursion.bodies import Inertia
from kanegen.recursion.derived import Derived
from kanegen.recursion.first_moment import first_moments, total_mass
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, column, cross, dot, multiply, scale, subtract
from kanegen.recursion.velocities import angular_velocities, relative_velocity, sliding_velocity, velocities
from kanegen.symbolic.definitions import AXES, Definitions, Vector


def kinetic_energy(tree: Tree) -> Derived:
    """The sum of the kinetic energies of the bodies."""
    total: Expr = S.Zero
    omega = angular_velocities(tree)
    velocity = velocities(tree, omega)
    for k, inertia in enumerate(tree.inertias, start=1):
        tree.about(k, "kinetic energy")
        energy = _energy(inertia, omega[k], velocity[k], tree.definitions, k)
        total = tree.definitions.define(f"KE_{k}s", total + energy)
    return Derived([total])


def _energy(inertia: Inertia, omega: Vector, v: Vector, definitions: Definitions, k: int) -> Expr:
    """omega . ([I] omega / 2 + h x v) + m v . v / 2, with [I] / 2 as its upper half, the diagonal halved."""
    i = inertia.inertia
    xx, yy, zz = (definitions.define(f"I_{k}_h{axis}", d / 2) for axis, d in zip(AXES, i[:3], strict=True))
    upper = (Vector(xx, i.xy, i.xz), Vector(S.Zero, yy, i.yz), Vector(S.Zero, S.Zero, zz))
    coupled = definitions.vector(f"hv_{k}", cross(inertia.moment, v))
    spin = definitions.vector(f"L_{k}h", add(multiply(upper, omega), coupled))
    square = definitions.define(f"vv_{k}", dot(v, v))
    half = definitions.define(f"m_{k}h", inertia.mass / 2)
    return definitions.define(f"KE_{k}", dot(omega, spin) + half * square)


def momentum(tree: Tree) -> Derived:
    """Linear momentum, and angular momentum about the mass centre of all bodies, inertial components.

    What a body carries has momenta about its origin and as seen from there: only rotations count. On the way
    inward, what one origin moves past the next is added. Home is the origin of the first body, so that the
    angular momentum loses no digits where a floating tree is far away or fast.
    """
    definitions, omega = tree.definitions, angular_velocities(tree)
    home, drift = tree.motions[0].offset, sliding_velocity(tree, tree.motions[0])
    carried, ground = first_moments(tree, home), tree.ground
    standing = definitions.vector("hc_0g", subtract(ground.moment, scale(ground.mass, home)))
    linear = [scale(-ground.mass, drift)]
    angular = [cross(drift, standing)]
    for k, inertia in enumerate(tree.inertias, start=1):
        rows = [column(inertia.inertia, axis) for axis in range(3)]
        linear.append(cross(omega[k], inertia.moment))
        angular.append(multiply(rows, omega[k]))
    for motion in reversed(tree.motions):
        k, j = motion.body, motion.lower
        passing, arm = relative_velocity(tree, motion, omega[j]), motion.offset
        if not j:
            passing, arm = subtract(passing, drift), subtract(arm, home)
        tree.about(k, "momentum, linear and angular")
        p, spin = definitions.vector(f"P_{k}", linear[k]), definitions.vector(f"L_{k}", angular[k])
        for step in reversed(motion.steps):
            p = definitions.vector(f"P_{step.frame}", step.turn.down(p))
            spin = definitions.vector(f"L_{step.frame}", step.turn.down(spin))
        p = definitions.vector(f"P_{k}j", add(p, scale(carried.masses[k], passing)))
        spin = add(spin, add(cross(carried.moments[k], passing), cross(arm, p)))
        linear[j] = add(linear[j], p)
        angular[j] = add(angular[j], definitions.vector(f"L_{k}j", spin))
    mass = total_mass(tree)
    center = scale(1 / mass, carried.moments[0]) if mass != 0 else ZERO
    center = definitions.vector("c_0h", center)
    p = definitions.vector("P_0", linear[0])
    return Derived([*add(p, scale(mass, drift)), *subtract(angular[0], cross(center, p))])
