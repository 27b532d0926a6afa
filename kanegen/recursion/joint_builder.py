"""Construction of `JointMotion` from the description of a joint in a system."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy
from sympy import Add, Expr, S

from kanegen.model.body import Body
from kanegen.model.coordinates import ANGLES, Freedom, Rotation
from kanegen.model.numbers import Matrix, Number, is_fixed
from kanegen.model.numbers import Vector as Angles
from kanegen.model.system import System
from kanegen.recursion.constants import constant_rotation, constant_sine_cosine, exact
from kanegen.recursion.joint_motion import NO_FREEDOM, AngularSpeed, JointMotion, Step, Translation, down
from kanegen.recursion.turns import (
    Turn,
    composed,
    constant_turns,
    is_identity,
    planar_turn,
    rotation_as_a_whole,
)
from kanegen.recursion.vectors import ZERO, add, dot, scale, subtract, unit
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.freedom_motion import FreedomMotions
from kanegen.symbolic.symbols import acceleration, coordinate, speed


def joint_motion(system: System, k: int, below: Vector, definitions: Definitions) -> JointMotion:
    """Return the motion of body `k` on its lower body, with sines and cosines defined.

    Args:
        system: The system.
        k: Number of the body.
        below: Attribute `origin` of the lower body's joint, zero for the ground (m).
        definitions: Definitions that the intermediates are added to.
    """
    body, number = system.bodies[k - 1], system.places
    definitions.about(f"Body {k} ({body.name}): the joint, Eqs. (4), (22)")
    constant = orientation_turns(body.joint.orientation, f"{k}_c", definitions)
    along = [definitions.vector(f"u_{k}_{i + 1}", down(constant, unit(i))) for i in range(3)]
    directions = along[0], along[1], along[2]
    arm = Vector(*(exact(value) for value in body.joint.position))
    moving: list[Translation] = []
    for axis in range(3):
        moves = body.joint.moving[3 + axis]
        if moves:
            motion = _motion(system, Freedom(k, 3 + axis), definitions)
            moving.append(Translation(direction=directions[axis], **motion))
        s = moving[-1].value if moves else exact(body.joint.locked[3 + axis])
        arm = add(arm, scale(s, directions[axis]))
    free = tuple(one for one in moving if one.shares)
    prescribed = tuple(one for one in moving if not one.shares)
    fixed = [Step(turn, f"{k}c{i + 1}") for i, turn in enumerate(constant)]
    about_axes = [index for index in body.joint.rotation.coordinates if index in ANGLES]
    angles = [_angle_step(system, Freedom(k, index), definitions) for index in about_axes]
    offset = subtract(arm, below)
    steps = _without_identities(fixed), _without_identities(angles)
    joint = JointMotion(
        k, body.lower, arm, directions, offset, ZERO, free, *steps, prescribed_translations=prescribed
    )
    if not body.joint.speeds_are_rates:
        kinds = body.joint.speed_kinds
        speeds = tuple(
            AngularSpeed(
                freedom=number[Freedom(k, i)],
                number=number[Freedom(k, i)],
                axis=i,
                rate=speed(k, kinds[i]),
                acceleration=acceleration(k, kinds[i]),
                shares={number[Freedom(k, i)]: S.One},
                armature=_armature(system, Freedom(k, i), definitions),
            )
            for i in ANGLES
        )
        joint = turning_as_a_whole(replace(joint, angular_speeds=speeds), body.joint.rotation, definitions)
    return _with_origin(joint, body, definitions)


def _motion(system: System, freedom: Freedom, definitions: Definitions) -> dict[str, Any]:
    """Return the attributes of the `FreedomMotion` of a freedom that moves, by name."""
    motions, places = FreedomMotions(system, exact), system.moving_places
    n, number = len(system.freedoms), places[freedom]
    shares = {places[one]: share for one, share in motions.shares(freedom).items()}
    moves = {symbol: symbol(freedom.body, freedom.index).name for symbol in (coordinate, speed, acceleration)}
    driven = (
        share * acceleration(one.body, one.index)
        for one, share in motions.shares(freedom).items()
        if places[one] >= n
    )
    return {
        "freedom": number if number < n else NO_FREEDOM,
        "number": number,
        "axis": freedom.axis,
        "value": definitions.define(moves[coordinate], motions.coordinate(freedom)),
        "rate": definitions.define(moves[speed], motions.speed(freedom)),
        "acceleration": definitions.define(moves[acceleration], motions.acceleration(freedom)),
        "prescribed_acceleration": definitions.define(f"{moves[acceleration]}p", Add(*driven)),
        "shares": {i: share for i, share in shares.items() if i < n},
        "prescribed_shares": {i - n: share for i, share in shares.items() if i >= n},
        "is_coupled": freedom in system.in_couplings,
        "armature": _armature(system, freedom, definitions),
    }


def _armature(system: System, freedom: Freedom, definitions: Definitions) -> Expr:
    """Return the reflected inertia of the motor of a freedom and of its rotors, J n^2 (kg m^2, kg)."""
    found = exact(system.bodies[freedom.body - 1].joint.armature[freedom.index])
    for one in system.mounted_rotors:
        if one.freedom == freedom:
            found += exact(one.rotor.inertia) * exact(one.rotor.ratio) ** 2
    return definitions.define(f"ar_{freedom.body}_{freedom.index + 1}", found)


def turning_as_a_whole(joint: JointMotion, rotation: Rotation, definitions: Definitions) -> JointMotion:
    """Return a joint with its rotation as one turn, for speeds that are no rates of angles.

    Unless the lower body is the ground, the turns of [C_K] are included: in `merged` if the joint translates,
    else in the turn itself.
    """
    k = joint.body
    parts = [step.turn for step in joint.angles] or [rotation_as_a_whole(k, rotation, definitions)]
    turned = Step(composed(f"R_{k}", parts, definitions), f"{k}a")
    joint = replace(joint, angles=(turned,), composed_of=joint.angles)
    if not joint.constant or not joint.lower:
        return joint
    merged = Step(composed(f"RC_{k}", [step.turn for step in joint.steps], definitions), f"{k}t")
    if joint.translations:
        return replace(joint, merged=(merged,))
    return replace(joint, constant=(), angles=(merged,))


def _with_origin(joint: JointMotion, body: Body, definitions: Definitions) -> JointMotion:
    """Return a joint with another point of K as its origin, so that constants vanish; [A], {f} do not change.

    For a body that only translates it is the mass centre, which leaves no first moment. For a hinge whose
    axis is a basis vector of J it is the point of the axis opposite the lower body's origin, which leaves an
    offset without a component along the axis.
    """
    origin, offset, hinge = ZERO, joint.offset, joint.hinge
    if joint.moving_translations and not joint.rotates:
        origin = Vector(*(exact(value) for value in body.mass_center))
        offset = add(offset, down(tuple(step.turn for step in joint.steps), origin))
    elif hinge:
        axis = unit(hinge.axis)
        direction = down(tuple(step.turn for step in joint.constant), axis)
        if all(component in (-1, 0, 1) for component in direction):
            along = -dot(direction, offset)
            origin, offset = scale(along, axis), add(offset, scale(along, direction))
    return replace(
        joint,
        origin=definitions.vector(f"o_{joint.body}", origin),
        offset=definitions.vector(f"d_{joint.body}", offset),
        arm=definitions.vector(f"q_{joint.body}", joint.arm),
    )


def _without_identities(steps: list[Step]) -> tuple[Step, ...]:
    """Return the steps without constant turns that are the identity."""
    return tuple(step for step in steps if step.moves or not is_identity(step.turn))


def orientation_turns(orientation: Matrix | Angles, name: str, definitions: Definitions) -> tuple[Turn, ...]:
    """Return the turns of a constant orientation, such as [C_K] of a joint.

    Args:
        orientation: A rotation matrix, or three 1-2-3 angles (rad).
        name: Prefix of the names of the angles, such as `2_c`.
        definitions: Definitions that sines and cosines of parameters are added to.
    """
    if isinstance(orientation[0], tuple):
        rows = [[exact(entry) for entry in row] for row in orientation]
        return constant_turns(constant_rotation(rows, definitions.constants))
    turns = [_constant_turn(f"{name}{i + 1}", i, angle, definitions) for i, angle in enumerate(orientation)]
    return tuple(turns)


def _angle_step(system: System, freedom: Freedom, definitions: Definitions) -> Step:
    """Return the turn of an angle, moving or locked."""
    k, index = freedom.body, freedom.index
    joint = system.bodies[k - 1].joint
    frame, axis = f"{k}a{index + 1}", joint.axes[index]
    if not joint.moving[index]:
        locked = joint.locked[index]
        return Step(_constant_turn(f"{k}_{index + 1}", axis, locked, definitions), frame, angle=index)
    motion = _motion(system, freedom, definitions)
    angle = motion["value"]
    sine = definitions.define(f"S_{k}_{index + 1}", sympy.sin(angle))
    cosine = definitions.define(f"C_{k}_{index + 1}", sympy.cos(angle))
    turn = planar_turn(axis, sine, cosine, angle)
    return Step(turn, frame, sine=sine, cosine=cosine, angle=index, **motion | {"axis": axis})


def _constant_turn(name: str, axis: int, angle: Number, definitions: Definitions) -> Turn:
    """Return the turn by a constant angle or one that depends on parameters (rad)."""
    if not is_fixed(angle):
        symbol = exact(angle)
        sine = definitions.define(f"S_{name}", sympy.sin(symbol))
        return planar_turn(axis, sine, definitions.define(f"C_{name}", sympy.cos(symbol)))
    sine, cosine = constant_sine_cosine(angle, definitions.constants)
    return planar_turn(axis, sine, cosine)
