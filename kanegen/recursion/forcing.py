"""{f} by an outward recursion of motions and an inward recursion of forces: Eq. (44) regrouped.

Outward: the angular velocity, and the accelerations that remain where {ydot} = 0, gravity counted as an
upward acceleration of the ground. Inward: the force and moment about each origin that these motions need,
less the loads; what they do on a freedom is minus its entry of {f} (Luh, Walker and Paul 1980; Featherstone
2008, section 5.3).
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr

from kanegen.recursion.bodies import Inertia, body_inertia
from kanegen.recursion.joints import NO_FREEDOM, JointMotion, exact
from kanegen.recursion.vectors import ZERO, add, cross, dot, multiply, negate, scale, subtract, unit
from kanegen.symbolic.definitions import AXES, Definitions, Vector
from kanegen.symbolic.symbols import force as force_symbol
from kanegen.symbolic.symbols import torque as torque_symbol
from kanegen.system import System

Rows = tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class Motion:
    """Motion of a body with {ydot} = 0, in its frame.

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


def forcing(system: System, motions: tuple[JointMotion, ...], definitions: Definitions) -> list[Expr]:
    """The entries of {f}."""
    moved = _outward(system, motions, definitions)
    count = system.number_of_bodies
    forces = [ZERO] * count
    moments = [ZERO] * count
    result: dict[int, Expr] = {}
    for motion in reversed(motions):
        k, j = motion.body, motion.lower
        inertia = body_inertia(system, k, definitions)
        definitions.about(f"Body {k} ({system.bodies[k - 1].name}): force and moment about O_{k}, Eq. (44)")
        own_force, own_moment = _required(system, inertia, moved[k], k, definitions)
        force = definitions.vector(f"F_{k}", add(own_force, forces[k - 1]))
        moment = definitions.vector(f"M_{k}", add(own_moment, moments[k - 1]))
        for step in reversed(motion.steps):
            if step.freedom != NO_FREEDOM:
                result[step.freedom] = -moment[step.axis]
            force = definitions.vector(f"F_{step.frame}", step.turn.down(force))
            moment = definitions.vector(f"M_{step.frame}", step.turn.down(moment))
        for slide in motion.slides:
            result[slide.freedom] = -definitions.define(f"f_{slide.freedom}", dot(slide.direction, force))
        if j:
            shifted = definitions.vector(f"M_{k}j", add(moment, cross(motion.offset, force)))
            forces[j - 1] = definitions.vector(f"F_{k}s", add(forces[j - 1], force))
            moments[j - 1] = definitions.vector(f"M_{k}s", add(moments[j - 1], shifted))
    return [result[i] for i in range(len(system.freedoms))]


def _outward(system: System, motions: tuple[JointMotion, ...], definitions: Definitions) -> dict[int, Motion]:
    gravity = Vector(*(exact(value) for value in system.gravity))
    still = {(i, j): exact(0.0) for i in range(3) for j in range(3)}
    moved = {0: Motion(ZERO, ZERO, negate(gravity), still, (ZERO, ZERO, ZERO))}
    for motion in motions:
        moved[motion.body] = _move(
            moved[motion.lower], motion, system.bodies[motion.body - 1].name, definitions
        )
    return moved


def _move(lower: Motion, motion: JointMotion, name: str, definitions: Definitions) -> Motion:
    """From body J to body K: Eqs. (11), (20), (33) with {ydot} = 0, one turn at a time."""
    k = motion.body
    definitions.about(f"Body {k} ({name}): angular velocity and acceleration, Eqs. (11), (20)")
    omega, alpha = lower.omega, lower.alpha
    sliding = ZERO
    for slide in motion.slides:
        sliding = add(sliding, scale(slide.rate, slide.direction))
    twice = definitions.vector(f"w_{motion.lower}", scale(exact(2.0), omega))
    carried = add(lower.acceleration, multiply(lower.field, motion.offset))
    sliding = definitions.vector(f"v_{k}", sliding)
    acceleration = definitions.vector(f"a_{k}j", add(carried, cross(twice, sliding)))
    last = motion.steps[-1] if motion.steps else None
    for step in motion.steps:
        above = f"{k}" if step is last else f"{step.frame}u"
        turned = step.turn.up(omega)
        rate = scale(step.rate, unit(step.axis))
        alpha = definitions.vector(f"alpha_{above}", add(step.turn.up(alpha), cross(turned, rate)))
        omega = definitions.vector(f"omega_{above}", add(turned, rate))
        acceleration = definitions.vector(f"a_{above}", step.turn.up(acceleration))
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


def _required(
    system: System, inertia: Inertia, motion: Motion, k: int, definitions: Definitions
) -> tuple[Vector, Vector]:
    """Force and moment about O_K that the motion of body K needs, less its loads."""
    body = system.bodies[k - 1]
    m, h = inertia.mass, inertia.moment
    force = add(scale(m, motion.acceleration), multiply(motion.field, h))
    moment = add(_rotational(inertia, motion, definitions, k), cross(h, motion.acceleration))
    if body.loads:
        load = Vector(*(force_symbol(k, axis) for axis in range(3)))
        torque = Vector(*(torque_symbol(k, axis) for axis in range(3)))
        arm = Vector(*(exact(value) for value in body.mass_center))
        force = subtract(force, load)
        moment = subtract(subtract(moment, torque), cross(arm, load))
    return definitions.vector(f"F_{k}own", force), definitions.vector(f"M_{k}own", moment)


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
