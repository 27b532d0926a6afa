"""Random trees that draw every kind of orientation, coordinate, speed, force element and parameter together.

A fault that needs two kinds at once, such as a damped spring on a body whose speeds are its angular velocity,
shows only where both are drawn into one tree.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import count, pairwise
from typing import Any

import numpy as np

import kanegen as kg
from kanegen.model.coordinates import FREEDOMS, SEQUENCES, SPEED_KINDS
from kanegen.model.force_elements.elements import (
    Drive,
    JointFriction,
    JointSpring,
    PointLoad,
    Potential,
    Spring,
)
from kanegen.model.force_elements.names import coordinate_places, speed_places
from kanegen.model.grammar import parse
from kanegen.model.joint import IDENTITY
from kanegen.model.numbers import Number
from tests.support import systems
from tests.support.couplings import random_couplings
from tests.support.random_contacts import with_contacts

ROTATIONS = ("angle rates", "angular velocity", "quaternion", "two angles", "hinge", "none")
"""Kinds of rotations: of the first three all angles are free, of the others the rest are locked."""

ORIENTATIONS = ("none", "matrix", "right angles", "three parameters", "parameters and numbers")
"""Kinds of constant orientations of a joint frame."""

QUARTER = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


class Drawing:
    """A source of numbers, of which about every fifth becomes a parameter of its own, or an expression.

    Attributes:
        rng: Source of everything random.
        share: Share of the numbers that become parameters or expressions of parameters.
        prefix: Beginning of the names of these parameters.
    """

    def __init__(self, rng: np.random.Generator, share: float = 0.2, prefix: str = "p") -> None:
        self.rng, self.share, self.prefix = rng, share, prefix
        self._names, self._forms = count(), count()

    def parameter(self, value: float) -> kg.Parameter:
        return kg.Parameter(f"{self.prefix}{next(self._names)}", float(value))

    def number(self, value: float) -> Number:
        return self.of_parameters(float(value)) if self.rng.random() < self.share else float(value)

    def of_parameters(self, value: float) -> Number:
        """Return a parameter or an expression with this value, which changes by no more than they do."""
        match next(self._forms) % 7:
            case 1:
                return -self.parameter(-value)
            case 2:
                return self.parameter(3 * value) / 3
            case 4:
                return 0.75 * value + self.parameter(3 * value) * self.parameter(1.0) ** 2 / 12
            case 5:
                tilt = self.parameter(0.2)
                return self.parameter(value) * np.cos(tilt) / np.cos(0.2)
        return self.parameter(value)

    def vector(self, size: float = 1.0) -> tuple[Number, ...]:
        return tuple(self.number(value) for value in self.rng.uniform(-size, size, 3))

    def angles(self) -> list[float]:
        return [float(angle) for angle in self.rng.uniform(-3.0, 3.0, 3)]

    def one_of(self, names: Any) -> Any:
        return names[int(self.rng.integers(len(names)))]


EFFORTS = (
    "tanh(5*y.Y)*max(0, x.X)",
    "atan2(y.Y, 2 + x.X**2) - atan2(2 + x.X**2, -y.Y)",
    "exp(-x.X**2)*sign(y.Y)*sqrt(abs(x.X))",
    "min(x.X, y.Y, 0.3)*pi - log(2 + abs(x.X))",
    "x.X**2 if 0 < x.X and y.Y <= 0.5 or not x.X > -0.5 else log(2 + x.X)*y.Y",
    "max(x.X, -x.X, 0.2)/(1 if y.Y > 0 else 2)",
)
"""Efforts with every function of expressions but sine and cosine, of a coordinate X and a speed Y."""

ENERGIES = (
    "tanh(x.A)*log(2 + x.B**2) + max(0, -x.A)**2",
    "abs(x.B)**3 + exp(-x.A**2)*atan2(x.B, 2 + x.A**2)",
    "(x.A**3 if x.B > 0.1 else sqrt(1 + x.B)*0.3 if x.B > -1 else 2) + min(x.A, x.B)",
    "sqrt(x.A**2 + x.B**2)*sign(x.A)*x.A",
)
"""Energies with the same functions, of two coordinates A and B."""


def everything(seed: int, bodies: int = 4) -> kg.System:
    """Return a random tree of `ROTATIONS` and `ORIENTATIONS`, with force elements, contacts and parameters.

    The kinds of rotations and orientations are taken in turn, so that the bodies of successive seeds have
    every pair of them. Trees of odd seeds have couplings.
    """
    drawing = Drawing(np.random.default_rng(seed))
    tree = [_body(drawing, k, seed * bodies + k) for k in range(bodies)]
    tree = with_motors(tree, Drawing(np.random.default_rng([seed, 1]), prefix="motor"))
    gravity = drawing.vector(6.0)
    system = kg.System("everything", tuple(tree), gravity)
    system = _acted_on(_with_frames(system, drawing), drawing)
    system = _with_wrench(system, np.random.default_rng([seed, 4]))
    system = with_rotors(system, Drawing(np.random.default_rng([seed, 2]), prefix="rotor"))
    system = random_couplings(system, np.random.default_rng([seed, 3]), 0.3) if seed % 2 else system
    return with_contacts(system, np.random.default_rng([seed, 5]))


def _body(drawing: Drawing, k: int, turn: int) -> kg.Body:
    rng = drawing.rng
    mass = float(rng.uniform(0.5, 2.0))
    inertia = (systems.random_inertia(rng, mass, 0.6) + 0.4 * mass * np.eye(3)).tolist()
    inertia[0][0] = drawing.number(inertia[0][0])  # a real body for every value that is near
    kind = ROTATIONS[turn % len(ROTATIONS)]
    orientation = ORIENTATIONS[turn % len(ORIENTATIONS)]
    return kg.Body(
        f"b{k + 1}",
        int(rng.integers(max(0, k - 1), k + 1)),
        drawing.number(mass),
        inertia,
        drawing.vector(0.5),
        _joint(drawing, kind, orientation),
        loads=bool(rng.random() < 0.5),
        points=(kg.Point(f"at{k + 1}", drawing.vector(), loads=bool(rng.random() < 0.3)),),
    )


def _joint(drawing: Drawing, kind: str, orientation: str) -> kg.Joint:
    """Return a joint whose locked freedoms stand at numbers and parameters."""
    angles = {"two angles": 2, "hinge": 1, "none": 0}.get(kind, 3)
    free = np.zeros(6, dtype=bool)
    free[drawing.rng.permutation(3)[:angles]] = True
    free[3:] = drawing.rng.random(3) < (0.25 if angles else 0.6)
    return kg.Joint(
        position=drawing.vector(),
        orientation=_orientation(drawing, orientation),
        free=tuple(map(bool, free)),
        locked=tuple(0.0 if flag else drawing.number(drawing.rng.uniform(-1, 1)) for flag in free),
        speeds="angle_rates" if kind != "angular velocity" else "angular_velocity",
        sequence="1-2-3" if kind == "quaternion" else drawing.one_of(list(SEQUENCES)),
        coordinates="quaternion" if kind == "quaternion" else "angles",
    )


def with_motors(bodies: list[kg.Body], drawing: Drawing) -> list[kg.Body]:
    """Return the bodies with armature at about a third of their freedoms, locked ones among them."""
    armed = []
    for body in bodies:
        sizes = drawing.rng.uniform(0.1, 2.0, 6) * (drawing.rng.random(6) < 0.3)
        armature = tuple(drawing.number(size) if size else 0.0 for size in sizes)
        armed.append(replace(body, joint=replace(body.joint, armature=armature)))
    return armed


def with_rotors(system: kg.System, drawing: Drawing, count: int = 3) -> kg.System:
    """Return the system with rotors on random freedoms, most of them in the lower body of the joint."""
    rated, carriers = _rated(system), ["", "", "", "ground", *system.frame_names]
    rotors = [
        kg.Rotor(
            f"motor{i}",
            drawing.one_of(rated),
            tuple(drawing.rng.normal(size=3)),
            drawing.number(drawing.rng.uniform(0.001, 0.01)),
            drawing.number(drawing.rng.uniform(-20, 20)),
            drawing.one_of(carriers),
        )
        for i in range(count if rated else 0)
    ]
    return system.with_rotors(*rotors)


def _orientation(drawing: Drawing, kind: str) -> Any:
    match kind:
        case "matrix":
            return systems.random_rotation(drawing.rng).tolist()
        case "right angles":
            return QUARTER.tolist()
        case "three parameters":
            return [drawing.parameter(angle) for angle in drawing.angles()]
        case "parameters and numbers":
            first, second, third = drawing.angles()
            return [first, drawing.parameter(second), third]
    return IDENTITY


def _with_frames(system: kg.System, drawing: Drawing) -> kg.System:
    """Return the system with frames: of a body for its users, in others, on the ground; some with a point."""
    names = [body.name for body in system.bodies]
    frames: dict[str, Any] = {"on_ground": ("ground", drawing.vector(), drawing.angles())}
    points: dict[str, Any] = {}
    for name in names:
        if drawing.rng.random() < 0.5:
            frames[name] = (name, drawing.vector(), _orientation(drawing, drawing.one_of(ORIENTATIONS)))
        for inner in range(int(drawing.rng.integers(3))):
            place = drawing.one_of([other for other in (name, *frames) if other.startswith(name)])
            orientation = _orientation(drawing, drawing.one_of(ORIENTATIONS))
            frames[f"{name}f{inner}"] = (place, drawing.vector(), orientation)
    for name in drawing.rng.permutation([name for name in frames if name not in names])[:2]:
        if not str(name).startswith("on"):
            points[f"at_{name}"] = (str(name), drawing.vector())
    return system.with_frames(frames).with_points(points)


def _with_wrench(system: kg.System, rng: np.random.Generator) -> kg.System:
    """Return the system, in every other draw with a load in components of a frame, if a body has one."""
    bodies = {body.name for body in system.bodies}
    inner = [frame.name for frame in system.frames if frame.body and frame.name not in bodies]
    return system.with_loads(str(rng.choice(inner))) if inner and rng.random() < 0.5 else system


def _acted_on(system: kg.System, drawing: Drawing) -> kg.System:
    """Return the system with springs, drives, loads on points and a potential between random places."""
    every = [point.name for _, point in system.points]
    ends = [body.points[0].name for body in system.bodies]
    above = drawing.one_of([*every, *(frame.name for frame in system.frames if frame.body)])
    elements: list[kg.ForceElement] = [
        Spring((drawing.vector(2.0), above), drawing.number(3.0), drawing.number(0.7), drawing.number(0.6)),
        *(
            Spring((low, high), drawing.number(2.0), 0.4 * (k % 2), drawing.number(0.5))
            for k, (low, high) in enumerate(pairwise(ends))
        ),
    ]
    coordinates, speeds = _variables(system)
    stiffness, rate = drawing.parameter(1.5), drawing.parameter(0.8)
    parameters = [stiffness, rate]
    for speed in drawing.rng.permutation(speeds)[:3]:
        x, y = drawing.one_of(coordinates), drawing.one_of(speeds)
        text = f"{stiffness.name}*sin({rate.name}*t) - y.{y}*abs(x.{x})/(2 + x.{x}**2) - 0.3*y.{speed}"
        elements.append(Drive(str(speed), parse(text, parameters)))
    x, y = drawing.one_of(coordinates), drawing.one_of(speeds)
    force = (parse(f"-2*y.{y}"), parse("cos(t)"), parse(f"x.{x}*{stiffness.name}", parameters))
    elements.append(
        PointLoad(
            drawing.one_of([*every, *system.frame_names[:2]]),
            force=force,
            moment=(0, parse(rate.name, parameters), 2),
        )
    )
    rated = _rated(system)
    if rated:
        a, b = drawing.one_of(rated), drawing.one_of(rated)
        roots = f"sqrt(4 + x.{b}**2)**3 + 1/sqrt(3 + x.{a}**2)**3"
        energy = f"{stiffness.name}*cos(x.{a} - 2*x.{b})*x.{a}**3 + {roots}"
        elements.append(Potential(parse(energy, parameters)))
        elements.append(JointSpring(b, drawing.number(1.2), drawing.number(0.3), drawing.number(0.4)))
        energy = drawing.one_of(ENERGIES).replace("A", a).replace("B", b)
        elements.append(Potential(parse(f"{stiffness.name}*({energy})", parameters)))
    elements.append(JointFriction(str(drawing.one_of(speeds)), drawing.number(0.7), drawing.number(0.6)))
    effort = drawing.one_of(EFFORTS).replace("X", x).replace("Y", y)
    elements.append(Drive(drawing.one_of(speeds), parse(f"{rate.name}*({effort})", parameters)))
    k = int(drawing.rng.integers(len(system.bodies))) + 1
    frame = drawing.one_of([name for name in system.frame_names if system.frame(name).body == k])
    thrust = (0.5, parse(rate.name, parameters), parse(f"sin(x.{x})"))
    elements.append(PointLoad(ends[k - 1], force=thrust, moment=(1.5, 0, parse("cos(t)")), frame=frame))
    return system.with_force_elements(*elements)


def _variables(system: kg.System) -> tuple[list[str], list[str]]:
    """Return the names of the coordinates and of the speeds that move."""
    bodies = system.bodies
    coordinates = [
        name
        for name, (k, kind) in coordinate_places(bodies).items()
        if kind >= len(FREEDOMS) or bodies[k - 1].joint.free[kind]
    ]
    speeds = [name for name, (k, index) in speed_places(bodies).items() if bodies[k - 1].joint.free[index]]
    return coordinates, speeds


def _rated(system: kg.System) -> list[str]:
    """Return the names of the free coordinates whose rates are speeds."""
    return [
        f"{body.name}.{FREEDOMS[index]}"
        for body in system.bodies
        for index, kind in enumerate(body.joint.speed_kinds)
        if body.joint.free[index] and SPEED_KINDS[kind].is_rate
    ]


def other_parameters(system: kg.System, seed: int) -> dict[str, float]:
    """Return values of all parameters that differ from their defaults by up to a fifth."""
    factors = np.random.default_rng(seed).uniform(0.8, 1.2, len(system.parameters))
    return {p.name: p.value * f for p, f in zip(system.parameters, factors.tolist(), strict=True)}


def without_actions(system: kg.System) -> kg.System:
    """Return the system without force elements and loads on points, for which there is certified truth."""
    bodies = tuple(
        replace(body, points=tuple(replace(point, loads=False) for point in body.points))
        for body in system.bodies
    )
    return replace(system, bodies=bodies, force_elements=())
