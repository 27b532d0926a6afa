"""Systems with rotors beside the same systems in which each rotor is a body of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import kanegen as kg
from tests.support import systems

Floats = Any


@dataclass(frozen=True)
class Motor:
    """A rotor as a body of revolution: how it is mounted, and what it weighs.

    Attributes:
        freedom: The freedom that drives it.
        carrier: Number of the body that carries it, 0 for the ground.
        axis: (3,) unit vector along its axis, in the carrier.
        place: (3,) its mass centre, in the carrier (m).
        mass: Mass (kg).
        along: Inertia about the axis (kg m^2).
        across: Inertia about axes across it (kg m^2).
        ratio: Ratio of the gear.
    """

    freedom: str
    carrier: int
    axis: Floats
    place: Floats
    mass: float
    along: float
    across: float
    ratio: float


def random_motors(system: kg.System, rng: np.random.Generator, carriers: dict[str, int]) -> list[Motor]:
    """Return random motors for freedoms, by name, in bodies."""
    found = []
    for freedom, carrier in carriers.items():
        axis = rng.normal(size=3)
        sizes = rng.uniform(0.01, 0.05, 3)
        found.append(
            Motor(
                freedom,
                carrier,
                axis / np.linalg.norm(axis),
                rng.uniform(-0.3, 0.3, 3),
                float(rng.uniform(0.2, 0.6)) if carrier else 0.0,  # the ground has no mass that counts
                float(sizes[0]),
                float(sizes[0] / 2 + sizes[1]),
                float(rng.uniform(-9, 9)),
            )
        )
    return found


def with_rotors(system: kg.System, mounted: Sequence[Motor]) -> kg.System:
    """Return the system with rotors, and with their masses and inertias in the bodies that carry them."""
    bodies = list(system.bodies)
    for motor in mounted:
        if motor.carrier:
            bodies[motor.carrier - 1] = _loaded(bodies[motor.carrier - 1], motor)
    names = ["ground", *(body.name for body in bodies)]
    rotors = [
        kg.Rotor(f"m{i}", m.freedom, tuple(3.5 * m.axis), m.along, m.ratio, names[m.carrier])
        for i, m in enumerate(mounted)
    ]
    return replace(system, bodies=tuple(bodies)).with_rotors(*rotors)


def _loaded(body: kg.Body, motor: Motor) -> kg.Body:
    """Return a body with a motor welded to it."""
    own, center, inertia = float(body.mass), np.array(body.mass_center), np.array(body.inertia)
    total = own + motor.mass
    common = (own * center + motor.mass * motor.place) / total
    whole = np.zeros((3, 3))
    turned = motor.across * np.eye(3) + (motor.along - motor.across) * np.outer(motor.axis, motor.axis)
    for mass, at, part in ((own, center, inertia), (motor.mass, motor.place, turned)):
        d = at - common
        whole += part + mass * (d @ d * np.eye(3) - np.outer(d, d))
    return replace(body, mass=total, mass_center=tuple(common), inertia=tuple(map(tuple, whole.tolist())))


def with_bodies(system: kg.System, mounted: Sequence[Motor]) -> kg.System:
    """Return the system in which every rotor is a body that turns freely in its carrier about its axis."""
    bodies = list(system.bodies)
    for i, motor in enumerate(mounted):
        across = np.linalg.svd(motor.axis[None])[2][1]
        rows = np.array([across, np.cross(motor.axis, across), motor.axis])
        joint = kg.Joint(motor.place, rows.tolist(), free=(False, False, True, False, False, False))
        inertia = np.diag([motor.across, motor.across, motor.along]).tolist()
        bodies.append(kg.Body(f"rotor{i}", motor.carrier, motor.mass, inertia, joint=joint))
    return replace(system, bodies=tuple(bodies))


def driven(small: kg.System, large: kg.System, mounted: Sequence[Motor]) -> Floats:
    """Return the matrix [G] of the speeds of the larger system by those of the smaller one."""
    names = list(small.freedom_names)
    g = np.zeros((len(large.freedoms), len(names)))
    for row, name in enumerate(large.freedom_names):
        if name in names:
            g[row, names.index(name)] = 1
        else:
            motor = mounted[int(name.removeprefix("rotor").removesuffix(".theta3"))]
            g[row, names.index(motor.freedom)] = motor.ratio
    return g


CASES = {
    "in the lower bodies": {"body2.theta3": 1, "body3.theta3": 2, "body4.theta3": 2},
    "in the bodies of the joints": {"body2.theta3": 2, "body3.theta3": 3, "body4.theta3": 4},
    "on a floating base": {"body2.theta3": 1, "body3.theta3": 1, "body1.s2": 1},
    "far inward, far outward, across and on the ground": {
        "body4.theta3": 1,
        "body2.theta3": 3,
        "body3.theta3": 4,
        "body1.theta2": 0,
    },
    "several for one freedom": {"body3.theta3": 2, "body3.theta3 ": 3, "body3.theta3  ": 1},
}


def case(name: str) -> tuple[kg.System, kg.System, list[Motor], Floats]:
    """Return a floating base with a chain and a branch, with rotors and with bodies, its motors and [G]."""
    rng = np.random.default_rng(sorted(CASES).index(name))
    free = systems.flags(4, ["theta3"])
    free[0] = True
    bare = systems.random_system(rng, 4, connection=(0, 1, 2, 2), free=free, loads=False)
    mounted = [replace(m, freedom=m.freedom.strip()) for m in random_motors(bare, rng, CASES[name])]
    small, large = with_rotors(bare, mounted), with_bodies(bare, mounted)
    return small, large, mounted, driven(small, large, mounted)
