"""A spacecraft with two hinged panels, by Basilisk."""

from __future__ import annotations

import numpy as np

import kanegen as kg
from benchmarks.validation.case import Case, build, row

TIME = 2.5
"""Time of the results, s."""

OPENED = np.radians(5.0)
"""First angle of panel 1, rad; that of panel 2 is 0."""

POSITION, VELOCITY = np.array([0.1, -0.4, 0.3]), np.array([-0.2, 0.5, 0.1])
"""First position (m) and velocity (m/s) of the mass centre of the whole spacecraft."""

ROTATION_RATE = np.array([0.1, -0.1, 0.1])
"""First angular velocity of the hub, rad/s."""

FINAL_POSITION = "-0.15832794740648992 1.122481716747217 -0.37975995949382907"
FINAL_ORIENTATION = "0.06170318243240492 -0.07089090074412899 0.06409500412692531"

ACCURACY = 1e-10
"""Relative difference that the test of Basilisk allows."""


def case() -> Case:
    """Return the case: position and orientation of the hub after some seconds."""
    library = build("hinged_panels", "forward_dynamics", "coordinate_rates")
    center = _center()
    x = np.array([1.0, 0.0, 0.0, 0.0, OPENED, 0.0, *(POSITION - center)])
    y = np.array([*ROTATION_RATE, 0.0, 0.0, *(VELOCITY - np.cross(ROTATION_RATE, center))])
    run = kg.simulate(library, x, y, [0.0, TIME], method="DOP853", tolerance=1e-13)
    scalar, *vector = run.x[-1, :4] / np.linalg.norm(run.x[-1, :4])
    parameters = np.array(vector) / (1 + scalar)
    rows = []
    for quantity, unit, text, found in (
        ("position of B", "m", FINAL_POSITION, run.x[-1, 6:]),
        ("modified Rodrigues parameters", "1", FINAL_ORIENTATION, parameters),
    ):
        allowed = ACCURACY * np.linalg.norm(np.array(text.split(), float))
        rows.append(row(f"{quantity} at {TIME:g} s", unit, text, found, float(allowed)))
    return Case(
        title="Hinged panels by Basilisk",
        model="hinged_panels",
        source=(
            "Basilisk of the AVS Lab, University of Colorado, `hingedRigidBodyNoGravity` in "
            "`src/simulation/dynamics/HingedRigidBodies/_UnitTest/test_hingedRigidBodyStateEffector.py`."
        ),
        problem=(
            "A free hub of 750 kg turns and carries two panels of 100 kg on hinges with springs, of which "
            "one starts 5° open: a tree of three bodies with eight freedoms. `forward_dynamics` and "
            "`coordinate_rates` in C, integrated by DOP853 with the tolerance 1e-13."
        ),
        allowance=f"The relative accuracy of the test, {ACCURACY:g}; its numbers have 16 digits.",
        rows=tuple(rows),
    )


def _center() -> np.ndarray:
    """Return the first position of the mass centre of the whole from point B, in the hub, m."""
    hub, first = np.array([0.0, 0.0, 1.0]), np.array([np.cos(OPENED), 0.0, np.sin(OPENED)])
    second = np.array([-0.5 - 1.5, 0.0, 1.0])
    return (750 * hub + 100 * (np.array([0.5, 0.0, 1.0]) + 1.5 * first) + 100 * second) / 950
