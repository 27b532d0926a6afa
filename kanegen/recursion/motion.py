"""Motions of the bodies, outward, and the forces that each needs for itself.

The motion of a body is its angular velocity and the accelerations that belong to given accelerations of the
coordinates; gravity counts as an upward acceleration of the ground. With {ydot} = 0 this is what remains of
Eqs. (20) and (33).
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr

from kanegen.recursion.bodies import Inertia
from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion
from kanegen.recursion.joints import exact
from kanegen.recursion.loads import UNLOADED, Applied, applied
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, add, cross, multiply, negate, scale, subtract, unit
from kanegen.symbolic.definitions import AXES, Definitions, Vector
from kanegen.symbolic.symbols import force as force_symbol
from kanegen.symbolic.symbols import torque as torque_symbol

Rows = tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class Requirement:
    """The force and the moment about its origin that a body needs, in its frame (N, N m)."""

    force: Vector = ZERO
    moment: Vector = ZERO

    def plus(self, other: Requirement, name: str, definitions: Definitions) -> Requirement:
        """Both together."""
        both = Requirement(add(self.force, other.force), add(self.moment, other.moment))
        return both.named(name, definitions)

    def named(self, name: str, definitions: Definitions) -> Requirement:
        """With a symbol for every component."""
        force = definitions.vector(f"pF_{name}", self.force)
        return Requirement(force, definitions.vector(f"pN_{name}", self.moment))


@dataclass(frozen=True)
class Motion:
    """Motion of a body, in its frame.

    Attributes:
        omega: Angular velocity {omega'_K} (rad/s).
        alpha: Angular acceleration (rad/s^2).
        acceleration: Of the origin O_K, less gravity (m/s^2).
        squares: Products omega_i omega_j by pair of axes.
        field: [alpha~] + [omega~][omega~], which times a body-fixed vector gives its acceleration.
    """

    omega: Vector
    alpha: Vector
    acceleration: Vector
    squares: dict[tuple[int, int], Expr]
    field: Rows


def outward(tree: Tree, *, accelerated: bool, weightless: bool = False) -> dict[int, Motion]:
    """The motions of the ground, 0, and of every body.

    Args:
        tree: The tree.
        accelerated: With {ydot} as its symbols say, else with {ydot} = 0. What is prescribed accelerates.
        weightless: Whether to leave gravity out of the accelerations.
    """
    gravity = ZERO if weightless else Vector(*(exact(value) for value in tree.system.gravity))
    still = {(i, j): exact(0.0) for i in range(3) for j in range(3)}
    moved = {0: Motion(ZERO, ZERO, negate(gravity), still, (ZERO, ZERO, ZERO))}
    for motion in tree.motions:
        tree.about(motion.body, "angular velocity and acceleration, Eqs. (11), (20)")
        moved[motion.body] = _move(moved[motion.lower], motion, tree.definitions, accelerated)
    return moved


def _move(lower: Motion, motion: JointMotion, definitions: Definitions, accelerated: bool) -> Motion:
    """From body J to body K: Eqs. (11), (20), (33), one turn at a time."""
    k = motion.body
    omega, alpha = lower.omega, lower.alpha
    sliding = ZERO
    carried = add(lower.acceleration, multiply(lower.field, motion.offset))
    for slide in motion.sliding:
        sliding = add(sliding, scale(slide.rate, slide.direction))
        if accelerated or slide.freedom == NO_FREEDOM:
            carried = add(carried, scale(slide.acceleration, slide.direction))
    twice = definitions.vector(f"w_{motion.lower}", scale(exact(2.0), omega))
    sliding = definitions.vector(f"v_{k}", sliding)
    acceleration = definitions.vector(f"a_{k}j", add(carried, cross(twice, sliding)))
    for step in motion.steps:
        above = motion.above(step)
        turned = step.turn.up(omega)
        rate = scale(step.rate, unit(step.axis))
        alpha = add(step.turn.up(alpha), cross(turned, rate))
        if accelerated or step.freedom == NO_FREEDOM:
            alpha = add(alpha, scale(step.acceleration, unit(step.axis)))
        alpha = definitions.vector(f"alpha_{above}", alpha)
        omega = definitions.vector(f"omega_{above}", add(turned, rate))
        acceleration = definitions.vector(f"a_{above}", step.turn.up(acceleration))
    if motion.spins:
        alpha = add(alpha, cross(omega, motion.spinning))
        if accelerated:
            alpha = add(alpha, motion.spinning_up)
        alpha = definitions.vector(f"alpha_{k}", alpha)
        omega = definitions.vector(f"omega_{k}", add(omega, motion.spinning))
    return _with_field(k, omega, alpha, acceleration, definitions)


def _with_field(
    k: int, omega: Vector, alpha: Vector, acceleration: Vector, definitions: Definitions
) -> Motion:
    squares: dict[tuple[int, int], Expr] = {}
    for i in range(3):
        for j in range(i, 3):
            name = f"ww_{k}_{AXES[i]}{AXES[j]}"
            squares[i, j] = squares[j, i] = definitions.define(name, omega[i] * omega[j])
    w = squares
    field = (
        Vector(-(w[1, 1] + w[2, 2]), w[0, 1] - alpha.z, w[0, 2] + alpha.y),
        Vector(w[0, 1] + alpha.z, -(w[0, 0] + w[2, 2]), w[1, 2] - alpha.x),
        Vector(w[0, 2] - alpha.y, w[1, 2] + alpha.x, -(w[0, 0] + w[1, 1])),
    )
    named = tuple(definitions.vector(f"W_{k}_{axis}", row) for axis, row in zip(AXES, field, strict=True))
    return Motion(omega, alpha, acceleration, squares, (named[0], named[1], named[2]))


def requirements(tree: Tree, *, accelerated: bool) -> list[Requirement]:
    """What each body needs for its motion, less its loads.

    Args:
        tree: The tree.
        accelerated: With {ydot} as its symbols say, else with {ydot} = 0.
    """
    moved, loads = outward(tree, accelerated=accelerated), applied(tree)
    return [
        _required(tree, motion.body, moved[motion.body], loads.get(motion.body, UNLOADED))
        for motion in tree.motions
    ]


def _required(tree: Tree, k: int, motion: Motion, applied: Applied) -> Requirement:
    """What the motion of body `k` needs, less its loads: its terms of Eqs. (38) and (44)."""
    body, inertia, definitions = tree.system.bodies[k - 1], tree.inertias[k - 1], tree.definitions
    tree.about(k, "force and moment about its origin, Eq. (44)")
    m, h = inertia.mass, inertia.moment
    force = add(scale(m, motion.acceleration), multiply(motion.field, h))
    moment = add(_rotational(inertia, motion, definitions, k), cross(h, motion.acceleration))
    if body.loads:
        load = Vector(*(force_symbol(k, axis) for axis in range(3)))
        torque = Vector(*(torque_symbol(k, axis) for axis in range(3)))
        center = Vector(*(exact(value) for value in body.mass_center))
        arm = definitions.vector(f"r_{k}", subtract(center, tree.motions[k - 1].origin))
        force = subtract(force, load)
        moment = subtract(subtract(moment, torque), cross(arm, load))
    named = definitions.vector(f"F_{k}own", subtract(force, applied.force))
    return Requirement(named, definitions.vector(f"M_{k}own", subtract(moment, applied.moment)))


def _rotational(inertia: Inertia, motion: Motion, definitions: Definitions, k: int) -> Vector:
    """[I] {alpha} + [omega~] [I] {omega}, from the products of speeds that `field` holds already."""
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
