"""Random force elements for every test."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import kanegen as kg
from kanegen.model.force_elements.elements import Drive, JointSpring, PointLoad, Potential, Spring
from kanegen.model.grammar import parse
from kanegen.model.numbers import Parameter

K, W = Parameter("k", 3.0), Parameter("w", 2.0)


def pointed(system: kg.System, seed: int) -> kg.System:
    """The system with a point on every body, of which every other one takes loads."""
    rng = np.random.default_rng(seed)
    bodies = tuple(
        replace(body, points=(kg.Point(f"p{k}", tuple(rng.normal(size=3)), loads=k % 2 == 0),))
        for k, body in enumerate(system.bodies)
    )
    return replace(system, bodies=bodies)


def acted_on(system: kg.System, seed: int) -> kg.System:
    """The system with everything on it that can act, between freedoms and bodies of a random choice."""
    rng, bodies, system = np.random.default_rng(seed), system.number_of_bodies, pointed(system, seed)
    freedoms = [system.freedom_names[i] for i in rng.integers(0, len(system.freedoms), 4)]
    a, b, c, d = freedoms
    one, two = rng.permutation(bodies)[:2] if bodies > 1 else (0, 0)
    elements: list[kg.ForceElement] = [
        JointSpring(a, K, 0.2, 0.7),
        JointSpring(f"{system.bodies[0].name}.theta2", 1.5),
        Drive(b, parse(f"k*sin(w*t) - y.{c}*abs(x.{d})/(2 + x.{a}**2)", [K, W])),
        Potential(parse(f"k*cos(x.{a} - 2*x.{b})*x.{c}**3 + sqrt(4 + x.{d}**2)", [K])),
        PointLoad(
            f"p{one}", force=(parse(f"-2*y.{a}"), parse("cos(t)"), 1.5), moment=(0, parse("k", [K]), 2)
        ),
        Spring(((1.0, -2.0, 0.5), f"p{two}"), stiffness=4.0, rest_length=K, damping=0.3),
    ]
    if bodies > 1:
        elements.append(Spring((f"p{one}", f"p{two}"), stiffness=K, damping=W))
    return system.with_force_elements(*elements)
