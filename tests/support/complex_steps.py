"""The equations of motion by the NumPy reference for complex states, whose imaginary parts carry derivatives.

A complex step has no error but the rounding of the reference, which computes no derivative itself (Squire and
Trapp 1998).
"""

from __future__ import annotations

from typing import Any

import numpy as np

import kanegen as kg
from kanegen.reference import equations as reference
from kanegen.reference.kinematics import kinematics
from tests.support.orientation_trees import angle_state

STEP = 1e-30
"""Length of a complex step, which cancels nothing."""


def state(system: kg.System, seed: int) -> dict[str, np.ndarray]:
    """Return a state away from gimbal lock, with quaternions of any length."""
    found = angle_state(system.with_coordinates("angles"), seed)
    if len(system.coordinates) > len(system.freedoms):
        found["x"] = np.random.default_rng(seed).uniform(-1.0, 1.0, len(system.coordinates))
    return found


def dynamics(system: kg.System, inputs: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return [A] and {f} by the reference, for real or complex numbers."""
    kind = np.result_type(inputs["x"], inputs["y"])
    x, y = inputs["x"].astype(kind), inputs["y"].astype(kind)
    loads = inputs["force"], inputs["torque"]
    return reference.mass_matrix(system, x), reference.forcing(system, x, y, *loads)


def rates_of(system: kg.System, x: Any, y: Any) -> Any:
    """Return {xdot}: Eq. (8) solved for the rates of angles, and half the product of quaternion and omega."""
    bodies = kinematics(system.values(), x, y)
    found = np.zeros(len(x), np.result_type(x, y))
    for place, coordinate in enumerate(system.coordinates):
        joint = system.bodies[coordinate.body - 1].joint
        if coordinate.is_translation or joint.speeds_are_rates:
            found[place] = y[system.freedom_names.index(system.coordinate_names[place])]
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.speeds_are_rates:
            continue
        places = [i for i, c in enumerate(system.coordinates) if c.body == k and not c.is_translation]
        omega = bodies[k - 1].relative_omega
        if len(places) == 4:
            e0, e = x[places[0]], x[places[1:]]
            found[places] = np.concatenate([[-(e @ omega)], e0 * omega + np.cross(e, omega)]) / 2
        else:
            (s2, s3), (c2, c3) = np.sin(x[places[1:]]), np.cos(x[places[1:]])
            one, zero = np.ones_like(s2), np.zeros_like(s2)
            block = np.array([[c2 * c3, s3, zero], [-c2 * s3, c3, zero], [s2, zero, one]])
            found[places] = np.linalg.solve(block, omega)
    return found
