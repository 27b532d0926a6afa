"""Joints as the recursions see them, from the bodies of a system."""

from __future__ import annotations

from dataclasses import replace

import sympy
from sympy import Expr

from kanegen.model.body import Body
from kanegen.model.coordinates import ANGLES, Freedom, Rotation
from kanegen.model.numbers import Number, Parameter
from kanegen.model.system import System
from kanegen.recursion.constants import constant_rotation, constant_sine_cosine
from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion, Slide, Spin, Step, down
from kanegen.recursion.orientations import constant_turns, planar, rotated_as_a_whole, whole
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, add, dot, scale, subtract, unit
from kanegen.symbolic.definitions import Definitions, Vector
from kanegen.symbolic.symbols import acceleration, coordinate, speed


def exact(value: Number) -> Expr:
    """A parameter's symbol, or the rational number that a float is, so that folding rounds only once."""
    return sympy.Symbol(value.name, real=True) if isinstance(value, Parameter) else sympy.Rational(value)


def joint_motion(system: System, k: int, below: Vector, definitions: Definitions) -> JointMotion:
    """The motion of body `k` on its lower body, sines and cosines defined.

    Args:
        system: The tree.
        k: Number of the body.
        below: `origin` of the lower body, zero for the ground.
        definitions: Take the intermediates.
    """
    body, number = system.bodies[k - 1], system.places
    definitions.about(f"Body {k} ({body.name}): the joint, Eqs. (4), (22)")
    constant = _orientation(body, k, definitions)
    along = [definitions.vector(f"u_{k}_{i + 1}", down(constant, unit(i))) for i in range(3)]
    directions = along[0], along[1], along[2]
    arm = Vector(*(exact(value) for value in body.joint.position))
    for axis in range(3):
        moves = body.joint.moving[3 + axis]
        s = coordinate(k, 3 + axis) if moves else exact(body.joint.locked[3 + axis])
        arm = add(arm, scale(s, directions[axis]))
    sliding = [_slide(system, Freedom(k, 3 + i), directions[i]) for i in range(3) if body.joint.moving[3 + i]]
    slides = tuple(slide for slide in sliding if slide.freedom != NO_FREEDOM)
    drives = tuple(slide for slide in sliding if slide.freedom == NO_FREEDOM)
    fixed = [Step(turn, f"{k}c{i + 1}") for i, turn in enumerate(constant)]
    about_axes = [index for index in body.joint.rotation.coordinates if index in ANGLES]
    angles = [_angle_step(system, Freedom(k, index), definitions) for index in about_axes]
    offset = subtract(arm, below)
    turning = _changing(fixed), _changing(angles)
    motion = JointMotion(k, body.lower, arm, directions, offset, ZERO, slides, *turning, drives=drives)
    if not body.joint.speeds_are_rates:
        kinds = body.joint.speed_kinds
        spins = [
            Spin(number[Freedom(k, i)], i, speed(k, kinds[i]), acceleration(k, kinds[i])) for i in ANGLES
        ]
        motion = _spinning(replace(motion, spins=tuple(spins)), body.joint.rotation, definitions)
    return _with_origin(motion, body, definitions)


def _slide(system: System, freedom: Freedom, direction: Vector) -> Slide:
    place, number = _numbers(system, freedom)
    k, index = freedom.body, freedom.index
    return Slide(place, freedom.axis, direction, speed(k, index), acceleration(k, index), number)


def _numbers(system: System, freedom: Freedom) -> tuple[int, int]:
    """`freedom` and `number` of a `Step` or a `Slide`."""
    place = system.places.get(freedom, NO_FREEDOM)
    return place, len(system.places) + system.prescribed.index(freedom) if place == NO_FREEDOM else place


def _spinning(motion: JointMotion, rotation: Rotation, definitions: Definitions) -> JointMotion:
    """A joint whose angles have no rates of their own turns as a whole, with [C_K] if a body is below."""
    k = motion.body
    parts = [step.turn for step in motion.angles] or [rotated_as_a_whole(k, rotation, definitions)]
    turned = Step(whole(f"R_{k}", parts, definitions), f"{k}a")
    motion = replace(motion, angles=(turned,), behind=motion.angles)
    if not motion.constant or not motion.lower:
        return motion
    through = Step(whole(f"RC_{k}", [step.turn for step in motion.steps], definitions), f"{k}t")
    if motion.slides:
        return replace(motion, through=(through,))
    return replace(motion, constant=(), angles=(through,))


def _with_origin(motion: JointMotion, body: Body, definitions: Definitions) -> JointMotion:
    """Choose the point of K that serves as its origin so that constants vanish; [A] and {f} do not change.

    A body that only slides takes its mass centre, so that it has no first moment. A hinge takes the point of
    its axis opposite the lower body's origin, where the axis is a basis vector of J and the offset thus loses
    a component.
    """
    origin, offset, hinge = ZERO, motion.offset, motion.hinge
    if motion.sliding and not motion.turns:
        origin = Vector(*(exact(value) for value in body.mass_center))
        offset = add(offset, down(tuple(step.turn for step in motion.steps), origin))
    elif hinge:
        axis = unit(hinge.axis)
        direction = down(tuple(step.turn for step in motion.constant), axis)
        if all(component in (-1, 0, 1) for component in direction):
            along = -dot(direction, offset)
            origin, offset = scale(along, axis), add(offset, scale(along, direction))
    return replace(
        motion,
        origin=definitions.vector(f"o_{motion.body}", origin),
        offset=definitions.vector(f"d_{motion.body}", offset),
        arm=definitions.vector(f"q_{motion.body}", motion.arm),
    )


def _changing(steps: list[Step]) -> tuple[Step, ...]:
    """Those that change anything."""
    return tuple(step for step in steps if step.moves or not _is_identity(step.turn))


def _orientation(body: Body, k: int, definitions: Definitions) -> tuple[Turn, ...]:
    orientation = body.joint.orientation
    if not isinstance(orientation[0], tuple):
        return tuple(
            _locked_turn(f"{k}_c{i + 1}", i, angle, definitions) for i, angle in enumerate(orientation)
        )
    rows = [[exact(entry) for entry in row] for row in orientation]
    return constant_turns(constant_rotation(rows, definitions.constants))


def _angle_step(system: System, freedom: Freedom, definitions: Definitions) -> Step:
    k, index = freedom.body, freedom.index
    joint = system.bodies[k - 1].joint
    frame, axis = f"{k}a{index + 1}", joint.axes[index]
    if not joint.moving[index]:
        locked = joint.locked[index]
        return Step(_locked_turn(f"{k}_{index + 1}", axis, locked, definitions), frame, angle=index)
    angle = coordinate(k, index)
    sine = definitions.define(f"S_{k}_{index + 1}", sympy.sin(angle))
    cosine = definitions.define(f"C_{k}_{index + 1}", sympy.cos(angle))
    place, number = _numbers(system, freedom)
    turn, rates = planar(axis, sine, cosine), (speed(k, index), acceleration(k, index))
    return Step(turn, frame, place, axis, *rates, sine, cosine, index, number)


def _locked_turn(name: str, axis: int, angle: Number, definitions: Definitions) -> Turn:
    if isinstance(angle, Parameter):
        symbol = exact(angle)
        sine = definitions.define(f"S_{name}", sympy.sin(symbol))
        return planar(axis, sine, definitions.define(f"C_{name}", sympy.cos(symbol)))
    sine, cosine = constant_sine_cosine(angle, definitions.constants)
    return planar(axis, sine, cosine)


def _is_identity(turn: Turn) -> bool:
    return all(turn.up(unit(axis)) == unit(axis) for axis in range(3))
