"""Random trees on a floating base."""

from __future__ import annotations

from typing import Any

import numpy as np

import kanegen as kg
from tests.support import random_trees, systems

HINGE = (False, False, True, False, False, False)


def floating(seed: int, kind: str) -> kg.System:
    """Return a floating base with hinges, a ball joint and a slide, motors, loads and force elements.

    Args:
        seed: Seed of all numbers.
        kind: How the base is oriented: "angles", "angular velocity" or "quaternion".
    """
    drawing = random_trees.Drawing(np.random.default_rng(seed))
    frees = [(True,) * 6, HINGE, HINGE, (True, True, True, False, False, False), HINGE[::-1]]
    bodies = []
    for k, (lower, free) in enumerate(zip((0, 1, 1, 2, 3), frees, strict=True)):
        mass = float(drawing.rng.uniform(0.5, 2.0))
        inertia = systems.random_inertia(drawing.rng, mass, 0.6) + 0.4 * mass * np.eye(3)
        is_free = kind if k == 0 else "quaternion" if kind == "quaternion" and all(free[:3]) else "angles"
        joint = kg.Joint(
            position=drawing.vector(),
            orientation=systems.random_rotation(drawing.rng).tolist(),
            free=free,
            speeds="angle_rates" if is_free == "angles" else "angular_velocity",
            coordinates="quaternion" if is_free == "quaternion" else "angles",
            armature=(0.0, 0.0, 0.3, 0.0, 0.0, 0.0) if k == 2 else (0.0,) * 6,
        )
        bodies.append(
            kg.Body(
                f"b{k + 1}",
                lower,
                drawing.number(mass),
                inertia.tolist(),
                drawing.vector(),
                joint,
                loads=k in (0, 3),
            )
        )
    elements: list[Any] = [kg.JointSpring("b2.theta3", stiffness=3.0, damping=0.5)]
    if kind == "quaternion":
        elements.append(kg.Spring(("b5", (0.5, 1.0, 2.0)), stiffness=9.0, damping=1.0))
    return kg.System("floating", tuple(bodies), (0.3, -0.2, -9.81), force_elements=tuple(elements))
